//! Free flight: six degrees of freedom with mass, centre of mass, inertia and slosh sampled inside
//! the stages of a fourth-order Runge-Kutta step (T.1 to T.8 and T.50 to T.59 in the README).

use lander_models::Vehicle;
use lander_models::frames::Attitude;
use lander_models::mass::MassProperties;
use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::engine;
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
    pub thrust_n: f64,
    pub gimbal_rad: Vector2<f64>,
    pub slosh: Pendulums,
}

/// Rates of what is integrated.
struct Rate {
    velocity_w: Vector3<f64>,
    acceleration_w: Vector3<f64>,
    quaternion: Quaternion<f64>,
    angular_acceleration_b: Vector3<f64>,
    propellant_kg_s: f64,
    slosh: Pendulums,
}

impl Motion {
    pub fn is_finite(&self) -> bool {
        let attitude = &self.attitude_wb.coords;
        let actuators = [self.propellant_kg, self.thrust_n, self.gimbal_rad.x, self.gimbal_rad.y];
        let vectors = [&self.position_w, &self.velocity_w, &self.rate_b];
        (vectors.into_iter().flatten().chain(attitude).chain(&actuators))
            .all(|value| value.is_finite())
            && self.slosh.is_finite()
    }

    /// Velocity of a body-fixed point, world frame.
    pub fn point_velocity_w(&self, point_b: &Vector3<f64>) -> Vector3<f64> {
        self.velocity_w + self.attitude_wb * self.rate_b.cross(point_b)
    }

    /// Position of a body-fixed point, world frame.
    pub fn point_position_w(&self, point_b: &Vector3<f64>) -> Vector3<f64> {
        self.position_w + self.attitude_wb * point_b
    }

    /// This motion after `time_s` at constant rates, and its quaternion before normalisation.
    #[inline]
    fn after(
        &self,
        rate: &Rate,
        time_s: f64,
        (thrust_n, gimbal_rad): (f64, Vector2<f64>),
    ) -> (Self, Quaternion<f64>) {
        let raw = self.attitude_wb.quaternion() + rate.quaternion * time_s;
        let motion = Self {
            position_w: self.position_w + rate.velocity_w * time_s,
            velocity_w: self.velocity_w + rate.acceleration_w * time_s,
            attitude_wb: UnitQuaternion::from_quaternion(raw),
            rate_b: self.rate_b + rate.angular_acceleration_b * time_s,
            propellant_kg: self.propellant_kg + rate.propellant_kg_s * time_s,
            thrust_n,
            gimbal_rad,
            slosh: self.slosh.plus(&rate.slosh, time_s),
        };
        (motion, raw)
    }
}

impl Rate {
    /// Runge and Kutta's mean of the four stages.
    fn mean(k1: &Self, k2: &Self, k3: &Self, k4: &Self) -> Self {
        macro_rules! mean {
            ($field:ident) => {
                (k1.$field + (k2.$field + k3.$field) * 2.0 + k4.$field) * (1.0 / 6.0)
            };
        }
        let outer = k1.slosh.plus(&k4.slosh, 1.0);
        let inner = k2.slosh.plus(&k3.slosh, 1.0);
        Self {
            velocity_w: mean!(velocity_w),
            acceleration_w: mean!(acceleration_w),
            quaternion: mean!(quaternion),
            angular_acceleration_b: mean!(angular_acceleration_b),
            propellant_kg_s: mean!(propellant_kg_s),
            slosh: outer.plus(&inner, 2.0).times(1.0 / 6.0),
        }
    }
}

/// What the main engine's propellant does on its way from the tanks through the nozzle of a turning
/// vehicle, about the centre of mass: Coriolis force, jet damping and the spin that it leaves
/// behind (T.50, T.51). Other flows leave from where they are and take their own momentum along.
#[inline]
pub fn jet_wrench(
    vehicle: &Vehicle,
    motion: &Motion,
    flow_kg_s: f64,
    com_b: &Vector3<f64>,
) -> Wrench {
    let (engine, rate_b) = (&vehicle.engine, &motion.rate_b);
    // Ahead of the branch, so that the compiler shares it with the thrust's own.
    let thrust_direction_b = engine::thrust_direction_b(motion.gimbal_rad);
    if flow_kg_s <= 0.0 {
        return Wrench::default();
    }
    let draw = vehicle.mass.draw(motion.propellant_kg.max(0.0));
    let nozzle_m = engine.pivot_b.z - engine.nozzle_exit_height_m;
    let exit_b = engine.pivot_b - thrust_direction_b * nozzle_m;
    let arm_b = exit_b - com_b;
    // Uniform flow over the exit disc, across the body's axis to within the gimbal's few degrees.
    let disc_m2 = 0.25 * engine.nozzle_exit_radius_m * engine.nozzle_exit_radius_m;
    let carried_out = arm_b.cross(&rate_b.cross(&arm_b))
        + rate_b.component_mul(&Vector3::new(disc_m2, disc_m2, 2.0 * disc_m2));
    Wrench {
        force_b: rate_b.cross(&(exit_b - draw.centre_b)) * (-2.0 * flow_kg_s),
        torque_b: (draw.inertia_b * rate_b - carried_out) * flow_kg_s,
    }
}

/// Acceleration of O less gravity, and angular acceleration, of a rigid vehicle (T.1, T.2).
fn rigid(mass: &MassProperties, rate_b: &Vector3<f64>, wrench: &Wrench) -> [Vector3<f64>; 2] {
    let gyroscopic_b = rate_b.cross(&(mass.inertia_b * rate_b));
    // A vehicle file admits only positive moments, so the tensor is invertible.
    let inverse_inertia_b = mass.inertia_b.try_inverse().unwrap_or_default();
    let turn_b = inverse_inertia_b * (wrench.torque_b - gyroscopic_b);
    let origin_b = wrench.force_b / mass.mass_kg
        - turn_b.cross(&mass.com_b)
        - rate_b.cross(&rate_b.cross(&mass.com_b));
    [origin_b, turn_b]
}

/// Rates at `motion`, whose quaternion was `raw` before normalisation.
fn rates(
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    drive: &Drive,
    motion: &Motion,
    raw: &Quaternion<f64>,
    outside: &Wrench,
) -> Rate {
    let mass = vehicle.mass.at(motion.propellant_kg.max(0.0));
    let jet = jet_wrench(vehicle, motion, drive.engine_flow_kg_s(vehicle, motion), &mass.com_b);
    let driven = drive.wrench(vehicle, motion, &mass.com_b);
    let wrench = Wrench {
        force_b: driven.force_b + jet.force_b + outside.force_b,
        torque_b: driven.torque_b + jet.torque_b + outside.torque_b,
    };
    let mut slosh = Pendulums::default();
    let [origin_b, angular_acceleration_b] = match &vehicle.slosh {
        Some(tanks) if motion.slosh.are_active() => {
            let coupled = slosh::accelerations(tanks, &mass, motion, &wrench);
            slosh = coupled.swings;
            [coupled.origin_b, coupled.turn_b]
        }
        _ => rigid(&mass, &motion.rate_b, &wrench),
    };
    Rate {
        velocity_w: motion.velocity_w,
        acceleration_w: motion.attitude_wb * origin_b + gravity_w,
        // (T.3) on the raw, unnormalised quaternion of the stage.
        quaternion: raw * Quaternion::from_imag(motion.rate_b) * 0.5,
        angular_acceleration_b,
        propellant_kg_s: -drive.flow_kg_s(vehicle, motion),
        slosh,
    }
}

/// One classical fourth-order Runge-Kutta step of `step_s` seconds (T.8).
///
/// `outside` is the wrench of whatever else acts on the vehicle in a given motion: nothing in free
/// flight, the ground in contact. Its torque is about `vehicle.mass.at(propellant).com_b`, with
/// slosh too: the centre of mass with the bobs hanging straight down the body's axis.
pub fn advance(
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    motion: &Motion,
    drive: &Drive,
    step_s: f64,
    outside: impl Fn(&Motion) -> Wrench,
) -> Motion {
    let f = |(stage, raw): (Motion, Quaternion<f64>)| {
        rates(vehicle, gravity_w, drive, &stage, &raw, &outside(&stage))
    };
    let half_s = 0.5 * step_s;
    let middle = drive.actuators_after(vehicle, motion, half_s);
    let end = drive.actuators_after(vehicle, motion, step_s);
    let k1 = f((*motion, *motion.attitude_wb.quaternion()));
    let k2 = f(motion.after(&k1, half_s, middle));
    let k3 = f(motion.after(&k2, half_s, middle));
    let k4 = f(motion.after(&k3, step_s, end));
    let (mut next, _) = motion.after(&Rate::mean(&k1, &k2, &k3, &k4), step_s, end);
    next.propellant_kg = next.propellant_kg.max(0.0);
    next.slosh.normalise();
    next
}

/// Free flight: nothing acts from outside.
pub fn free(_: &Motion) -> Wrench {
    Wrench::default()
}
