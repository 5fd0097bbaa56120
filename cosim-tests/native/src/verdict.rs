//! The verdict in words. The only place that writes it.

use std::fmt;

use lander_models::vehicle::Leg;
use lander_models::{Outcome, Scenario, Vehicle};

use crate::results::Results;

/// Usual touchdown limits of small robotic landers: 2 m/s down, 0.5 m/s across.
pub const DOWN_LIMIT_M_S: f64 = 2.0;
pub const ACROSS_LIMIT_M_S: f64 = 0.5;

pub struct Verdict<'a> {
    pub results: &'a Results,
    pub scenario: &'a Scenario,
    pub vehicle: &'a Vehicle,
}

/// The gate passes what the truth model calls landed, and nothing else.
pub fn gate_passed(results: &Results) -> bool {
    results.outcome == Outcome::Landed
}

impl Verdict<'_> {
    fn headline(&self) -> String {
        let r = self.results;
        let limits = &self.scenario.touchdown;
        match r.outcome {
            Outcome::Landed => "LANDED upright".to_owned(),
            Outcome::Slid => format!(
                "SLID: upright, but beyond the limit of {} m or still sliding",
                limits.slide_limit_m
            ),
            Outcome::Tipped => format!("TIPPED OVER at {:.2} s", r.value("tip_time_s")),
            Outcome::Struck => "STRUCK the ground with its hull or nozzle".to_owned(),
            Outcome::Bottomed => "BOTTOMED: a strut used up its stroke".to_owned(),
            Outcome::Crashed => {
                format!("CRASHED: first contact above {} m/s", limits.crash_speed_m_s)
            }
            Outcome::NoContact => "NO CONTACT: time ran out before a touchdown".to_owned(),
            Outcome::InFlight => "INTERRUPTED: the run ended before its outcome".to_owned(),
        }
    }

    /// A line for each thing that was measured.
    fn lines(&self) -> Vec<(&'static str, String)> {
        let r = |name: &str| self.results.value(name);
        let strokes_m = self.vehicle.gear.legs.iter().map(Leg::strut_stroke_max_m);
        let strut_stroke_max_m = strokes_m.fold(0.0, f64::max);
        // Only a landing is known to have come to rest.
        let end = if gate_passed(self.results) { "at rest" } else { "at the end" };
        let all = [
            (
                "contact speed",
                measured([r("contact_speed_down_m_s"), r("contact_speed_across_m_s")], |[d, a]| {
                    format!(
                        "{d:.2} m/s down (limit {DOWN_LIMIT_M_S:.1}), \
                         {a:.2} m/s across (limit {ACROSS_LIMIT_M_S:.1})"
                    )
                }),
            ),
            (
                "at contact",
                measured([r("contact_tilt_deg"), r("contact_rate_deg_s")], |[tilt, rate]| {
                    format!("tilt {tilt:.1} deg, rate {rate:.1} deg/s")
                }),
            ),
            (
                end,
                measured([r("rest_tilt_deg"), r("slide_distance_m")], |[tilt, slid]| {
                    format!("tilt {tilt:.1} deg, slid {slid:.2} m")
                }),
            ),
            (
                "legs",
                measured([r("peak_stroke_m"), r("peak_leg_load_n")], |[stroke, load]| {
                    let (max_m, load_kn) = (strut_stroke_max_m, load / 1e3);
                    format!("stroke {stroke:.3} of {max_m:.3} m, load {load_kn:.1} kN")
                }),
            ),
            (
                "tip-over margin",
                measured([r("tip_energy_margin_j")], |[margin]| format!("{margin:.0} J")),
            ),
            (
                "position",
                measured([r("position_error_m")], |[error]| {
                    format!("{error:.2} m from the target")
                }),
            ),
            (
                "propellant",
                measured([r("propellant_used_kg")], |[used]| {
                    let left = self.scenario.initial.propellant_kg - used;
                    format!("{used:.2} kg used, {left:.2} kg left")
                }),
            ),
            (
                "time",
                measured([r("flight_time_s"), self.results.end_time_s], |[flight, end]| {
                    format!("{flight:.2} s of flight, {end:.2} s in all")
                }),
            ),
            (
                "dead zone",
                measured([r("dead_zone_time_s")], |[time]| {
                    format!("{time:.2} s of thrust commands below combustion")
                }),
            ),
        ];
        all.into_iter().filter_map(|(label, text)| Some((label, text?))).collect()
    }
}

impl fmt::Display for Verdict<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} ({})", self.headline(), self.results.scenario)?;
        for (label, text) in self.lines() {
            writeln!(f, "  {label:<16} {text}")?;
        }
        Ok(())
    }
}

fn measured<const N: usize>(values: [f64; N], text: impl Fn([f64; N]) -> String) -> Option<String> {
    values.iter().all(|value| value.is_finite()).then(|| text(values))
}
