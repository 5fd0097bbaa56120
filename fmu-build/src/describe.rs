//! The interfaces as text or JSON.

use fmi_adapter::variables::Variant;
use fmi_adapter::{token, variables};
use lander_models::signals::Interface;
use serde_json::{Map, Value, json};

use crate::model::identifier;

/// Scalars, under the type names of FMI 3.0.
const LISTED: Variant = Variant::Fmi3;

/// One line for each scalar of each model.
pub fn table(models: &[&Interface]) -> String {
    let mut text = String::new();
    for interface in models {
        text += &format!("{}: {}\n", interface.model, interface.description);
        for variant in Variant::ALL {
            text += &format!("token {} {}\n", variant.name(), token(interface, variant));
        }
        for v in variables(interface, LISTED) {
            let (causality, unit) = (v.slot.causality(), v.unit.unwrap_or("-"));
            let (reference, name, about) = (v.reference, &v.name, v.description);
            text += &format!("{reference:>5} {name:<26} {causality:<11} {unit:<6} {about}\n");
        }
        text.push('\n');
    }
    text
}

pub fn json(models: &[&Interface]) -> Value {
    models.iter().map(|interface| model_json(interface)).collect()
}

fn model_json(interface: &Interface) -> Value {
    let variables: Vec<Value> = variables(interface, LISTED)
        .iter()
        .map(|v| {
            json!({
                "reference": v.reference,
                "name": v.name,
                "type": v.slot.data_type(LISTED),
                "causality": v.slot.causality(),
                "unit": v.unit,
                "start": v.start,
                "min": v.range.0,
                "max": v.range.1,
                "description": v.description,
            })
        })
        .collect();
    let tokens: Map<_, _> = Variant::ALL
        .into_iter()
        .map(|variant| (variant.name().to_owned(), json!(token(interface, variant))))
        .collect();
    json!({
        "model": interface.model,
        "identifier": identifier(interface),
        "description": interface.description,
        "tokens": tokens,
        "variables": variables,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::MODELS;

    #[test]
    fn text_and_json_name_every_variable() {
        let (text, json) = (table(&MODELS), json(&MODELS));
        for (model, described) in MODELS.into_iter().zip(json.as_array().unwrap()) {
            for (variable, row) in
                variables(model, LISTED).iter().zip(described["variables"].as_array().unwrap())
            {
                assert_eq!(row["name"], variable.name);
                assert!(text.contains(&format!("{:>5} {} ", variable.reference, variable.name)));
            }
        }
    }
}
