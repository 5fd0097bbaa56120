//! What may strike the ground: `[hull]` of a vehicle.

use crate::quantity::{ConfigError, Limit, Section};

/// What may strike the ground besides the feet: a cylinder on the vehicle's axis.
#[derive(Clone, Debug)]
pub struct Hull {
    pub radius_m: f64,
    pub bottom_height_m: f64,
    pub top_height_m: f64,
}

pub(super) fn read(root: &Section) -> Result<Hull, ConfigError> {
    let s = root.section("hull")?;
    let top_height_m = s.number("top_height", "m", Limit::Positive)?;
    let hull = Hull {
        radius_m: s.number("radius", "m", Limit::Positive)?,
        bottom_height_m: s.number("bottom_height", "m", Limit::Within(0.0, top_height_m))?,
        top_height_m,
    };
    s.finish()?;
    Ok(hull)
}
