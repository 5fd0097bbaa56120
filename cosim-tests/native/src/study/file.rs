//! The study file: what is run, what is drawn, how often.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use lander_models::quantity::{ConfigError, Limit, Section, parse_table, read_table};
use lander_models::{Scenario, Vehicle};
use sha2::{Digest, Sha256};
use toml::{Table, Value as Toml};

use super::StudyError;
use super::axis::{Axis, Designs};
use super::effect;
use super::failures::Failures;
use super::parameter::{Parameter, case_unit};
use super::rare;
use super::run::Draw;
use super::shard::{BUILD, VERSION, origin};
use crate::landing::{hexadecimal, names_a_file};
use crate::map::file::Map;
use crate::statistics::subset::Settings;
use crate::touchdowns::COLUMNS;

/// What one run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Truth and guidance in a closed loop, from the scenario's start to rest.
    Landing,
    /// Truth alone from a state at contact to rest, engine off.
    Touchdown,
}

/// How runs draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Each by itself.
    Independent,
    /// In groups laid out for Sobol' indices: (A, B, AB_1, AB_2 …) of one row each.
    Sobol,
}

/// Layout of the runs of `Sampling::Sobol`.
pub struct SobolLayout {
    /// Columns of the inputs.
    pub inputs: Vec<String>,
    /// Runs of a row.
    pub matrices: usize,
}

/// A study file, read and checked, with the files that it names.
#[derive(Clone, Debug)]
pub struct Study {
    pub file: PathBuf,
    pub name: String,
    pub kind: Kind,
    /// Of all designs together.
    pub runs: u64,
    pub seed: u64,
    /// Runs that are written, and after a kill repeated, together.
    pub shard_runs: u64,
    /// Of `lander design`.
    pub axes: Vec<Axis>,
    pub parameters: Vec<Parameter>,
    pub failures: Failures,
    pub sampling: Sampling,
    /// Of `lander map`.
    pub map: Option<Map>,
    /// Of `lander rare`.
    pub rare_event: Settings,
    pub scenario_file: PathBuf,
    pub vehicle_file: PathBuf,
    /// The scenario's and the vehicle's tables before any draw; the case is that of the scenario.
    pub scenario: Table,
    pub vehicle: Table,
    /// Columns of the contact state that the study sets, by index.
    pub case: Vec<(usize, f64)>,
    /// The study file itself.
    pub text: String,
    /// SHA-256 of all that a row depends on, but for the version of the software.
    pub hash: String,
}

/// Some ten seconds of work on one core.
const LANDINGS_A_SHARD: f64 = 100.0;
const TOUCHDOWNS_A_SHARD: f64 = 1000.0;

impl Study {
    pub fn load(file: &Path) -> Result<Self, StudyError> {
        Self::parse(file, &read_text(file)?)
    }

    /// As `load`, from text in memory; `file` names it and is where its paths start.
    pub fn parse(file: &Path, text: &str) -> Result<Self, StudyError> {
        let study = Self::read(file, text)?;
        study.check()?;
        Ok(study)
    }

    fn read(file: &Path, text: &str) -> Result<Self, ConfigError> {
        let root = Section::parse(file, text, false)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let name = root.text("name")?;
        if !names_a_file(&name) {
            return Err(root.error("name", format!("is {name:?}, must be fit for a folder's name")));
        }
        root.text("kind")?;
        let kind = match root.choice("kind", &["landing", "touchdown"])? {
            "touchdown" => Kind::Touchdown,
            _ => Kind::Landing,
        };
        let whole = |key: &str, low: f64, default: f64| {
            let number = root.number_or(key, "1", Limit::Within(low, 9.007e15), default)?;
            match number.fract() == 0.0 {
                true => Ok(number as u64),
                false => Err(root.error(key, format!("is {number}, must be a whole number"))),
            }
        };
        let shard_runs = match kind {
            Kind::Landing => LANDINGS_A_SHARD,
            Kind::Touchdown => TOUCHDOWNS_A_SHARD,
        };
        root.number("runs", "1", Limit::Within(1.0, 1e9))?;
        let (runs, seed) = (whole("runs", 1.0, 1.0)?, whole("seed", 0.0, 0.0)?);
        let shard_runs = whole("shard_runs", 1.0, shard_runs)?;
        let scenario_file = folder.join(root.text("scenario")?);
        let scenario = read_table(&scenario_file)?;
        let vehicle_name = Section::of(&scenario_file, scenario.clone(), false).text("vehicle")?;
        let vehicle_file = scenario_file.parent().unwrap_or(Path::new("")).join(vehicle_name);
        let vehicle = Vehicle::table(&vehicle_file)?;
        let mut parameters = Vec::new();
        for (list, known) in [("design", true), ("dispersion", false)] {
            for s in root.sections(list)? {
                parameters.push(Parameter::read(s, known)?);
            }
        }
        let axes = Axis::read_all(&root)?;
        let runs = runs.saturating_mul(Designs(&axes).count());
        let case = read_case(&root, kind)?;
        let failures = Failures::read(&root)?;
        let sampling = match root.choice("sampling", &["independent", "sobol"])? {
            "sobol" => Sampling::Sobol,
            _ => Sampling::Independent,
        };
        let mut study = Self {
            file: file.to_owned(),
            name,
            kind,
            runs,
            seed,
            shard_runs,
            axes,
            parameters,
            failures,
            sampling,
            map: Map::read(&root)?,
            rare_event: rare::read(&root, seed)?,
            scenario_file,
            vehicle_file,
            scenario,
            vehicle,
            case,
            text: text.to_owned(),
            hash: String::new(),
        };
        study.check_columns(&root)?;
        effect::check(&study, &root)?;
        study.check_sampling(&root)?;
        root.finish()?;
        study.hash = study.hash_of(parse_table(file, text)?)?;
        Ok(study)
    }

    /// What its rows come from.
    pub fn origin(&self) -> String {
        origin(&self.hash, VERSION, BUILD)
    }

    /// An error unless it has designs.
    pub fn need_axes(&self) -> Result<(), StudyError> {
        if !self.axes.is_empty() {
            return Ok(());
        }
        let (file, key) = (self.file.clone(), "axis".to_owned());
        let reason = "is missing: a design study has one or two".to_owned();
        Err(ConfigError::Key { file, key, reason }.into())
    }

    /// An error if it is a map, of which a campaign would run one touchdown.
    pub fn need_no_map(&self) -> Result<(), StudyError> {
        if self.map.is_none() {
            return Ok(());
        }
        let (file, key) = (self.file.clone(), "map".to_owned());
        let reason = "is for `lander map`: a campaign has no place for it".to_owned();
        Err(ConfigError::Key { file, key, reason }.into())
    }

    pub fn designs(&self) -> Designs<'_> {
        Designs(&self.axes)
    }

    /// All that can be drawn, failure modes last.
    pub fn drawn(&self) -> impl Iterator<Item = &Parameter> {
        let of_modes = self.failures.modes.iter().flat_map(|mode| &mode.parameters);
        self.parameters.iter().chain(of_modes).filter(|p| !p.distribution.is_constant())
    }

    /// Tries every parameter at the ends of its distribution, those of its failure mode in their middle.
    fn check(&self) -> Result<(), StudyError> {
        let vehicle = Vehicle::of(&self.vehicle_file, self.vehicle.clone())?;
        Scenario::of(&self.scenario_file, self.scenario.clone(), &vehicle)?;
        self.realise(&[]).map_err(|refused| refused.at(self, "before any draw"))?;
        // What is constant is so in every run, so that constants may need each other.
        let is_constant = |p: &&Parameter| p.distribution.is_constant();
        let constants: Vec<Draw> =
            self.parameters.iter().filter(is_constant).map(in_the_middle).collect();
        let before = || "before the first run".to_owned();
        let designs = self.designs();
        for design in 0..designs.count() {
            let place = match self.axes.is_empty() {
                true => before(),
                false => format!("design {}", designs.name(design)),
            };
            let draws = [designs.draws(design), constants.clone()].concat();
            self.realise(&draws).map_err(|refused| refused.at(self, place))?;
        }
        let drawn = self.parameters.iter().filter(|p| !is_constant(p));
        let alone = drawn.map(std::slice::from_ref);
        let modes = self.failures.modes.iter().map(|mode| mode.parameters.as_slice());
        for together in alone.chain(modes) {
            let middle: Vec<Draw> = together.iter().map(in_the_middle).collect();
            for (index, parameter) in together.iter().enumerate() {
                for extreme in parameter.distribution.extremes() {
                    let mut draws = [constants.clone(), middle.clone()].concat();
                    draws[constants.len() + index].1 = extreme;
                    self.realise(&draws).map_err(|refused| refused.at(self, before()))?;
                }
            }
        }
        Ok(())
    }

    /// No two parameters may share a column.
    fn check_columns(&self, root: &Section) -> Result<(), ConfigError> {
        let mut seen = BTreeSet::new();
        match self.drawn().find(|parameter| !seen.insert(&parameter.column)) {
            None => Ok(()),
            Some(twice) => Err(root.error(&twice.key, "is drawn twice")),
        }
    }

    /// Of `Sampling::Sobol`.
    pub fn sobol_layout(&self) -> Option<SobolLayout> {
        let inputs: Vec<String> = self.drawn().map(|parameter| parameter.column.clone()).collect();
        let matrices = inputs.len() + 2;
        (self.sampling == Sampling::Sobol).then_some(SobolLayout { inputs, matrices })
    }

    /// Sobol' indices need whole rows, inputs and no failure modes, which are no inputs.
    fn check_sampling(&self, root: &Section) -> Result<(), ConfigError> {
        let Some(SobolLayout { inputs, matrices }) = self.sobol_layout() else { return Ok(()) };
        if inputs.is_empty() || !self.failures.modes.is_empty() || !self.axes.is_empty() {
            let reason = "is \"sobol\", which needs drawn parameters, no failure modes and no axes";
            return Err(root.error("sampling", reason));
        }
        if !self.runs.is_multiple_of(matrices as u64) {
            let (runs, n) = (self.runs, inputs.len());
            let reason =
                format!("is {runs}, must be a multiple of {matrices}: {n} parameters and 2");
            return Err(root.error("runs", reason));
        }
        Ok(())
    }

    fn hash_of(&self, mut study: Table) -> Result<String, ConfigError> {
        // No row depends on these.
        for key in ["name", "runs", "shard_runs", "rare_event"] {
            study.remove(key);
        }
        let mut digest = Sha256::new();
        for table in [&study, &self.scenario, &self.vehicle] {
            digest.update(table.to_string());
            digest.update([0]);
        }
        if let Some(map) = self.scenario.get("terrain").and_then(|t| t.get("heightmap"))
            && let Some(file) = map.get("file").and_then(Toml::as_str)
        {
            let file = self.scenario_file.parent().unwrap_or(Path::new("")).join(file);
            digest.update(std::fs::read(&file).map_err(|e| unreadable(&file, &e))?);
        }
        Ok(hexadecimal(&digest.finalize()))
    }
}

/// Half the draws are below.
fn in_the_middle(parameter: &Parameter) -> Draw<'_> {
    (parameter, parameter.distribution.quantile(0.5))
}

fn unreadable(file: &Path, error: &std::io::Error) -> ConfigError {
    ConfigError::Unreadable { file: file.to_owned(), reason: error.to_string() }
}

fn read_text(file: &Path) -> Result<String, ConfigError> {
    std::fs::read_to_string(file).map_err(|error| unreadable(file, &error))
}

/// `[case]`: columns of the contact state that every run has unless it draws them.
fn read_case(root: &Section, kind: Kind) -> Result<Vec<(usize, f64)>, ConfigError> {
    if kind == Kind::Landing && root.has("case") {
        return Err(root.error("case", "is for kind \"touchdown\""));
    }
    let s = root.optional_section("case")?;
    let mut case = Vec::new();
    for (index, (column, limit)) in COLUMNS.into_iter().enumerate() {
        if s.has(column) {
            case.push((index, s.number(column, case_unit(column), limit)?));
        }
    }
    s.finish()?;
    Ok(case)
}
