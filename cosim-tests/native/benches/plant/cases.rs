//! The touchdowns that are timed: those of `touchdown_cosim.bench_mujoco`, by the same names.

use cosim::touchdowns::{self, COLUMNS};
use lander_models::frames::tilt_rad;
use lander_models::scenario::ContactEngine;
use lander_models::time::Ticks;
use lander_models::{ConfigError, Vehicle};
use truth_model::{State, TruthModel};

/// A touchdown of BUG from just above the ground, engine off, that ends on its feet.
pub struct Case {
    pub name: &'static str,
    /// As `COLUMNS`.
    pub values: [f64; COLUMNS.len()],
}

#[rustfmt::skip]
pub const CASES: [Case; 5] = [
    // Propellant, gravity, down, across, travel; roll, pitch, yaw; rates; slope, downhill, pads.
    Case { name: "flat", values: [
        5.0, 1.625, 1.0, 0.3, 0.0,   0.0, 0.0, 0.0,   0.0, 0.0, 0.0,   0.0, 0.0, 0.6, 0.0,
    ] },
    Case { name: "two legs first, downhill", values: [
        5.0, 1.625, 1.0, 0.6, 0.0,   0.0, 0.0, 0.0,   0.0, 0.0, 0.0,   8.0, 0.0, 0.6, 0.0,
    ] },
    Case { name: "one leg first, across", values: [
        5.0, 1.625, 1.0, 0.6, 90.0,   0.0, 0.0, 45.0,   0.0, 0.0, 0.0,   8.0, 0.0, 0.6, 0.0,
    ] },
    Case { name: "tilted and turning", values: [
        5.0, 1.625, 1.0, 0.3, 0.0,   3.0, -4.0, 0.0,   0.0, 5.0, 3.0,   0.0, 0.0, 0.6, 0.0,
    ] },
    Case { name: "rocking on held pads", values: [
        5.0, 1.625, 1.0, 1.2, 0.0,   0.0, 0.0, 0.0,   0.0, 0.0, 0.0,   0.0, 0.0, 0.6, 1.0,
    ] },
];

/// Who still moves after so long does not come to rest.
const STOP_TIME: Ticks = Ticks(12_000);

/// How a touchdown ended, to be compared.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    pub place_w: nalgebra::Vector3<f64>,
    pub tilt_deg: f64,
    pub stroke_m: f64,
}

impl Rest {
    pub fn of(state: &State) -> Self {
        Self {
            place_w: state.motion.position_w,
            tilt_deg: tilt_rad(&state.motion.attitude_wb).to_degrees(),
            stroke_m: state.touchdown.peak_stroke_m,
        }
    }
}

/// The case just clear of the ground.
pub fn model(
    vehicle: &Vehicle,
    case: &Case,
    engine: ContactEngine,
) -> Result<TruthModel, ConfigError> {
    touchdowns::model(vehicle, engine, STOP_TIME, &case.values)
}
