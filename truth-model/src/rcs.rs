//! Attitude thrusters: on or off, with a shortest pulse (T.69, T.70).

use lander_models::scenario::RcsStuck;
use lander_models::time::{TICK_S, Ticks};
use lander_models::vehicle::Rcs;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::engine;

/// Pulse-width pulse-frequency modulator of one axis: a pair fires once a whole pulse is owed,
/// until nothing is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Modulator {
    /// Asked for and not given yet, N·m·s.
    owed: f64,
    /// Sense of the pair that fires: 1, -1, or 0 for none.
    sense: f64,
    fired: Ticks,
}

/// What the thrusters give during one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Firing {
    pub torque_b: Vector3<f64>,
    pub flow_kg_s: f64,
}

impl Modulator {
    /// Torque about the axis during the next tick, N·m (T.69).
    fn tick(&mut self, asked_n_m: f64, max_n_m: f64, min_pulse: Ticks) -> f64 {
        let (pulse, tick) = (max_n_m * min_pulse.seconds(), max_n_m * TICK_S);
        // Half a tick against rounding of the sum.
        let slack = 0.5 * tick;
        self.owed += asked_n_m * TICK_S;
        if self.fired >= min_pulse && self.sense * self.owed <= slack {
            self.sense = 0.0;
        }
        if self.sense == 0.0 && max_n_m > 0.0 && self.owed.abs() >= pulse - slack {
            (self.sense, self.fired) = (self.owed.signum(), Ticks::ZERO);
        }
        if self.sense != 0.0 {
            self.owed -= self.sense * tick;
            self.fired += Ticks(1);
        }
        self.sense * max_n_m
    }
}

/// What the thrusters give for a torque asked, one modulator an axis. A stuck pair fires whatever
/// is asked; the pair against it still obeys.
pub fn fire(
    rcs: &Rcs,
    modulators: &mut [Modulator; 3],
    asked_b: &Vector3<f64>,
    stuck: Option<RcsStuck>,
) -> Firing {
    let mut firing = Firing::default();
    for (axis, modulator) in modulators.iter_mut().enumerate() {
        let max_n_m = rcs.torque_max_b[axis];
        let asked_n_m = asked_b[axis].clamp(-max_n_m, max_n_m);
        let given_n_m = match rcs.min_pulse {
            Some(min_pulse) => modulator.tick(asked_n_m, max_n_m, min_pulse),
            None => asked_n_m,
        };
        let (mut positive_n_m, mut negative_n_m) = (given_n_m.max(0.0), (-given_n_m).max(0.0));
        if let Some(pair) = stuck.filter(|pair| pair.axis == axis) {
            let open = if pair.sign > 0.0 { &mut positive_n_m } else { &mut negative_n_m };
            *open = max_n_m;
        }
        firing.torque_b[axis] = positive_n_m - negative_n_m;
        // (T.70) Both pairs use propellant, even against each other.
        let thrust_n = (positive_n_m + negative_n_m) / rcs.lever_arm_m;
        firing.flow_kg_s += engine::flow_kg_s(thrust_n, rcs.isp_s);
    }
    firing
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAX_N_M: f64 = 50.0;
    const PULSE: Ticks = Ticks(20);

    /// Lengths in ticks of the alternating pauses and firings for a torque held.
    fn rhythm(asked_n_m: f64, ticks: usize) -> Vec<(bool, usize)> {
        let mut modulator = Modulator::default();
        let mut lengths: Vec<(bool, usize)> = Vec::new();
        for _ in 0..ticks {
            let on = modulator.tick(asked_n_m, MAX_N_M, PULSE) != 0.0;
            match lengths.last_mut() {
                Some((last, length)) if *last == on => *length += 1,
                _ => lengths.push((on, 1)),
            }
        }
        lengths
    }

    #[test]
    fn pulses_and_pauses_have_the_lengths_of_the_closed_form() {
        for asked_n_m in [1.0, 10.0, 25.0, 40.0] {
            let share = asked_n_m / MAX_N_M;
            let lengths = rhythm(asked_n_m, 20_000);
            // The last one may be cut off.
            for (on, length) in &lengths[..lengths.len() - 1] {
                let rate = if *on { 1.0 - share } else { share };
                let expected = 20.0 / rate;
                // The debt of a tick's torque more or less at either end, and whole ticks.
                let bound = 1.0 / rate + 1.0;
                assert!((*length as f64 - expected).abs() <= bound, "{asked_n_m}: {length} ticks");
            }
        }
        assert_eq!(rhythm(MAX_N_M, 1000), [(false, 19), (true, 981)]);
        assert_eq!(rhythm(0.0, 1000), [(false, 1000)]);
    }

    #[test]
    fn no_pulse_is_shorter_than_the_shortest_and_never_more_than_one_is_owed() {
        let mut modulator = Modulator::default();
        let (mut run, mut last) = (0, 0.0);
        let (mut asked, mut given) = (0.0, 0.0);
        for n in 0..100_000_u64 {
            // A request that changes sign and size every 7 ticks.
            let torque_n_m = MAX_N_M * (2.0 * crate::random::uniform(1, "request", n / 7) - 1.0);
            let now = modulator.tick(torque_n_m, MAX_N_M, PULSE);
            asked += torque_n_m * TICK_S;
            given += now * TICK_S;
            // A pulse, and a tick's request on top.
            let bound = MAX_N_M * (PULSE.seconds() + TICK_S);
            assert!((asked - given).abs() < bound, "tick {n}: {} N.m.s owed", asked - given);
            if now != last {
                assert!(last == 0.0 || run >= 20, "tick {n}: a pulse of {run} ticks");
                (run, last) = (0, now);
            }
            run += 1;
        }
    }
}
