//! Whether propellant sloshes: `[slosh]` of a scenario.

use crate::quantity::{ConfigError, Section};
use crate::vehicle::Vehicle;

pub(super) fn read(root: &Section, vehicle: &Vehicle) -> Result<bool, ConfigError> {
    let s = root.optional_section("slosh")?;
    let active = s.choice("active", &["off", "on"])? == "on";
    if active && vehicle.slosh.is_none() {
        let reason = format!("is \"on\", but vehicle {} has no [slosh]", vehicle.name);
        return Err(s.error("active", reason));
    }
    s.finish()?;
    Ok(active)
}
