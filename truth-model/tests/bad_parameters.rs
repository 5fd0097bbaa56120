//! Every number of a vehicle and a scenario file, spoilt in every way: refused with an error that
//! names file and key, or flown to a finite touchdown or a named error. Never a panic.

mod common;

use claims::{Bound, Claim};
use lander_models::component::ModelError;
use lander_models::scenario::Scenario;
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};
use toml::{Table, Value};
use truth_model::TruthModel;

const VEHICLE: &str = include_str!("../../models/vehicles/bug.toml");
const SCENARIO: &str = include_str!("../../models/scenarios/landing.toml");

/// Changes a key of a section.
type Spoil = fn(&mut Table, &str);

/// What is done to a key: a value put in the place of each of its numbers, or the whole changed.
const SPOILS: [(&str, Spoil); 11] = [
    ("negative", |t, key| number(t, key, -1.0)),
    ("zero", |t, key| number(t, key, 0.0)),
    ("tiny", |t, key| number(t, key, 1e-300)),
    ("large", |t, key| number(t, key, 1e15)),
    ("huge", |t, key| number(t, key, 1e300)),
    ("NaN", |t, key| number(t, key, f64::NAN)),
    ("infinite", |t, key| number(t, key, f64::INFINITY)),
    ("wrong unit", |t, key| part(t, key, "unit", "furlong".into())),
    ("wrong type", |t, key| part(t, key, "value", "much".into())),
    ("no unit", |t, key| drop(t[key].as_table_mut().unwrap().remove("unit"))),
    ("missing", |t, key| drop(t.remove(key))),
];

fn part(table: &mut Table, key: &str, part: &str, value: Value) {
    table[key].as_table_mut().unwrap().insert(part.to_owned(), value);
}

/// Puts `value` in the place of the first number of the key.
fn number(table: &mut Table, key: &str, value: f64) {
    let mut place = &mut table[key]["value"];
    while place.is_array() {
        place = &mut place[0];
    }
    *place = value.into();
}

/// Section and key of all numbers with a unit.
fn numbers(text: &str) -> Vec<(String, String)> {
    let root: Table = text.parse().unwrap();
    let sections = root.iter().filter_map(|(name, value)| Some((name, value.as_table()?)));
    sections
        .flat_map(|(name, section)| {
            let keys = section.iter().filter(|(_, value)| value.get("unit").is_some());
            keys.map(move |(key, _)| (name.clone(), key.clone()))
        })
        .collect()
}

fn spoilt(text: &str, section: &str, key: &str, spoil: Spoil) -> String {
    let mut root: Table = text.parse().unwrap();
    spoil(root[section].as_table_mut().unwrap(), key);
    root.to_string()
}

/// A touchdown of whatever the files said, 0.3 s of it. Whether it stayed finite, or said so.
fn lands(mut scenario: Scenario, vehicle: Vehicle) -> Result<(), ModelError> {
    scenario.initial.position_w = Vector3::zeros();
    scenario.initial.velocity_w = Vector3::new(0.5, 0.0, -1.0);
    scenario.initial.attitude_wb = UnitQuaternion::identity();
    let model = TruthModel::new(scenario, vehicle);
    let mut state = model.initial_state();
    for _ in 0..300 {
        if model.tick(&mut state)?.terminate {
            break;
        }
    }
    assert!(state.motion.is_finite());
    Ok(())
}

/// Counts of what was refused, flown and diverged.
#[derive(Debug, Default)]
struct Tally {
    refused: u32,
    flown: u32,
    diverged: Vec<String>,
}

impl Tally {
    fn of(
        text: &str,
        file: &str,
        read: impl Fn(&str) -> Result<(Scenario, Vehicle), String>,
    ) -> Self {
        let mut tally = Self::default();
        for (section, key) in numbers(text) {
            for (name, spoil) in SPOILS {
                match read(&spoilt(text, &section, &key, spoil)) {
                    Ok((scenario, vehicle)) => match lands(scenario, vehicle) {
                        Ok(()) => tally.flown += 1,
                        Err(error) => {
                            tally.diverged.push(format!("{section}.{key} {name}: {error}"))
                        }
                    },
                    Err(error) => {
                        // A number may show only in that another no longer fits it.
                        let named = error.contains(file) && error.contains("key `");
                        assert!(named, "{section}.{key} {name}: {error}");
                        tally.refused += 1;
                    }
                }
            }
        }
        tally
    }
}

#[test]
fn a_spoilt_number_is_refused_by_name_or_flies_finitely() {
    let bug = common::bug();
    let scenarios = Tally::of(SCENARIO, "landing.toml", |text| {
        Scenario::parse("landing.toml".as_ref(), text, &bug)
            .map(|scenario| (scenario, bug.clone()))
            .map_err(|error| error.to_string())
    });
    let vehicles = Tally::of(VEHICLE, "bug.toml", |text| {
        let vehicle = Vehicle::parse("bug.toml".as_ref(), text);
        vehicle
            .and_then(|vehicle| {
                // Its propellant may no longer fit the scenario's: that is the scenario's error.
                let text = SCENARIO.replace("value = 85.5", "value = 0.0");
                let scenario = Scenario::parse("bug.toml".as_ref(), &text, &vehicle)?;
                Ok((scenario, vehicle))
            })
            .map_err(|error| error.to_string())
    });
    println!("{scenarios:#?} {vehicles:#?}");
    let refused = scenarios.refused + vehicles.refused;
    assert!(refused > scenarios.flown + vehicles.flown, "most of them are wrong");
    Claim {
        id: "bad-parameters",
        section: "Files",
        claim: "numbers of a vehicle and a scenario file, each spoilt in eleven ways, that neither an \
                error names nor a finite touchdown follows",
        reference: "all are refused by file and key, or fly",
        unit: "",
        bound: Bound::AtMost(0.0),
        origin: "acceptance list: every bad parameter a named error",
        noise: 0.0,
    }
    .holds((scenarios.diverged.len() + vehicles.diverged.len()) as f64);
}
