//! The touchdown verdict: one function decides, from what was seen tick by tick.

mod rest;
#[cfg(test)]
mod tests;

use lander_models::Outcome;
use lander_models::frames::Attitude;
use lander_models::scenario::TouchdownLimits;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::Ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::contact::Structure;
use crate::stability::TipState;
use rest::Still;

/// A centre of mass outside the support for so long near the ground is not coming back: beyond an
/// edge gravity only turns it outwards. The wait lets a bounce pass in which no foot touches.
const TIP_TIME: Ticks = Ticks(500);

/// State just before the tick in which the ground was felt, after none was.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Impact {
    pub time: Ticks,
    pub com_velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_rad_s: f64,
    /// Centre of the footprint.
    pub footprint_w: Vector3<f64>,
}

/// A pad just before the tick in which it first felt the ground (T.21).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FootImpact {
    pub time: Ticks,
    /// Speed into the ground, along its normal.
    pub normal_m_s: f64,
    /// Speed along the ground.
    pub tangential_m_s: f64,
}

/// What the verdict looks at after every tick on or near the ground.
#[derive(Clone, Debug)]
pub struct Sight {
    pub now: Ticks,
    /// Only for a vehicle that has been in flight: standing before lift-off is no touchdown.
    pub impact: Option<Impact>,
    /// Of the pads that have touched for the first time.
    pub foot_impacts: [Option<FootImpact>; FOOT_SLOTS],
    pub tip: TipState,
    pub feet_down: [bool; FOOT_SLOTS],
    pub structure_down: Structure<bool>,
    pub clearance_m: Structure<f64>,
    /// A strut has no stroke left.
    pub bottomed: bool,
    pub stroke_m: f64,
    pub load_n: f64,
    /// Non-gravitational acceleration of the centre of mass.
    pub acceleration_m_s2: f64,
    pub angular_acceleration_rad_s2: f64,
    pub speed_m_s: f64,
    pub rate_rad_s: f64,
    pub attitude_wb: Attitude,
    pub footprint_w: Vector3<f64>,
}

/// Memory of the touchdown so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Touchdown {
    pub first: Option<Impact>,
    pub feet: [Option<FootImpact>; FOOT_SLOTS],
    pub outcome: Outcome,
    /// Least tip-over margin since first contact, J.
    pub margin_j: Option<f64>,
    /// Least stability distance since first contact, m.
    pub distance_m: Option<f64>,
    /// Least clearance of hull and nozzle since first contact, m.
    pub clearance_m: Option<Structure<f64>>,
    /// When the centre of mass left the support, while it stays outside.
    pub unsupported_since: Option<Ticks>,
    /// The structure took the blow.
    pub struck: Structure<bool>,
    /// A strut used up its stroke.
    pub bottomed: bool,
    pub slide_m: f64,
    pub peak_stroke_m: f64,
    pub peak_load_n: f64,
    pub peak_acceleration_m_s2: f64,
    pub peak_angular_acceleration_rad_s2: f64,
    /// A foot carried load in the last look.
    on_feet: bool,
    /// For how long it has been outside, without a flight in between.
    outside: Ticks,
    still: Option<Still>,
}

impl Touchdown {
    /// Looks once per tick on or near the ground. Decides at most once.
    pub fn look(&mut self, limits: &TouchdownLimits, sight: &Sight) {
        if self.decided() {
            return;
        }
        self.on_feet = sight.feet_down.contains(&true);
        if let Some(impact) = sight.impact {
            self.first.get_or_insert(impact);
        }
        if let Some(first) = self.first {
            self.record(&first, sight);
        }
        if sight.impact.is_some_and(|i| i.com_velocity_w.norm() > limits.crash_speed_m_s) {
            self.outcome = Outcome::Crashed;
        } else if self.goes_over(sight) {
            self.outcome = Outcome::Tipped;
        } else if self.first.is_some() && rest::comes_to_rest(&mut self.still, sight) {
            self.outcome = self.damage().unwrap_or(if self.slide_m > limits.slide_limit_m {
                Outcome::Slid
            } else {
                Outcome::Landed
            });
        }
    }

    /// Extremes since first contact.
    fn record(&mut self, first: &Impact, sight: &Sight) {
        for (foot, impact) in self.feet.iter_mut().zip(sight.foot_impacts) {
            *foot = foot.or(impact);
        }
        self.struck.hull |= sight.structure_down.hull;
        self.struck.nozzle |= sight.structure_down.nozzle;
        self.bottomed |= sight.bottomed;
        self.slide_m = (sight.footprint_w - first.footprint_w).xy().norm();
        self.margin_j = least(self.margin_j, sight.tip.margin_j);
        self.distance_m = least(self.distance_m, sight.tip.distance_m);
        let (near, now) = (self.clearance_m.unwrap_or(sight.clearance_m), sight.clearance_m);
        self.clearance_m =
            Some(Structure { hull: near.hull.min(now.hull), nozzle: near.nozzle.min(now.nozzle) });
        self.peak_stroke_m = self.peak_stroke_m.max(sight.stroke_m);
        self.peak_load_n = self.peak_load_n.max(sight.load_n);
        self.peak_acceleration_m_s2 = self.peak_acceleration_m_s2.max(sight.acceleration_m_s2);
        self.peak_angular_acceleration_rad_s2 =
            self.peak_angular_acceleration_rad_s2.max(sight.angular_acceleration_rad_s2);
    }

    /// Looks at a tick of free flight. After first contact that is a bounce: a centre of mass
    /// outside the support may come back in the air, but a vehicle that goes head down has tipped.
    pub fn look_in_flight(&mut self, now: Ticks, supported: bool, attitude_wb: &Attitude) {
        if self.first.is_none() || self.decided() {
            return;
        }
        self.outside = Ticks::ZERO;
        self.unsupported_since = (!supported).then(|| self.unsupported_since.unwrap_or(now));
        if !supported && is_head_down(attitude_wb) {
            self.outcome = Outcome::Tipped;
        }
    }

    /// Whether the centre of mass has left the support for good.
    fn goes_over(&mut self, sight: &Sight) -> bool {
        if sight.tip.supported() {
            (self.unsupported_since, self.outside) = (None, Ticks::ZERO);
            return false;
        }
        self.unsupported_since.get_or_insert(sight.now);
        self.outside += Ticks(1);
        sight.structure_down.any()
            || self.outside > TIP_TIME
            || (self.first.is_some() && is_head_down(&sight.attitude_wb))
    }

    /// The run's time is up: the same questions, with what is known by now.
    pub fn end(&mut self) {
        if self.decided() {
            return;
        }
        self.outcome = if self.unsupported_since.is_some() {
            Outcome::Tipped
        } else if self.first.is_none() || (!self.on_feet && self.damage().is_none()) {
            Outcome::NoContact
        } else {
            // Upright, but not seen at rest.
            self.damage().unwrap_or(Outcome::Slid)
        };
    }

    /// What an upright vehicle suffered.
    fn damage(&self) -> Option<Outcome> {
        if self.struck.any() {
            Some(Outcome::Struck)
        } else {
            self.bottomed.then_some(Outcome::Bottomed)
        }
    }

    pub fn decided(&self) -> bool {
        self.outcome != Outcome::InFlight
    }

    /// When the centre of mass left the support for good, once that is the verdict.
    pub fn tip_time(&self) -> Option<Ticks> {
        self.unsupported_since.filter(|_| self.outcome == Outcome::Tipped)
    }
}

fn is_head_down(attitude_wb: &Attitude) -> bool {
    (attitude_wb * Vector3::z()).z < 0.0
}

fn least(so_far: Option<f64>, value: f64) -> Option<f64> {
    Some(so_far.map_or(value, |least| least.min(value)))
}
