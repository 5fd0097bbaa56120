//! Landings with a failure on board: the perturbed landing of `descents` with one of the ten modes
//! set in, with guidance that looks for failures and with guidance that does not.

use std::ops::ControlFlow;

use guidance_fmu::Guidance;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{ConfigError, ModelError, Outcome, Scenario, Vehicle};
use serde::Serialize;
use truth_model::TruthModel;

use crate::layout::Layout;
use crate::master::Master;
use crate::schedule::{Pair, Schedule};

/// Site, start and perturbations.
const BASE: &str = include_str!("../../../models/scenarios/monte-carlo.toml");

/// One landing that may go wrong.
#[derive(Clone, Debug)]
pub struct Flight<'a> {
    /// Table of the scenario, as `[faults.MODE]` takes it, with `ONSET` in place of its time.
    pub fault: &'a str,
    pub onset_s: f64,
    /// Whether guidance looks for failures.
    pub response: bool,
    /// Whether guidance flies on a filter over raw readings.
    pub sensors: bool,
    /// Of the perturbations; `None` flies without any.
    pub seed: Option<u64>,
}

/// How it ended.
#[derive(Clone, Debug, Serialize)]
pub struct Ending {
    pub outcome: &'static str,
    pub landed: bool,
    pub miss_m: f64,
    pub down_m_s: f64,
    pub across_m_s: f64,
    pub tilt_deg: f64,
    pub rate_deg_s: f64,
    pub propellant_left_kg: f64,
    pub flight_s: f64,
    /// Phase at the onset, by its code.
    pub phase: f64,
}

impl Flight<'_> {
    pub fn scenario_text(&self) -> String {
        let response = if self.response { "on" } else { "off" };
        let preset = if self.seed.is_some() { "monte-carlo-table" } else { "none" };
        let seed = self.seed.unwrap_or(1);
        let mut text = BASE
            .replace("[guidance]", &format!("[guidance]\nfault_response = \"{response}\""))
            .replace("\"monte-carlo-table\"", &format!("{preset:?}"))
            .replace("seed = { value = 1,", &format!("seed = {{ value = {seed},"));
        if self.sensors {
            text += "\n[sensors]\nnavigation = \"sensors\"\n";
        }
        let onset = format!("{{ value = {:?}, unit = \"s\" }}", self.onset_s);
        text + "\n" + &self.fault.replace("ONSET", &onset)
    }

    fn scenario(&self, vehicle: &Vehicle) -> Result<Scenario, ConfigError> {
        Scenario::parse("failure.toml".as_ref(), &self.scenario_text(), vehicle)
    }

    /// Flies to the verdict, showing every row.
    pub fn fly(
        &self,
        vehicle: &Vehicle,
        schedule: &Schedule,
        layout: &Layout,
        mut see: impl FnMut(&[f64]),
    ) -> Result<Ending, ModelError> {
        let scenario = self.scenario(vehicle)?;
        let guidance = Guidance::new(&scenario, vehicle.clone());
        let (stop_time, mut last, mut phase) = (scenario.stop_time, Vec::new(), f64::NAN);
        let guidance_start = guidance.initial_state();
        let truth = TruthModel::new(scenario, vehicle.clone());
        let start = truth.initial_state();
        let mut master = Master::of(schedule, (truth, start), (guidance, guidance_start));
        master.run::<ModelError>(stop_time, |row| {
            see(row);
            if row[0] <= self.onset_s {
                phase = layout.scalar(row, "phase");
            }
            last.clear();
            last.extend_from_slice(row);
            Ok(ControlFlow::Continue(()))
        })?;
        let value = |name| layout.scalar(&last, name);
        let outcome = Outcome::from_code(value("outcome")).unwrap_or_default();
        Ok(Ending {
            outcome: outcome.name(),
            landed: outcome == Outcome::Landed,
            miss_m: value("position_error_m"),
            down_m_s: value("contact_speed_down_m_s"),
            across_m_s: value("contact_speed_across_m_s"),
            tilt_deg: value("contact_tilt_deg"),
            rate_deg_s: value("contact_rate_deg_s"),
            propellant_left_kg: value("propellant_kg"),
            flight_s: value("flight_time_s"),
            phase,
        })
    }
}

/// Schedule and layout of the two components.
pub fn wiring() -> Result<(Schedule, Layout), crate::landing::Error> {
    let interfaces: Pair<&'static Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };
    let schedule = Schedule::load(&interfaces)?;
    let layout = Layout::new(&schedule, &interfaces);
    Ok((schedule, layout))
}
