//! Gimbal: thrust line against the angles commanded (G.82, G.83).

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::engine::START_LAGS;
use super::{Evidence, Felt, lesser};
use crate::attitude::GIMBAL_THRUST_MIN_N;
use crate::disturbance::{self, EngineEstimate, POINTING_ERROR_MAX_RAD};

/// Deviation of the thrust line's jitter, rad, and the time from one independent value to the
/// next, s: the paper's 0.5°, and twice the correlation time of the engine's noise.
const JITTER_RAD: f64 = 0.00873;
const INDEPENDENT_S: f64 = 0.1;
/// Log likelihood ratio that declares: Wald's bound ln(1/α), α = 1e-6 a decision.
const DECISION: f64 = 13.8;
/// A line that is off from where it should be by less than so many deviations is no matter; one
/// that moves by more is not seized, whatever else moves it: slosh.
const DEVIATIONS: f64 = 4.0;
/// For so long a line has to stand, s, before plans are made for it.
const PROOF_S: f64 = 0.4;
/// Over which its place is averaged, s: the jitter's correlation time, in which a free gimbal turns
/// by a degree.
const HELD_S: f64 = 0.05;
/// How far from its place a line is asked to go meanwhile, rad: well beyond `DEVIATIONS`.
const PROBE_RAD: f64 = 0.07;
/// Time over which each hypothesis learns its constant, s.
const MEMORY_S: f64 = 1.0;
/// Over which torque is averaged, s: five shortest pulses of the thrusters.
const TORQUE_MEMORY_S: f64 = 0.1;
/// Of a seized line, s: three correlation times of the jitter.
const SEIZED_MEMORY_S: f64 = 0.15;
/// Acceleration noise that a force's direction suffers from, m/s²: the paper's, each axis.
const NOISE_M_S2: f64 = 0.05;

/// Two hypotheses: the line follows the commands with a constant error, or it doesn't move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GimbalWatch {
    /// Error of a line that follows.
    error_rad: Vector2<f64>,
    /// For how long that was learnt, s.
    learnt_s: f64,
    /// The same by the torque felt, smoothed.
    by_torque_rad: Vector2<f64>,
    /// Angles of a line that doesn't.
    line_rad: Vector2<f64>,
    seen_s: f64,
    /// Page's cumulative sum of the log likelihood ratio.
    evidence: f64,
    seized: Option<Seizure>,
    /// It was declared and moved after all: an error beyond a calibration's is believed since.
    refuted: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Seizure {
    /// Angles of the line at the declaration.
    held_rad: Vector2<f64>,
    /// For how long it has stood since, s of thrust.
    stood_s: f64,
}

impl GimbalWatch {
    /// Angles of the thrust line once the gimbal is declared seized.
    pub fn seized(&self) -> Option<Vector2<f64>> {
        self.seized.map(|_| self.line_rad)
    }

    /// Where the line is asked to go once declared seized: to `trim_rad`, at first farther, so that
    /// a gimbal that is free shows it (G.88).
    pub fn asked_rad(&self, trim_rad: &Vector2<f64>) -> Option<Vector2<f64>> {
        let seizure = self.seized.as_ref()?;
        let way_rad = trim_rad - seizure.held_rad;
        let proven = seizure.stood_s > PROOF_S || way_rad.norm() > PROBE_RAD;
        let direction = way_rad.try_normalize(0.0).unwrap_or(Vector2::x());
        Some(if proven { *trim_rad } else { seizure.held_rad + direction * PROBE_RAD })
    }

    /// Whether the line has stood for long enough to plan for it.
    pub fn proven(&self) -> bool {
        self.seized.is_some_and(|seizure| seizure.stood_s > PROOF_S)
    }

    /// Whether the line may have stopped following.
    pub fn doubtful(&self) -> bool {
        self.evidence > 1.0 || self.seized.is_some()
    }

    pub fn observe(&mut self, evidence: &Evidence, felt: &Felt, engine: &mut EngineEstimate) {
        let Some(force_b) = evidence.force_b(&felt.turn_b) else { return };
        // A force that is the engine's, in a thrust that has settled.
        let started_s = START_LAGS * evidence.vehicle.engine.ignition_lag_s;
        let judged = engine.steady_n(started_s).is_some_and(|nominal_n| {
            force_b.norm() > GIMBAL_THRUST_MIN_N && force_b.norm() > 0.5 * engine.scale * nominal_n
        });
        if !judged {
            (self.seen_s, self.evidence) = (0.0, 0.0);
            return;
        }
        let expected_rad = engine.gimbal_mean_rad();
        let step_s = evidence.duration.seconds();
        let line_rad = disturbance::line_rad(&force_b);
        self.seen_s += step_s;
        let gain = |memory_s: f64| step_s / self.seen_s.min(memory_s).max(step_s);
        let sigma_rad =
            libm::hypot(JITTER_RAD, NOISE_M_S2 * evidence.nav.mass.mass_kg / force_b.norm());
        let most_rad = DEVIATIONS * sigma_rad;
        if let Some(seizure) = &mut self.seized {
            self.line_rad += (line_rad - self.line_rad) * gain(SEIZED_MEMORY_S);
            if seizure.stood_s < HELD_S {
                seizure.held_rad = self.line_rad;
            }
            seizure.stood_s += step_s;
            if (self.line_rad - seizure.held_rad).norm() > most_rad {
                // Asked to move (G.88), it did: it was something else.
                *self = Self { refuted: true, ..Self::default() };
                engine.limited(None);
                return;
            }
            engine.limited(Some(balanced_n(evidence, &self.line_rad)));
            return;
        }
        // (G.82)
        let off_rad = line_rad - expected_rad;
        let by_torque_rad = line_by_torque_rad(evidence, felt, force_b.norm()) - expected_rad;
        self.by_torque_rad += (by_torque_rad - self.by_torque_rad) * gain(TORQUE_MEMORY_S);
        let follows =
            (off_rad - self.error_rad).zip_map(&(self.by_torque_rad - self.error_rad), lesser);
        let stands = line_rad - self.line_rad;
        let ratio =
            (follows.norm_squared() - stands.norm_squared()) / (2.0 * sigma_rad * sigma_rad);
        if stands.norm() > most_rad {
            self.evidence = 0.0;
        } else if follows.norm() > most_rad && self.seen_s > INDEPENDENT_S {
            self.evidence += ratio * step_s / INDEPENDENT_S;
        } else {
            self.evidence = (self.evidence - step_s / INDEPENDENT_S).max(0.0);
        }
        // A calibration once made is only followed: what jumps is no calibration.
        if self.learnt_s < MEMORY_S || (off_rad - self.error_rad).norm() < most_rad {
            self.learnt_s += step_s;
            let gain = step_s / self.learnt_s.min(MEMORY_S).max(step_s);
            self.error_rad += (off_rad - self.error_rad) * gain;
            if !self.refuted {
                let most_rad = POINTING_ERROR_MAX_RAD;
                self.error_rad = self.error_rad.map(|angle| angle.clamp(-most_rad, most_rad));
            }
        }
        self.line_rad += stands * gain(MEMORY_S);
        if self.evidence > DECISION {
            self.line_rad = line_rad;
            self.seen_s = step_s;
            self.seized = Some(Seizure { held_rad: line_rad, stood_s: 0.0 });
        }
    }
}

/// Angles of the thrust line whose torque was felt, to first order.
fn line_by_torque_rad(evidence: &Evidence, felt: &Felt, thrust_n: f64) -> Vector2<f64> {
    let Evidence { vehicle, nav, .. } = evidence;
    let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
    let torque_m = felt.torque_b / thrust_n;
    Vector2::new(torque_m.x - arm_b.y, torque_m.y + arm_b.x) / arm_b.z
}

/// Share of the thrusters' torque that may go into balancing a thrust line that is off.
const BALANCE_SHARE: f64 = 0.7;

/// Thrust whose torque along a line the thrusters can balance, N.
fn balanced_n(evidence: &Evidence, line_rad: &Vector2<f64>) -> f64 {
    let Evidence { vehicle, nav, .. } = evidence;
    let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
    let lever_b: Vector3<f64> = arm_b.cross(&disturbance::line_b(line_rad));
    let most_b = vehicle.rcs.torque_max_b * BALANCE_SHARE;
    let along = |axis: usize| most_b[axis] / lever_b[axis].abs().max(f64::MIN_POSITIVE);
    along(0).min(along(1))
}
