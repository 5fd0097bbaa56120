//! modelDescription.xml against the signal tables, with another XML reader than the writer's.

use std::collections::{BTreeMap, BTreeSet};

use fmi_adapter::variables::Slot;
use fmi_adapter::{Variant, token, variables};
use lander_models::signals::Interface;
use roxmltree::{Document, Node};

use crate::model::{MODELS, identifier};

/// What the description is of.
pub type Subject = (&'static Interface, Variant);

/// The model and variant that `text` describes, and the problems found in it; an error if it is a
/// description of none of this kit's models.
pub fn read(text: &str) -> Result<(Subject, Vec<String>), String> {
    let document =
        Document::parse(text).map_err(|error| format!("modelDescription.xml: {error}"))?;
    let root = document.root_element();
    let name = root.attribute("modelName").unwrap_or_default();
    let model = MODELS.into_iter().find(|model| model.model == name);
    let model =
        model.ok_or_else(|| format!("modelName \"{name}\" is none of this kit's models"))?;
    let variant = variant_of(root);
    let problems = [header_problems, variable_problems, structure_problems];
    let problems = problems.into_iter().flat_map(|find| find(model, variant, root)).collect();
    Ok(((model, variant), problems))
}

fn variant_of(root: Node) -> Variant {
    if root.attribute("fmiVersion") == Some("2.0") {
        Variant::Fmi2
    } else if root.descendants().any(|node| node.has_tag_name("Dimension")) {
        Variant::Fmi3Arrays
    } else {
        Variant::Fmi3
    }
}

fn header_problems(model: &Interface, variant: Variant, root: Node) -> Vec<String> {
    let interface = child(root, "CoSimulation");
    let (version, key) = match variant {
        Variant::Fmi2 => ("2.0", "guid"),
        Variant::Fmi3 | Variant::Fmi3Arrays => ("3.0", "instantiationToken"),
    };
    let expected = [
        (Some(root), "fmiVersion", version.to_owned()),
        (Some(root), key, token(model, variant)),
        (interface, "modelIdentifier", identifier(model)),
    ];
    let differs = |(node, key, value): (Option<Node>, &str, String)| {
        let found = node.and_then(|node| node.attribute(key));
        (found != Some(&value)).then(|| format!("{key} is {found:?}, expected \"{value}\""))
    };
    expected.into_iter().filter_map(differs).collect()
}

/// Type, reference, causality, unit, start, range and size by name, as the XML spells them.
type Row = [String; 8];

fn variable_problems(model: &Interface, variant: Variant, root: Node) -> Vec<String> {
    let expected: BTreeMap<String, Row> = variables(model, variant)
        .into_iter()
        .map(|v| {
            let (kind, causality) = (v.slot.data_type(variant), v.slot.causality());
            let (unit, start) = (v.unit.unwrap_or_default(), v.start.unwrap_or_default());
            let (reference, size) = (v.reference.to_string(), v.size.to_string());
            let end = |end: f64| if end.is_finite() { end.to_string() } else { String::new() };
            let (least, greatest) = (end(v.range.0), end(v.range.1));
            let row = [kind, &reference, causality, unit, &start, &least, &greatest, &size];
            let row = row.map(str::to_owned);
            (v.name, row)
        })
        .collect();
    let types: BTreeMap<&str, &str> = child(root, "TypeDefinitions")
        .into_iter()
        .flat_map(|types| types.children())
        .filter_map(|one| one.attribute("name").zip(one.attribute("unit")))
        .collect();
    let mut found = BTreeMap::<String, Row>::new();
    let mut problems = Vec::new();
    let listed = child(root, "ModelVariables").into_iter().flat_map(|n| n.children());
    for node in listed.filter(Node::is_element) {
        // FMI 2.0 has the type in an element of its own.
        let typed = match variant {
            Variant::Fmi2 => node.first_element_child().unwrap_or(node),
            Variant::Fmi3 | Variant::Fmi3Arrays => node,
        };
        let attribute = |node: Node, key| node.attribute(key).unwrap_or_default().to_owned();
        // In FMI 3.0 the type says it.
        let declared = node.attribute("declaredType").and_then(|name| types.get(name));
        let unit = typed.attribute("unit").or(declared.copied()).unwrap_or_default();
        // A string of FMI 3.0 has its start in an element.
        let start =
            child(node, "Start").map_or(attribute(typed, "start"), |s| attribute(s, "value"));
        let size = child(node, "Dimension").map_or("1".to_owned(), |d| attribute(d, "start"));
        let row = [
            typed.tag_name().name().to_owned(),
            attribute(node, "valueReference"),
            attribute(node, "causality"),
            unit.to_owned(),
            start,
            attribute(typed, "min"),
            attribute(typed, "max"),
            size,
        ];
        let name = attribute(node, "name");
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

fn structure_problems(model: &Interface, variant: Variant, root: Node) -> Vec<String> {
    let listed = variables(model, variant);
    let outputs = listed.iter().enumerate().filter(|(_, v)| matches!(v.slot, Slot::Output(_)));
    let expected: Vec<String> = outputs
        .map(|(at, v)| match variant {
            Variant::Fmi2 => (at + 1).to_string(),
            Variant::Fmi3 | Variant::Fmi3Arrays => v.reference.to_string(),
        })
        .collect();
    let structure = child(root, "ModelStructure");
    let unknowns = |element: &str| -> Vec<&str> {
        let nodes = structure.into_iter();
        if variant == Variant::Fmi2 {
            let nodes = nodes.filter_map(|node| child(node, &format!("{element}s")));
            let nodes = nodes.flat_map(|node| node.children());
            return nodes.filter_map(|node| node.attribute("index")).collect();
        }
        let nodes = nodes.flat_map(|node| node.children());
        let nodes = nodes.filter(|node| node.has_tag_name(element));
        nodes.filter_map(|node| node.attribute("valueReference")).collect()
    };
    let differs = |element: &&str| unknowns(element) != expected;
    let lists = ["Output", "InitialUnknown"].into_iter().filter(differs);
    lists.map(|list| format!("ModelStructure/{list} does not list all outputs")).collect()
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}
