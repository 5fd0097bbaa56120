//! Descents of the six-degree-of-freedom tests: BUG above the Moon.

use guidance_fmu::six_dof::{Actuators, Limits, SixDofProblem, Start};
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};

/// From (300, 100, 500) m at (-15, -5, -25) m/s, upright and still, to rest at the origin within 1°
/// and 1 °/s.
pub fn descent() -> SixDofProblem {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref()).unwrap();
    SixDofProblem {
        start: Start {
            propellant_kg: 85.5,
            r_w: Vector3::new(300.0, 100.0, 500.0),
            v_w: Vector3::new(-15.0, -5.0, -25.0),
            attitude_wb: Some(UnitQuaternion::identity()),
            rate_b: Vector3::zeros(),
        },
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        gravity_m_s2: 1.625,
        actuators: Actuators::of(&vehicle),
        limits: Limits {
            tilt_max_rad: 29_f64.to_radians(),
            rate_max_rad_s: 0.8,
            glide_slope_rad: None,
            end_tilt_max_rad: 1_f64.to_radians(),
            end_rate_max_rad_s: 1_f64.to_radians(),
        },
        mass: vehicle.mass,
    }
}
