//! Variables and structure as FMI 3.0 has them.

use fmi_adapter::variables::{CHANGES_REFERENCE, SCENARIO_REFERENCE, Variable, Variant};
use lander_models::signals::Interface;

use super::{borrowed, is_output, real_attributes};
use crate::xml::Xml;

pub fn write_variable(xml: &mut Xml, variable: &Variable) {
    let reference = variable.reference.to_string();
    let kind = variable.slot.data_type(Variant::Fmi3);
    let mut attributes = vec![
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("causality", variable.slot.causality()),
        ("description", variable.description),
    ];
    let own = real_attributes(variable);
    if kind == "Float64" {
        attributes.extend(borrowed(&own));
    } else {
        attributes.push(("variability", "fixed"));
    }
    let size = variable.size.to_string();
    match (kind, &variable.start) {
        // A string's start is an element.
        ("String", Some(start)) => {
            xml.element(kind, &attributes, |xml| xml.leaf("Start", &[("value", start)]));
        }
        ("Boolean", Some(start)) => {
            attributes.push(("start", start));
            xml.leaf(kind, &attributes);
        }
        _ if variable.size == 1 => xml.leaf(kind, &attributes),
        _ => xml.element(kind, &attributes, |xml| xml.leaf("Dimension", &[("start", &size)])),
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
    let scenario = format!("{SCENARIO_REFERENCE} {CHANGES_REFERENCE}");
    for output in outputs() {
        let reference = output.reference.to_string();
        xml.leaf("InitialUnknown", &[("valueReference", &reference), ("dependencies", &scenario)]);
    }
}
