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
/// A centre of mass outside the support for so long is not coming back: beyond an edge gravity
/// only turns it outwards. The wait lets a bounce pass in which the feet were in the air.
const TIP_TIME: Ticks = Ticks(500);
/// Feet that must carry load at rest.
const REST_FEET: usize = 3;

/// State just before the tick in which the ground was felt, after none was.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Impact {
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
    /// Only for a vehicle that has been in flight: standing before lift-off is no touchdown.
    pub impact: Option<Impact>,
    pub tip: TipState,
    pub feet_down: usize,
    /// Hull or nozzle touched.
    pub structure_down: bool,
    /// A strut has no stroke left.
    pub bottomed: bool,
    pub stroke_m: f64,
    pub load_n: f64,
    pub speed_m_s: f64,
    pub rate_rad_s: f64,
    pub footprint_w: Vector3<f64>,
}

/// Memory of the touchdown so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Touchdown {
    pub first: Option<Impact>,
    pub outcome: Outcome,
    /// Least margin since first contact, J.
    pub margin_j: Option<f64>,
    /// When the centre of mass left the support, while it stays outside.
    pub unsupported_since: Option<Ticks>,
    /// Hull or nozzle touched, or a strut bottomed out: the structure took the blow.
    pub struck: bool,
    pub slide_m: f64,
    pub peak_stroke_m: f64,
    pub peak_load_n: f64,
    feet_down: usize,
    still: Ticks,
}

impl Touchdown {
    /// Looks once per tick on or near the ground. Decides at most once.
    pub fn look(&mut self, limits: &TouchdownLimits, sight: &Sight) {
        if self.decided() {
            return;
        }
        self.feet_down = sight.feet_down;
        if let Some(impact) = sight.impact {
            self.first.get_or_insert(impact);
            if impact.com_velocity_w.norm() > limits.crash_speed_m_s {
                self.outcome = Outcome::Crashed;
                return;
            }
        }
        if self.goes_over(sight) {
            self.outcome = Outcome::Tipped;
            return;
        }
        let Some(first) = self.first else { return };
        self.struck |= sight.structure_down || sight.bottomed;
        self.slide_m = (sight.footprint_w - first.footprint_w).xy().norm();
        self.margin_j =
            Some(self.margin_j.map_or(sight.tip.margin_j, |m| m.min(sight.tip.margin_j)));
        self.peak_stroke_m = self.peak_stroke_m.max(sight.stroke_m);
        self.peak_load_n = self.peak_load_n.max(sight.load_n);

        let still = sight.tip.supported
            && sight.feet_down >= REST_FEET
            && sight.speed_m_s < REST_SPEED_M_S
            && sight.rate_rad_s < REST_RATE_RAD_S;
        self.still = if still { self.still + Ticks(1) } else { Ticks::ZERO };
        if self.still >= REST_TIME {
            self.outcome = self.at_rest(limits);
        }
    }

    /// Whether the centre of mass has left the support for good.
    fn goes_over(&mut self, sight: &Sight) -> bool {
        self.unsupported_since =
            (!sight.tip.supported).then(|| self.unsupported_since.unwrap_or(sight.now));
        self.unsupported_since
            .is_some_and(|since| sight.structure_down || sight.now >= since + TIP_TIME)
    }

    /// The run's time is up: the same questions, with what is known by now.
    pub fn end(&mut self, limits: &TouchdownLimits) {
        if self.decided() {
            return;
        }
        self.outcome = if self.unsupported_since.is_some() {
            Outcome::Tipped
        } else if self.first.is_none() || self.feet_down == 0 {
            Outcome::NoContact
        } else if self.still == Ticks::ZERO && !self.struck {
            // On its feet and still moving.
            Outcome::Slid
        } else {
            self.at_rest(limits)
        };
    }

    fn at_rest(&self, limits: &TouchdownLimits) -> Outcome {
        if self.struck {
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

    /// When the centre of mass left the support for good, once that is the verdict.
    pub fn tip_time(&self) -> Option<Ticks> {
        self.unsupported_since.filter(|_| self.outcome == Outcome::Tipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: TouchdownLimits = TouchdownLimits { crash_speed_m_s: 5.0, slide_limit_m: 1.0 };

    fn impact(speed_m_s: f64) -> Option<Impact> {
        Some(Impact {
            time: Ticks::ZERO,
            com_velocity_w: Vector3::new(0.0, 0.0, -speed_m_s),
            tilt_rad: 0.0,
            rate_rad_s: 0.0,
            footprint_w: Vector3::zeros(),
        })
    }

    /// Standing still on four feet.
    fn standing() -> Sight {
        Sight {
            now: Ticks::ZERO,
            impact: None,
            tip: TipState { margin_j: 100.0, supported: true },
            feet_down: 4,
            structure_down: false,
            bottomed: false,
            stroke_m: 0.01,
            load_n: 70.0,
            speed_m_s: 0.0,
            rate_rad_s: 0.0,
            footprint_w: Vector3::zeros(),
        }
    }

    /// A touchdown at 1 m/s, one tick of `event`, then two seconds of `after`.
    fn verdict(event: Sight, after: Sight) -> Touchdown {
        let mut touchdown = Touchdown::default();
        let moving = Sight { impact: impact(1.0), speed_m_s: 1.0, ..standing() };
        let rest = std::iter::repeat_n(after, 2000);
        for (n, sight) in [moving, event].into_iter().chain(rest).enumerate() {
            touchdown.look(&LIMITS, &Sight { now: Ticks(n as u64), ..sight });
        }
        touchdown.end(&LIMITS);
        touchdown
    }

    #[test]
    fn every_outcome_has_its_history() {
        let over = TipState { margin_j: -1.0, supported: false };
        let moving = Sight { speed_m_s: 0.1, ..standing() };
        let away = Sight { footprint_w: Vector3::new(0.8, 0.8, 0.0), ..standing() };
        let cases = [
            (standing(), standing(), Outcome::Landed),
            (moving.clone(), moving.clone(), Outcome::Slid),
            (standing(), away, Outcome::Slid),
            (Sight { tip: over, ..moving.clone() }, standing(), Outcome::Landed),
            (standing(), Sight { tip: over, ..standing() }, Outcome::Tipped),
            (
                Sight { tip: over, structure_down: true, ..moving.clone() },
                standing(),
                Outcome::Tipped,
            ),
            (Sight { structure_down: true, ..moving.clone() }, standing(), Outcome::Struck),
            (Sight { bottomed: true, ..moving.clone() }, standing(), Outcome::Struck),
            (Sight { bottomed: true, ..moving.clone() }, moving.clone(), Outcome::Struck),
            (Sight { impact: impact(18.0), ..moving.clone() }, standing(), Outcome::Crashed),
            (moving.clone(), Sight { feet_down: 0, ..moving }, Outcome::NoContact),
            (standing(), Sight { feet_down: 2, ..standing() }, Outcome::Slid),
        ];
        for (n, (event, after, outcome)) in cases.into_iter().enumerate() {
            assert_eq!(verdict(event, after).outcome, outcome, "case {n}");
        }
    }

    #[test]
    fn what_happens_after_the_verdict_changes_nothing() {
        let over = TipState { margin_j: -5.0, supported: false };
        let mut touchdown = verdict(standing(), standing());
        let landed = touchdown.clone();
        touchdown.look(&LIMITS, &Sight { tip: over, load_n: 1e6, ..standing() });
        assert_eq!(format!("{touchdown:?}"), format!("{landed:?}"));
    }

    #[test]
    fn a_vehicle_that_never_flew_can_tip_over_but_not_land() {
        let mut touchdown = Touchdown::default();
        for n in 0..2000 {
            touchdown.look(&LIMITS, &Sight { now: Ticks(n), ..standing() });
        }
        assert!(!touchdown.decided() && touchdown.peak_load_n == 0.0);
        let tip = TipState { margin_j: -1.0, supported: false };
        for n in 2000..3000 {
            touchdown.look(&LIMITS, &Sight { now: Ticks(n), tip, ..standing() });
        }
        assert_eq!((touchdown.outcome, touchdown.tip_time()), (Outcome::Tipped, Some(Ticks(2000))));
    }
}
