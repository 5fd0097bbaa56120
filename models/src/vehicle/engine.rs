//! Main engine: `[engine]` of a vehicle.

use nalgebra::Vector3;

use super::curve::{self, Curve};
use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;

/// Main engine on a two-axis gimbal.
#[derive(Clone, Debug)]
pub struct Engine {
    pub thrust_min_n: f64,
    pub thrust_max_n: f64,
    /// Below this command combustion is not sustained.
    pub dead_zone_n: f64,
    pub dead_zone: DeadZone,
    /// Steady thrust in N against the command in N, on the throttle range; the command itself if
    /// there is none.
    pub throttle: Option<Curve>,
    /// Constant, and what guidance plans with.
    pub isp_s: f64,
    /// I_sp in s against thrust as a share of `thrust_max_n`; constant if there is none.
    pub isp_by_throttle: Option<Curve>,
    /// First-order lag from command to thrust.
    pub thrust_lag_s: f64,
    /// From the first command to the first thrust.
    pub ignition_delay: Ticks,
    /// First-order lag of the rise that follows.
    pub ignition_lag_s: f64,
    /// First-order lag of the decay after shut-down.
    pub tail_off_lag_s: f64,
    pub gimbal_limit_rad: f64,
    pub gimbal_rate_rad_s: f64,
    /// First-order lag from gimbal command to angle, within the rate limit.
    pub gimbal_lag_s: f64,
    /// Gimbal pivot from O.
    pub pivot_b: Vector3<f64>,
    pub nozzle_exit_radius_m: f64,
    /// Height of the nozzle exit above the footpad plane.
    pub nozzle_exit_height_m: f64,
    /// Exit area over throat area.
    pub expansion_ratio: f64,
    /// Ratio of specific heats of the exhaust.
    pub heat_capacity_ratio: f64,
}

/// What a command below the dead zone's limit gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeadZone {
    /// Nothing.
    Off,
    /// Combustion that goes out and comes back at random.
    Unstable,
}

pub(super) fn read(root: &Section) -> Result<Engine, ConfigError> {
    let s = root.section("engine")?;
    let thrust_max_n = s.number("thrust_max", "N", Limit::Positive)?;
    let thrust_min_n = s.number("thrust_min", "N", Limit::Within(0.0, thrust_max_n))?;
    let thrust_lag_s = s.number("thrust_lag", "s", Limit::Positive)?;
    let isp_table = curve::read(&s, "specific_impulse_table", "1, s")?;
    let engine = Engine {
        thrust_min_n,
        thrust_max_n,
        dead_zone_n: s.number("dead_zone", "N", Limit::Within(0.0, thrust_min_n))?,
        dead_zone: match s.choice("dead_zone_behaviour", &["off", "unstable"])? {
            "unstable" => DeadZone::Unstable,
            _ => DeadZone::Off,
        },
        throttle: curve::read(&s, "throttle_table", "N, N")?,
        isp_s: s.number("specific_impulse", "s", Limit::Positive)?,
        isp_by_throttle: match s.choice("specific_impulse_model", &["constant", "throttle"])? {
            "throttle" => Some(isp_table.ok_or_else(|| {
                s.error("specific_impulse_model", "\"throttle\" needs a specific_impulse_table")
            })?),
            _ => None,
        },
        thrust_lag_s,
        ignition_delay: s.ticks_or("ignition_delay", Limit::Within(0.0, 60.0), Ticks::ZERO)?,
        ignition_lag_s: s.number_or("ignition_lag", "s", Limit::Positive, thrust_lag_s)?,
        tail_off_lag_s: s.number_or("tail_off_lag", "s", Limit::Positive, thrust_lag_s)?,
        gimbal_limit_rad: s.number("gimbal_limit", "deg", Limit::Within(0.0, 45.0))?.to_radians(),
        gimbal_rate_rad_s: s.number("gimbal_rate", "deg/s", Limit::Positive)?.to_radians(),
        gimbal_lag_s: s.number("gimbal_lag", "s", Limit::Positive)?,
        pivot_b: s.vector("gimbal_pivot_b", "m", Limit::Any)?.into(),
        nozzle_exit_radius_m: s.number("nozzle_exit_radius", "m", Limit::Positive)?,
        nozzle_exit_height_m: s.number("nozzle_exit_height", "m", Limit::Positive)?,
        expansion_ratio: s.number_or("expansion_ratio", "1", Limit::Within(1.5, 1e3), 30.0)?,
        heat_capacity_ratio: s.number_or(
            "heat_capacity_ratio",
            "1",
            Limit::Within(1.05, 1.67),
            1.2,
        )?,
    };
    s.finish()?;
    Ok(engine)
}
