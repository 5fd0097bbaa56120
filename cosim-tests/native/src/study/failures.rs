//! Failure modes of a study: how probable each is in a run, and how its numbers are spread.

use lander_models::quantity::{ConfigError, Limit, Section};

use super::distribution::Distribution;
use super::parameter::Parameter;

/// One mode of `[faults]` of a scenario.
#[derive(Clone, Debug)]
pub struct Mode {
    pub name: String,
    /// That a run has it.
    pub probability: f64,
    /// Its onset and other keys.
    pub parameters: Vec<Parameter>,
}

#[derive(Clone, Debug, Default)]
pub struct Failures {
    pub modes: Vec<Mode>,
    /// Each run has exactly one mode, in turn, whatever the probabilities.
    pub forced: bool,
}

impl Failures {
    pub fn read(root: &Section) -> Result<Self, ConfigError> {
        let s = root.optional_section("failures")?;
        let forced = s.choice("forced", &["no", "in_turn"])? == "in_turn";
        let names: Vec<String> =
            s.keys().filter(|key| *key != "forced").map(str::to_owned).collect();
        let modes: Vec<Mode> =
            names.iter().map(|name| read_mode(name, s.section(name)?)).collect::<Result<_, _>>()?;
        if forced && modes.is_empty() {
            return Err(s.error("forced", "is \"in_turn\", but there is no mode"));
        }
        s.finish()?;
        Ok(Self { modes, forced })
    }

    /// Modes of a run. `uniform` is its draw of a named stream.
    pub fn of_run(&self, run: u64, uniform: &dyn Fn(&str) -> f64) -> Vec<&Mode> {
        let turn = |index: usize| run % self.modes.len() as u64 == index as u64;
        let modes = self.modes.iter().enumerate();
        modes
            .filter(|(index, mode)| match self.forced {
                true => turn(*index),
                false => uniform(&format!("failure {}", mode.name)) < mode.probability,
            })
            .map(|(_, mode)| mode)
            .collect()
    }
}

fn read_mode(name: &str, s: Section) -> Result<Mode, ConfigError> {
    let probability = s.number("probability", "1", Limit::Within(0.0, 1.0))?;
    let keys: Vec<String> =
        s.keys().filter(|key| *key != "probability").map(str::to_owned).collect();
    let parameters = keys
        .iter()
        .map(|key| {
            let spread = s.section(key)?;
            let distribution = Distribution::read(&spread)?;
            spread.finish()?;
            Ok(Parameter::of_scenario(&["faults", name, key], distribution))
        })
        .collect::<Result<_, ConfigError>>()?;
    s.finish()?;
    Ok(Mode { name: name.to_owned(), probability, parameters })
}
