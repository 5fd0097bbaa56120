//! The touchdowns that are timed: `cosim-tests/benchmark.toml`, which `touchdown_cosim.bench_mujoco`
//! reads too.

use std::collections::HashMap;

use cosim::touchdowns::{self, COLUMNS};
use lander_models::scenario::ContactEngine;
use lander_models::time::Ticks;
use lander_models::{ConfigError, Vehicle};
use serde::Deserialize;
use truth_model::TruthModel;

const FILE: &str = include_str!("../../../benchmark.toml");

/// Who still moves after so long does not come to rest.
const STOP_TIME: Ticks = Ticks(12_000);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    speed_factors: Vec<f64>,
    base: HashMap<String, f64>,
    touchdown: Vec<Touchdown>,
}

#[derive(Deserialize)]
struct Touchdown {
    name: String,
    #[serde(flatten)]
    own: HashMap<String, f64>,
}

/// One touchdown with its speeds a little slower and a little faster.
pub struct Family {
    pub name: String,
    /// As `COLUMNS`.
    pub members: Vec<[f64; COLUMNS.len()]>,
}

/// # Errors
/// The file is not TOML, or names a column that there is not or lacks one.
pub fn families() -> Result<Vec<Family>, String> {
    let table: Table = toml::from_str(FILE).map_err(|error| format!("benchmark.toml: {error}"))?;
    table.touchdown.iter().map(|touchdown| family(&table, touchdown)).collect()
}

fn family(table: &Table, touchdown: &Touchdown) -> Result<Family, String> {
    let Touchdown { name, own } = touchdown;
    let mut named = table.base.clone();
    named.extend(own.clone());
    let is_column = |key: &str| COLUMNS.iter().any(|(column, _)| *column == key);
    if let Some(key) = named.keys().find(|key| !is_column(key)) {
        return Err(format!("benchmark.toml: touchdown `{name}`: key `{key}` is no column"));
    }
    let mut values = [0.0; COLUMNS.len()];
    for (value, (column, _)) in values.iter_mut().zip(COLUMNS) {
        let lacks = || format!("benchmark.toml: touchdown `{name}`: lacks `{column}`");
        *value = *named.get(column).ok_or_else(lacks)?;
    }
    let member = |factor: &f64| {
        let mut member = values;
        for (value, (column, _)) in member.iter_mut().zip(COLUMNS) {
            if matches!(column, "down_m_s" | "across_m_s") {
                *value *= factor;
            }
        }
        member
    };
    Ok(Family { name: name.clone(), members: table.speed_factors.iter().map(member).collect() })
}

/// A member just clear of the ground.
pub fn model(
    vehicle: &Vehicle,
    member: &[f64; COLUMNS.len()],
    engine: ContactEngine,
    refinement: u32,
) -> Result<TruthModel, ConfigError> {
    let model = touchdowns::model(vehicle, engine, STOP_TIME, member)?;
    let mut scenario = model.scenario().clone();
    scenario.contact_refinement = refinement;
    Ok(TruthModel::new(scenario, vehicle.clone()))
}
