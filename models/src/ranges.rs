//! Least and greatest values of signals, where there are any. An input beyond them is refused.

use std::ops::RangeInclusive;

use crate::outcome::Outcome;
use crate::signals::{
    ALTIMETER_M, FOOT_CONTACT, MASS_KG, POSITION_W, RATE_B, SENSOR_SAMPLES, SENSOR_VALID,
    SPECIFIC_FORCE_B, Signal, VELOCITY_W,
};

const FLAG: (f64, f64) = (0.0, 1.0);
const NOT_NEGATIVE: (f64, f64) = (0.0, f64::INFINITY);

/// The first six are magnitudes that a landing never reaches: a broken wire or a wrong unit, not a
/// disturbance. Ten times what the planner's envelope, the fastest tumble and the hardest blow
/// would give. Codes are described with their signal.
const RANGES: [(&str, (f64, f64)); 29] = [
    (POSITION_W.name, (-1e6, 1e6)),
    (VELOCITY_W.name, (-1e4, 1e4)),
    (RATE_B.name, (-1e2, 1e2)),
    (SPECIFIC_FORCE_B.name, (-1e5, 1e5)),
    (MASS_KG.name, (0.0, 1e6)),
    (ALTIMETER_M.name, (-1e6, 1e6)),
    (FOOT_CONTACT.name, FLAG),
    (SENSOR_VALID.name, FLAG),
    (SENSOR_SAMPLES.name, NOT_NEGATIVE),
    ("propellant_kg", NOT_NEGATIVE),
    ("propellant_used_kg", NOT_NEGATIVE),
    ("thrust_n", NOT_NEGATIVE),
    ("tilt_deg", (0.0, 180.0)),
    ("contact_active", FLAG),
    ("hull_struck", FLAG),
    ("nozzle_struck", FLAG),
    ("leg_bottomed", FLAG),
    ("outcome", (0.0, Outcome::Bottomed as u8 as f64)),
    ("flight_time_s", NOT_NEGATIVE),
    ("dead_zone_time_s", NOT_NEGATIVE),
    ("faults_active", NOT_NEGATIVE),
    ("phase", (0.0, 6.0)),
    ("plan_time_to_go_s", NOT_NEGATIVE),
    ("plans_accepted", NOT_NEGATIVE),
    ("plans_failed", NOT_NEGATIVE),
    ("nav_rejected", NOT_NEGATIVE),
    ("computer_up", FLAG),
    ("fault_declared", FLAG),
    ("goal", (0.0, 4.0)),
];

impl Signal {
    /// Of each scalar; an end that is not limited is infinite.
    pub fn range(&self) -> RangeInclusive<f64> {
        let found = RANGES.iter().find(|(name, _)| *name == self.name);
        let (least, greatest) = found.map_or((f64::NEG_INFINITY, f64::INFINITY), |entry| entry.1);
        least..=greatest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::{GUIDANCE, TRUTH};

    fn all() -> impl Iterator<Item = &'static Signal> {
        [&TRUTH, &GUIDANCE].into_iter().flat_map(|i| i.inputs.iter().chain(i.outputs))
    }

    #[test]
    fn every_range_is_of_a_signal() {
        for (name, _) in RANGES {
            assert!(all().any(|signal| signal.name == name), "{name}");
        }
    }

    #[test]
    fn every_start_is_within_its_range() {
        for signal in all() {
            assert!(signal.start.is_nan() || signal.range().contains(&signal.start), "{signal:?}");
        }
    }

    #[test]
    fn the_codes_are_all_in_range() {
        let outcome = all().find(|signal| signal.name == "outcome").unwrap();
        assert!(Outcome::ALL.iter().all(|each| outcome.range().contains(&each.code())));
    }
}
