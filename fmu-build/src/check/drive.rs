//! Inputs that make a model work: a descent for guidance, a burn for truth.

use std::ops::Range;

use fmi_adapter::variables::{Slot, input_starts};
use fmi_adapter::{Variant, variables};
use lander_models::signals::Interface;

use crate::importer::{Answer, Instance, Refusal};

/// Communication step, s.
pub const STEP_S: f64 = 0.01;

/// Name, value at 0, and rate a second; other inputs stay at their start values. Truth burns,
/// leans and turns; guidance sees the descent of the default landing without a burn.
const INPUTS: [(&str, f64, f64); 12] = [
    ("thrust_command_n", 2500.0, 0.0),
    ("gimbal_command_rad[1]", 0.01, 0.0),
    ("rcs_torque_command_b[3]", 5.0, 0.0),
    ("position_w[1]", 300.0, -15.0),
    ("position_w[2]", 100.0, -5.0),
    ("position_w[3]", 500.0, -25.0),
    ("velocity_w[1]", -15.0, 0.0),
    ("velocity_w[2]", -5.0, 0.0),
    ("velocity_w[3]", -25.0, 0.0),
    ("mass_kg", 250.0, 0.0),
    ("altimeter_m", 500.0, -25.0),
    ("altimeter_range_m", 500.0, -25.0),
];

/// The variables of a model that a run sets and reads.
pub struct Drive {
    inputs: Vec<u32>,
    /// Value and rate of each scalar input.
    signals: Vec<(f64, f64)>,
    outputs: Vec<u32>,
    output_count: usize,
}

/// Every bit of every output after each step.
pub type Bits = Vec<u64>;

impl Drive {
    pub fn new(model: &Interface, variant: Variant) -> Self {
        let all = variables(model, variant);
        let listed = |wanted: fn(Slot) -> bool| -> Vec<u32> {
            all.iter().filter(|v| wanted(v.slot)).map(|v| v.reference).collect()
        };
        let signal = |(index, start)| {
            let name = Slot::Input(index).name(model);
            let found = INPUTS.iter().find(|input| input.0 == name);
            found.map_or((start, 0.0), |&(_, value, rate)| (value, rate))
        };
        Self {
            inputs: listed(|slot| matches!(slot, Slot::Input(_))),
            signals: input_starts(model).into_iter().enumerate().map(signal).collect(),
            outputs: listed(|slot| matches!(slot, Slot::Output(_))),
            output_count: model.output_len(),
        }
    }

    /// Reference of the first input, and of the first output.
    pub fn first(&self) -> (u32, u32) {
        (self.inputs[0], self.outputs[0])
    }

    /// Flies the steps of these numbers.
    pub fn fly(&self, instance: &Instance, steps: Range<u32>) -> Result<Bits, String> {
        let mut bits = Bits::new();
        for number in steps {
            done("a step", self.step(instance, number))?;
            let outputs = instance.get(&self.outputs, self.output_count);
            let outputs = done("reading outputs", outputs)?;
            bits.extend(outputs.into_iter().map(f64::to_bits));
        }
        Ok(bits)
    }

    fn step(&self, instance: &Instance, number: u32) -> Result<bool, Refusal> {
        let time_s = time_s(number);
        let at = |&(value, rate): &(f64, f64)| value + rate * time_s;
        instance.set(&self.inputs, &self.signals.iter().map(at).collect::<Vec<_>>())?;
        instance.step(time_s, STEP_S)
    }
}

/// The double nearest to the decimal, without the drift of a sum.
pub fn time_s(number: u32) -> f64 {
    f64::from(number) / 100.0
}

/// The answer, or why `what` failed, as the FMU logged it.
pub fn done<T>(what: &str, answer: Answer<T>) -> Result<T, String> {
    answer.map_err(|refusal| told(what, &refusal))
}

fn told(what: &str, refusal: &Refusal) -> String {
    let reason = refusal.messages.join("; ");
    format!("{what} gave status {}: {reason}", refusal.status)
}
