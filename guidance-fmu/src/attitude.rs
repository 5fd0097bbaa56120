//! Attitude control by gimbal and thrusters (G.35 to G.37).

use lander_models::vehicle::Vehicle;
use nalgebra::{Rotation3, UnitQuaternion, Vector2, Vector3};

use crate::navigation::Navigation;

/// Loop gains: attitude error to rate and rate error to acceleration, 1/s.
struct Gains {
    error_to_rate_1_s: f64,
    rate_to_acceleration_1_s: f64,
    /// Slews are held to this rate.
    rate_max_rad_s: f64,
}

/// On the gimbal: poles at 3 ± 2.4i rad/s, a fifth of the gimbal's lag (20 rad/s).
const ON_GIMBAL: Gains =
    Gains { error_to_rate_1_s: 2.5, rate_to_acceleration_1_s: 6.0, rate_max_rad_s: 0.5 };
/// On the thrusters: poles at 1.5 ± 1.2i rad/s; their 0.36 rad/s² stops a slew within 0.7 s.
const ON_THRUSTERS: Gains =
    Gains { error_to_rate_1_s: 1.2, rate_to_acceleration_1_s: 3.0, rate_max_rad_s: 0.26 };

/// Below this thrust the gimbal's torque is not relied on.
const GIMBAL_THRUST_MIN_N: f64 = 400.0;

/// Commands of one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Torquers {
    pub gimbal_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
}

/// Turns the vehicle so that a thrust through the centre of mass points along `up_w` and body x
/// keeps its heading towards world x. `thrust_n` is the thrust expected now.
///
/// `up_rate_w` is the angular velocity of `up_w` itself, rad/s: a turn that is planned needs no
/// error to follow.
pub fn control(
    vehicle: &Vehicle,
    nav: &Navigation,
    up_w: &Vector3<f64>,
    up_rate_w: &Vector3<f64>,
    thrust_n: f64,
) -> Torquers {
    let gains = if thrust_n > GIMBAL_THRUST_MIN_N { ON_GIMBAL } else { ON_THRUSTERS };
    let wanted_wb = attitude_for(vehicle, nav, up_w, thrust_n);
    let error_b = (wanted_wb.inverse() * nav.attitude_wb).scaled_axis();
    let turn_b = nav.attitude_wb.inverse() * up_rate_w;
    let rate_b = (turn_b - error_b * gains.error_to_rate_1_s).cap_magnitude(gains.rate_max_rad_s);
    let acceleration_b = (rate_b - nav.rate_b) * gains.rate_to_acceleration_1_s;
    // (G.36)
    let spin_b = nav.mass.inertia_b * nav.rate_b;
    let torque_b = nav.mass.inertia_b * acceleration_b + nav.rate_b.cross(&spin_b);
    allocate(vehicle, nav, &torque_b, thrust_n)
}

/// Attitude whose trimmed thrust line is `up_w` (G.35).
fn attitude_for(
    vehicle: &Vehicle,
    nav: &Navigation,
    up_w: &Vector3<f64>,
    thrust_n: f64,
) -> UnitQuaternion<f64> {
    let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
    let trim_b = if thrust_n > GIMBAL_THRUST_MIN_N { -arm_b.normalize() } else { Vector3::z() };
    // Body y from up × x: defined for every tilt below 90°, which the planner's limit ensures.
    let y_w = up_w.cross(&Vector3::x());
    let y_w = y_w.try_normalize(1e-9).unwrap_or(Vector3::y());
    let x_w = y_w.cross(up_w);
    let frame = Rotation3::from_basis_unchecked(&[x_w, y_w, *up_w]);
    let trim = UnitQuaternion::rotation_between(&trim_b, &Vector3::z()).unwrap_or_default();
    UnitQuaternion::from_rotation_matrix(&frame) * trim
}

/// Gimbal first, thrusters for what it can't give (G.37).
fn allocate(
    vehicle: &Vehicle,
    nav: &Navigation,
    torque_b: &Vector3<f64>,
    thrust_n: f64,
) -> Torquers {
    let limit_rad = vehicle.engine.gimbal_limit_rad;
    let arm_b = vehicle.engine.pivot_b - nav.mass.com_b;
    let mut left_b = *torque_b;
    let mut gimbal_rad = Vector2::zeros();
    if thrust_n > GIMBAL_THRUST_MIN_N {
        let lever_nm = arm_b.z * thrust_n;
        gimbal_rad = Vector2::new(
            (torque_b.x - arm_b.y * thrust_n) / lever_nm,
            (torque_b.y + arm_b.x * thrust_n) / lever_nm,
        )
        .map(|angle| angle.clamp(-limit_rad, limit_rad));
        left_b.x -= lever_nm * gimbal_rad.x + arm_b.y * thrust_n;
        left_b.y -= lever_nm * gimbal_rad.y - arm_b.x * thrust_n;
    }
    let rcs_torque_b =
        left_b.zip_map(&vehicle.rcs.torque_max_b, |torque, max| torque.clamp(-max, max));
    Torquers { gimbal_rad, rcs_torque_b }
}
