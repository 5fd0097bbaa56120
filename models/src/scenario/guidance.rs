//! What guidance is asked to do: `[guidance]` of a scenario.

use nalgebra::Vector3;

use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;
use crate::vehicle::{LandmarkSpec, Vehicle};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuidanceMode {
    /// Fly from the initial state to the target and land.
    Descent,
    /// Lift off first.
    Hop,
    /// No command at all: a drop.
    Off,
}

/// What guidance is asked to do, and its tuning. Nothing in it describes the dispersed truth.
#[derive(Clone, Debug)]
pub struct Guidance {
    pub mode: GuidanceMode,
    pub target_w: Vector3<f64>,
    /// Whether the target was chosen on the map that the landmarks are on.
    pub target_on_map: bool,
    /// Limit of the planned thrust direction against the vertical.
    pub tilt_max_rad: f64,
    /// Planned thrust band, inside the engine's so that tracking has margin.
    pub plan_thrust_min_n: f64,
    pub plan_thrust_max_n: f64,
    pub replan_period: Ticks,
    /// Whether the engine's errors are estimated and taken out of the commands.
    pub compensation: bool,
    /// Whether a plan's path is followed; else its thrust is flown as planned, without feedback.
    pub tracking: bool,
    /// Whether the plan ends at the gate and the terminal law lands; else it ends at cut-off.
    pub terminal_law: bool,
    /// Whether failures are looked for and answered.
    pub fault_response: bool,
    /// Height of O above the target at which the plan ends and the terminal law begins.
    pub gate_height_m: f64,
    /// Planned deceleration of the vertical terminal descent.
    pub terminal_deceleration_m_s2: f64,
    /// Height of O above the ground at cut-off.
    pub cutoff_height_m: f64,
    /// Downward speed at cut-off, once thrust has decayed.
    pub cutoff_speed_m_s: f64,
    /// Height of O above the ground at which a hop starts its plan.
    pub lift_off_height_m: f64,
}

impl Guidance {
    /// Deviations of the landmarks' map, by axis, from the world in which the target is. A target
    /// chosen on that map shares its offset, which then moves the site and no landing on it.
    pub fn map_bias_w(&self, landmark: &LandmarkSpec) -> Vector3<f64> {
        if self.target_on_map { Vector3::zeros() } else { landmark.bias_w }
    }
}

pub(super) fn read(root: &Section, vehicle: &Vehicle) -> Result<Guidance, ConfigError> {
    let s = root.section("guidance")?;
    let mode = match s.choice("mode", &["descent", "hop", "off"])? {
        "hop" => GuidanceMode::Hop,
        "off" => GuidanceMode::Off,
        _ => GuidanceMode::Descent,
    };
    let (floor_n, ceiling_n) = (vehicle.engine.thrust_min_n, vehicle.engine.thrust_max_n);
    let plan_thrust_max_n =
        s.number_or("plan_thrust_max", "N", Limit::Within(floor_n, ceiling_n), 2500.0)?;
    let replan_s = s.number_or("replan_period", "s", Limit::Within(0.1, 60.0), 0.5)?;
    let guidance = Guidance {
        mode,
        target_w: s.vector("target_w", "m", Limit::Any)?.into(),
        target_on_map: s.choice("target_on", &["ground", "map"])? == "map",
        tilt_max_rad: s.number_or("tilt_max", "deg", Limit::Within(1.0, 80.0), 29.0)?.to_radians(),
        plan_thrust_min_n: s.number_or(
            "plan_thrust_min",
            "N",
            Limit::Within(floor_n, plan_thrust_max_n),
            1.125 * floor_n,
        )?,
        plan_thrust_max_n,
        compensation: s.choice("compensation", &["on", "off"])? == "on",
        tracking: s.choice("tracking", &["on", "off"])? == "on",
        terminal_law: s.choice("terminal_law", &["on", "off"])? == "on",
        fault_response: s.choice("fault_response", &["on", "off"])? == "on",
        replan_period: Ticks::from_seconds(replan_s)
            .map_err(|error| s.error("replan_period", error.to_string()))?,
        gate_height_m: s.number_or("gate_height", "m", Limit::Positive, 12.0)?,
        terminal_deceleration_m_s2: s.number_or(
            "terminal_deceleration",
            "m/s2",
            Limit::Positive,
            3.0,
        )?,
        cutoff_height_m: s.number_or("cutoff_height", "m", Limit::Positive, 0.45)?,
        cutoff_speed_m_s: s.number_or("cutoff_speed", "m/s", Limit::NotNegative, 0.3)?,
        lift_off_height_m: s.number_or("lift_off_height", "m", Limit::Positive, 3.0)?,
    };
    s.finish()?;
    Ok(guidance)
}
