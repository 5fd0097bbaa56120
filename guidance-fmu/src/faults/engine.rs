//! Engine: thrust commanded against specific force (G.81).

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Evidence;
use crate::disturbance::EngineEstimate;

/// Below this share of the expected thrust the engine is out: at the floor 80 N, four times the
/// mean force of the paper's acceleration noise (0.05 m/s² an axis).
const OUT_SHARE: f64 = 0.1;
/// For so long, s: two correlation times of the engine's noise.
const OUT_TIME_S: f64 = 0.1;
/// Below this share it is weak: five standard deviations of the paper's thrust bias, 3 %.
const WEAK_SHARE: f64 = 0.85;
/// A share is judged once it is within so much of its mean: not in a decay, which ends as an outage.
const STEADY: f64 = 0.1;
/// Above this share, between the former and one, it is itself again.
const SOUND_SHARE: f64 = 0.9;
/// Memory of the share, s: three correlation times of the noise, which leave 0.6 % of its 1 %.
const MEMORY_S: f64 = 0.15;
/// Rise times that a start may take before it is judged: 5 % are left of the rise then.
pub const START_LAGS: f64 = 3.0;
/// An engine that is out burns again above this share of its floor, for so long.
const LIT_SHARE: f64 = 0.3;
const LIT_TIME_S: f64 = 0.03;
/// Restarts: valves open for so long, s, beyond delay and rise of the ignition, then shut for the
/// planner's least time off.
const TRY_S: f64 = 0.3;
const REST_S: f64 = 0.2;

/// What the engine does of what is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineWatch {
    /// Thrust over expected, by a short memory.
    share: f64,
    /// For how long a thrust has been judged in one go, s.
    judged_s: f64,
    /// For how long there has been none, s.
    absent_s: f64,
    weak: bool,
    out: Option<Outage>,
}

/// Since the engine was declared out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Outage {
    since_s: f64,
    burning_s: f64,
}

impl Default for EngineWatch {
    fn default() -> Self {
        Self { share: 1.0, judged_s: 0.0, absent_s: 0.0, weak: false, out: None }
    }
}

impl EngineWatch {
    /// Thrust is commanded and none comes.
    pub fn out(&self) -> bool {
        self.out.is_some()
    }

    /// Less thrust comes than any calibration explains.
    pub fn weak(&self) -> bool {
        self.weak
    }

    /// Whether valves should be open for a restart now; none is tried while the engine burns.
    pub fn tries_restart(&self, ignition_s: f64) -> bool {
        let Some(out) = self.out else { return false };
        let open_s = TRY_S + ignition_s;
        out.burning_s > 0.0 || out.since_s % (open_s + REST_S) >= REST_S
    }

    pub fn observe(&mut self, evidence: &Evidence, engine: &mut EngineEstimate) {
        let Some(force_b) = evidence.nav.specific_force_b else { return };
        let force_n = force_b.norm() * evidence.nav.mass.mass_kg;
        let step_s = evidence.duration.seconds();
        let spec = &evidence.vehicle.engine;
        match &mut self.out {
            Some(out) => {
                out.since_s += step_s;
                let burns = force_n > LIT_SHARE * spec.thrust_min_n && up(&force_b);
                out.burning_s = if burns { out.burning_s + step_s } else { 0.0 };
                if out.burning_s > LIT_TIME_S {
                    *self = Self::default();
                    engine.relit(force_n);
                } else {
                    engine.extinguished();
                }
            }
            None => self.judge(force_n, step_s, spec, engine),
        }
    }

    fn judge(
        &mut self,
        force_n: f64,
        step_s: f64,
        spec: &lander_models::vehicle::Engine,
        engine: &mut EngineEstimate,
    ) {
        let started_s = START_LAGS * spec.ignition_lag_s;
        let absent = engine.burning_n(started_s).is_some_and(|n| force_n < OUT_SHARE * n);
        self.absent_s = if absent { self.absent_s + step_s } else { 0.0 };
        let mut steady = None;
        if let Some(expected_n) = engine.steady_n(started_s) {
            let share = force_n / expected_n;
            self.judged_s += step_s;
            let gain = step_s / self.judged_s.min(MEMORY_S).max(step_s);
            self.share += gain * (share - self.share);
            let judged = self.judged_s > MEMORY_S && (share - self.share).abs() < STEADY;
            steady = judged.then_some(share);
        } else {
            self.judged_s = 0.0;
        }
        if self.absent_s > OUT_TIME_S {
            *self = Self { out: Some(Outage::default()), ..Self::default() };
            engine.extinguished();
        } else if let Some(share) = steady {
            let weak = self.share < if self.weak { SOUND_SHARE } else { WEAK_SHARE };
            if weak && !self.weak {
                engine.weakened(share);
            }
            self.weak = weak;
        }
    }
}

/// Whether a force could be the engine's: out of the nozzle's direction.
fn up(force_b: &Vector3<f64>) -> bool {
    force_b.z > 0.0
}
