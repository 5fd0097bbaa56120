//! Static tip angle of a standing vehicle over all directions, by the truth model's own criterion.

use nalgebra::{Matrix3, Vector3};
use truth_model::stability::{Tipping, tip_state};

/// Slope, rad, at which a centre of mass above pads at rest leaves them, if the ground falls towards
/// `azimuth_rad`: the stability distance (T.20) is 0.
pub fn towards_rad(feet_b: &[Vector3<f64>], com_b: Vector3<f64>, azimuth_rad: f64) -> f64 {
    let distance_m = |slope_rad: f64| {
        let (sin, cos) = libm::sincos(slope_rad);
        let up_b = Vector3::new(-sin * libm::cos(azimuth_rad), -sin * libm::sin(azimuth_rad), cos);
        let standing = Tipping {
            mass_kg: 1.0,
            com_b,
            com_velocity_b: Vector3::zeros(),
            rate_b: Vector3::zeros(),
            inertia_b: Matrix3::identity(),
            up_b,
            gravity_m_s2: 1.0,
        };
        tip_state(&standing, feet_b).distance_m
    };
    let (mut stands, mut tips) = (0.0, std::f64::consts::FRAC_PI_2);
    // Bisection to the last bits.
    for _ in 0..60 {
        let middle = 0.5 * (stands + tips);
        if distance_m(middle) > 0.0 { stands = middle } else { tips = middle }
    }
    stands
}

/// Least and greatest tip angle, rad, over azimuths a quarter of a degree apart: every edge and pad of
/// three, four or six pads that stand symmetrically is among them.
pub fn extremes_rad(feet_b: &[Vector3<f64>], com_b: Vector3<f64>) -> [f64; 2] {
    let all = (0..1440)
        .map(|n| towards_rad(feet_b, com_b, f64::from(n) * std::f64::consts::TAU / 1440.0));
    all.fold([f64::INFINITY, 0.0], |[low, high], angle| [low.min(angle), high.max(angle)])
}

/// So many pads on a circle, counter-clockwise from above.
pub fn ring(pads: u32, diameter_m: f64) -> Vec<Vector3<f64>> {
    let pad = |n: u32| {
        let azimuth_rad = (f64::from(n) + 0.5) * std::f64::consts::TAU / f64::from(pads);
        Vector3::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0) * (0.5 * diameter_m)
    };
    (0..pads).map(pad).collect()
}
