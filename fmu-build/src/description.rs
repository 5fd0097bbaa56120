//! modelDescription.xml for FMI 3.0 Co-Simulation.

use std::collections::BTreeMap;

use fmi_adapter::logger::Category;
use fmi_adapter::variables::{SCENARIO_REFERENCE, Slot, Variable, capabilities, hex};
use fmi_adapter::{token, variables};
use lander_models::Ticks;
use lander_models::signals::Interface;

use crate::model::identifier;
use crate::units::{BASE_NAMES, BaseUnit, base_unit};
use crate::xml::Xml;
use crate::{Error, Stamp};

/// Communication step of the co-simulation schedule (cosim-tests/schedule.toml).
const DEFAULT_STEP: Ticks = Ticks(10);

/// `default_stop` is the stop time of the default scenario.
pub fn model_description(
    interface: &Interface,
    default_stop: Ticks,
    stamp: Stamp,
) -> Result<String, Error> {
    let variables = variables(interface);
    let units = units(interface, &variables)?;
    let mut xml = Xml::new();
    let root = [
        ("fmiVersion", "3.0"),
        ("modelName", interface.model),
        ("instantiationToken", &hex(&token(interface))),
        ("description", interface.description),
        ("version", env!("CARGO_PKG_VERSION")),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", concat!("fmu-build ", env!("CARGO_PKG_VERSION"))),
        ("generationDateAndTime", &stamp.iso()),
        ("variableNamingConvention", "structured"),
    ];
    xml.element("fmiModelDescription", &root, |xml| {
        let identifier = identifier(interface);
        let flags = capabilities();
        let mut attributes = vec![("modelIdentifier", identifier.as_str())];
        attributes.extend(flags.iter().map(|(flag, value)| (*flag, value.as_str())));
        xml.leaf("CoSimulation", &attributes);
        xml.element("UnitDefinitions", &[], |xml| {
            for (name, base) in &units {
                xml.element("Unit", &[("name", name)], |xml| write_base(xml, base));
            }
        });
        xml.element("LogCategories", &[], |xml| {
            for category in Category::ALL {
                let attributes =
                    [("name", category.name()), ("description", category.description())];
                xml.leaf("Category", &attributes);
            }
        });
        let (stop, step) = (default_stop.seconds().to_string(), DEFAULT_STEP.seconds().to_string());
        let experiment = [("startTime", "0"), ("stopTime", &stop), ("stepSize", &step)];
        xml.leaf("DefaultExperiment", &experiment);
        xml.element("ModelVariables", &[], |xml| {
            variables.iter().for_each(|variable| write_variable(xml, variable));
        });
        xml.element("ModelStructure", &[], |xml| write_structure(xml, interface, &variables));
    });
    Ok(xml.finish())
}

fn units(
    interface: &Interface,
    variables: &[Variable],
) -> Result<BTreeMap<&'static str, BaseUnit>, Error> {
    let known = |name: &'static str, unit: &'static str| {
        base_unit(unit).map(|base| (unit, base)).ok_or(Error::Unit { signal: name, unit })
    };
    let signals = interface.inputs.iter().chain(interface.outputs);
    let mut units: BTreeMap<_, _> =
        signals.map(|signal| known(signal.name, signal.unit)).collect::<Result<_, _>>()?;
    let time = variables.iter().filter(|v| v.slot == Slot::Time).filter_map(|v| v.unit);
    for unit in time {
        units.extend([known("time", unit)?]);
    }
    Ok(units)
}

fn write_base(xml: &mut Xml, base: &BaseUnit) {
    let exponents = base.exponents.map(|exponent| exponent.to_string());
    let factor = base.factor.to_string();
    let mut attributes: Vec<_> = BASE_NAMES
        .into_iter()
        .zip(exponents.iter().map(String::as_str))
        .filter(|(_, exponent)| *exponent != "0")
        .collect();
    if base.factor != 1.0 {
        attributes.push(("factor", &factor));
    }
    xml.leaf("BaseUnit", &attributes);
}

/// Outputs are `initial="calculated"` by default and so have no start value.
fn write_variable(xml: &mut Xml, variable: &Variable) {
    let reference = variable.reference.to_string();
    let start = variable.start.map(|start| start.to_string());
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
    attributes.extend(start.as_deref().map(|start| ("start", start)));
    xml.leaf("Float64", &attributes);
}

/// Outputs respond to inputs through a step only; at the start they depend on the scenario.
fn write_structure(xml: &mut Xml, interface: &Interface, variables: &[Variable]) {
    let outputs = || variables.iter().filter(|v| matches!(v.slot, Slot::Output(_)));
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
