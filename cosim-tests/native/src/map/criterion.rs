//! Criteria that need no simulation: the static tip angle, and the speed that tips captured pads.

use lander_models::Vehicle;
use lander_models::frames::attitude_from_roll_pitch_yaw_deg;
use nalgebra::Vector3;
use truth_model::stability::{Captured, static_tip_angle_rad};

use crate::touchdowns::Case;

/// Whether each criterion calls a touchdown a tip-over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tips {
    /// The slope exceeds the static tip angle over an edge (T.16). It knows no velocity.
    pub fixed: bool,
    /// The speed towards an edge exceeds that at which the stop of its pads tips the vehicle (T.24).
    pub captured: bool,
}

/// Of a vehicle that stands on a case's slope with its heading, and moves with its velocity.
pub fn tips(vehicle: &Vehicle, case: &Case) -> Tips {
    let [
        propellant_kg,
        gravity_m_s2,
        down_m_s,
        across_m_s,
        travel_deg,
        roll_deg,
        pitch_deg,
        yaw_deg,
        _rate_x,
        _rate_y,
        _rate_z,
        slope_deg,
        downhill_deg,
        ..,
    ] = *case;
    let (slope_rad, downhill_rad) = (slope_deg.to_radians(), downhill_deg.to_radians());
    let mass = vehicle.mass.at(propellant_kg);
    let forward_w = attitude_from_roll_pitch_yaw_deg([roll_deg, pitch_deg, yaw_deg]) * Vector3::x();
    let heading_deg = libm::atan2(forward_w.y, forward_w.x).to_degrees();
    let heading_wb = attitude_from_roll_pitch_yaw_deg([0.0, 0.0, heading_deg]);
    let com_w = heading_wb * mass.com_b;
    let feet_w: Vec<Vector3<f64>> = vehicle.gear.feet_b().map(|foot| heading_wb * foot).collect();
    let towards =
        |azimuth_rad: f64| Vector3::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0);
    let (travel_w, downhill_w) = (towards(travel_deg.to_radians()), towards(downhill_rad));
    let mut tips = Tips { fixed: false, captured: false };
    for (foot_w, next_w) in feet_w.iter().zip(feet_w.iter().cycle().skip(1)) {
        let edge = (next_w - foot_w).normalize();
        let outward = edge.cross(&Vector3::z());
        let distance_m = (foot_w - com_w).dot(&outward);
        let height_m = com_w.z - foot_w.z;
        // Of the slope, how much falls across this edge.
        let fall_rad = libm::atan(libm::tan(slope_rad) * downhill_w.dot(&outward));
        tips.fixed |= fall_rad > static_tip_angle_rad(distance_m, height_m);
        let edge_b = heading_wb.inverse() * edge;
        let standing = Captured {
            mass_kg: mass.mass_kg,
            inertia_kg_m2: edge_b.dot(&(mass.inertia_b * edge_b)),
            distance_m,
            height_m,
            pad_radius_m: vehicle.gear.pad_radius_m,
            slope_rad: fall_rad,
        };
        let speed_m_s = across_m_s * travel_w.dot(&outward) * libm::cos(fall_rad)
            + down_m_s * libm::sin(fall_rad);
        let limit_m_s = standing.tip_speed_m_s(gravity_m_s2);
        // Not a number beyond the static tip angle.
        tips.captured |= limit_m_s.is_nan() || speed_m_s > limit_m_s;
    }
    tips
}
