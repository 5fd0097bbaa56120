//! Attitude thrusters: `[rcs]` of a vehicle.

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;

/// Attitude thrusters: a pair for each sense of each body axis, as torque about it.
#[derive(Clone, Debug)]
pub struct Rcs {
    pub torque_max_b: Vector3<f64>,
    pub lever_arm_m: f64,
    pub isp_s: f64,
    /// Shortest firing of thrusters that are on or off; without it torque follows the command
    /// (ideal).
    pub min_pulse: Option<Ticks>,
}

pub(super) fn read(root: &Section) -> Result<Rcs, ConfigError> {
    let s = root.section("rcs")?;
    let pulsed = s.choice("mode", &["ideal", "pulsed"])? == "pulsed";
    // Read in either mode, so that a vehicle may state it and fly ideal.
    let min_pulse = (pulsed || s.has("min_pulse"))
        .then(|| s.ticks("min_pulse", Limit::Within(0.001, 10.0)))
        .transpose()?;
    let rcs = Rcs {
        torque_max_b: s.vector("torque_max_b", "N.m", Limit::NotNegative)?.into(),
        lever_arm_m: s.number("lever_arm", "m", Limit::Positive)?,
        isp_s: s.number("specific_impulse", "s", Limit::Positive)?,
        min_pulse: min_pulse.filter(|_| pulsed),
    };
    s.finish()?;
    Ok(rcs)
}
