//! Many touchdowns from a file: one state at contact a row, run without FMU or guidance to its verdict.
//!
//! Rows are independent, so they are spread over threads; results stand in the order of the file and
//! have the same bits whatever the number of threads.

use std::path::{Path, PathBuf};

use lander_models::component::Component;
use lander_models::frames::attitude_from_roll_pitch_yaw_deg;
use lander_models::quantity::Limit;
use lander_models::scenario::{ContactEngine, Initial};
use lander_models::signals::TRUTH;
use lander_models::{ConfigError, ModelError, Outcome, Scenario, Ticks, Vehicle};
use nalgebra::Vector3;
use rayon::prelude::*;
use truth_model::TruthModel;

use crate::progress::Count;

/// The lowest point of the vehicle starts this far from the ground, m: clear of it, so that the
/// contact is a touchdown, and near enough that the speeds are those of the row.
const START_GAP_M: f64 = 2e-3;

/// Site and limits that a row does not give.
const BASE: &str = include_str!("../../../models/scenarios/tip-over.toml");

/// Columns of the file with their limits, in order. Angles in degrees; azimuths from world x
/// towards world y; velocity of the centre of mass; roll, pitch, yaw as in a scenario file.
pub const COLUMNS: [(&str, Limit); 15] = [
    ("propellant_kg", Limit::NotNegative),
    ("gravity_m_s2", Limit::Positive),
    ("down_m_s", Limit::Any),
    ("across_m_s", Limit::NotNegative),
    ("travel_deg", Limit::Within(-360.0, 360.0)),
    ("roll_deg", Limit::Within(-180.0, 180.0)),
    ("pitch_deg", Limit::Within(-180.0, 180.0)),
    ("yaw_deg", Limit::Within(-180.0, 180.0)),
    ("rate_x_deg_s", Limit::Any),
    ("rate_y_deg_s", Limit::Any),
    ("rate_z_deg_s", Limit::Any),
    ("slope_deg", Limit::Within(0.0, 45.0)),
    ("downhill_deg", Limit::Within(-360.0, 360.0)),
    ("friction", Limit::Within(0.0, 2.0)),
    ("captured", Limit::Within(0.0, 1.0)),
];

/// A state at contact, as `COLUMNS`.
pub type Case = [f64; COLUMNS.len()];

/// Results of a row, by their names in the signal table; a result never measured is NaN.
const RESULTS: [&str; 7] = [
    "contact_time_s",
    "rest_tilt_deg",
    "tip_energy_margin_j",
    "tip_time_s",
    "peak_stroke_m",
    "peak_leg_load_n",
    "slide_distance_m",
];

#[derive(Debug, thiserror::Error)]
pub enum TouchdownsError {
    #[error("{}: {source}", file.display())]
    File { file: PathBuf, source: std::io::Error },
    #[error("{}: line 1: must have the columns {expected}; {found}", file.display())]
    Header { file: PathBuf, expected: String, found: String },
    #[error("{}: line {line}: has {count} values, must have {}", file.display(), COLUMNS.len())]
    Width { file: PathBuf, line: usize, count: usize },
    #[error("{}: line {line}: column `{column}`: is {value}, {need}", file.display())]
    Value { file: PathBuf, line: usize, column: &'static str, value: String, need: String },
    #[error("{}: has no cases", file.display())]
    Empty { file: PathBuf },
    #[error("{}: line {line}: {source}", file.display())]
    Run { file: PathBuf, line: usize, source: ModelError },
    #[error("{0} threads cannot be started: {1}")]
    Threads(usize, rayon::ThreadPoolBuildError),
}

/// Which engine resolves contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Engine {
    #[default]
    Rapier,
    Strut,
}

impl From<Engine> for ContactEngine {
    fn from(engine: Engine) -> Self {
        match engine {
            Engine::Rapier => Self::Rapier,
            Engine::Strut => Self::Strut,
        }
    }
}

/// A file of cases, read and checked.
#[derive(Debug)]
pub struct Cases {
    file: PathBuf,
    /// As `COLUMNS`, with the line in the file.
    rows: Vec<(usize, Case)>,
}

/// One touchdown: the case and how it ended.
#[derive(Clone, Debug)]
pub struct Touchdown {
    pub case: Case,
    pub outcome: Outcome,
    pub end_time_s: f64,
    /// As `RESULTS`.
    pub results: [f64; RESULTS.len()],
}

impl Cases {
    pub fn read(file: &Path, vehicle: &Vehicle) -> Result<Self, TouchdownsError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| TouchdownsError::File { file: file.to_owned(), source })?;
        Self::parse(file, &text, vehicle)
    }

    /// As `read`, from text in memory; `file` only names it.
    pub fn parse(file: &Path, text: &str, vehicle: &Vehicle) -> Result<Self, TouchdownsError> {
        let mut lines = text.lines().zip(1..);
        check_header(file, lines.next().map_or("", |(header, _)| header))?;
        let rows = lines
            .filter(|(text, _)| !text.trim().is_empty())
            .map(|(text, line)| Ok((line, read_row(file, line, text, vehicle)?)))
            .collect::<Result<Vec<_>, _>>()?;
        if rows.is_empty() {
            return Err(TouchdownsError::Empty { file: file.to_owned() });
        }
        Ok(Self { file: file.to_owned(), rows })
    }

    /// Runs every case, at most to `stop_time`.
    ///
    /// # Errors
    /// The first in file order, whichever thread met it.
    pub fn run(
        &self,
        vehicle: &Vehicle,
        engine: Engine,
        stop_time: Ticks,
        threads: usize,
    ) -> Result<Vec<Touchdown>, TouchdownsError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| TouchdownsError::Threads(threads, error))?;
        let progress = Count::new("touchdowns", self.rows.len());
        let run_one = |(line, case): &(usize, Case)| {
            let touchdown = run(vehicle, engine, stop_time, case);
            progress.one_more();
            touchdown.map_err(|source| TouchdownsError::Run {
                file: self.file.clone(),
                line: *line,
                source,
            })
        };
        let results: Vec<_> = pool.install(|| self.rows.par_iter().map(run_one).collect());
        progress.finish();
        results.into_iter().collect()
    }
}

fn check_header(file: &Path, header: &str) -> Result<(), TouchdownsError> {
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let at = |n: usize| names.get(n).copied();
    let wrong = (0..COLUMNS.len().max(names.len()))
        .find(|n| at(*n) != COLUMNS.get(*n).map(|(name, _)| *name));
    let Some(n) = wrong else { return Ok(()) };
    let found = match (at(n), COLUMNS.get(n)) {
        (Some(name), _) => format!("column {} is `{name}`", n + 1),
        (None, Some((name, _))) => format!("column {} `{name}` is missing", n + 1),
        (None, None) => "the header is empty".to_owned(),
    };
    let expected = COLUMNS.map(|(name, _)| name).join(",");
    Err(TouchdownsError::Header { file: file.to_owned(), expected, found })
}

fn read_row(
    file: &Path,
    line: usize,
    text: &str,
    vehicle: &Vehicle,
) -> Result<Case, TouchdownsError> {
    let words: Vec<&str> = text.split(',').map(str::trim).collect();
    if words.len() != COLUMNS.len() {
        let count = words.len();
        return Err(TouchdownsError::Width { file: file.to_owned(), line, count });
    }
    let mut row = [0.0; COLUMNS.len()];
    for ((slot, word), (column, limit)) in row.iter_mut().zip(words).zip(COLUMNS) {
        let wrong = |need: String| TouchdownsError::Value {
            file: file.to_owned(),
            line,
            column,
            value: format!("`{word}`"),
            need,
        };
        let value: f64 = word.parse().map_err(|_| wrong("must be a number".to_owned()))?;
        match violation(column, limit, value, vehicle) {
            None => *slot = value,
            Some(need) => return Err(wrong(need)),
        }
    }
    Ok(row)
}

/// What the value of a column should have been, if it is wrong for this vehicle.
fn violation(column: &str, limit: Limit, value: f64, vehicle: &Vehicle) -> Option<String> {
    let capacity_kg = vehicle.mass.propellant.capacity_kg;
    match limit {
        _ if !value.is_finite() => Some("must be finite".to_owned()),
        _ if column == "propellant_kg" && value > capacity_kg => {
            Some(format!("must not exceed the vehicle's {capacity_kg}"))
        }
        _ if column == "captured" && value != 0.0 && value != 1.0 => {
            Some("must be 0 or 1".to_owned())
        }
        _ => limit.violated_by(value),
    }
}

/// The first column of a case that is wrong for this vehicle, and why.
pub fn check(case: &Case, vehicle: &Vehicle) -> Result<(), (&'static str, String)> {
    let mut columns = COLUMNS.iter().zip(case);
    let wrong = columns.find_map(|((column, limit), value)| {
        let need = violation(column, *limit, *value, vehicle)?;
        Some((*column, format!("is {value}, {need}")))
    });
    wrong.map_or(Ok(()), Err)
}

/// One touchdown to its verdict.
fn run(
    vehicle: &Vehicle,
    engine: Engine,
    stop_time: Ticks,
    case: &Case,
) -> Result<Touchdown, ModelError> {
    let (end, outputs) = settle(&model(vehicle, engine.into(), stop_time, case)?)?;
    // Every name stands in the table: `results_are_truth_s_outputs` holds that.
    let value = |name| TRUTH.output_offset(name).map_or(f64::NAN, |offset| outputs[offset]);
    Ok(Touchdown {
        case: *case,
        outcome: Outcome::from_code(value("outcome")).unwrap_or_default(),
        end_time_s: end.seconds(),
        results: RESULTS.map(value),
    })
}

/// Runs a truth model with its engine off to its verdict. When it ended, and its outputs then.
pub fn settle(model: &TruthModel) -> Result<(Ticks, Vec<f64>), ModelError> {
    let mut state = model.initial_state();
    let engine_off = vec![0.0; TRUTH.input_len()];
    model.step(&mut state, &engine_off, model.scenario().stop_time)?;
    let mut outputs = vec![0.0; TRUTH.output_len()];
    model.outputs(&state, &mut outputs);
    Ok((state.now, outputs))
}

/// The truth model of a case, its lowest point `START_GAP_M` above the ground.
///
/// # Errors
/// Those of the base scenario with this vehicle.
pub fn model(
    vehicle: &Vehicle,
    engine: ContactEngine,
    stop_time: Ticks,
    case: &Case,
) -> Result<TruthModel, ConfigError> {
    let mut scenario = Scenario::parse("tip-over.toml".as_ref(), BASE, vehicle)?;
    scenario.contact_engine = engine;
    scenario.stop_time = stop_time;
    Ok(place(scenario, vehicle, case))
}

/// The truth model of a case on a scenario's site, but for what the case has of it.
pub fn place(scenario: Scenario, vehicle: &Vehicle, case: &Case) -> TruthModel {
    let mut scenario = at_origin(scenario, vehicle, case);
    let normal_w = scenario.terrain.normal_w();
    // From the origin straight up until the lowest point is clear by the gap.
    let low = TruthModel::new(scenario.clone(), vehicle.clone());
    let climb_m = START_GAP_M - low.lowest_m(&low.initial_state());
    scenario.initial.position_w.z += climb_m / normal_w.z;
    TruthModel::new(scenario, vehicle.clone())
}

/// Columns of a case that a scenario has too, and their keys there.
pub const OF_SCENARIO: [(&str, &str); 6] = [
    ("propellant_kg", "initial.propellant"),
    ("gravity_m_s2", "site.gravity"),
    ("slope_deg", "terrain.slope"),
    ("downhill_deg", "terrain.downhill_azimuth"),
    ("friction", "terrain.friction"),
    ("captured", "terrain.pads"),
];

/// What a scenario has of a case: its site and propellant. Upright and without speed.
pub fn case_of(scenario: &Scenario) -> Case {
    let terrain = &scenario.terrain;
    let of_scenario = |column| match column {
        "propellant_kg" => scenario.initial.propellant_kg,
        "gravity_m_s2" => scenario.gravity_m_s2,
        "slope_deg" => terrain.slope_rad.to_degrees(),
        "downhill_deg" => terrain.downhill_rad.to_degrees(),
        "friction" => terrain.friction,
        "captured" => f64::from(u8::from(terrain.pads_captured)),
        _ => 0.0,
    };
    COLUMNS.map(|(column, _)| of_scenario(column))
}

/// The scenario with the site and start of a case, O at the world's origin.
fn at_origin(mut scenario: Scenario, vehicle: &Vehicle, case: &Case) -> Scenario {
    let [
        propellant_kg,
        gravity_m_s2,
        down_m_s,
        across_m_s,
        travel_deg,
        roll_deg,
        pitch_deg,
        yaw_deg,
        rate_x_deg_s,
        rate_y_deg_s,
        rate_z_deg_s,
        slope_deg,
        downhill_deg,
        friction,
        captured,
    ] = *case;
    scenario.gravity_m_s2 = gravity_m_s2;
    scenario.terrain.slope_rad = slope_deg.to_radians();
    scenario.terrain.downhill_rad = downhill_deg.to_radians();
    scenario.terrain.friction = friction;
    scenario.terrain.pads_captured = captured == 1.0;
    let attitude_wb = attitude_from_roll_pitch_yaw_deg([roll_deg, pitch_deg, yaw_deg]);
    let rate_b = Vector3::new(rate_x_deg_s, rate_y_deg_s, rate_z_deg_s).map(f64::to_radians);
    let (sin, cos) = libm::sincos(travel_deg.to_radians());
    let com_velocity_w = Vector3::new(across_m_s * cos, across_m_s * sin, -down_m_s);
    let com_b = vehicle.mass.at(propellant_kg).com_b;
    scenario.initial = Initial {
        position_w: Vector3::zeros(),
        velocity_w: com_velocity_w - attitude_wb * rate_b.cross(&com_b),
        attitude_wb,
        rate_b,
        propellant_kg,
    };
    scenario
}

/// The rows as CSV: the columns of the cases, then those of the results. A result that was never
/// measured is empty.
pub fn to_csv(touchdowns: &[Touchdown]) -> String {
    let names = COLUMNS.map(|(name, _)| name).into_iter();
    let header: Vec<&str> = names.chain(["outcome", "end_time_s"]).chain(RESULTS).collect();
    let number = |value: &f64| if value.is_finite() { value.to_string() } else { String::new() };
    let mut text = header.join(",") + "\n";
    for touchdown in touchdowns {
        let mut words: Vec<String> = touchdown.case.iter().map(number).collect();
        words.push(touchdown.outcome.name().to_owned());
        words.push(number(&touchdown.end_time_s));
        words.extend(touchdown.results.iter().map(number));
        text += &(words.join(",") + "\n");
    }
    text
}

/// How many ended in each outcome, in the outcomes' order.
pub fn count(touchdowns: &[Touchdown]) -> Vec<(&'static str, usize)> {
    Outcome::ALL
        .into_iter()
        .map(|outcome| (outcome.name(), touchdowns.iter().filter(|t| t.outcome == outcome).count()))
        .filter(|(_, count)| *count > 0)
        .collect()
}

/// The rows as one JSON object: counts by outcome, then every row by column name.
pub fn to_json(touchdowns: &[Touchdown]) -> serde_json::Value {
    let number = |value: f64| value.is_finite().then_some(value);
    let rows: Vec<serde_json::Value> = touchdowns
        .iter()
        .map(|touchdown| {
            let mut row = serde_json::Map::new();
            for ((name, _), value) in COLUMNS.iter().zip(touchdown.case) {
                row.insert((*name).to_owned(), number(value).into());
            }
            row.insert("outcome".to_owned(), touchdown.outcome.name().into());
            row.insert("end_time_s".to_owned(), number(touchdown.end_time_s).into());
            for (name, value) in RESULTS.iter().zip(touchdown.results) {
                row.insert((*name).to_owned(), number(value).into());
            }
            row.into()
        })
        .collect();
    let outcomes: serde_json::Map<_, _> =
        count(touchdowns).into_iter().map(|(name, n)| (name.to_owned(), n.into())).collect();
    serde_json::json!({ "cases": touchdowns.len(), "outcomes": outcomes, "rows": rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_truth_s_outputs() {
        for name in RESULTS.into_iter().chain(["outcome"]) {
            assert!(TRUTH.output_offset(name).is_some(), "{name}");
        }
    }
}
