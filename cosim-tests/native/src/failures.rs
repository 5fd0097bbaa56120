//! Landings with a failure on board: the perturbed landing of `descents` with one of the ten modes
//! set in, with guidance that looks for failures and with guidance that does not.

use std::ops::ControlFlow;

use guidance_fmu::Guidance;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{ConfigError, ModelError, Outcome, Scenario, Vehicle};
use rayon::prelude::*;
use serde::Serialize;
use truth_model::TruthModel;

use crate::landing::Error;
use crate::layout::Layout;
use crate::master::Master;
use crate::schedule::{Pair, Schedule};

/// Site, start and perturbations.
const BASE: &str = include_str!("../../../models/scenarios/monte-carlo.toml");

/// One of the ten modes, as bad as the campaign has it.
#[derive(Clone, Copy, Debug)]
pub struct Failure {
    pub name: &'static str,
    /// Of the scenario, with `ONSET` in place of its time.
    pub tables: &'static str,
    /// Whether guidance flies on a filter over raw readings.
    pub sensors: bool,
}

const fn failure(name: &'static str, tables: &'static str) -> Failure {
    Failure { name, tables, sensors: false }
}

/// The ten modes; two of them twice.
pub const FAILURES: [Failure; 12] = [
    failure("engine shut-off", "[faults.engine_shutoff]\nonset = ONSET"),
    failure(
        "thrust loss 70 %",
        "[faults.thrust_degradation]\nonset = ONSET\nfraction = { value = 0.7, unit = \"1\" }",
    ),
    failure(
        "brown-out 1 s",
        "[faults.power_brownout]\nonset = ONSET\nduration = { value = 1.0, unit = \"s\" }",
    ),
    failure("altimeter lost", "[faults.sensor_failure]\nonset = ONSET\nsensor = \"altimeter\""),
    Failure {
        name: "IMU lost",
        tables: "[faults.sensor_failure]\nonset = ONSET\nsensor = \"imu\"",
        sensors: true,
    },
    failure(
        "pair stuck, pitch",
        "[faults.rcs_stuck]\nonset = ONSET\naxis = \"y\"\nsense = \"negative\"",
    ),
    failure("pair stuck, roll", "[faults.rcs_stuck]\nonset = ONSET\naxis = \"z\""),
    failure(
        "leak 4 kg/s",
        "[faults.propellant_leak]\nonset = ONSET\nflow = { value = 4.0, unit = \"kg/s\" }",
    ),
    failure("gimbal seized", "[faults.gimbal_seizure]\nonset = ONSET"),
    failure(
        "computer reset 0.5 s",
        "[faults.computer_reset]\nonset = ONSET\nduration = { value = 0.5, unit = \"s\" }",
    ),
    failure(
        "slosh 20 deg",
        "[slosh]\nactive = \"on\"\n[faults.slosh]\nonset = ONSET\n\
         angle = { value = 20.0, unit = \"deg\" }",
    ),
    failure(
        "nozzle erosion",
        "[faults.nozzle_erosion]\nonset = ONSET\nrate = { value = 0.1, unit = \"1/s\" }\n\
         pointing_rate = { value = 0.3, unit = \"deg/s\" }",
    ),
];

/// Before the first burn, between the burns, early and late in the last one.
pub const ONSETS_S: [f64; 4] = [0.5, 6.0, 20.0, 22.0];
/// Unperturbed, and two draws of the perturbations.
pub const SEEDS: [Option<u64>; 3] = [None, Some(1), Some(2)];

/// One landing that may go wrong.
#[derive(Clone, Debug)]
pub struct Flight<'a> {
    pub failure: &'a Failure,
    pub onset_s: f64,
    /// Whether guidance looks for failures.
    pub response: bool,
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
    /// From the onset to the first declaration of anything; NaN without one.
    pub declared_after_s: f64,
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
        if self.failure.sensors {
            text += "\n[sensors]\nnavigation = \"sensors\"\n";
        }
        let onset = format!("{{ value = {:?}, unit = \"s\" }}", self.onset_s);
        text + "\n" + &self.failure.tables.replace("ONSET", &onset)
    }

    fn scenario(&self, vehicle: &Vehicle) -> Result<Scenario, ConfigError> {
        Scenario::parse("failure.toml".as_ref(), &self.scenario_text(), vehicle)
    }

    /// Flies to the verdict.
    ///
    /// # Errors
    /// A scenario that is none, a component that breaks the run off.
    pub fn fly(&self, vehicle: &Vehicle, wiring: &Wiring) -> Result<Ending, ModelError> {
        let Wiring { schedule, layout } = wiring;
        let scenario = self.scenario(vehicle)?;
        let guidance = Guidance::new(&scenario, vehicle.clone());
        let (stop_time, mut last, mut declared_s) = (scenario.stop_time, Vec::new(), f64::NAN);
        let guidance_start = guidance.initial_state();
        let truth = TruthModel::new(scenario, vehicle.clone());
        let start = truth.initial_state();
        let mut master = Master::of(schedule, (truth, start), (guidance, guidance_start));
        let declared = layout.columns("fault_declared");
        master.run::<ModelError>(stop_time, |row| {
            if declared_s.is_nan() && row[declared.clone()].contains(&1.0) {
                declared_s = row[0];
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
            declared_after_s: declared_s - self.onset_s,
        })
    }
}

/// Schedule of the two components, and what stands where in a row.
pub struct Wiring {
    schedule: Schedule,
    layout: Layout,
}

impl Wiring {
    /// # Errors
    /// A schedule that does not fit the components.
    pub fn new() -> Result<Self, Error> {
        let interfaces: Pair<&'static Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };
        let schedule = Schedule::load(&interfaces)?;
        let layout = Layout::new(&schedule, &interfaces);
        Ok(Self { schedule, layout })
    }
}

/// All onsets and seeds of one failure, seed by seed, on all cores.
///
/// # Errors
/// As `Flight::fly`.
pub fn campaign(
    failure: &Failure,
    response: bool,
    vehicle: &Vehicle,
) -> Result<Vec<Ending>, Error> {
    let wiring = Wiring::new()?;
    let cases: Vec<_> =
        SEEDS.into_iter().flat_map(|seed| ONSETS_S.map(|onset_s| (seed, onset_s))).collect();
    let endings: Result<Vec<_>, ModelError> = cases
        .par_iter()
        .map(|&(seed, onset_s)| Flight { failure, onset_s, response, seed }.fly(vehicle, &wiring))
        .collect();
    Ok(endings?)
}
