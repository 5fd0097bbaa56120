//! modelDescription.xml: what both FMI versions have in common, in the order that both ask for.

mod fmi2;
mod fmi3;

use std::collections::BTreeMap;

use fmi_adapter::logger::Category;
use fmi_adapter::variables::{Slot, Variable, Variant, capabilities};
use fmi_adapter::{token, variables};
use lander_models::Ticks;
use lander_models::signals::Interface;

use crate::model::identifier;
use crate::units::{BASE_NAMES, BaseUnit, Quantity, base_unit, quantity};
use crate::xml::Xml;
use crate::{Error, Stamp};

/// Communication step of the co-simulation schedule (cosim-tests/schedule.toml).
pub const DEFAULT_STEP: Ticks = Ticks(10);

/// `default_stop` is the stop time of the default scenario.
pub fn model_description(
    interface: &Interface,
    variant: Variant,
    default_stop: Ticks,
    stamp: Stamp,
) -> Result<String, Error> {
    let variables = variables(interface, variant);
    let units = units(interface, &variables)?;
    let two = variant == Variant::Fmi2;
    let mut xml = Xml::new();
    let root = [
        ("fmiVersion", if two { "2.0" } else { "3.0" }),
        ("modelName", interface.model),
        (if two { "guid" } else { "instantiationToken" }, &token(interface, variant)),
        ("description", interface.description),
        ("version", env!("CARGO_PKG_VERSION")),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", concat!("fmu-build ", env!("CARGO_PKG_VERSION"))),
        ("generationDateAndTime", &stamp.iso()),
        ("variableNamingConvention", "structured"),
    ];
    xml.element("fmiModelDescription", &root, |xml| {
        let identifier = identifier(interface);
        let flags = capabilities(variant);
        let mut attributes = vec![("modelIdentifier", identifier.as_str())];
        attributes.extend(flags.iter().map(|(flag, value)| (*flag, value.as_str())));
        xml.leaf("CoSimulation", &attributes);
        xml.element("UnitDefinitions", &[], |xml| {
            for (name, (base, quantity)) in &units {
                xml.element("Unit", &[("name", name)], |xml| {
                    write_base(xml, "BaseUnit", base);
                    if let Some((display, factor)) = quantity.display {
                        let factor = factor.to_string();
                        xml.leaf("DisplayUnit", &[("name", display), ("factor", &factor)]);
                    }
                });
            }
        });
        xml.element("TypeDefinitions", &[], |xml| {
            for (unit, (_, quantity)) in &units {
                let name = ("name", quantity.name);
                let mut real = vec![("quantity", quantity.name), ("unit", *unit)];
                real.extend(quantity.display.map(|(display, _)| ("displayUnit", display)));
                if two {
                    xml.element("SimpleType", &[name], |xml| xml.leaf("Real", &real));
                } else {
                    xml.leaf("Float64Type", &[&[name], &real[..]].concat());
                }
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
            let write = if two { fmi2::write_variable } else { fmi3::write_variable };
            variables.iter().for_each(|variable| write(xml, variable));
        });
        xml.element("ModelStructure", &[], |xml| {
            let write = if two { fmi2::write_structure } else { fmi3::write_structure };
            write(xml, interface, &variables);
        });
    });
    Ok(xml.finish())
}

/// By name; each has one type.
fn units(
    interface: &Interface,
    variables: &[Variable],
) -> Result<BTreeMap<&'static str, (BaseUnit, Quantity)>, Error> {
    let known = |name: &'static str, unit: &'static str| {
        let both = base_unit(unit).zip(quantity(unit));
        both.map(|both| (unit, both)).ok_or(Error::Unit { signal: name, unit })
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

/// `element` is its name with the prefix that the document has.
pub fn write_base(xml: &mut Xml, element: &'static str, base: &BaseUnit) {
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
    xml.leaf(element, &attributes);
}

/// Attributes of a real variable, but for those of its version. Outputs are
/// `initial="calculated"` by default and so have no start value. The unit is that of the declared
/// type; FMI 2.0 repeats it, FMI 3.0 does not, because fmi-sim refuses it there.
fn real_attributes(variable: &Variable) -> Vec<(&'static str, String)> {
    let mut attributes = Vec::new();
    let quantity = variable.unit.and_then(quantity);
    attributes.extend(quantity.map(|quantity| ("declaredType", quantity.name.to_owned())));
    let (least, greatest) = variable.range;
    let ends = [("min", least), ("max", greatest)].into_iter().filter(|(_, end)| end.is_finite());
    attributes.extend(ends.map(|(key, end)| (key, end.to_string())));
    attributes.extend(variable.start.clone().map(|start| ("start", start)));
    attributes
}

fn borrowed<'a>(attributes: &'a [(&'static str, String)]) -> Vec<(&'static str, &'a str)> {
    attributes.iter().map(|(key, value)| (*key, value.as_str())).collect()
}

/// Those of which ModelStructure speaks.
fn is_output(variable: &Variable) -> bool {
    matches!(variable.slot, Slot::Output(_))
}
