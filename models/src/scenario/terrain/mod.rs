//! The ground: `[terrain]` of a scenario.

mod fields;
mod heightmap;
mod soil;

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};

pub use fields::{Craters, RockLaw, Rocks};
pub use heightmap::Heightmap;
pub use soil::Soil;

/// A plane through the world origin, and what lies on it.
#[derive(Clone, Debug)]
pub struct Terrain {
    pub slope_rad: f64,
    /// Direction in which the slope falls, from world x towards world y.
    pub downhill_rad: f64,
    pub friction: f64,
    /// Pads held sideways where they touch, as by a rock or a rut. They may still lift off.
    pub pads_captured: bool,
    /// Of the random fields. Not the run's: a campaign varies its runs over one terrain.
    pub seed: u64,
    pub craters: Option<Craters>,
    pub rocks: Option<Rocks>,
    pub heightmap: Option<Heightmap>,
    /// Absent: hard ground.
    pub soil: Option<Soil>,
}

impl Terrain {
    /// Unit normal of the plane, world frame.
    pub fn normal_w(&self) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.slope_rad);
        Vector3::new(sin * libm::cos(self.downhill_rad), sin * libm::sin(self.downhill_rad), cos)
    }
}

pub(super) fn read(root: &Section) -> Result<Terrain, ConfigError> {
    let s = root.section("terrain")?;
    let terrain = Terrain {
        slope_rad: s.number_or("slope", "deg", Limit::Within(0.0, 45.0), 0.0)?.to_radians(),
        downhill_rad: s.number_or("downhill_azimuth", "deg", Limit::Any, 0.0)?.to_radians(),
        friction: s.number("friction", "1", Limit::Within(0.0, 2.0))?,
        pads_captured: s.choice("pads", &["sliding", "captured"])? == "captured",
        // Whole numbers up to 2^53 are exact in a file's f64.
        seed: s.number_or("seed", "1", Limit::Within(0.0, 9.007e15), 0.0)? as u64,
        craters: optional(&s, "craters", fields::read_craters)?,
        rocks: optional(&s, "rocks", fields::read_rocks)?,
        heightmap: optional(&s, "heightmap", heightmap::read)?,
        soil: optional(&s, "soil", soil::read)?,
    };
    s.finish()?;
    Ok(terrain)
}

/// What a sub-table describes, if it is there.
fn optional<T>(
    s: &Section,
    key: &str,
    read: impl Fn(&Section) -> Result<T, ConfigError>,
) -> Result<Option<T>, ConfigError> {
    if !s.has(key) {
        return Ok(None);
    }
    let table = s.section(key)?;
    let value = read(&table)?;
    table.finish()?;
    Ok(Some(value))
}
