//! What a study may not set, because it would change nothing and its table would say otherwise.

use lander_models::quantity::{ConfigError, Section};

use super::file::{Kind, Study};
use super::parameter::{Parameter, Root};
use crate::touchdowns::{COLUMNS, OF_SCENARIO};

/// Sections of a scenario that a touchdown, with its engine off, does not ask.
const OF_FLIGHT: [&str; 5] = ["initial", "guidance", "navigation", "sensors", "engine"];

/// # Errors
/// A parameter that no run would notice, or that is set twice.
pub fn check(study: &Study, root: &Section) -> Result<(), ConfigError> {
    let of_axes = || study.axes.iter().flat_map(|axis| &axis.parameters).map(|m| &m.parameter);
    for parameter in of_axes().chain(&study.parameters) {
        if let Some(reason) = without_effect(study, parameter) {
            return Err(root.error(&parameter.key, reason));
        }
    }
    let twice = |parameter: &&Parameter| {
        parameter.replaces() && of_axes().any(|of_axis| of_axis.key == parameter.key)
    };
    match study.parameters.iter().find(twice) {
        Some(twice) => {
            let reason =
                "is an axis already, which this would replace: take it \"as\" added or factor";
            Err(root.error(&twice.key, reason))
        }
        None => Ok(()),
    }
}

fn without_effect(study: &Study, parameter: &Parameter) -> Option<String> {
    let path = parameter.path_in_file();
    match (parameter.root, path.as_str()) {
        (Root::Case, _) => None,
        (_, "name") => Some("changes no run".to_owned()),
        (Root::Scenario, "vehicle") => Some(
            "names a file that is read before any draw: make a study of each vehicle".to_owned(),
        ),
        (Root::Scenario, "run.seed") => {
            Some("is each run's own, from the study's seed and the run's number".to_owned())
        }
        (Root::Scenario, path) if study.kind == Kind::Touchdown => of_touchdown(study, path),
        _ => None,
    }
}

/// Why a scenario's key at `path` says nothing to a touchdown.
fn of_touchdown(study: &Study, path: &str) -> Option<String> {
    if let Some((column, _)) = OF_SCENARIO.iter().find(|(_, of_scenario)| *of_scenario == path) {
        let constant = study.case.iter().any(|(index, _)| COLUMNS[*index].0 == *column);
        let of_case = |p: &&Parameter| p.root == Root::Case && p.path_in_file() == *column;
        let drawn = study.parameters.iter().find(of_case).is_some();
        return (constant || drawn).then(|| format!("is set by `case.{column}` instead"));
    }
    let section = path.split('.').next().filter(|section| OF_FLIGHT.contains(section))?;
    Some(format!("is no part of a touchdown: it begins at `case`, without `{section}`"))
}
