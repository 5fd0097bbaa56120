//! `lander.ssp` and `lander-fmi3.ssp`: both FMUs, their wires and a parameter set for each
//! scenario (System Structure and Parameterization 1.0).

use std::path::{Path, PathBuf};

use fmi_adapter::variables::{SCENARIO_NAME, Variant};
use lander_models::signals::{GUIDANCE, Interface, Signal, TRUTH};

use crate::archive::{Entries, pack};
use crate::description::{DEFAULT_STEP, write_base};
use crate::model::{MODELS, archive_file};
use crate::package::{default_stop, files, read, write_all};
use crate::terminals::is_wire;
use crate::units::base_unit;
use crate::xml::Xml;
use crate::{Error, Stamp};

const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";
const DESCRIPTION: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
const OPEN_MODELICA: &str =
    "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";

/// Elements in the order in which a sequential master steps them: truth flies a step with the
/// command computed from its start (cosim-tests/schedule.toml).
const ELEMENTS: [(&str, &Interface); 2] = [("guidance", &GUIDANCE), ("truth", &TRUTH)];

/// Outputs shown besides the wires. No connector of the system stands for them: ecos can't have one.
const RESULTS: [&str; 1] = ["outcome"];

/// Writes both archives around the FMUs in `fmus` and returns their paths.
pub fn build(fmus: &Path, root: &Path, stamp: Stamp, out: &Path) -> Result<Vec<PathBuf>, Error> {
    let made = [("lander.ssp", Variant::Fmi2), ("lander-fmi3.ssp", Variant::Fmi3)]
        .into_iter()
        .map(|(name, variant)| Ok((out.join(name), archive(fmus, root, variant, stamp)?)))
        .collect::<Result<Vec<_>, Error>>()?;
    write_all(out, made)
}

fn archive(fmus: &Path, root: &Path, variant: Variant, stamp: Stamp) -> Result<Vec<u8>, Error> {
    let models = root.join("models");
    let mut entries = Entries::new();
    for model in MODELS {
        let name = archive_file(model, variant);
        entries.insert(format!("resources/{name}"), read(&fmus.join(name))?);
    }
    for file in files(&models.join("scenarios"), "toml")? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        entries.insert(format!("resources/{name}.ssv"), parameter_set(&name, stamp).into_bytes());
    }
    let description = description(variant, default_stop(&models)?.seconds(), stamp)?;
    entries.insert("SystemStructure.ssd".to_owned(), description.into_bytes());
    pack(&entries, stamp)
}

/// Bound to each component on its own, which is where ecos and libcosim look for it.
fn parameter_set(scenario: &str, stamp: Stamp) -> String {
    let mut xml = Xml::new();
    let (tool, time) = (generation_tool(), stamp.iso());
    let attributes = [
        ("xmlns:ssv", VALUES),
        ("xmlns:ssc", COMMON),
        ("version", "1.0"),
        ("name", scenario),
        ("generationTool", &tool),
        ("generationDateAndTime", &time),
    ];
    xml.element("ssv:ParameterSet", &attributes, |xml| {
        xml.element("ssv:Parameters", &[], |xml| {
            xml.element("ssv:Parameter", &[("name", SCENARIO_NAME)], |xml| {
                xml.leaf("ssv:String", &[("value", &format!("scenarios/{scenario}.toml"))]);
            });
        });
    });
    xml.finish()
}

fn description(variant: Variant, stop_s: f64, stamp: Stamp) -> Result<String, Error> {
    let mut xml = Xml::new();
    let (tool, time) = (generation_tool(), stamp.iso());
    let root = [
        ("xmlns:ssd", DESCRIPTION),
        ("xmlns:ssc", COMMON),
        ("version", "1.0"),
        ("name", "lander"),
        ("description", "A lander and its guidance, from the descent to the verdict"),
        ("license", env!("CARGO_PKG_LICENSE")),
        ("generationTool", &tool),
        ("generationDateAndTime", &time),
    ];
    let units = units()?;
    xml.element("ssd:SystemStructureDescription", &root, |xml| {
        xml.element("ssd:System", &[("name", "lander")], |xml| {
            xml.element("ssd:Elements", &[], |xml| {
                ELEMENTS.iter().for_each(|element| write_component(xml, element, variant));
            });
            xml.element("ssd:Connections", &[], write_connections);
            xml.element("ssd:Annotations", &[], write_open_modelica);
        });
        xml.element("ssd:Units", &[], |xml| {
            for (name, base) in &units {
                xml.element("ssc:Unit", &[("name", name)], |xml| {
                    write_base(xml, "ssc:BaseUnit", base);
                });
            }
        });
        let stop = stop_s.to_string();
        xml.leaf("ssd:DefaultExperiment", &[("startTime", "0"), ("stopTime", &stop)]);
    });
    Ok(xml.finish())
}

/// Only inputs that are connected: some importers invent a source for the others.
fn write_component(xml: &mut Xml, (element, model): &(&str, &Interface), variant: Variant) {
    let source = format!("resources/{}", archive_file(model, variant));
    let kind = "application/x-fmu-sharedlibrary";
    let attributes = [("name", *element), ("type", kind), ("source", &source)];
    xml.element("ssd:Component", &attributes, |xml| {
        xml.element("ssd:Connectors", &[], |xml| {
            signals(model.inputs, is_wire)
                .for_each(|(name, unit)| write_connector(xml, &name, unit, "input"));
            signals(model.outputs, |name| is_wire(name) || is_result(name))
                .for_each(|(name, unit)| write_connector(xml, &name, unit, "output"));
        });
        xml.element("ssd:ParameterBindings", &[], |xml| {
            xml.leaf("ssd:ParameterBinding", &[("source", "resources/landing.ssv")]);
        });
    });
}

fn write_connector(xml: &mut Xml, name: &str, unit: &str, kind: &str) {
    xml.element("ssd:Connector", &[("name", name), ("kind", kind)], |xml| {
        xml.leaf("ssc:Real", &[("unit", unit)]);
    });
}

fn write_connections(xml: &mut Xml) {
    let [(guidance, _), (truth, _)] = ELEMENTS;
    for (from, to, fed) in [(truth, guidance, &GUIDANCE), (guidance, truth, &TRUTH)] {
        for (name, _) in signals(fed.inputs, is_wire) {
            let ends = [
                ("startElement", from),
                ("startConnector", &name),
                ("endElement", to),
                ("endConnector", &name),
            ];
            xml.leaf("ssd:Connection", &ends);
        }
    }
}

/// OMSimulator does not load a system that names no master.
fn write_open_modelica(xml: &mut Xml) {
    xml.element("ssc:Annotation", &[("type", "org.openmodelica")], |xml| {
        xml.element("oms:Annotations", &[("xmlns:oms", OPEN_MODELICA)], |xml| {
            xml.element("oms:SimulationInformation", &[], |xml| {
                let step = DEFAULT_STEP.seconds().to_string();
                let master = [("description", "oms-ma"), ("stepSize", step.as_str())];
                xml.leaf("oms:FixedStepMaster", &master);
            });
        });
    });
}

/// Scalars of the signals wanted, with their units.
fn signals<'a>(
    signals: &'a [Signal],
    wanted: impl Fn(&str) -> bool + 'a,
) -> impl Iterator<Item = (String, &'static str)> + 'a {
    let signals = signals.iter().filter(move |signal| wanted(signal.name));
    signals.flat_map(|signal| (0..signal.size).map(|n| (signal.scalar_name(n), signal.unit)))
}

fn is_result(name: &str) -> bool {
    RESULTS.contains(&name)
}

fn units() -> Result<std::collections::BTreeMap<&'static str, crate::units::BaseUnit>, Error> {
    let used = MODELS.iter().flat_map(|model| model.inputs.iter().chain(model.outputs));
    used.filter(|signal| is_wire(signal.name) || is_result(signal.name))
        .map(|Signal { name, unit, .. }| {
            let base = base_unit(unit).ok_or(Error::Unit { signal: name, unit })?;
            Ok((*unit, base))
        })
        .collect()
}

fn generation_tool() -> String {
    format!("fmu-build {}", env!("CARGO_PKG_VERSION"))
}
