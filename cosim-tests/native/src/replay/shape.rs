//! What the viewer draws of vehicle and ground.

use lander_models::Vehicle;
use serde::Serialize;
use truth_model::terrain::{Ground as Terrain, Rock};

/// Half the edge of the two patches of ground, m, and the squares along an edge: the landing site,
/// and its surroundings.
const SITE_M: f64 = 16.0;
const SITE_SQUARES: u32 = 32;
const AROUND_SQUARES: u32 = 40;
/// Least half edge of the surroundings, m: a horizon for a vehicle high up.
const AROUND_M: f64 = 800.0;
/// Rocks shown, those around the landing site.
const ROCK_REACH_M: f64 = 12.0;

/// Body frame, m.
#[derive(Serialize)]
pub struct Shape {
    hull_bottom_m: f64,
    hull_top_m: f64,
    hull_radius_m: f64,
    pivot_b: [f64; 3],
    nozzle_exit_m: f64,
    nozzle_radius_m: f64,
    thrust_max_n: f64,
    pad_radius_m: f64,
    stroke_max_m: f64,
    feet_b: Vec<[f64; 3]>,
    stroke_axes_b: Vec<[f64; 3]>,
}

/// World frame, m.
#[derive(Serialize)]
pub struct Ground {
    site: Patch,
    around: Patch,
    /// Centre and radius.
    rocks: Vec<[f64; 4]>,
}

/// Heights over a square grid, row by row from the least x and y.
#[derive(Serialize)]
pub struct Patch {
    least_x_m: f64,
    least_y_m: f64,
    spacing_m: f64,
    squares: u32,
    heights_m: Vec<f64>,
}

impl Shape {
    pub fn of(vehicle: &Vehicle) -> Self {
        let (hull, engine, gear) = (&vehicle.hull, &vehicle.engine, &vehicle.gear);
        let stroke_max_m = gear.legs.iter().map(|leg| leg.strut.stroke_max_m).fold(0.0, f64::max);
        Self {
            hull_bottom_m: hull.bottom_height_m,
            hull_top_m: hull.top_height_m,
            hull_radius_m: hull.radius_m,
            pivot_b: engine.pivot_b.into(),
            nozzle_exit_m: engine.nozzle_exit_height_m,
            nozzle_radius_m: engine.nozzle_exit_radius_m,
            thrust_max_n: engine.thrust_max_n,
            pad_radius_m: gear.pad_radius_m,
            stroke_max_m,
            feet_b: gear.feet_b().map(Into::into).collect(),
            stroke_axes_b: gear.legs.iter().map(|leg| leg.stroke_axis_b.into()).collect(),
        }
    }
}

impl Ground {
    /// About where the vehicle ended, out to where it started.
    pub fn around(terrain: &Terrain, end_w: &[f64; 3], start_w: &nalgebra::Vector3<f64>) -> Self {
        let [x_m, y_m, _] = *end_w;
        let reach_m = (start_w.x - x_m).abs().max((start_w.y - y_m).abs());
        let rocks = terrain.rocks_near(&(*end_w).into(), ROCK_REACH_M).map(rock).collect();
        let around_m = (1.5 * reach_m).max(AROUND_M);
        Self {
            site: Patch::about(terrain, [x_m, y_m], SITE_M, SITE_SQUARES),
            around: Patch::about(terrain, [x_m, y_m], around_m, AROUND_SQUARES),
            rocks,
        }
    }
}

fn rock(rock: &Rock) -> [f64; 4] {
    [rock.centre_w.x, rock.centre_w.y, rock.centre_w.z, rock.radius_m]
}

impl Patch {
    fn about(terrain: &Terrain, [x_m, y_m]: [f64; 2], half_m: f64, squares: u32) -> Self {
        let spacing_m = 2.0 * half_m / f64::from(squares);
        // Whole spacings, so that lines stand on round numbers.
        let least = |middle_m: f64| ((middle_m - half_m) / spacing_m).round() * spacing_m;
        let (least_x_m, least_y_m) = (least(x_m), least(y_m));
        let at = |index: u32| f64::from(index) * spacing_m;
        let heights_m = (0..=squares)
            .flat_map(|row| (0..=squares).map(move |column| (row, column)))
            .map(|(row, column)| terrain.height_m(least_x_m + at(column), least_y_m + at(row)))
            .map(|height_m| super::round(height_m, 1e-3))
            .collect();
        Self { least_x_m, least_y_m, spacing_m, squares, heights_m }
    }
}
