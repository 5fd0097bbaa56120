//! The FMI variables of a component, derived from its signal table.
//!
//! Arrays are expanded to scalars `name[1]` …: every importer reads those, few read the arrays
//! of FMI 3.0. References: 0 time, 1 to 3 parameters, inputs from 1000, outputs from 2000.

use std::fmt::Write;

use lander_models::signals::{Interface, Signal, len};
use lander_models::time::TICK_S;
use sha2::{Digest, Sha256};

pub const TIME_REFERENCE: u32 = 0;
pub const SCENARIO_REFERENCE: u32 = 1;
pub const TERMINATE_REFERENCE: u32 = 2;
pub const CHANGES_REFERENCE: u32 = 3;
pub const FIRST_INPUT: u32 = 1000;
pub const FIRST_OUTPUT: u32 = 2000;

pub const TIME_NAME: &str = "time";
pub const SCENARIO_NAME: &str = "scenario_file";
pub const TERMINATE_NAME: &str = "terminate_at_end";
pub const CHANGES_NAME: &str = "scenario_changes";
/// Start value of `scenario_file`, relative to the resources folder; empty stands for it too.
pub const DEFAULT_SCENARIO: &str = "scenarios/landing.toml";

/// CoSimulation attributes of modelDescription.xml: what is true, and nothing more.
pub fn capabilities(variant: Variant) -> Vec<(&'static str, String)> {
    let yes = || "true".to_owned();
    // Any whole number of ticks.
    let mut flags = vec![("canHandleVariableCommunicationStepSize", yes())];
    if variant == Variant::Fmi2 {
        flags.extend([("canGetAndSetFMUstate", yes()), ("canSerializeFMUstate", yes())]);
        flags.push(("canNotUseMemoryManagementFunctions", yes()));
    } else {
        flags.extend([("canGetAndSetFMUState", yes()), ("canSerializeFMUState", yes())]);
        flags.extend([("hasEventMode", yes()), ("mightReturnEarlyFromDoStep", yes())]);
        flags.push(("fixedInternalStepSize", TICK_S.to_string()));
    }
    flags
}

/// How an archive presents the interface. All three are in one library; the token tells it which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// FMI 2.0; arrays as scalars `name[1]` …
    Fmi2,
    /// FMI 3.0; arrays as scalars
    Fmi3,
    /// FMI 3.0; arrays as arrays, each under the reference of its first scalar
    Fmi3Arrays,
}

impl Variant {
    pub const ALL: [Self; 3] = [Self::Fmi2, Self::Fmi3, Self::Fmi3Arrays];

    /// As in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fmi2 => "fmi2",
            Self::Fmi3 => "fmi3",
            Self::Fmi3Arrays => "fmi3-arrays",
        }
    }

    /// What the FMI version calls a 64-bit floating-point number.
    pub fn real_type(self) -> &'static str {
        if self == Self::Fmi2 { "Real" } else { "Float64" }
    }
}

/// Which variable a reference means; inputs and outputs by flat scalar index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    Time,
    Scenario,
    TerminateAtEnd,
    Changes,
    Input(usize),
    Output(usize),
}

impl Slot {
    /// The scalar that `reference` stands for and 1, or the first of an array and its size.
    pub fn find(interface: &Interface, variant: Variant, reference: u32) -> Option<(Self, usize)> {
        let within = |first: u32, signals: &[Signal], slot: fn(usize) -> Self| {
            let index = (reference - first) as usize;
            let size = match variant {
                Variant::Fmi3Arrays => size_at(signals, index)?,
                _ => 1,
            };
            (index < len(signals)).then(|| (slot(index), size))
        };
        match reference {
            TIME_REFERENCE => Some((Self::Time, 1)),
            SCENARIO_REFERENCE => Some((Self::Scenario, 1)),
            TERMINATE_REFERENCE => Some((Self::TerminateAtEnd, 1)),
            CHANGES_REFERENCE => Some((Self::Changes, 1)),
            FIRST_OUTPUT.. => within(FIRST_OUTPUT, interface.outputs, Self::Output),
            FIRST_INPUT.. => within(FIRST_INPUT, interface.inputs, Self::Input),
            _ => None,
        }
    }

    /// The `count` scalars from this one on.
    pub fn run(self, count: usize) -> impl Iterator<Item = Self> {
        (0..count).map(move |offset| match self {
            Self::Input(first) => Self::Input(first + offset),
            Self::Output(first) => Self::Output(first + offset),
            other => other,
        })
    }

    pub fn reference(self) -> u32 {
        match self {
            Self::Time => TIME_REFERENCE,
            Self::Scenario => SCENARIO_REFERENCE,
            Self::TerminateAtEnd => TERMINATE_REFERENCE,
            Self::Changes => CHANGES_REFERENCE,
            Self::Input(index) => FIRST_INPUT + index as u32,
            Self::Output(index) => FIRST_OUTPUT + index as u32,
        }
    }

    pub fn causality(self) -> &'static str {
        match self {
            Self::Time => "independent",
            Self::Scenario | Self::TerminateAtEnd | Self::Changes => "parameter",
            Self::Input(_) => "input",
            Self::Output(_) => "output",
        }
    }

    /// FMI type name.
    pub fn data_type(self, variant: Variant) -> &'static str {
        match self {
            Self::Scenario | Self::Changes => "String",
            Self::TerminateAtEnd => "Boolean",
            Self::Time | Self::Input(_) | Self::Output(_) => variant.real_type(),
        }
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
            Self::TerminateAtEnd => TERMINATE_NAME.to_owned(),
            Self::Changes => CHANGES_NAME.to_owned(),
            Self::Input(index) => scalar(interface.inputs, index),
            Self::Output(index) => scalar(interface.outputs, index),
        }
    }
}

const UNLIMITED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Size of the signal that begins at `index`.
fn size_at(signals: &[Signal], index: usize) -> Option<usize> {
    let mut first = 0;
    for signal in signals {
        if first == index {
            return Some(signal.size);
        }
        first += signal.size;
    }
    None
}

/// One variable as modelDescription.xml lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub reference: u32,
    pub name: String,
    /// Of the first scalar.
    pub slot: Slot,
    /// Number of values; more than 1 is an array.
    pub size: usize,
    /// Unit in FMI spelling; none for parameters.
    pub unit: Option<&'static str>,
    /// As attributes have it, an array's with spaces between. None for time and outputs, which
    /// are calculated.
    pub start: Option<String>,
    /// Ends that are not limited are infinite.
    pub range: (f64, f64),
    pub description: &'static str,
}

/// All variables, by value reference.
pub fn variables(interface: &Interface, variant: Variant) -> Vec<Variable> {
    let mut all = vec![
        Variable {
            reference: TIME_REFERENCE,
            name: TIME_NAME.to_owned(),
            slot: Slot::Time,
            size: 1,
            unit: Some("s"),
            start: None,
            range: UNLIMITED,
            description: "Simulation time",
        },
        Variable {
            reference: SCENARIO_REFERENCE,
            name: SCENARIO_NAME.to_owned(),
            slot: Slot::Scenario,
            size: 1,
            unit: None,
            start: Some(DEFAULT_SCENARIO.to_owned()),
            range: UNLIMITED,
            description: "Scenario file, absolute or relative to the resources folder",
        },
        Variable {
            reference: TERMINATE_REFERENCE,
            name: TERMINATE_NAME.to_owned(),
            slot: Slot::TerminateAtEnd,
            size: 1,
            unit: None,
            start: Some(false.to_string()),
            range: UNLIMITED,
            description: "Ask the importer to end the simulation when the run is decided; if \
                          false, the outputs stay as they are from then on",
        },
        Variable {
            reference: CHANGES_REFERENCE,
            name: CHANGES_NAME.to_owned(),
            slot: Slot::Changes,
            size: 1,
            unit: None,
            start: Some(String::new()),
            range: UNLIMITED,
            description: "Changes to the scenario, as in: run.stop_time = 60; \
                          initial.velocity_w[1] = -12.5",
        },
    ];
    all.extend(listed(interface.inputs, variant, Slot::Input));
    all.extend(listed(interface.outputs, variant, Slot::Output));
    all
}

/// The variables of `signals`, one for each scalar or, as arrays, one for each signal.
fn listed(signals: &[Signal], variant: Variant, slot: fn(usize) -> Slot) -> Vec<Variable> {
    let (mut all, mut index) = (Vec::new(), 0);
    for signal in signals {
        let whole = variant == Variant::Fmi3Arrays;
        let size = if whole { signal.size } else { 1 };
        for first in (0..signal.size).step_by(size) {
            let slot = slot(index);
            let starts = || {
                let starts = (first..first + size).map(|n| signal.start_of(n).to_string());
                starts.collect::<Vec<_>>().join(" ")
            };
            let range = signal.range();
            all.push(Variable {
                reference: slot.reference(),
                name: if whole { signal.name.to_owned() } else { signal.scalar_name(first) },
                slot,
                size,
                unit: Some(signal.unit),
                start: matches!(slot, Slot::Input(_)).then(starts),
                range: (*range.start(), *range.end()),
                description: signal.description,
            });
            index += size;
        }
    }
    all
}

/// Start values of all inputs, in table order.
pub fn input_starts(interface: &Interface) -> Vec<f64> {
    interface.inputs.iter().flat_map(|s| (0..s.size).map(|i| s.start_of(i))).collect()
}

/// Ranges of all inputs, in table order.
pub fn input_ranges(interface: &Interface) -> Vec<(f64, f64)> {
    let range = |signal: &Signal| (*signal.range().start(), *signal.range().end());
    interface.inputs.iter().flat_map(|s| std::iter::repeat_n(range(s), s.size)).collect()
}

/// SHA-256 of version, model and variables. Its bytes begin each serialised state, which all
/// variants of one library can read.
pub fn interface_hash(interface: &Interface) -> [u8; 32] {
    let mut text = format!("{} {}\n", interface.model, env!("CARGO_PKG_VERSION"));
    for v in variables(interface, Variant::Fmi3) {
        let (kind, causality) = (v.slot.data_type(Variant::Fmi3), v.slot.causality());
        let Variable { reference, name, unit, start, range, description, .. } = &v;
        // Writing to a String can't fail.
        let _ = writeln!(
            text,
            "{reference} {name} {kind} {causality} {unit:?} {start:?} {range:?} {description}"
        );
    }
    Sha256::digest(text.as_bytes()).into()
}

/// `guid` of FMI 2.0, `instantiationToken` of 3.0: SHA-256, in hexadecimal, of all that an
/// importer can rely on.
pub fn token(interface: &Interface, variant: Variant) -> String {
    let mut text = format!("{} {}\n", hex(&interface_hash(interface)), variant.name());
    for (flag, value) in capabilities(variant) {
        // Writing to a String can't fail.
        let _ = writeln!(text, "{flag}={value}");
    }
    hex(&Sha256::digest(text.as_bytes()))
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
    use std::collections::BTreeSet;

    use lander_models::signals::{GUIDANCE, TRUTH};

    use super::*;

    #[test]
    fn a_reference_finds_the_variable_it_was_given_to() {
        for (interface, variant) in all() {
            let mut scalars = 0;
            for variable in variables(interface, variant) {
                let found = Slot::find(interface, variant, variable.reference);
                assert_eq!(found, Some((variable.slot, variable.size)));
                assert_eq!(variable.slot.reference(), variable.reference);
                let name = variable.slot.name(interface);
                assert_eq!(name.split('[').next(), variable.name.split('[').next());
                scalars += variable.size;
            }
            assert_eq!(scalars, 4 + interface.input_len() + interface.output_len());
            let beyond_inputs = FIRST_INPUT + interface.input_len() as u32;
            let beyond_outputs = FIRST_OUTPUT + interface.output_len() as u32;
            for unknown in [4, FIRST_INPUT - 1, beyond_inputs, beyond_outputs, u32::MAX] {
                assert_eq!(Slot::find(interface, variant, unknown), None, "{unknown}");
            }
        }
    }

    #[test]
    fn inside_an_array_there_is_no_reference() {
        // attitude_wb follows six scalars of position and velocity.
        let found = |variant| Slot::find(&TRUTH, variant, FIRST_OUTPUT + 7);
        assert_eq!(found(Variant::Fmi3), Some((Slot::Output(7), 1)));
        assert_eq!(found(Variant::Fmi3Arrays), None);
    }

    #[test]
    fn inputs_start_finite() {
        for interface in [&TRUTH, &GUIDANCE] {
            assert!(input_starts(interface).iter().all(|start| start.is_finite()));
        }
    }

    #[test]
    fn models_and_variants_have_different_tokens() {
        let tokens: BTreeSet<_> =
            all().map(|(interface, variant)| token(interface, variant)).collect();
        assert_eq!(tokens.len(), 6);
    }

    #[test]
    fn the_token_changes_with_anything_of_a_variable() {
        let of = |signal: Signal| {
            let inputs = Box::leak(Box::new([signal]));
            let interface = Interface { inputs, ..TRUTH };
            token(&interface, Variant::Fmi2)
        };
        let signal = TRUTH.inputs[0];
        let changed = [
            signal,
            Signal { name: "other", ..signal },
            Signal { size: 2, ..signal },
            Signal { unit: "kg", ..signal },
            Signal { start: 1.0, ..signal },
            Signal { description: "other", ..signal },
            // A name that brings a range.
            Signal { name: "thrust_n", ..signal },
        ];
        let tokens: BTreeSet<_> = changed.into_iter().map(of).collect();
        assert_eq!(tokens.len(), changed.len());
    }

    fn all() -> impl Iterator<Item = (&'static Interface, Variant)> {
        [&TRUTH, &GUIDANCE].into_iter().flat_map(|i| Variant::ALL.map(|variant| (i, variant)))
    }
}
