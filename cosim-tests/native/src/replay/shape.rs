//! What the viewer draws of the vehicle.

use lander_models::Vehicle;
use serde::Serialize;

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
