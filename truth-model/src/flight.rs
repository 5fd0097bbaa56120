//! Free flight: six degrees of freedom with mass, centre of mass, inertia and slosh sampled inside
//! the stages of a fourth-order Runge-Kutta step (T.1 to T.8 and T.50 to T.59 in the README).

use lander_models::Vehicle;
use lander_models::frames::Attitude;
use lander_models::vehicle::Slosh;
use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::burn::Burn;
use crate::engine::Actuators;
use crate::propulsion::{Drive, Wrench};
use crate::slosh::{self, Pendulums};

/// Motion and what moves it. Position and velocity are those of the structural origin O,
/// so a migrating centre of mass moves nothing by itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    pub propellant_kg: f64,
    /// Of the engine's lag; `Drive::thrust_n` is what is delivered.
    pub thrust_n: f64,
    pub gimbal_rad: Vector2<f64>,
    pub slosh: Pendulums,
}

/// Rates of what is integrated.
struct Rate<S> {
    velocity_w: Vector3<f64>,
    acceleration_w: Vector3<f64>,
    quaternion: Quaternion<f64>,
    angular_acceleration_b: Vector3<f64>,
    swings: S,
}

/// What a wrench does to the vehicle, body axes, gravity left out.
pub(crate) struct Accelerations<S> {
    pub origin_b: Vector3<f64>,
    pub turn_b: Vector3<f64>,
    /// Rates of what swings inside.
    pub swings: S,
}

/// What is inside the vehicle and may swing there.
trait Inside {
    type Swings;
    fn accelerations(
        &self,
        burn: &Burn,
        motion: &Motion,
        wrench: &Wrench,
    ) -> Accelerations<Self::Swings>;
    /// What swings becomes what `start` is after `time_s` at constant rates.
    fn follow(now: &mut Pendulums, start: &Pendulums, swings: &Self::Swings, time_s: f64);
    /// Runge and Kutta's mean of the four stages.
    fn mean(swings: [&Self::Swings; 4]) -> Self::Swings;
}

/// Nothing swings.
struct Rigid;

/// Propellant sloshes.
struct Sloshing<'a>(&'a Slosh);

impl Motion {
    pub fn is_finite(&self) -> bool {
        let attitude = &self.attitude_wb.coords;
        let actuators = [self.propellant_kg, self.thrust_n, self.gimbal_rad.x, self.gimbal_rad.y];
        let vectors = [&self.position_w, &self.velocity_w, &self.rate_b];
        (vectors.into_iter().flatten().chain(attitude).chain(&actuators))
            .all(|value| value.is_finite())
            && self.slosh.is_finite()
    }

    pub fn actuators(&self) -> Actuators {
        Actuators { thrust_n: self.thrust_n, gimbal_rad: self.gimbal_rad }
    }

    pub(crate) fn actuate(&mut self, actuators: Actuators) {
        (self.thrust_n, self.gimbal_rad) = (actuators.thrust_n, actuators.gimbal_rad);
    }

    /// Velocity of a body-fixed point, world frame.
    pub fn point_velocity_w(&self, point_b: &Vector3<f64>) -> Vector3<f64> {
        self.velocity_w + self.attitude_wb * self.rate_b.cross(point_b)
    }

    /// Position of a body-fixed point, world frame.
    pub fn point_position_w(&self, point_b: &Vector3<f64>) -> Vector3<f64> {
        self.position_w + self.attitude_wb * point_b
    }
}

/// A motion inside a step.
struct Stage {
    motion: Motion,
    /// Its attitude before normalisation.
    raw: Quaternion<f64>,
}

impl Stage {
    /// Becomes what `start` is after `time_s` at constant rates.
    #[inline]
    fn follow<I: Inside>(
        &mut self,
        start: &Motion,
        rate: &Rate<I::Swings>,
        time_s: f64,
        burn: &Burn,
    ) {
        let motion = &mut self.motion;
        motion.position_w = start.position_w + rate.velocity_w * time_s;
        motion.velocity_w = start.velocity_w + rate.acceleration_w * time_s;
        self.raw = start.attitude_wb.quaternion() + rate.quaternion * time_s;
        motion.attitude_wb = UnitQuaternion::from_quaternion(self.raw);
        motion.rate_b = start.rate_b + rate.angular_acceleration_b * time_s;
        motion.propellant_kg = burn.propellant_kg;
        motion.actuate(burn.actuators);
        I::follow(&mut motion.slosh, &start.slosh, &rate.swings, time_s);
    }
}

/// Runge and Kutta's mean of the four stages.
fn mean<I: Inside>([k1, k2, k3, k4]: [&Rate<I::Swings>; 4]) -> Rate<I::Swings> {
    macro_rules! mean {
        ($field:ident) => {
            (k1.$field + (k2.$field + k3.$field) * 2.0 + k4.$field) * (1.0 / 6.0)
        };
    }
    Rate {
        velocity_w: mean!(velocity_w),
        acceleration_w: mean!(acceleration_w),
        quaternion: mean!(quaternion),
        angular_acceleration_b: mean!(angular_acceleration_b),
        swings: I::mean([&k1.swings, &k2.swings, &k3.swings, &k4.swings]),
    }
}

/// (T.1, T.2)
impl Inside for Rigid {
    type Swings = ();

    #[inline]
    fn accelerations(&self, burn: &Burn, motion: &Motion, wrench: &Wrench) -> Accelerations<()> {
        let (mass, rate_b) = (&burn.mass, &motion.rate_b);
        let gyroscopic_b = rate_b.cross(&(mass.inertia_b * rate_b));
        let turn_b = burn.inverse_inertia_b * (wrench.torque_b - gyroscopic_b);
        let origin_b = wrench.force_b / mass.mass_kg
            - turn_b.cross(&mass.com_b)
            - rate_b.cross(&rate_b.cross(&mass.com_b));
        Accelerations { origin_b, turn_b, swings: () }
    }

    #[inline]
    fn follow(_: &mut Pendulums, _: &Pendulums, (): &(), _: f64) {}

    fn mean(_: [&(); 4]) {}
}

/// (T.53 to T.56)
impl Inside for Sloshing<'_> {
    type Swings = Pendulums;

    fn accelerations(
        &self,
        burn: &Burn,
        motion: &Motion,
        wrench: &Wrench,
    ) -> Accelerations<Pendulums> {
        slosh::accelerations(self.0, &burn.mass, motion, wrench)
    }

    fn follow(now: &mut Pendulums, start: &Pendulums, swings: &Pendulums, time_s: f64) {
        *now = start.plus(swings, time_s);
    }

    fn mean([k1, k2, k3, k4]: [&Pendulums; 4]) -> Pendulums {
        k1.plus(k4, 1.0).plus(&k2.plus(k3, 1.0), 2.0).times(1.0 / 6.0)
    }
}

/// Propellant at the middle and at the end of a step that starts with `start_kg`, for the flows at
/// start, middle and end. The end is Simpson's sum of the flow, which is Runge and Kutta's; the
/// middle is that of the parabola through it (T.9).
fn drained_kg(start_kg: f64, [start, middle, end]: [f64; 3], step_s: f64) -> [f64; 2] {
    let to_middle_kg = (5.0 * start + 8.0 * middle - end) * (step_s / 24.0);
    let to_end_kg = (start + 4.0 * middle + end) * (step_s / 6.0);
    [(start_kg - to_middle_kg).max(0.0), (start_kg - to_end_kg).max(0.0)]
}

#[inline]
fn rates<I: Inside>(
    inside: &I,
    gravity_w: &Vector3<f64>,
    burn: &Burn,
    Stage { motion, raw }: &Stage,
    outside: &Wrench,
) -> Rate<I::Swings> {
    let (driven, jet) = (&burn.driven, burn.inside(&motion.rate_b));
    let outside_torque_b = outside.torque_b - burn.mass.com_b.cross(&outside.force_b);
    let wrench = Wrench {
        force_b: driven.force_b + jet.force_b + outside.force_b,
        torque_b: driven.torque_b + jet.torque_b + outside_torque_b,
    };
    let Accelerations { origin_b, turn_b, swings } = inside.accelerations(burn, motion, &wrench);
    Rate {
        velocity_w: motion.velocity_w,
        acceleration_w: gravity_w + motion.attitude_wb * origin_b,
        // (T.3) on the raw, unnormalised quaternion of the stage.
        quaternion: raw * Quaternion::from_imag(motion.rate_b) * 0.5,
        angular_acceleration_b: turn_b,
        swings,
    }
}

/// One classical fourth-order Runge-Kutta step of `step_s` seconds (T.8).
///
/// `outside` is the wrench of whatever else acts on the vehicle in a given motion: nothing in free
/// flight, the ground in contact. Its torque is about O.
pub fn advance(
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    motion: &Motion,
    drive: &Drive,
    step_s: f64,
    outside: impl Fn(&Motion) -> Wrench,
) -> Motion {
    match &vehicle.slosh {
        Some(tanks) if motion.slosh.are_active() => {
            step(&Sloshing(tanks), vehicle, gravity_w, motion, drive, step_s, outside)
        }
        _ => step(&Rigid, vehicle, gravity_w, motion, drive, step_s, outside),
    }
}

fn step<I: Inside>(
    inside: &I,
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    motion: &Motion,
    drive: &Drive,
    step_s: f64,
    outside: impl Fn(&Motion) -> Wrench,
) -> Motion {
    let half_s = 0.5 * step_s;
    let (now, following) = (motion.actuators(), drive.following(vehicle, half_s));
    let later = following.after(now);
    let actuators = [now, later, following.after(later)];
    // Dry tanks stay dry.
    let engine_kg_s = actuators.map(|at| drive.engine_flow_kg_s(vehicle, at.thrust_n));
    let flows_kg_s = engine_kg_s.map(|flow_kg_s| flow_kg_s + drive.other_flow_kg_s);
    let [middle_kg, end_kg] = drained_kg(motion.propellant_kg, flows_kg_s, step_s);
    let burn = |n: usize, kg| Burn::at(vehicle, drive, actuators[n], engine_kg_s[n], kg);
    let start = burn(0, motion.propellant_kg);
    // In a coast with the gimbal at rest nothing changes within a step.
    let (at_middle, at_end);
    let (middle, end) = if end_kg == motion.propellant_kg && actuators == [now; 3] {
        (&start, &start)
    } else {
        (at_middle, at_end) = (burn(1, middle_kg), burn(2, end_kg));
        (&at_middle, &at_end)
    };
    let f =
        |stage: &Stage, burn: &Burn| rates(inside, gravity_w, burn, stage, &outside(&stage.motion));
    let mut stage = Stage { motion: *motion, raw: *motion.attitude_wb.quaternion() };
    let k1 = f(&stage, &start);
    stage.follow::<I>(motion, &k1, half_s, middle);
    let k2 = f(&stage, middle);
    stage.follow::<I>(motion, &k2, half_s, middle);
    let k3 = f(&stage, middle);
    stage.follow::<I>(motion, &k3, step_s, end);
    let k4 = f(&stage, end);
    stage.follow::<I>(motion, &mean::<I>([&k1, &k2, &k3, &k4]), step_s, end);
    stage.motion.slosh.normalise();
    stage.motion
}

/// Free flight: nothing acts from outside.
#[inline]
pub fn free(_: &Motion) -> Wrench {
    Wrench::default()
}
