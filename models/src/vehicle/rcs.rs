//! Attitude thrusters: `[rcs]` of a vehicle.

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};

/// Attitude thrusters, as torque about each body axis.
#[derive(Clone, Debug)]
pub struct Rcs {
    pub torque_max_b: Vector3<f64>,
    pub lever_arm_m: f64,
    pub isp_s: f64,
}

pub(super) fn read(root: &Section) -> Result<Rcs, ConfigError> {
    let s = root.section("rcs")?;
    let rcs = Rcs {
        torque_max_b: s.vector("torque_max_b", "N.m", Limit::NotNegative)?.into(),
        lever_arm_m: s.number("lever_arm", "m", Limit::Positive)?,
        isp_s: s.number("specific_impulse", "s", Limit::Positive)?,
    };
    s.finish()?;
    Ok(rcs)
}
