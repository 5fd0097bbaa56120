//! Times on the monotonic clock: the least of several runs, which is the machine undisturbed.

use std::error::Error;
use std::time::Instant;

use lander_models::scenario::ContactEngine;
use lander_models::time::TICK_S;
use lander_models::{Outcome, Vehicle};
use nalgebra::Vector3;
use truth_model::flight::{advance, free};
use truth_model::propulsion::Drive;
use truth_model::{State, TruthModel};

use crate::cases::{self, CASES, Case, Rest};
use crate::table::Row;

const RUNS: usize = 5;
/// Steps of the reference of an error within one of the engine's own.
pub const REFINEMENT: u32 = 16;

/// The flight integrator alone, microseconds a step.
pub fn flight_us(vehicle: &Vehicle) -> Result<f64, Box<dyn Error>> {
    const STEPS: u32 = 100_000;
    let model = cases::model(vehicle, &CASES[0], ContactEngine::Rapier)?;
    let drive = Drive { thrust_target_n: 2500.0, ..Drive::default() };
    let gravity_w = Vector3::z() * -model.scenario().gravity_m_s2;
    let run = || {
        let mut motion = model.initial_state().motion;
        motion.rate_b = Vector3::new(0.02, 0.05, -0.03);
        let start = Instant::now();
        for _ in 0..STEPS {
            motion = advance(vehicle, &gravity_w, &motion, &drive, TICK_S, free);
        }
        let elapsed_us = start.elapsed().as_secs_f64() * 1e6;
        std::hint::black_box(motion);
        elapsed_us / f64::from(STEPS)
    };
    Ok((0..RUNS).map(|_| run()).fold(f64::INFINITY, f64::min))
}

/// From just above the ground to the verdict: the end, milliseconds and ticks.
fn touch_down(model: &TruthModel) -> Result<(State, f64, u32), Box<dyn Error>> {
    let mut state = model.initial_state();
    let start = Instant::now();
    let mut ticks = 1;
    while !model.tick(&mut state)?.terminate {
        ticks += 1;
    }
    Ok((state, start.elapsed().as_secs_f64() * 1e3, ticks))
}

/// One touchdown with one engine: its time, and its error against the same engine on finer steps.
pub fn touchdown(
    vehicle: &Vehicle,
    case: &Case,
    engine: ContactEngine,
    name: &str,
) -> Result<Row, Box<dyn Error>> {
    let model = cases::model(vehicle, case, engine)?;
    let (mut end, mut least_ms, mut ticks) = touch_down(&model)?;
    for _ in 1..RUNS {
        let (state, ms, count) = touch_down(&model)?;
        least_ms = least_ms.min(ms);
        (end, ticks) = (state, count);
    }
    let mut scenario = model.scenario().clone();
    scenario.contact_refinement = REFINEMENT;
    let (fine, _, _) = touch_down(&TruthModel::new(scenario, vehicle.clone()))?;
    let landed = end.touchdown.outcome == Outcome::Landed;
    let (rest, fine) = (Rest::of(&end), Rest::of(&fine));
    Ok(Row {
        engine: name.to_owned(),
        case: case.name.to_owned(),
        step_ms: 1e3 * TICK_S,
        step_us: 1e3 * least_ms / f64::from(ticks),
        to_rest_ms: landed.then_some(least_ms),
        place_error_m: Some((rest.place_w - fine.place_w).norm()),
        tilt_error_deg: Some((rest.tilt_deg - fine.tilt_deg).abs()),
        stroke_error_percent: Some(100.0 * (rest.stroke_m / fine.stroke_m - 1.0).abs()),
        ratio_to_mujoco: None,
    })
}
