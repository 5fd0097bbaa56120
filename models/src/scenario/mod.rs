//! The scenario file: site, initial state, terrain, guidance settings, touchdown limits.

mod contact;
mod disturbances;
mod faults;
mod guidance;
mod initial;
mod navigation;
mod sensors;
mod slosh;
mod terrain;
mod touchdown;

use std::path::{Path, PathBuf};

use toml::Table;

pub use contact::ContactEngine;
pub use disturbances::{Disturbances, Offsets};
pub use faults::*;
pub use guidance::{Guidance, GuidanceMode};
pub use initial::Initial;
pub use navigation::Prior;
pub use sensors::{DropOut, Navigation, PerSensor, Sensing, SensorSettings};
pub use terrain::{Craters, Heightmap, RockLaw, Rocks, Soil, Terrain};
pub use touchdown::TouchdownLimits;

use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;
use crate::vehicle::Vehicle;

#[derive(Clone, Debug)]
pub struct Scenario {
    pub name: String,
    pub gravity_m_s2: f64,
    pub terrain: Terrain,
    pub contact_engine: ContactEngine,
    /// Steps within a tick for each of the contact engine's own.
    pub contact_refinement: u32,
    pub initial: Initial,
    /// The vehicle's propellant sloshes.
    pub slosh_active: bool,
    pub ignition: Ignition,
    pub disturbances: Disturbances,
    pub faults: Faults,
    pub guidance: Guidance,
    /// What the navigation filter knows at the start.
    pub prior: Prior,
    pub touchdown: TouchdownLimits,
    pub sensing: Sensing,
    pub stop_time: Ticks,
    /// Of all random draws: noise, bias, rocks.
    pub seed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ignition {
    Nominal,
    /// The engine never lights, whatever is commanded.
    Never,
}

impl Scenario {
    /// Reads a scenario and the vehicle that it names (relative to the scenario's folder).
    pub fn load(file: &Path) -> Result<(Self, Vehicle), ConfigError> {
        Self::load_changed(file, "")
    }

    /// As `load`, with changes such as `run.seed = 7; initial.velocity_w[1] = -12.5`.
    pub fn load_changed(file: &Path, changes: &str) -> Result<(Self, Vehicle), ConfigError> {
        let root = Section::read_changed(file, changes)?;
        let named = PathBuf::from(root.text("vehicle")?);
        let vehicle = Vehicle::load(&file.parent().unwrap_or(Path::new("")).join(named))?;
        Ok((Self::from_section(root, &vehicle)?, vehicle))
    }

    /// Whether propellant moves in its tanks: asked for, or kicked by a fault.
    pub fn sloshes(&self) -> bool {
        self.slosh_active || self.faults.slosh.is_some()
    }

    /// As `load`, from text in memory, with the vehicle given.
    pub fn parse(file: &Path, text: &str, vehicle: &Vehicle) -> Result<Self, ConfigError> {
        Self::from_section(Section::parse(file, text, false)?, vehicle)
    }

    /// As `load`, from a table in memory, with the vehicle given.
    pub fn of(file: &Path, table: Table, vehicle: &Vehicle) -> Result<Self, ConfigError> {
        Self::from_section(Section::of(file, table, false), vehicle)
    }

    fn from_section(root: Section, vehicle: &Vehicle) -> Result<Self, ConfigError> {
        root.text("vehicle")?;
        let site = root.section("site")?;
        let run = root.section("run")?;
        let engine = root.optional_section("engine")?;
        let stop_s = run.number("stop_time", "s", Limit::Within(0.001, 1e6))?;
        let (contact_engine, contact_refinement) = contact::read(&root)?;
        let scenario = Self {
            name: root.text("name")?,
            gravity_m_s2: site.number("gravity", "m/s2", Limit::Positive)?,
            terrain: terrain::read(&root)?,
            contact_engine,
            contact_refinement,
            initial: initial::read(&root, vehicle)?,
            slosh_active: slosh::read(&root, vehicle)?,
            ignition: match engine.choice("ignition", &["nominal", "never"])? {
                "never" => Ignition::Never,
                _ => Ignition::Nominal,
            },
            disturbances: disturbances::read(&root, vehicle)?,
            faults: faults::read(&root)?,
            guidance: guidance::read(&root, vehicle)?,
            prior: navigation::read(&root)?,
            touchdown: touchdown::read(&root)?,
            sensing: sensors::read(&root, vehicle)?,
            // Whole numbers up to 2^53 are exact in a file's f64.
            seed: run.number_or("seed", "1", Limit::Within(0.0, 9.007e15), 0.0)? as u64,
            stop_time: Ticks::from_seconds(stop_s)
                .map_err(|error| run.error("stop_time", error.to_string()))?,
        };
        if scenario.faults.slosh.is_some() && vehicle.slosh.is_none() {
            let reason = format!("needs tanks, but vehicle {} has no [slosh]", vehicle.name);
            return Err(root.error("faults.slosh", reason));
        }
        for section in [site, run, engine] {
            section.finish()?;
        }
        root.finish()?;
        Ok(scenario)
    }
}
