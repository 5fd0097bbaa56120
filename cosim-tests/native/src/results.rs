//! The results of a run: the last values of the outputs that the schedule lists.

use lander_models::Outcome;
use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::layout::{Layout, TIME};
use crate::schedule::Schedule;

#[derive(Clone, Debug)]
pub struct Results {
    pub scenario: String,
    pub outcome: Outcome,
    /// Simulated time of the last row, s.
    pub end_time_s: f64,
    /// SHA-256 over all rows, in hexadecimal.
    pub digest: String,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    name: String,
    /// As many as the output has scalars.
    values: Vec<f64>,
    /// The value's name, where the schedule names the codes of this output.
    code: Option<String>,
}

#[derive(Debug, thiserror::Error)]
#[error("outcome is {code}, which is no outcome's code")]
pub struct UnknownOutcome {
    code: f64,
}

impl Results {
    pub fn from_last_row(
        scenario: &str,
        schedule: &Schedule,
        layout: &Layout,
        row: &[f64],
        digest: String,
    ) -> Result<Self, UnknownOutcome> {
        let code = layout.scalar(row, "outcome");
        let outcome = Outcome::from_code(code).ok_or(UnknownOutcome { code })?;
        let entries = schedule
            .results
            .iter()
            .map(|name| {
                let values = row[layout.columns(name)].to_vec();
                let code = schedule.code_name(name, values[0]).map(str::to_owned);
                Entry { name: name.clone(), values, code }
            })
            .collect();
        Ok(Self { scenario: scenario.to_owned(), outcome, end_time_s: row[0], digest, entries })
    }

    /// Whether the rows ended before truth had decided on an outcome.
    pub fn interrupted(&self) -> bool {
        self.outcome == Outcome::InFlight
    }

    /// A result by name, the first of several; NaN if it was never measured.
    pub fn value(&self, name: &str) -> f64 {
        let entry = self.entries.iter().find(|entry| entry.name == name);
        entry.map_or(f64::NAN, |entry| entry.values[0])
    }

    /// The results file: one JSON object, a result that was never measured as `null`, one with
    /// several scalars as a list.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl Serialize for Results {
    /// In the order of the schedule, which a derived map would lose.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("scenario", &self.scenario)?;
        for entry in &self.entries {
            let measured = |value: &f64| value.is_finite().then_some(*value);
            match (&entry.code, entry.values.as_slice()) {
                (Some(name), _) => map.serialize_entry(&entry.name, name)?,
                (None, [value]) => map.serialize_entry(&entry.name, &measured(value))?,
                (None, values) => {
                    let list: Vec<_> = values.iter().map(measured).collect();
                    map.serialize_entry(&entry.name, &list)?;
                }
            }
        }
        map.serialize_entry("interrupted", &self.interrupted())?;
        map.serialize_entry(&format!("end_{TIME}"), &self.end_time_s)?;
        map.serialize_entry("digest", &self.digest)?;
        map.end()
    }
}
