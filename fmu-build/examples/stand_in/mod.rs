//! The smallest model behind truth's interface, with a fault to be found or without.

use std::sync::atomic::{AtomicU32, Ordering};

use lander_models::signals::{Interface, TRUTH};
use lander_models::{Component, ModelError, Scenario, Settings, StepReport, Ticks};
use serde::{Deserialize, Serialize};

/// Steps of all instances: what no model may look at.
static STEPS: AtomicU32 = AtomicU32::new(0);

/// Its first output grows with thrust; if `FORGETFUL`, also with what is not in its state.
#[derive(Debug)]
pub struct StandIn<const FORGETFUL: bool>;

#[derive(Clone, Serialize, Deserialize)]
pub struct State {
    impulse_n_s: f64,
}

impl<const FORGETFUL: bool> Component for StandIn<FORGETFUL> {
    const INTERFACE: &'static Interface = &TRUTH;
    type State = State;

    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        Self::create_changed(settings, "")
    }

    fn create_changed(settings: &Settings, changes: &str) -> Result<(Self, State), ModelError> {
        Scenario::load_changed(&settings.scenario_file, changes)?;
        Ok((Self, State { impulse_n_s: 0.0 }))
    }

    fn step(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        state.impulse_n_s += inputs[0] * duration.seconds();
        if FORGETFUL {
            state.impulse_n_s += f64::from(STEPS.fetch_add(1, Ordering::Relaxed));
        }
        Ok(StepReport::default())
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        outputs.fill(f64::NAN);
        outputs[0] = state.impulse_n_s;
    }
}
