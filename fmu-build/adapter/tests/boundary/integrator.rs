//! The smallest component that exercises everything: x' = rate, and ways to go wrong.

use std::path::Path;

use lander_models::signals::{Interface, Signal};
use lander_models::{Component, ConfigError, ModelError, Settings, StepReport, Ticks};
use serde::{Deserialize, Serialize};

const fn signal(name: &'static str, size: usize) -> Signal {
    Signal { name, size, unit: "1", start: 0.5, description: "test" }
}

static INTERFACE: Interface = Interface {
    model: "integrator",
    description: "Integrates two rates",
    inputs: &[signal("rate", 2), signal("trouble", 1), signal("mass_kg", 1)],
    outputs: &[signal("x", 2), signal("steps", 1)],
    outputs_depend_on_inputs: false,
};

pub const RATE_1: u32 = 1000;
pub const RATE_2: u32 = 1001;
pub const TROUBLE: u32 = 1002;
/// Its name has a range in the signal table: 0 to 1e6.
pub const MASS_KG: u32 = 1003;
pub const X_1: u32 = 2000;
pub const X_2: u32 = 2001;
pub const STEPS: u32 = 2002;
pub const ALL_OUTPUTS: [u32; 3] = [X_1, X_2, STEPS];

/// Values of `trouble`.
pub const PANIC: f64 = 1.0;
pub const DIVERGE: f64 = 2.0;
pub const EVENT: f64 = 3.0;
pub const END: f64 = 4.0;

/// Scenario content that makes `create` panic.
pub const PANIC_ON_CREATE: &str = "panic";

#[derive(Debug)]
pub struct Integrator {
    gain: f64,
}

#[derive(Clone, Serialize, Deserialize)]
pub struct State {
    x: [f64; 2],
    steps: u32,
}

fn read(file: &Path) -> Result<String, ConfigError> {
    std::fs::read_to_string(file).map_err(|error| {
        let (file, reason) = (file.to_owned(), error.to_string());
        ConfigError::Unreadable { file, reason }
    })
}

impl Component for Integrator {
    const INTERFACE: &'static Interface = &INTERFACE;
    type State = State;

    /// The scenario file holds the gain, which is also the start of x, or names the file beside
    /// it that does.
    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        let text = read(&settings.scenario_file)?;
        assert_ne!(text, PANIC_ON_CREATE, "create was told to panic");
        let gain = match text.parse() {
            Ok(gain) => gain,
            Err(_) => read(&settings.scenario_file.with_file_name(text))?.parse().unwrap(),
        };
        Ok((Self { gain }, State { x: [gain, -gain], steps: 0 }))
    }

    /// A change is the gain.
    fn create_changed(settings: &Settings, changes: &str) -> Result<(Self, State), ModelError> {
        let (model, state) = Self::create(settings)?;
        match changes.parse() {
            Ok(gain) => Ok((Self { gain }, State { x: [gain, -gain], steps: 0 })),
            Err(_) => Ok((model, state)),
        }
    }

    fn step(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        for (x, rate) in state.x.iter_mut().zip(inputs) {
            *x += self.gain * rate * duration.seconds();
        }
        state.steps += 1;
        assert_ne!(inputs[2], PANIC, "step was told\nto panic");
        if inputs[2] == DIVERGE {
            return Err(ModelError::Diverged { time_s: 0.0, what: "x" });
        }
        Ok(StepReport { event: inputs[2] == EVENT, terminate: inputs[2] == END })
    }

    /// The event happens 3 ms into a step.
    fn step_to_event(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<(Ticks, StepReport), ModelError> {
        let passed = if inputs[2] == EVENT { duration.min(Ticks(3)) } else { duration };
        self.step(state, inputs, passed).map(|report| (passed, report))
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        outputs[..2].copy_from_slice(&state.x);
        outputs[2] = f64::from(state.steps);
    }
}
