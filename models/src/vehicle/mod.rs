//! The vehicle file: every number with unit, source and grade.

mod base;
mod curve;
mod engine;
mod gear;
mod hull;
mod mass;
mod rcs;
mod sensors;
mod slosh;

use std::path::Path;

use toml::Table;

pub use curve::Curve;
pub use engine::{DeadZone, Engine};
pub use gear::{Gear, Lateral, Leg, Strut};
pub use hull::Hull;
pub use rcs::Rcs;
pub use sensors::{
    AltimeterSpec, ImuSpec, LandmarkSpec, LegProbeSpec, Sensors, StarTrackerSpec, TriadSpec,
    VelocimeterSpec,
};
pub use slosh::{MAX_TANKS, Slosh};

use crate::mass::MassModel;
use crate::quantity::{ConfigError, Limit, Section, parse_table, read_table};

/// Standard gravity of the I_sp definition, m/s² (CGPM 1901).
pub const G0_M_S2: f64 = 9.80665;

#[derive(Clone, Debug)]
pub struct Vehicle {
    pub name: String,
    /// Lowest and highest that the centre of mass may stand above O, of a vehicle of which it is not known;
    /// `mass` then has one in between.
    pub com_height_range_m: Option<[f64; 2]>,
    pub mass: MassModel,
    pub engine: Engine,
    pub rcs: Rcs,
    pub gear: Gear,
    pub hull: Hull,
    pub slosh: Option<Slosh>,
    /// `None`: the file says nothing about sensors, so only perfect navigation can be flown.
    pub sensors: Option<Sensors>,
}

impl Vehicle {
    pub fn load(file: &Path) -> Result<Self, ConfigError> {
        Self::of(file, Self::table(file)?)
    }

    /// What `file` and those it is based on say.
    pub fn table(file: &Path) -> Result<Table, ConfigError> {
        base::resolve(file, read_table(file)?)
    }

    /// Parses `text`; `file` names it in errors, and a base is looked for beside it.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ConfigError> {
        Self::of(file, base::resolve(file, parse_table(file, text)?)?)
    }

    /// As `load`, from a table in memory; `file` only names it in errors.
    pub fn of(file: &Path, table: Table) -> Result<Self, ConfigError> {
        Self::from_section(Section::of(file, table, true))
    }

    fn from_section(root: Section) -> Result<Self, ConfigError> {
        let mass = mass::read(&root)?;
        let vehicle = Self {
            name: root.text("name")?,
            com_height_range_m: read_com_height_range(&root, &mass)?,
            gear: gear::read(&root, &mass)?,
            slosh: slosh::read(&root, &mass)?,
            mass,
            engine: engine::read(&root)?,
            rcs: rcs::read(&root)?,
            hull: hull::read(&root)?,
            sensors: sensors::read(&root)?,
        };
        root.finish()?;
        Ok(vehicle)
    }
}

fn read_com_height_range(
    root: &Section,
    mass: &MassModel,
) -> Result<Option<[f64; 2]>, ConfigError> {
    const KEY: &str = "com_height_range";
    if !root.has(KEY) {
        return Ok(None);
    }
    let [low_m, high_m] = root.vector(KEY, "m", Limit::Positive)?;
    let height_m = mass.dry.com_b.z;
    if !(low_m..=high_m).contains(&height_m) {
        let need = format!("must hold the height in mass.dry_com_b, {height_m} m");
        return Err(root.error(KEY, format!("is {low_m} to {high_m} m, {need}")));
    }
    Ok(Some([low_m, high_m]))
}
