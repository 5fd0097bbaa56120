//! Free flight: six degrees of freedom with mass, centre of mass and inertia sampled inside the
//! stages of a fourth-order Runge-Kutta step (T.1 to T.8 in the README).

use lander_models::Vehicle;
use lander_models::frames::Attitude;
use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::propulsion::{Drive, Wrench};

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
}

/// The integrated part: position, velocity, quaternion, rate, propellant.
type Packed = SVector<f64, 14>;

impl Motion {
    fn pack(&self) -> Packed {
        let q = self.attitude_wb.quaternion().coords;
        let mut x = Packed::zeros();
        x.fixed_rows_mut::<3>(0).copy_from(&self.position_w);
        x.fixed_rows_mut::<3>(3).copy_from(&self.velocity_w);
        x.fixed_rows_mut::<4>(6).copy_from(&q);
        x.fixed_rows_mut::<3>(10).copy_from(&self.rate_b);
        x[13] = self.propellant_kg;
        x
    }

    fn unpack(x: &Packed, thrust_n: f64, gimbal_rad: Vector2<f64>) -> Self {
        Self {
            position_w: x.fixed_rows::<3>(0).into(),
            velocity_w: x.fixed_rows::<3>(3).into(),
            attitude_wb: UnitQuaternion::from_quaternion(Quaternion::from_vector(
                x.fixed_rows::<4>(6).into(),
            )),
            rate_b: x.fixed_rows::<3>(10).into(),
            propellant_kg: x[13],
            thrust_n,
            gimbal_rad,
        }
    }

    pub fn is_finite(&self) -> bool {
        let actuators = [self.thrust_n, self.gimbal_rad.x, self.gimbal_rad.y];
        self.pack().iter().chain(&actuators).all(|value| value.is_finite())
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

/// Time derivative of the packed state, for the motion that it was packed from.
fn derivative(
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    drive: &Drive,
    x: &Packed,
    motion: &Motion,
    outside: &Wrench,
) -> Packed {
    let mass = vehicle.mass.at(motion.propellant_kg.max(0.0));
    let wrench = drive.wrench(vehicle, motion, &mass.com_b);
    let rate_b = motion.rate_b;

    // (T.2) Euler's equation about the centre of mass.
    let gyroscopic_b = rate_b.cross(&(mass.inertia_b * rate_b));
    // A vehicle file admits only positive moments, so the tensor is invertible.
    let inverse_inertia_b = mass.inertia_b.try_inverse().unwrap_or_default();
    let torque_b = wrench.torque_b + outside.torque_b;
    let angular_acceleration_b = inverse_inertia_b * (torque_b - gyroscopic_b);

    // (T.1) Acceleration of O from that of the centre of mass.
    let com_acceleration_b = (wrench.force_b + outside.force_b) / mass.mass_kg;
    let origin_acceleration_b = com_acceleration_b
        - angular_acceleration_b.cross(&mass.com_b)
        - rate_b.cross(&rate_b.cross(&mass.com_b));
    let acceleration_w = motion.attitude_wb * origin_acceleration_b + gravity_w;

    // (T.3) Quaternion kinematics on the raw, unnormalised quaternion of the stage.
    let q = Quaternion::from_vector(x.fixed_rows::<4>(6).into());
    let q_dot = q * Quaternion::from_imag(rate_b) * 0.5;

    let mut dx = Packed::zeros();
    dx.fixed_rows_mut::<3>(0).copy_from(&motion.velocity_w);
    dx.fixed_rows_mut::<3>(3).copy_from(&acceleration_w);
    dx.fixed_rows_mut::<4>(6).copy_from(&q_dot.coords);
    dx.fixed_rows_mut::<3>(10).copy_from(&angular_acceleration_b);
    dx[13] = -drive.flow_kg_s(vehicle, motion);
    dx
}

/// One classical fourth-order Runge-Kutta step of `step_s` seconds (T.8). `outside` is the wrench
/// of whatever else acts on the vehicle in a given motion: nothing in free flight, the ground in
/// contact.
pub fn advance(
    vehicle: &Vehicle,
    gravity_w: &Vector3<f64>,
    motion: &Motion,
    drive: &Drive,
    step_s: f64,
    outside: impl Fn(&Motion) -> Wrench,
) -> Motion {
    let unpack = |x: &Packed, time_s: f64| {
        let (thrust_n, gimbal_rad) = drive.actuators_after(vehicle, motion, time_s);
        Motion::unpack(x, thrust_n, gimbal_rad)
    };
    let f = |x: &Packed, time_s: f64| {
        let stage = unpack(x, time_s);
        derivative(vehicle, gravity_w, drive, x, &stage, &outside(&stage))
    };
    let x = motion.pack();
    let half_s = 0.5 * step_s;
    let k1 = f(&x, 0.0);
    let k2 = f(&(x + k1 * half_s), half_s);
    let k3 = f(&(x + k2 * half_s), half_s);
    let k4 = f(&(x + k3 * step_s), step_s);
    let mut next = unpack(&(x + (k1 + (k2 + k3) * 2.0 + k4) * (step_s / 6.0)), step_s);
    next.propellant_kg = next.propellant_kg.max(0.0);
    next
}

/// Free flight: nothing acts from outside.
pub fn free(_: &Motion) -> Wrench {
    Wrench::default()
}
