//! terminalsAndIcons/terminalsAndIcons.xml of FMI 3.0: the bus that joins the two models.

use fmi_adapter::variables::{Variant, variables};
use lander_models::signals::{Interface, Signal};

use crate::model::MODELS;
use crate::xml::Xml;

pub const ENTRY: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Equal in both models, so that an importer connects them by name (`matchingRule="bus"`).
pub const TERMINAL: &str = "flight_control";

pub fn terminals(interface: &Interface, variant: Variant) -> String {
    let mut xml = Xml::new();
    xml.element("fmiTerminalsAndIcons", &[("fmiVersion", "3.0")], |xml| {
        xml.element("Terminals", &[], |xml| {
            let attributes = [
                ("name", TERMINAL),
                ("matchingRule", "bus"),
                ("terminalKind", "lander.flight_control"),
                ("description", "Between vehicle and flight computer: sensors and commands"),
            ];
            xml.element("Terminal", &attributes, |xml| write_members(xml, interface, variant));
        });
    });
    xml.finish()
}

fn write_members(xml: &mut Xml, interface: &Interface, variant: Variant) {
    for variable in variables(interface, variant) {
        let signal = variable.name.split('[').next().unwrap_or_default();
        if is_wire(signal) {
            let attributes = [
                ("variableKind", "signal"),
                ("variableName", &variable.name),
                ("memberName", &variable.name),
            ];
            xml.leaf("TerminalMemberVariable", &attributes);
        }
    }
}

/// Whether one model's output feeds the other's input of this name.
pub fn is_wire(name: &str) -> bool {
    let has = |signals: &[Signal]| signals.iter().any(|signal| signal.name == name);
    MODELS.iter().any(|model| has(model.inputs)) && MODELS.iter().any(|model| has(model.outputs))
}
