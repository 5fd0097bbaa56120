//! Variables and structure as FMI 3.0 has them.

use fmi_adapter::variables::{SCENARIO_REFERENCE, Slot, Variable};
use lander_models::signals::Interface;

use super::is_output;
use crate::xml::Xml;

/// Outputs are `initial="calculated"` by default and so have no start value.
pub fn write_variable(xml: &mut Xml, variable: &Variable) {
    let (reference, start) = (variable.reference.to_string(), variable.start_text());
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("causality", variable.slot.causality()),
        ("description", variable.description),
    ];
    if variable.slot == Slot::Scenario {
        attributes.push(("variability", "fixed"));
        xml.element("String", &attributes, |xml| xml.leaf("Start", &[("value", "")]));
        return;
    }
    attributes.extend(variable.unit.map(|unit| ("unit", unit)));
    if !start.is_empty() {
        attributes.push(("start", &start));
    }
    if variable.size == 1 {
        xml.leaf("Float64", &attributes);
    } else {
        let size = variable.size.to_string();
        xml.element("Float64", &attributes, |xml| xml.leaf("Dimension", &[("start", &size)]));
    }
}

/// Outputs respond to inputs through a step only; at the start they depend on the scenario.
pub fn write_structure(xml: &mut Xml, interface: &Interface, variables: &[Variable]) {
    let outputs = || variables.iter().filter(|v| is_output(v));
    for output in outputs() {
        let reference = output.reference.to_string();
        let mut attributes = vec![("valueReference", reference.as_str())];
        // Without the attribute an output depends on every input.
        if !interface.outputs_depend_on_inputs {
            attributes.push(("dependencies", ""));
        }
        xml.leaf("Output", &attributes);
    }
    let scenario = SCENARIO_REFERENCE.to_string();
    for output in outputs() {
        let reference = output.reference.to_string();
        xml.leaf("InitialUnknown", &[("valueReference", &reference), ("dependencies", &scenario)]);
    }
}
