//! Variables and structure as FMI 2.0 has them.

use fmi_adapter::variables::{Slot, Variable, Variant};
use lander_models::signals::Interface;

use super::{borrowed, is_output, real_attributes};
use crate::xml::Xml;

pub fn write_variable(xml: &mut Xml, variable: &Variable) {
    let reference = variable.reference.to_string();
    let kind = variable.slot.data_type(Variant::Fmi2);
    let real = kind == "Real";
    let attributes = [
        ("name", variable.name.as_str()),
        ("valueReference", &reference),
        ("causality", variable.slot.causality()),
        ("variability", if real { "continuous" } else { "fixed" }),
        ("description", variable.description),
    ];
    xml.element("ScalarVariable", &attributes, |xml| {
        let mut own = real_attributes(variable);
        own.extend(variable.unit.map(|unit| ("unit", unit.to_owned())));
        xml.leaf(kind, &borrowed(&own));
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
    let scenario =
        places(|v| matches!(v.slot, Slot::Scenario | Slot::Changes)).collect::<Vec<_>>().join(" ");
    xml.element("InitialUnknowns", &[], |xml| {
        for output in places(is_output) {
            xml.leaf("Unknown", &[("index", &output), ("dependencies", &scenario)]);
        }
    });
}
