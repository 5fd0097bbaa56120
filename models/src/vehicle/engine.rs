//! Main engine: `[engine]` of a vehicle.

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};

/// Main engine on a two-axis gimbal.
#[derive(Clone, Debug)]
pub struct Engine {
    pub thrust_min_n: f64,
    pub thrust_max_n: f64,
    /// Below this command combustion is not sustained.
    pub dead_zone_n: f64,
    pub isp_s: f64,
    /// First-order lag from command to thrust.
    pub thrust_lag_s: f64,
    pub gimbal_limit_rad: f64,
    pub gimbal_rate_rad_s: f64,
    /// First-order lag from gimbal command to angle, within the rate limit.
    pub gimbal_lag_s: f64,
    /// Gimbal pivot from O.
    pub pivot_b: Vector3<f64>,
    pub nozzle_exit_radius_m: f64,
    /// Height of the nozzle exit above the footpad plane.
    pub nozzle_exit_height_m: f64,
}

pub(super) fn read(root: &Section) -> Result<Engine, ConfigError> {
    let s = root.section("engine")?;
    let thrust_max_n = s.number("thrust_max", "N", Limit::Positive)?;
    let thrust_min_n = s.number("thrust_min", "N", Limit::Within(0.0, thrust_max_n))?;
    let engine = Engine {
        thrust_min_n,
        thrust_max_n,
        dead_zone_n: s.number("dead_zone", "N", Limit::Within(0.0, thrust_min_n))?,
        isp_s: s.number("specific_impulse", "s", Limit::Positive)?,
        thrust_lag_s: s.number("thrust_lag", "s", Limit::Positive)?,
        gimbal_limit_rad: s.number("gimbal_limit", "deg", Limit::Within(0.0, 45.0))?.to_radians(),
        gimbal_rate_rad_s: s.number("gimbal_rate", "deg/s", Limit::Positive)?.to_radians(),
        gimbal_lag_s: s.number("gimbal_lag", "s", Limit::Positive)?,
        pivot_b: s.vector("gimbal_pivot_b", "m", Limit::Any)?.into(),
        nozzle_exit_radius_m: s.number("nozzle_exit_radius", "m", Limit::Positive)?,
        nozzle_exit_height_m: s.number("nozzle_exit_height", "m", Limit::Positive)?,
    };
    s.finish()?;
    Ok(engine)
}
