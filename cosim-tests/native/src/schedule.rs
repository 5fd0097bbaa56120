//! The schedule: who is set, stepped and read in which order, as data (`schedule.toml`).

use std::collections::BTreeMap;

use lander_models::Ticks;
use lander_models::signals::Interface;
use serde::Deserialize;

/// The file that the FMPy master reads too.
const FILE: &str = include_str!("../../schedule.toml");

/// The two halves of the co-simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    Truth,
    Guidance,
}

/// One entry for each side.
#[derive(Clone, Copy, Debug)]
pub struct Pair<T> {
    pub truth: T,
    pub guidance: T,
}

impl<T> std::ops::Index<Side> for Pair<T> {
    type Output = T;
    fn index(&self, side: Side) -> &T {
        match side {
            Side::Truth => &self.truth,
            Side::Guidance => &self.guidance,
        }
    }
}

impl<T> std::ops::IndexMut<Side> for Pair<T> {
    fn index_mut(&mut self, side: Side) -> &mut T {
        match side {
            Side::Truth => &mut self.truth,
            Side::Guidance => &mut self.guidance,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub enum Action {
    /// Copies each output of `from` to the input of the same name of `to`.
    Transfer { from: Side, to: Side },
    /// Advances one component by the communication step.
    Step { component: Side },
    /// Emits a row.
    Record {},
}

#[derive(Clone, Debug)]
pub struct Schedule {
    pub communication_step: Ticks,
    pub actions: Vec<Action>,
    /// Components whose outputs make a row, after the time.
    pub rows: Vec<Side>,
    /// Outputs whose last value makes the results.
    pub results: Vec<String>,
    /// Names of coded outputs, by code.
    pub codes: BTreeMap<String, Vec<String>>,
}

#[derive(Debug, thiserror::Error)]
pub enum ScheduleError {
    #[error("schedule.toml: {0}")]
    Syntax(#[from] toml::de::Error),
    #[error("schedule.toml: key `{key}`: {reason}")]
    Key { key: &'static str, reason: String },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    communication_step: Quantity,
    actions: Vec<Action>,
    rows: Vec<Side>,
    results: Vec<String>,
    components: Components,
    codes: BTreeMap<String, Vec<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Quantity {
    value: f64,
    unit: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Components {
    truth: String,
    guidance: String,
}

impl Schedule {
    /// The schedule of the repository, held against the components' interfaces.
    pub fn load(interfaces: &Pair<&Interface>) -> Result<Self, ScheduleError> {
        Self::parse(FILE, interfaces)
    }

    pub fn parse(text: &str, interfaces: &Pair<&Interface>) -> Result<Self, ScheduleError> {
        let file: File = toml::from_str(text)?;
        let named = Pair { truth: file.components.truth, guidance: file.components.guidance };
        for side in [Side::Truth, Side::Guidance] {
            if named[side] != interfaces[side].model {
                let reason = format!("\"{}\" is not {}", named[side], interfaces[side].model);
                return Err(ScheduleError::Key { key: "components", reason });
            }
        }
        let recorded = |name: &str| {
            file.rows.iter().any(|side| interfaces[*side].output_offset(name).is_some())
        };
        require_recorded("results", &file.results, recorded)?;
        require_recorded("codes", file.codes.keys(), recorded)?;
        Ok(Self {
            communication_step: communication_step(&file.communication_step)?,
            actions: file.actions,
            rows: file.rows,
            results: file.results,
            codes: file.codes,
        })
    }

    /// Name of a coded output's value, if the schedule names it.
    pub fn code_name(&self, signal: &str, code: f64) -> Option<&str> {
        let names = self.codes.get(signal)?;
        names
            .iter()
            .zip(0_u32..)
            .find(|(_, n)| f64::from(*n) == code)
            .map(|(name, _)| name.as_str())
    }
}

fn communication_step(step: &Quantity) -> Result<Ticks, ScheduleError> {
    let wrong = |reason| ScheduleError::Key { key: "communication_step", reason };
    if step.unit != "s" {
        return Err(wrong(format!("is in \"{}\", must be in \"s\"", step.unit)));
    }
    let ticks = Ticks::from_seconds(step.value).map_err(|error| wrong(error.to_string()))?;
    if ticks == Ticks::ZERO { Err(wrong("must be greater than 0".to_owned())) } else { Ok(ticks) }
}

fn require_recorded<'a>(
    key: &'static str,
    names: impl IntoIterator<Item = &'a String>,
    recorded: impl Fn(&str) -> bool,
) -> Result<(), ScheduleError> {
    match names.into_iter().find(|name| !recorded(name)) {
        None => Ok(()),
        Some(name) => {
            Err(ScheduleError::Key { key, reason: format!("`{name}` is no recorded output") })
        }
    }
}
