//! The fast contact engine: one body in the flight integrator, pads without inertia on crushable
//! struts, friction by anchors (T.30 to T.39). The reference engine's laws at a fraction of its
//! cost, for large campaigns.

mod blow;
mod inertia;
mod pad;
mod soil;
mod structure;

use lander_models::mass::MassProperties;
use lander_models::math::square;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::TICK_S;
use lander_models::vehicle::{Gear, Lateral};
use nalgebra::{Matrix3, Matrix6, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::{ContactEngine, Site, Touch};
use crate::flight::{self, Motion};
use crate::gear::LegState;
use crate::propulsion::{Drive, Wrench};
use inertia::{split, stack};
use pad::{Grip, Holds, Pad, Spring};
use structure::Bumpers;

/// Steps of a tick in which a strut strokes faster than `GENTLE_M_S` or may reach its stop: the stop
/// is as stiff as a step carries, and while pads grip hard a soft grip lets held ones turn the
/// vehicle over.
const WORKING_STEPS: u32 = 8;
const GENTLE_M_S: f64 = 0.1;
/// Step times the fastest rate of a vehicle that grips or stands on its stops: Runge-Kutta is stable
/// up to 2.785.
const STIFFEST_STEP: f64 = 2.5;
/// The same of a leg's own give, and of half its damping: Runge-Kutta is stable in the half disc of
/// 2.6, and at this errs by 1 % of a swing.
const SOFT_STEP: f64 = 1.3;
/// A blow sooner than this after the start of a step falls into it, s.
const BLOW_TIME_MIN_S: f64 = 1e-9;
/// Most blows for which one tick is cut.
const CUTS_MAX: usize = 16;

/// What the engine keeps from step to step beside motion and legs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrutContact {
    grips: [Grip; FOOT_SLOTS],
    /// Stiffness of each in the last step.
    grip_n_m: f64,
}

/// Sum of the ground's forces on the vehicle.
#[derive(Default)]
struct Forces {
    force_b: Vector3<f64>,
    /// About O.
    torque_b: Vector3<f64>,
}

/// A motion in body axes: a force of the ground is then a matter of a few products.
struct Stance {
    to_body: Matrix3<f64>,
    origin_w: Vector3<f64>,
    velocity_b: Vector3<f64>,
    rate_b: Vector3<f64>,
}

impl Stance {
    fn of(motion: &Motion) -> Self {
        let to_body = motion.attitude_wb.to_rotation_matrix().inverse().into_inner();
        Self {
            to_body,
            origin_w: motion.position_w,
            velocity_b: to_body * motion.velocity_w,
            rate_b: motion.rate_b,
        }
    }
}

impl Forces {
    fn add(&mut self, force_b: &Vector3<f64>, point_b: &Vector3<f64>) {
        self.force_b += force_b;
        self.torque_b += point_b.cross(force_b);
    }

    /// What the whole vehicle would need for the motion that they give one without its feet, about O.
    fn on_whole(&self, count: &Matrix6<f64>) -> Wrench {
        let [force_b, torque_b] = split(&(count * stack(&self.force_b, &self.torque_b)));
        Wrench { force_b, torque_b }
    }
}

/// What pads bear on in steps of `step_s`: the leg's own give across its stroke, if there is one that
/// a step carries, else the stiffest critically damped springs that it does, so that finer steps
/// tend to rigid legs. All pads together stiffen and damp by the share of one times a lever, in
/// the fastest of the vehicle's motions.
fn holds(gear: &Gear, mass: &MassProperties, step_s: f64) -> Holds {
    let reach_m2 = gear.feet_b().map(|foot_b| (foot_b - mass.com_b).xy().norm_squared());
    let reach_m2 = reach_m2.fold(0.0, f64::max);
    let height_m2 = mass.com_b.z * mass.com_b.z;
    let [x, y, z] = [0, 1, 2].map(|axis| mass.inertia_b[(axis, axis)] / mass.mass_kg);
    // Feet on the ground don't pitch (T.37).
    let foot = gear.foot_mass_kg / mass.mass_kg;
    let arms_m2 = gear.feet_b().map(|foot_b| (foot_b - mass.com_b).xy().map(|arm_m| arm_m * arm_m));
    let arms_m2: Vector2<f64> = arms_m2.sum();
    let pitch = (x - foot * arms_m2.y).min(y - foot * arms_m2.x);
    let feet = foot * gear.legs.len() as f64;
    // Yaw, or the pads' sliding with pitch (T.32).
    let grip_lever = (reach_m2 / z).max(1.0 + height_m2 / pitch);
    // Heave, or pitch, in which legs around the vehicle share r² between two axes (T.31).
    let stop_lever = (0.5 * reach_m2 / pitch).max(1.0 / (1.0 - feet));
    let share_kg = mass.mass_kg / gear.legs.len() as f64;
    let stiffest = |lever: f64| {
        let rad_s = STIFFEST_STEP / (2.0 * lever * step_s);
        Spring { stiffness_n_m: share_kg * rad_s * rad_s, damping_n_s_m: 2.0 * share_kg * rad_s }
    };
    let own = gear
        .lateral
        .map(|Lateral { stiffness_n_m, damping_n_s_m }| Spring { stiffness_n_m, damping_n_s_m });
    let is_carried = |spring: &Spring| {
        let (per_share, step_s2) = (grip_lever / share_kg, step_s * step_s);
        spring.stiffness_n_m * per_share * step_s2 < SOFT_STEP * SOFT_STEP
            && spring.damping_n_s_m * per_share * step_s < 2.0 * SOFT_STEP
    };
    let grip = own.filter(is_carried).unwrap_or_else(|| stiffest(grip_lever));
    Holds { grip, stop: stiffest(stop_lever) }
}

/// Steps of a tick by what the struts do.
fn steps(gear: &Gear, legs: &[LegState]) -> u32 {
    let stop_is_near = gear.legs.iter().zip(legs).any(|(leg, now)| {
        now.stroke_m + 2.0 * TICK_S * now.stroke_rate_m_s.max(0.0) > leg.strut.stroke_max_m
    });
    let stroking = legs.iter().any(|leg| leg.stroke_rate_m_s.abs() > GENTLE_M_S);
    if stop_is_near || stroking { WORKING_STEPS } else { 1 }
}

impl StrutContact {
    /// Energy that the grips hold along the ground and may give back, J.
    pub fn grip_energy_j(&self) -> f64 {
        let slips_m2 = self.grips.iter().map(|grip| square(grip.slip_m()));
        0.5 * self.grip_n_m * slips_m2.sum::<f64>()
    }

    /// Sets the grips' stiffness. A stiffer one holds with the force that it had, a softer one keeps
    /// the energy: neither makes any.
    fn stiffen(&mut self, grip_n_m: f64) {
        let ratio = self.grip_n_m / grip_n_m;
        let scale = if ratio < 1.0 { ratio } else { ratio.sqrt() };
        self.grips.iter_mut().for_each(|grip| grip.scale(scale));
        self.grip_n_m = grip_n_m;
    }

    /// Lets the pads that meet the ground stand on it, with the blow that they take; whether one did.
    fn stand<'a, I>(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        whole: &Matrix6<f64>,
        pads: impl Fn() -> I,
    ) -> bool
    where
        I: Iterator<Item = &'a Pad<'a>>,
    {
        let mut new = [false; FOOT_SLOTS];
        for ((grip, pad), new) in self.grips.iter_mut().zip(pads()).zip(&mut new) {
            if pad.meets_ground(motion) {
                *grip = Grip::fresh();
                *new = true;
            }
        }
        if !new.contains(&true) {
            return false;
        }
        let gear = &site.vehicle.gear;
        let (foot_kg, captured) = (gear.foot_mass_kg, site.terrain.pads_captured);
        let rigid = gear.lateral.is_none();
        let friction = if captured { f64::INFINITY } else { site.terrain.friction };
        let struck = pads().zip(&self.grips).zip(new);
        let struck = struck.filter(|((_, grip), new)| *new || rigid && captured && grip.holds());
        let holds = struck.map(|((pad, _), _)| pad.hold(motion, foot_kg, friction));
        let body = self.without_feet(site, whole, pads());
        *motion = match gear.lateral {
            Some(_) => blow::brush(motion, &body, foot_kg, holds),
            None => blow::stop(motion, &body, holds),
        };
        true
    }

    /// Inertia less the feet on the ground (T.37).
    fn without_feet<'a>(
        &self,
        site: &Site,
        whole: &Matrix6<f64>,
        pads: impl Iterator<Item = &'a Pad<'a>>,
    ) -> Matrix6<f64> {
        let mut body = *whole;
        for (pad, _) in pads.zip(&self.grips).filter(|(_, grip)| grip.holds()) {
            let foot_kg = site.vehicle.gear.foot_mass_kg;
            inertia::take_foot(&mut body, foot_kg, &pad.centre_b(), &pad.stroke_axis_b());
        }
        body
    }
}

impl ContactEngine for StrutContact {
    fn take_over(_: &Site, _: &Motion, _: &[LegState]) -> Self {
        Self { grips: [Grip::default(); FOOT_SLOTS], grip_n_m: 0.0 }
    }

    /// A tick is cut where a pad touches or a strut stops: a damper's force jumps there.
    fn step(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        legs: &mut [LegState],
        drive: &Drive,
    ) -> Option<Touch> {
        let vehicle = site.vehicle;
        let longest_s = TICK_S / f64::from(steps(&vehicle.gear, legs) * site.refinement);
        let mass = vehicle.mass.at(motion.propellant_kg);
        let (mass_kg, whole) = (mass.mass_kg, inertia::whole(&mass));
        let holds = holds(&vehicle.gear, &mass, longest_s);
        self.stiffen(holds.grip.stiffness_n_m);
        let bumpers = Bumpers::new(site, motion, mass_kg);
        let mut touch = Touch::default();
        let mut left_s = TICK_S;
        let mut cuts = 0;
        while left_s > 0.0 {
            let pads: [Option<Pad>; FOOT_SLOTS] = std::array::from_fn(|n| {
                let (leg, grip) = (vehicle.gear.legs.get(n)?, &self.grips[n]);
                Some(Pad::new(site, leg, motion, legs[n], grip, holds))
            });
            let pads = || pads.iter().flatten();
            if self.stand(site, motion, &whole, pads) {
                continue;
            }
            let body = self.without_feet(site, &whole, pads());
            // What a wrench of the ground counts for the whole vehicle. A vehicle file admits no feet
            // as heavy as the vehicle.
            let count = body.try_inverse().map_or(Matrix6::identity(), |inverse| whole * inverse);
            // What rounding leaves of a tick is no step of its own.
            let mut step_s = if left_s < 1.5 * longest_s { left_s } else { longest_s };
            let blow_s = pads()
                .map(|pad| pad.time_to_blow_s(motion))
                .filter(|time_s| *time_s > BLOW_TIME_MIN_S)
                .fold(f64::INFINITY, f64::min);
            if blow_s < step_s && cuts < CUTS_MAX {
                cuts += 1;
                step_s = blow_s;
            }
            let outside = |stage: &Motion| {
                let (mut forces, stance) = (Forces::default(), Stance::of(stage));
                for force in pads().filter_map(|pad| pad.force(site, &stance)) {
                    forces.add(&force.on_vehicle_b, &force.point_b);
                }
                bumpers.press(site, &stance, &mut forces);
                forces.on_whole(&count)
            };
            *motion = flight::advance(vehicle, &site.gravity_w, motion, drive, step_s, outside);
            if !motion.is_finite() {
                return None;
            }
            let mut lifted = false;
            for (n, pad) in pads().enumerate() {
                let stood = self.grips[n].holds();
                legs[n] = pad.settle(site, motion, step_s, &mut self.grips[n]);
                touch.feet[n] |= self.grips[n].holds();
                lifted |= stood && !self.grips[n].holds();
            }
            if lifted {
                *motion = blow::lift(motion, &body, &self.without_feet(site, &whole, pads()));
            }
            left_s -= step_s;
        }
        touch.structure = bumpers.touch(motion);
        Some(touch)
    }
}
