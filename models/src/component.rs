//! The contract that each half of the co-simulation fulfils. FMI is built on it elsewhere.

use std::fmt::Debug;
use std::path::PathBuf;

use serde::{Serialize, de::DeserializeOwned};

use crate::signals::Interface;
use crate::{ConfigError, Ticks};

/// What an instance is made from: the only things that may differ between two instances.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Scenario file; it names the vehicle file relative to itself.
    pub scenario_file: PathBuf,
}

/// What came of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepReport {
    /// Something discrete happened (touchdown, cut-off, tip-over, onset of a fault …).
    pub event: bool,
    /// The run has reached its end; further steps change nothing worth seeing.
    pub terminate: bool,
}

#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("input {name} is {value}: inputs must be finite")]
    NonFiniteInput { name: String, value: f64 },
    #[error("input {name} is {value}: must be within {low:e} and {high:e}")]
    AbsurdInput { name: String, value: f64, low: f64, high: f64 },
    #[error("input {name} has norm {norm}: must be within 1e-3 of 1")]
    NotAUnit { name: &'static str, norm: f64 },
    #[error("state became non-finite at t = {time_s} s: {what}")]
    Diverged { time_s: f64, what: &'static str },
}

/// A constant configuration (`Self`) and an explicit, plain state (`State`).
///
/// `State: Clone` is FMI's get/set state, `Serialize` its serialisation; a state restored in
/// another instance, thread or process continues bit for bit.
///
/// The `Debug` form of `Self` tells one configuration from another (a stored state fits its own
/// only): derive it, so that it shows every field.
pub trait Component: Sized + Debug {
    const INTERFACE: &'static Interface;
    type State: Clone + Serialize + DeserializeOwned;

    /// Reads the files that `settings` names and returns the state at t = 0.
    fn create(settings: &Settings) -> Result<(Self, Self::State), ModelError>;

    /// As `create`, with changes to the scenario (`Scenario::load_changed`).
    fn create_changed(
        settings: &Settings,
        changes: &str,
    ) -> Result<(Self, Self::State), ModelError> {
        if changes.is_empty() {
            return Self::create(settings);
        }
        let (file, reason) = (settings.scenario_file.clone(), "can't be changed".to_owned());
        Err(ConfigError::Key { file, key: changes.to_owned(), reason }.into())
    }

    /// Advances by `duration`, inputs held. `inputs` has `INTERFACE.input_len()` scalars in
    /// table order. On error the state must not be used further.
    fn step(
        &self,
        state: &mut Self::State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError>;

    /// As `step`, but done with the tick in which something discrete happened: returns how far it
    /// came. A component whose events fall on the ends of steps has nothing to add.
    fn step_to_event(
        &self,
        state: &mut Self::State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<(Ticks, StepReport), ModelError> {
        Ok((duration, self.step(state, inputs, duration)?))
    }

    /// Writes `INTERFACE.output_len()` scalars in table order. Cheap and free of side effects.
    fn outputs(&self, state: &Self::State, outputs: &mut [f64]);
}
