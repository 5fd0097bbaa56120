//! One closed loop in this process: truth and guidance, each with what it knows.

use std::ops::ControlFlow;

use guidance_fmu::Guidance;
use lander_models::{ModelError, Scenario, Vehicle};
use truth_model::TruthModel;

use crate::master::Master;
use crate::schedule::Schedule;

/// A world: site and start, and the vehicle in it.
pub type World<'a> = (&'a Scenario, &'a Vehicle);

/// Flies to the end that truth decides on, in the world `truth` with a guidance that takes `believed` for
/// it. Every row goes to `on_row`.
pub fn fly<E: From<ModelError>>(
    schedule: &Schedule,
    truth: World,
    believed: World,
    on_row: impl FnMut(&[f64]) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let stop_time = truth.0.stop_time;
    let guidance = Guidance::new(believed.0, believed.1.clone());
    let guidance_start = guidance.initial_state();
    let truth = TruthModel::new(truth.0.clone(), truth.1.clone());
    let start = truth.initial_state();
    let mut master = Master::of(schedule, (truth, start), (guidance, guidance_start));
    master.run(stop_time, on_row)
}

/// As `fly`, for the last row alone.
pub fn last_row(
    schedule: &Schedule,
    truth: World,
    believed: World,
) -> Result<Vec<f64>, ModelError> {
    let mut last = Vec::new();
    fly(schedule, truth, believed, |row| {
        last.clear();
        last.extend_from_slice(row);
        Ok::<_, ModelError>(ControlFlow::Continue(()))
    })?;
    Ok(last)
}
