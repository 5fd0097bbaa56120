//! The touchdown verdict: one function decides, from what was seen tick by tick.

use lander_models::Outcome;
use lander_models::scenario::TouchdownLimits;
use lander_models::time::Ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::stability::TipState;

/// Below these the vehicle counts as standing still: 5 mm/s crosses a pad's radius in 4 s, and
/// the contact engine's own creep is four decades smaller.
const REST_SPEED_M_S: f64 = 5e-3;
const REST_RATE_RAD_S: f64 = 1e-3;
/// For so long it must stand still to be at rest.
const REST_TIME: Ticks = Ticks(500);
/// A centre of mass outside the support for so long is not coming back: on the Moon it falls
/// outwards by g t²/2 = 0.2 m in this time.
const TIP_TIME: Ticks = Ticks(500);
/// Feet that must carry load at rest.
const REST_FEET: usize = 3;

/// State just before the tick in which the ground was first felt.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FirstContact {
    pub time: Ticks,
    pub com_velocity_w: Vector3<f64>,
    pub tilt_rad: f64,
    pub rate_rad_s: f64,
    /// Centre of the footprint.
    pub footprint_w: Vector3<f64>,
}

/// What the verdict looks at after every tick on or near the ground.
#[derive(Clone, Debug)]
pub struct Sight {
    pub now: Ticks,
    pub tip: TipState,
    pub feet_down: usize,
    pub structure_down: bool,
    pub speed_m_s: f64,
    pub rate_rad_s: f64,
    pub footprint_w: Vector3<f64>,
}

/// Memory of the touchdown so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Touchdown {
    pub first: Option<FirstContact>,
    pub outcome: Outcome,
    /// Least margin since first contact, J.
    pub margin_j: Option<f64>,
    /// When the centre of mass left the support, while it stays outside.
    pub unsupported_since: Option<Ticks>,
    pub structure_struck: bool,
    pub slide_m: f64,
    still: Ticks,
}

impl Touchdown {
    /// Takes note of the first contact; a crash is decided there and then.
    pub fn begin(&mut self, limits: &TouchdownLimits, first: FirstContact) {
        if first.com_velocity_w.norm() > limits.crash_speed_m_s {
            self.outcome = Outcome::Crashed;
        }
        self.first = Some(first);
    }

    /// Looks once per tick after first contact. Decides at most once.
    pub fn look(&mut self, limits: &TouchdownLimits, sight: &Sight) {
        let Some(first) = self.first.filter(|_| self.outcome == Outcome::InFlight) else { return };
        self.slide_m = (sight.footprint_w - first.footprint_w).xy().norm();
        self.margin_j =
            Some(self.margin_j.map_or(sight.tip.margin_j, |m| m.min(sight.tip.margin_j)));

        self.unsupported_since =
            (!sight.tip.supported).then(|| self.unsupported_since.unwrap_or(sight.now));
        let over = self
            .unsupported_since
            .is_some_and(|since| sight.structure_down || sight.now >= since + TIP_TIME);
        if over {
            self.outcome = Outcome::Tipped;
            return;
        }
        self.structure_struck |= sight.structure_down;

        let still = sight.feet_down >= REST_FEET
            && sight.speed_m_s < REST_SPEED_M_S
            && sight.rate_rad_s < REST_RATE_RAD_S;
        self.still = if still { self.still + Ticks(1) } else { Ticks::ZERO };
        if self.still >= REST_TIME {
            self.outcome = self.at_rest(limits);
        }
    }

    /// The run's time is up.
    pub fn end(&mut self) {
        if self.outcome == Outcome::InFlight {
            self.outcome = match self.first {
                None => Outcome::NoContact,
                Some(_) if self.structure_struck => Outcome::Struck,
                // On the ground, upright, and still not at rest.
                Some(_) => Outcome::Slid,
            };
        }
    }

    fn at_rest(&self, limits: &TouchdownLimits) -> Outcome {
        if self.structure_struck {
            Outcome::Struck
        } else if self.slide_m > limits.slide_limit_m {
            Outcome::Slid
        } else {
            Outcome::Landed
        }
    }

    pub fn decided(&self) -> bool {
        self.outcome != Outcome::InFlight
    }
}
