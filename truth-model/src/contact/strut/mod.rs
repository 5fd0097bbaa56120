//! The fast contact engine: one rigid body in the flight integrator, massless pads on crushable
//! struts, friction by anchors (T.30 to T.37). The reference engine's laws at a fraction of its
//! cost, for large campaigns.

mod capture;
mod pad;
mod soil;
mod structure;

use lander_models::mass::MassProperties;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::TICK_S;
use lander_models::vehicle::Gear;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{ContactEngine, Site, Touch};
use crate::flight::{self, Motion};
use crate::gear::LegState;
use crate::propulsion::{Drive, Wrench};
use pad::{Grip, Pad, Shares, Stiffest};
use structure::Bumpers;

/// Steps of a tick in which a strut may reach its stop: the stop is as stiff as a step carries.
const STOP_STEPS: u32 = 8;
/// Step times the fastest rate of a vehicle that grips or stands on its stops: Runge-Kutta is stable
/// up to 2.785.
const STIFFEST_STEP: f64 = 2.5;
/// A pad that would touch sooner than this after the start of a step touches in it, s.
const TOUCH_TIME_MIN_S: f64 = 1e-9;
/// Most touches for which one tick is cut.
const CUTS_MAX: usize = 16;

/// What the engine keeps from step to step beside motion and legs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrutContact {
    grips: [Grip; FOOT_SLOTS],
}

/// Sum of the ground's forces on the vehicle.
#[derive(Default)]
struct Forces {
    force_b: Vector3<f64>,
    /// About O.
    torque_b: Vector3<f64>,
}

impl Forces {
    fn add_w(&mut self, motion: &Motion, force_w: &Vector3<f64>, point_b: &Vector3<f64>) {
        let force_b = motion.attitude_wb.inverse_transform_vector(force_w);
        self.force_b += force_b;
        self.torque_b += point_b.cross(&force_b);
    }

    fn about(&self, com_b: &Vector3<f64>) -> Wrench {
        let torque_b = self.torque_b - com_b.cross(&self.force_b);
        Wrench { force_b: self.force_b, torque_b }
    }
}

/// Natural frequencies of the stiffest critically damped springs that steps of `step_s` carry, so
/// that finer ones tend to rigid contact. All pads together damp by 2 ω times a lever, the fastest
/// of the vehicle's rates.
fn stiffest(gear: &Gear, mass: &MassProperties, step_s: f64) -> Stiffest {
    let reach_m2 = gear.feet_b().map(|foot_b| (foot_b - mass.com_b).xy().norm_squared());
    let reach_m2 = reach_m2.fold(0.0, f64::max);
    let height_m2 = mass.com_b.z * mass.com_b.z;
    let [x, y, z] = [0, 1, 2].map(|axis| mass.inertia_b[(axis, axis)] / mass.mass_kg);
    // Yaw, or the pads' sliding with pitch (T.32).
    let grip = (reach_m2 / z).max(1.0 + height_m2 / x.min(y));
    // Heave, or pitch: legs around the vehicle share r² between two axes (T.31).
    let stop = (0.5 * reach_m2 / x.min(y)).max(1.0);
    let rad_s = |lever: f64| STIFFEST_STEP / (2.0 * lever * step_s);
    Stiffest { grip_rad_s: rad_s(grip), stop_rad_s: rad_s(stop) }
}

/// Whether a strut may reach its stop within two ticks, or is on it.
fn stop_is_near(gear: &Gear, legs: &[LegState]) -> bool {
    gear.legs.iter().zip(legs).any(|(leg, now)| {
        now.stroke_m + 2.0 * TICK_S * now.stroke_rate_m_s.max(0.0) > leg.strut.stroke_max_m
    })
}

impl StrutContact {
    /// Stops the vehicle on the pads that hold once another one meets the ground; whether one did.
    fn capture<'a, I>(
        &mut self,
        motion: &mut Motion,
        mass: &MassProperties,
        pads: impl Fn() -> I,
    ) -> bool
    where
        I: Iterator<Item = &'a Pad<'a>>,
    {
        let mut new = false;
        for (grip, pad) in self.grips.iter_mut().zip(pads()) {
            if pad.meets_ground(motion) {
                *grip = Grip::fresh();
                new = true;
            }
        }
        if new {
            let held = pads().zip(&self.grips).filter(|(_, grip)| grip.holds());
            *motion = capture::stop(motion, mass, held.map(|(pad, _)| pad.hold(motion)));
        }
        new
    }
}

impl ContactEngine for StrutContact {
    fn take_over(_: &Site, _: &Motion, _: &[LegState]) -> Self {
        Self { grips: [Grip::default(); FOOT_SLOTS] }
    }

    /// A tick is cut where a pad touches: the force of its strut's damper jumps there.
    fn step(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        legs: &mut [LegState],
        drive: &Drive,
    ) -> Option<Touch> {
        let vehicle = site.vehicle;
        let steps = if stop_is_near(&vehicle.gear, legs) { STOP_STEPS } else { 1 };
        let longest_s = TICK_S / f64::from(steps * site.refinement);
        let mass = vehicle.mass.at(motion.propellant_kg);
        let mass_kg = mass.mass_kg;
        let stiffest = stiffest(&vehicle.gear, &mass, longest_s);
        let share_kg = mass_kg / legs.len() as f64;
        let bumpers = Bumpers::new(site, motion, mass_kg);
        let mut touch = Touch::default();
        let mut left_s = TICK_S;
        let mut cuts = 0;
        while left_s > 0.0 {
            let standing = self.grips.iter().filter(|grip| grip.holds()).count().max(1);
            let sprung_kg = mass_kg - vehicle.gear.foot_mass_kg * standing as f64;
            let pads: [Option<Pad>; FOOT_SLOTS] = std::array::from_fn(|n| {
                let (leg, grip) = (vehicle.gear.legs.get(n)?, &self.grips[n]);
                let shares = Shares { share_kg, sprung: mass_kg / sprung_kg, stiffest };
                Some(Pad::new(site, leg, motion, legs[n], grip, shares))
            });
            let pads = || pads.iter().flatten();
            if site.terrain.pads_captured && self.capture(motion, &mass, pads) {
                continue;
            }
            // What rounding leaves of a tick is no step of its own.
            let mut step_s = if left_s < 1.5 * longest_s { left_s } else { longest_s };
            let touch_s = pads()
                .map(|pad| pad.time_to_touch_s(motion))
                .filter(|time_s| *time_s > TOUCH_TIME_MIN_S)
                .fold(f64::INFINITY, f64::min);
            if touch_s < step_s && cuts < CUTS_MAX {
                cuts += 1;
                step_s = touch_s;
            }
            let outside = |stage: &Motion| {
                let mut forces = Forces::default();
                for force in pads().filter_map(|pad| pad.force(site, stage)) {
                    forces.add_w(stage, &force.ground_w, &force.point_b);
                }
                bumpers.press(site, stage, &mut forces);
                forces.about(&vehicle.mass.at(stage.propellant_kg).com_b)
            };
            *motion = flight::advance(vehicle, &site.gravity_w, motion, drive, step_s, outside);
            if !motion.is_finite() {
                return None;
            }
            for (n, pad) in pads().enumerate() {
                legs[n] = pad.settle(site, motion, step_s, &mut self.grips[n]);
                touch.feet[n] |= legs[n].load_n > 0.0;
            }
            left_s -= step_s;
        }
        touch.structure = bumpers.touch(motion);
        Some(touch)
    }
}
