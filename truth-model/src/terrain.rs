//! Ground under a point. A plane through the world origin for now (T.13).

use lander_models::scenario::Terrain;
use nalgebra::Vector3;

/// Distance of a point from the plane along its normal, m; negative below ground.
pub fn clearance_m(terrain: &Terrain, point_w: &Vector3<f64>) -> f64 {
    terrain.normal_w().dot(point_w)
}

/// Vertical height of a point above the ground below it, m.
pub fn height_m(terrain: &Terrain, point_w: &Vector3<f64>) -> f64 {
    // The normal of a plane that is no wall has a positive z: slopes end at 45 degrees.
    clearance_m(terrain, point_w) / terrain.normal_w().z
}
