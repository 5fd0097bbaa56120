//! Looks into a finished FMU, with another XML reader than the writer's.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

use fmi_adapter::variables::{DEFAULT_SCENARIO, Slot, hex};
use fmi_adapter::{token, variables};
use lander_models::signals::Interface;
use roxmltree::{Document, Node};
use zip::ZipArchive;

use crate::Error;
use crate::model::{MODELS, identifier, library_entry};

/// The problems found in `file`; an error if it is no readable zip archive at all.
pub fn check(file: &Path) -> Result<Vec<String>, Error> {
    let entries = unpack(file)?;
    let mut problems = Vec::new();
    for path in entries.keys() {
        if path.contains('\\') || path.starts_with('/') || path.split('/').any(|part| part == "..")
        {
            problems.push(format!("entry {path}: not a plain relative path"));
        }
    }
    let text = entries.get("modelDescription.xml").map(|bytes| String::from_utf8_lossy(bytes));
    let Some(text) = text else {
        problems.push("modelDescription.xml is missing".to_owned());
        return Ok(problems);
    };
    let document = match Document::parse(&text) {
        Ok(document) => document,
        Err(error) => {
            problems.push(format!("modelDescription.xml: {error}"));
            return Ok(problems);
        }
    };
    let root = document.root_element();
    let name = root.attribute("modelName").unwrap_or_default();
    let Some(model) = MODELS.into_iter().find(|model| model.model == name) else {
        problems.push(format!("modelName \"{name}\" is none of this kit's models"));
        return Ok(problems);
    };
    problems.extend(entry_problems(model, &entries));
    problems.extend(header_problems(model, root));
    problems.extend(variable_problems(model, root));
    problems.extend(structure_problems(model, root));
    Ok(problems)
}

fn unpack(file: &Path) -> Result<BTreeMap<String, Vec<u8>>, Error> {
    let failed = |source| Error::Archive { file: file.display().to_string(), source };
    let mut zip = ZipArchive::new(File::open(file).map_err(Error::read(file))?).map_err(failed)?;
    let mut entries = BTreeMap::new();
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).map_err(failed)?;
        let name = entry.name().map_err(failed)?.into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).map_err(Error::read(file))?;
        entries.insert(name, content);
    }
    Ok(entries)
}

fn entry_problems(model: &Interface, entries: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let mut problems = Vec::new();
    let scenario = format!("resources/{DEFAULT_SCENARIO}");
    for path in [scenario.as_str(), "documentation/index.html"] {
        if !entries.contains_key(path) {
            problems.push(format!("{path} is missing"));
        }
    }
    let path = library_entry(model);
    match entries.get(&path) {
        None => problems.push(format!("{path} is missing")),
        Some(library) if !library.starts_with(b"\x7fELF") => {
            problems.push(format!("{path} is not an ELF library"));
        }
        Some(library) if !library.windows(10).any(|bytes| bytes == b"fmi3DoStep") => {
            problems.push(format!("{path} does not export fmi3DoStep"));
        }
        Some(_) => {}
    }
    problems
}

fn header_problems(model: &Interface, root: Node) -> Vec<String> {
    let interface = child(root, "CoSimulation");
    let expected = [
        (Some(root), "fmiVersion", "3.0".to_owned()),
        (Some(root), "instantiationToken", hex(&token(model))),
        (interface, "modelIdentifier", identifier(model)),
    ];
    let differs = |(node, key, value): (Option<Node>, &str, String)| {
        let found = node.and_then(|node| node.attribute(key));
        (found != Some(&value)).then(|| format!("{key} is {found:?}, expected \"{value}\""))
    };
    expected.into_iter().filter_map(differs).collect()
}

/// Type, reference, causality, unit and start by name, as the XML spells them.
type Row = [String; 5];

fn variable_problems(model: &Interface, root: Node) -> Vec<String> {
    let expected: BTreeMap<String, Row> = variables(model)
        .into_iter()
        .map(|v| {
            let start = v.start.map(|start| start.to_string()).unwrap_or_default();
            let (kind, causality) = (v.slot.data_type(), v.slot.causality());
            let unit = v.unit.unwrap_or_default();
            let row = [kind, &v.reference.to_string(), causality, unit, &start].map(str::to_owned);
            (v.name, row)
        })
        .collect();
    let mut found = BTreeMap::<String, Row>::new();
    let mut problems = Vec::new();
    let listed = child(root, "ModelVariables").into_iter().flat_map(|n| n.children());
    for node in listed.filter(Node::is_element) {
        let attribute = |key| node.attribute(key).unwrap_or_default().to_owned();
        let [reference, causality, unit, start] =
            ["valueReference", "causality", "unit", "start"].map(attribute);
        let kind = node.tag_name().name().to_owned();
        let row = [kind, reference, causality, unit, start];
        let name = attribute("name");
        if found.insert(name.clone(), row).is_some() {
            problems.push(format!("variable {name} is listed twice"));
        }
    }
    let names: BTreeSet<&String> = expected.keys().chain(found.keys()).collect();
    for name in names {
        match (expected.get(name), found.get(name)) {
            (Some(_), None) => problems.push(format!("variable {name} is missing")),
            (None, Some(_)) => problems.push(format!("variable {name} is not in the table")),
            (Some(table), Some(xml)) if table != xml => {
                problems.push(format!("variable {name} is {xml:?}, the table has {table:?}"));
            }
            _ => {}
        }
    }
    problems
}

fn structure_problems(model: &Interface, root: Node) -> Vec<String> {
    let outputs = variables(model).into_iter().filter(|v| matches!(v.slot, Slot::Output(_)));
    let expected: Vec<String> = outputs.map(|v| v.reference.to_string()).collect();
    let structure = child(root, "ModelStructure");
    let differs = |element: &str| {
        let nodes = structure.into_iter().flat_map(|node| node.children());
        let found: Vec<_> = nodes
            .filter(|node| node.has_tag_name(element))
            .map(|node| node.attribute("valueReference").unwrap_or_default())
            .collect();
        (found != expected).then(|| format!("ModelStructure/{element} does not list all outputs"))
    };
    ["Output", "InitialUnknown"].into_iter().filter_map(differs).collect()
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}
