//! Attitude thrusters: torque felt against torque asked (G.84, G.85).

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{Evidence, Felt, lesser};
use crate::attitude::GIMBAL_THRUST_MIN_N;
use crate::disturbance::EngineEstimate;

/// Pulses of angular impulse that declare a pair stuck in a coast: the modulator owes up to one
/// of them, and nothing else turns the vehicle.
const COAST_PULSES: f64 = 2.5;
/// Shortest pulse where the vehicle's thrusters are not pulsed, s.
const PULSE_S: f64 = 0.02;
/// Time of full torque that declares it in a burn, s: the gimbal holds the vehicle meanwhile, and
/// half a period of slosh (7 rad/s), or an error of the thrust line before it is learnt, stays below.
const BURN_S: f64 = 0.6;
/// Force that is as expected, for a thrust line that can be relied on: this share and so many newton
/// about it, s being known to a few per cent and a turning IMU feeling some 25 N.
const FORCE_SHARE: f64 = 0.2;
const FORCE_N: f64 = 60.0;

/// A pair that fires whatever is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StuckPair {
    /// Body axis: 0, 1 or 2.
    pub axis: usize,
    /// Sense of its torque: 1 or -1.
    pub sign: f64,
}

/// Page's cumulative sums of the torque that nobody asked for, one for each pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ThrusterWatch {
    pub stuck: Option<StuckPair>,
    excess: [[f64; 2]; 3],
}

impl ThrusterWatch {
    /// Looks at the step, unless `doubtful`: while the thrust line may not be where it should.
    pub fn observe(
        &mut self,
        evidence: &Evidence,
        felt: &Felt,
        engine: &EngineEstimate,
        doubtful: bool,
    ) {
        let Evidence { vehicle, nav, duration, .. } = evidence;
        let (step_s, expected_b) = (duration.seconds(), engine.force_mean_b());
        let as_expected = |force_b: &Vector3<f64>| {
            let expected_n = expected_b.norm();
            (force_b.norm() - expected_n).abs() < FORCE_SHARE * expected_n + FORCE_N
        };
        let force_b = evidence.force_b(&felt.turn_b).filter(as_expected);
        let (Some(force_b), false) = (force_b, doubtful || nav.any_foot_down) else {
            self.excess = Default::default();
            return;
        };
        // (G.84)
        let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
        let by_command_b = felt.torque_b - arm_b.cross(&expected_b);
        let by_force_b = felt.torque_b - arm_b.cross(&force_b);
        let mut left_b = by_command_b.zip_map(&by_force_b, lesser);
        let most_b = vehicle.rcs.torque_max_b;
        if let Some(StuckPair { axis, sign }) = self.stuck {
            left_b[axis] -= sign * most_b[axis];
        }
        let pulse_s = vehicle.rcs.min_pulse.map_or(PULSE_S, |pulse| pulse.seconds());
        let burns = expected_b.norm() > GIMBAL_THRUST_MIN_N;
        let decision_s = if burns { BURN_S } else { COAST_PULSES * pulse_s };
        for axis in 0..3 {
            for (slot, sign) in [1.0, -1.0].into_iter().enumerate() {
                let excess = &mut self.excess[axis][slot];
                // (G.85)
                *excess = (*excess + (sign * left_b[axis] - 0.5 * most_b[axis]) * step_s).max(0.0);
                if *excess > decision_s * most_b[axis] {
                    self.excess = Default::default();
                    let refuted = self.stuck.is_some_and(|p| p.axis == axis && p.sign != sign);
                    self.stuck = (!refuted).then_some(StuckPair { axis, sign });
                    return;
                }
            }
        }
    }
}
