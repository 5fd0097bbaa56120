//! The ground: height, nearest surface and rocks, from the scenario's terrain (T.13).

use lander_models::scenario::Terrain;
use nalgebra::Vector3;

/// The surface nearest to a point.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Distance of the point along the normal, m; negative below ground.
    pub clearance_m: f64,
    pub normal_w: Vector3<f64>,
}

/// The terrain made ready for queries. A plane through the world origin.
#[derive(Clone, Debug)]
pub struct Ground {
    normal_w: Vector3<f64>,
}

impl Ground {
    pub fn new(terrain: &Terrain) -> Self {
        Self { normal_w: terrain.normal_w() }
    }

    /// Height of the ground at a place, world z, m.
    pub fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        // The normal of a plane that is no wall has a positive z: slopes end at 45 degrees.
        -(self.normal_w.x * x_m + self.normal_w.y * y_m) / self.normal_w.z
    }

    /// The ground nearest to a point.
    pub fn nearest(&self, point_w: &Vector3<f64>) -> Surface {
        Surface { clearance_m: self.normal_w.dot(point_w), normal_w: self.normal_w }
    }
}
