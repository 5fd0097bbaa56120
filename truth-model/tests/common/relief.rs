//! Terrains for tests, and places to try them at.

use std::sync::Arc;

use lander_models::heightmap::HeightGrid;
use lander_models::scenario::{Craters, Heightmap, Terrain};
use nalgebra::Vector3;
use truth_model::random::uniform;

use super::{bug, on_plane};

pub fn level() -> Terrain {
    on_plane(bug(), 0.0).scenario.terrain
}

/// Craters by the shipped law, the narrowest 4 m wide.
pub fn cratered() -> Terrain {
    let craters = Craters {
        extent_m: 200.0,
        diameter_min_m: 4.0,
        diameter_max_m: 100.0,
        density_at_1m_m2: 10_f64.powf(-1.1),
        exponent: 2.0,
        depth_ratio: 0.12,
        rim_ratio: 0.18,
        freshness_min: 0.25,
    };
    Terrain { craters: Some(craters), ..level() }
}

/// A square grid about the origin with `elevation(x, y)` at its nodes.
pub fn meshed(spacing_m: f64, half_m: f64, elevation: impl Fn(f64, f64) -> f64) -> Terrain {
    let count = (2.0 * half_m / spacing_m).round() as usize + 1;
    let at = |index: usize| index as f64 * spacing_m - half_m;
    let nodes = (0..count * count).map(|node| elevation(at(node % count), at(node / count)));
    let grid = HeightGrid {
        columns: count,
        rows: count,
        spacing_m,
        west_m: -half_m,
        south_m: -half_m,
        elevations_m: nodes.collect(),
    };
    Terrain { heightmap: Some(Heightmap { grid: Arc::new(grid), datum_m: None }), ..level() }
}

/// Draw `index` of places in a box about the origin, half as wide as `half_m` says.
pub fn place(index: u64, half_m: Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| {
        half_m[axis] * (2.0 * uniform(1, "test.place", 3 * index + axis as u64) - 1.0)
    })
}
