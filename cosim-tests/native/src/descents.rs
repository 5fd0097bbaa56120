//! Many closed-loop descents, one a seed: the default landing under the paper's perturbations, flown
//! natively by truth and guidance to the verdict.
//!
//! Runs are independent, so they are spread over threads; results stand in the order of the seeds and
//! have the same bits whatever the number of threads.

use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{Outcome, Scenario, Vehicle};
use rayon::prelude::*;
use serde::Serialize;

use crate::flight;
use crate::landing::Error;
use crate::layout::Layout;
use crate::progress::Count;
use crate::schedule::{Pair, Schedule};

/// Site, start, perturbations and the laws that land.
const BASE: &str = include_str!("../../../models/scenarios/monte-carlo.toml");

/// How guidance flies.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    pub name: &'static str,
    /// Between two plans; longer than the flight for a single plan.
    pub replan_s: f64,
    /// Whether the engine's errors are estimated and compensated.
    pub compensation: bool,
    /// Whether the path is followed between plans.
    pub tracking: bool,
    /// Whether the terminal law lands.
    pub terminal_law: bool,
    /// Whether a filter over the sensors' readings navigates, towards a target on the landmarks' map.
    pub filter: bool,
}

/// A plan each half second and every law on: how this guidance lands.
pub const CLOSED_LOOP: Scheme = Scheme {
    name: "closed-loop",
    replan_s: 0.5,
    compensation: true,
    tracking: true,
    terminal_law: true,
    filter: false,
};
/// The same on the navigation filter.
pub const FILTER: Scheme = Scheme { name: "filter", filter: true, ..CLOSED_LOOP };
/// The same laws, a plan each ten seconds.
pub const SLOW: Scheme = Scheme { name: "slow", replan_s: 10.0, ..CLOSED_LOOP };
/// A plan each ten seconds down to the cut-off, flown without feedback in between: the paper's.
pub const PAPER: Scheme = Scheme {
    name: "paper",
    replan_s: 10.0,
    compensation: false,
    tracking: false,
    terminal_law: false,
    filter: false,
};
/// The first plan's thrust, to the end.
pub const OPEN_LOOP: Scheme = Scheme { name: "open-loop", replan_s: 60.0, ..PAPER };

/// How one descent ended.
#[derive(Clone, Debug, Serialize)]
pub struct Descent {
    pub seed: u64,
    pub outcome: &'static str,
    pub landed: bool,
    /// NaN, as the rest of the contact's, without a contact.
    pub miss_m: f64,
    pub down_m_s: f64,
    pub across_m_s: f64,
    pub tilt_deg: f64,
    pub rate_deg_s: f64,
    pub propellant_kg: f64,
    pub flight_s: f64,
    pub plans_failed: f64,
}

impl Scheme {
    /// The run of a seed as a scenario file, for a vehicle file at `vehicle`.
    pub fn scenario_text(&self, vehicle: &str, seed: u64) -> String {
        let on = |on| if on { "on" } else { "off" };
        let laws = format!(
            "[guidance]\nreplan_period = {{ value = {:?}, unit = \"s\" }}\n\
             compensation = \"{}\"\ntracking = \"{}\"\nterminal_law = \"{}\"",
            self.replan_s,
            on(self.compensation),
            on(self.tracking),
            on(self.terminal_law)
        );
        let (sensors, map) = if self.filter {
            ("[sensors]\nnavigation = \"sensors\"\n\n", "\ntarget_on = \"map\"")
        } else {
            Default::default()
        };
        BASE.replace("../vehicles/bug.toml", vehicle)
            .replace("name = \"monte-carlo\"", &format!("name = \"{}-{seed}\"", self.name))
            .replace("[guidance]", &format!("{sensors}{laws}{map}"))
            .replace("seed = { value = 1,", &format!("seed = {{ value = {seed},"))
    }

    /// Flies the runs of `seeds` on so many threads; 0 takes all cores. A run that a component
    /// breaks off has the outcome `failed`; flown by itself it tells why.
    ///
    /// # Errors
    /// A scheme that makes no scenario, threads that don't start.
    pub fn fly(
        &self,
        vehicle: &Vehicle,
        seeds: &[u64],
        threads: usize,
    ) -> Result<Vec<Descent>, Error> {
        let interfaces: Pair<&'static Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };
        let schedule = Schedule::load(&interfaces)?;
        let layout = Layout::new(&schedule, &interfaces);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let progress = Count::new(self.name, seeds.len());
        let run_one = |seed: &u64| {
            let text = self.scenario_text("vehicle.toml", *seed);
            let scenario = Scenario::parse("monte-carlo.toml".as_ref(), &text, vehicle)?;
            let row = flight::last_row(&schedule, (&scenario, vehicle), (&scenario, vehicle));
            progress.one_more();
            Ok(row.map_or(Descent::failed(*seed), |row| Descent::from_row(*seed, &layout, &row)))
        };
        let descents: Vec<_> = pool.install(|| seeds.par_iter().map(run_one).collect());
        progress.finish();
        descents.into_iter().collect()
    }
}

impl Descent {
    fn failed(seed: u64) -> Self {
        Self {
            seed,
            outcome: "failed",
            landed: false,
            miss_m: f64::NAN,
            down_m_s: f64::NAN,
            across_m_s: f64::NAN,
            tilt_deg: f64::NAN,
            rate_deg_s: f64::NAN,
            propellant_kg: f64::NAN,
            flight_s: f64::NAN,
            plans_failed: f64::NAN,
        }
    }

    fn from_row(seed: u64, layout: &Layout, row: &[f64]) -> Self {
        let value = |name| layout.scalar(row, name);
        let outcome = Outcome::from_code(value("outcome")).unwrap_or_default();
        Self {
            seed,
            outcome: outcome.name(),
            landed: outcome == Outcome::Landed,
            miss_m: value("position_error_m"),
            down_m_s: value("contact_speed_down_m_s"),
            across_m_s: value("contact_speed_across_m_s"),
            tilt_deg: value("contact_tilt_deg"),
            rate_deg_s: value("contact_rate_deg_s"),
            propellant_kg: value("propellant_used_kg"),
            flight_s: value("flight_time_s"),
            plans_failed: value("plans_failed"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scheme_s_scenario_says_what_the_scheme_does() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/vehicles/bug.toml");
        let vehicle = Vehicle::load(file.as_ref()).unwrap();
        let text = PAPER.scenario_text("vehicle.toml", 7);
        let scenario = Scenario::parse("monte-carlo.toml".as_ref(), &text, &vehicle).unwrap();
        assert_eq!((scenario.name.as_str(), scenario.seed), ("paper-7", 7));
        assert_eq!(scenario.guidance.replan_period.seconds(), 10.0);
        assert!(!scenario.guidance.terminal_law && !scenario.guidance.tracking);
    }
}
