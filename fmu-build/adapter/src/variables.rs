//! The FMI variables of a component, derived from its signal table.
//!
//! Arrays are expanded to scalars `name[1]` …: every FMI 3.0 importer reads those, few read
//! arrays. References: 0 time, 1 the scenario parameter, inputs from 1000, outputs from 2000.

use std::fmt::Write;

use lander_models::signals::{Interface, Signal};
use lander_models::time::TICK_S;
use sha2::{Digest, Sha256};

pub const TIME_REFERENCE: u32 = 0;
pub const SCENARIO_REFERENCE: u32 = 1;
pub const FIRST_INPUT: u32 = 1000;
pub const FIRST_OUTPUT: u32 = 2000;

pub const TIME_NAME: &str = "time";
pub const SCENARIO_NAME: &str = "scenario_file";
/// What an empty `scenario_file` stands for, relative to the resources folder.
pub const DEFAULT_SCENARIO: &str = "scenarios/landing.toml";

/// CoSimulation attributes of modelDescription.xml: what is true, and nothing more.
pub fn capabilities() -> [(&'static str, String); 4] {
    let yes = || "true".to_owned();
    [
        ("canGetAndSetFMUState", yes()),
        ("canSerializeFMUState", yes()),
        // Any whole number of ticks.
        ("canHandleVariableCommunicationStepSize", yes()),
        ("fixedInternalStepSize", TICK_S.to_string()),
    ]
}

/// Which variable a reference means; inputs and outputs by flat scalar index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    Time,
    Scenario,
    Input(usize),
    Output(usize),
}

impl Slot {
    pub fn find(interface: &Interface, reference: u32) -> Option<Self> {
        let within = |first: u32, length: usize| {
            let index = reference.checked_sub(first)? as usize;
            (index < length).then_some(index)
        };
        match reference {
            TIME_REFERENCE => Some(Self::Time),
            SCENARIO_REFERENCE => Some(Self::Scenario),
            FIRST_OUTPUT.. => within(FIRST_OUTPUT, interface.output_len()).map(Self::Output),
            _ => within(FIRST_INPUT, interface.input_len()).map(Self::Input),
        }
    }

    pub fn reference(self) -> u32 {
        match self {
            Self::Time => TIME_REFERENCE,
            Self::Scenario => SCENARIO_REFERENCE,
            Self::Input(index) => FIRST_INPUT + index as u32,
            Self::Output(index) => FIRST_OUTPUT + index as u32,
        }
    }

    pub fn causality(self) -> &'static str {
        match self {
            Self::Time => "independent",
            Self::Scenario => "parameter",
            Self::Input(_) => "input",
            Self::Output(_) => "output",
        }
    }

    /// FMI 3.0 type name.
    pub fn data_type(self) -> &'static str {
        if self == Self::Scenario { "String" } else { "Float64" }
    }

    pub fn name(self, interface: &Interface) -> String {
        let scalar = |signals: &[Signal], mut index: usize| {
            for signal in signals {
                if index < signal.size {
                    return signal.scalar_name(index);
                }
                index -= signal.size;
            }
            format!("#{index}")
        };
        match self {
            Self::Time => TIME_NAME.to_owned(),
            Self::Scenario => SCENARIO_NAME.to_owned(),
            Self::Input(index) => scalar(interface.inputs, index),
            Self::Output(index) => scalar(interface.outputs, index),
        }
    }
}

/// One scalar variable as modelDescription.xml lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub reference: u32,
    pub name: String,
    pub slot: Slot,
    /// Unit in FMI spelling; none for the string parameter.
    pub unit: Option<&'static str>,
    /// Only inputs: the others have none (time, calculated outputs) or "" (the parameter).
    pub start: Option<f64>,
    pub description: &'static str,
}

/// All variables, by value reference.
pub fn variables(interface: &Interface) -> Vec<Variable> {
    let mut all = vec![
        Variable {
            reference: TIME_REFERENCE,
            name: TIME_NAME.to_owned(),
            slot: Slot::Time,
            unit: Some("s"),
            start: None,
            description: "Simulation time",
        },
        Variable {
            reference: SCENARIO_REFERENCE,
            name: SCENARIO_NAME.to_owned(),
            slot: Slot::Scenario,
            unit: None,
            start: None,
            description: "Scenario file, absolute or relative to the resources folder; \
                          empty is scenarios/landing.toml",
        },
    ];
    all.extend(expand(interface.inputs, FIRST_INPUT, Slot::Input));
    all.extend(expand(interface.outputs, FIRST_OUTPUT, Slot::Output));
    all
}

fn expand(
    signals: &[Signal],
    first: u32,
    slot: fn(usize) -> Slot,
) -> impl Iterator<Item = Variable> + '_ {
    let scalars = signals.iter().flat_map(|signal| (0..signal.size).map(move |i| (signal, i)));
    (first..).zip(scalars).enumerate().map(move |(index, (reference, (signal, scalar)))| Variable {
        reference,
        name: signal.scalar_name(scalar),
        slot: slot(index),
        unit: Some(signal.unit),
        start: matches!(slot(index), Slot::Input(_)).then(|| signal.start_of(scalar)),
        description: signal.description,
    })
}

/// Start values of all inputs, in table order.
pub fn input_starts(interface: &Interface) -> Vec<f64> {
    interface.inputs.iter().flat_map(|s| (0..s.size).map(|i| s.start_of(i))).collect()
}

/// SHA-256 of all that an importer can rely on: version, model, capabilities, variables.
///
/// In hexadecimal it is the instantiation token; its bytes begin each serialised state.
pub fn token(interface: &Interface) -> [u8; 32] {
    let mut text = format!("{} {}\n", interface.model, env!("CARGO_PKG_VERSION"));
    for (flag, value) in capabilities() {
        // Writing to a String can't fail.
        let _ = writeln!(text, "{flag}={value}");
    }
    for v in variables(interface) {
        let (kind, causality) = (v.slot.data_type(), v.slot.causality());
        let (unit, start) = (v.unit.unwrap_or(""), v.start.map_or(0, f64::to_bits));
        let _ = writeln!(text, "{} {} {kind} {causality} {unit} {start:016x}", v.reference, v.name);
    }
    Sha256::digest(text.as_bytes()).into()
}

/// Lower-case hexadecimal, as in `instantiationToken`.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        // Writing to a String can't fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lander_models::signals::{GUIDANCE, TRUTH};

    #[test]
    fn a_reference_finds_the_variable_it_was_given_to() {
        for interface in [&TRUTH, &GUIDANCE] {
            for variable in variables(interface) {
                assert_eq!(Slot::find(interface, variable.reference), Some(variable.slot));
                assert_eq!(variable.slot.reference(), variable.reference);
                assert_eq!(variable.slot.name(interface), variable.name);
            }
            let beyond_inputs = FIRST_INPUT + interface.input_len() as u32;
            let beyond_outputs = FIRST_OUTPUT + interface.output_len() as u32;
            for unknown in [2, FIRST_INPUT - 1, beyond_inputs, beyond_outputs, u32::MAX] {
                assert_eq!(Slot::find(interface, unknown), None, "{unknown}");
            }
        }
    }

    #[test]
    fn inputs_start_finite() {
        for interface in [&TRUTH, &GUIDANCE] {
            assert!(input_starts(interface).iter().all(|start| start.is_finite()));
        }
    }

    #[test]
    fn the_two_models_have_different_tokens() {
        assert_ne!(token(&TRUTH), token(&GUIDANCE));
    }
}
