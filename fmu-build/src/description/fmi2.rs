//! Variables and structure as FMI 2.0 has them.

use fmi_adapter::variables::{Slot, Variable};
use lander_models::signals::Interface;

use super::is_output;
use crate::xml::Xml;

/// Outputs are `initial="calculated"` by default and so have no start value.
pub fn write_variable(xml: &mut Xml, variable: &Variable) {
    let (reference, start) = (variable.reference.to_string(), variable.start_text());
    let text = variable.slot == Slot::Scenario;
    let attributes = [
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("causality", variable.slot.causality()),
        ("variability", if text { "fixed" } else { "continuous" }),
        ("description", variable.description),
    ];
    xml.element("ScalarVariable", &attributes, |xml| {
        if text {
            return xml.leaf("String", &[("start", "")]);
        }
        let mut attributes = Vec::new();
        attributes.extend(variable.unit.map(|unit| ("unit", unit)));
        if !start.is_empty() {
            attributes.push(("start", &start));
        }
        xml.leaf("Real", &attributes);
    });
}

/// Outputs respond to inputs through a step only; at the start they depend on the scenario.
/// References are places in ModelVariables, counted from 1.
pub fn write_structure(xml: &mut Xml, interface: &Interface, variables: &[Variable]) {
    let place = |at: usize| (at + 1).to_string();
    let places = |wanted: fn(&Variable) -> bool| {
        let listed = variables.iter().enumerate().filter(move |(_, v)| wanted(v));
        listed.map(move |(at, _)| place(at))
    };
    xml.element("Outputs", &[], |xml| {
        for output in places(is_output) {
            let mut attributes = vec![("index", output.as_str())];
            // Without the attribute an output depends on every input.
            if !interface.outputs_depend_on_inputs {
                attributes.push(("dependencies", ""));
            }
            xml.leaf("Unknown", &attributes);
        }
    });
    let scenario = places(|v| v.slot == Slot::Scenario).collect::<Vec<_>>().join(" ");
    xml.element("InitialUnknowns", &[], |xml| {
        for output in places(is_output) {
            xml.leaf("Unknown", &[("index", &output), ("dependencies", &scenario)]);
        }
    });
}
