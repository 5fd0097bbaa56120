//! The ground: `[terrain]` of a scenario.

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};

/// A plane through the target.
#[derive(Clone, Debug)]
pub struct Terrain {
    pub slope_rad: f64,
    /// Direction in which the slope falls, from world x towards world y.
    pub downhill_rad: f64,
    pub friction: f64,
    /// Pads held sideways where they touch, as by a rock or a rut. They may still lift off.
    pub pads_captured: bool,
}

impl Terrain {
    /// Unit normal of the plane, world frame.
    pub fn normal_w(&self) -> Vector3<f64> {
        let (sin, cos) = self.slope_rad.sin_cos();
        Vector3::new(sin * self.downhill_rad.cos(), sin * self.downhill_rad.sin(), cos)
    }
}

pub(super) fn read(root: &Section) -> Result<Terrain, ConfigError> {
    let s = root.section("terrain")?;
    let terrain = Terrain {
        slope_rad: s.number_or("slope", "deg", Limit::Within(0.0, 45.0), 0.0)?.to_radians(),
        downhill_rad: s.number_or("downhill_azimuth", "deg", Limit::Any, 0.0)?.to_radians(),
        friction: s.number("friction", "1", Limit::Within(0.0, 2.0))?,
        pads_captured: s.choice("pads", &["sliding", "captured"])? == "captured",
    };
    s.finish()?;
    Ok(terrain)
}
