//! The scenario file: site, initial state, terrain, guidance settings, touchdown limits.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use crate::frames::{Attitude, attitude_from_roll_pitch_yaw_deg};
use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;
use crate::vehicle::Vehicle;

#[derive(Clone, Debug)]
pub struct Scenario {
    pub name: String,
    pub gravity_m_s2: f64,
    pub terrain: Terrain,
    pub initial: Initial,
    pub ignition: Ignition,
    pub guidance: Guidance,
    pub touchdown: TouchdownLimits,
    pub stop_time: Ticks,
}

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

#[derive(Clone, Debug)]
pub struct Initial {
    /// Of the structural origin O.
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    pub propellant_kg: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ignition {
    Nominal,
    /// The engine never lights, whatever is commanded.
    Never,
}

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
    /// Limit of the planned thrust direction against the vertical.
    pub tilt_max_rad: f64,
    /// Planned thrust band, inside the engine's so that tracking has margin.
    pub plan_thrust_min_n: f64,
    pub plan_thrust_max_n: f64,
    pub replan_period: Ticks,
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

/// Where the verdict draws its lines.
#[derive(Clone, Debug)]
pub struct TouchdownLimits {
    pub crash_speed_m_s: f64,
    pub slide_limit_m: f64,
}

impl Scenario {
    /// Reads a scenario and the vehicle that it names (relative to the scenario's folder).
    pub fn load(file: &Path) -> Result<(Self, Vehicle), ConfigError> {
        let root = Section::read(file, false)?;
        let named = PathBuf::from(root.text("vehicle")?);
        let vehicle = Vehicle::load(&file.parent().unwrap_or(Path::new("")).join(named))?;
        Ok((Self::from_section(root, &vehicle)?, vehicle))
    }

    /// As `load`, from text in memory, with the vehicle given.
    pub fn parse(file: &Path, text: &str, vehicle: &Vehicle) -> Result<Self, ConfigError> {
        Self::from_section(Section::parse(file, text, false)?, vehicle)
    }

    fn from_section(root: Section, vehicle: &Vehicle) -> Result<Self, ConfigError> {
        root.text("vehicle")?;
        let site = root.section("site")?;
        let run = root.section("run")?;
        let engine = root.optional_section("engine")?;
        let stop_s = run.number("stop_time", "s", Limit::Within(0.001, 1e6))?;
        let scenario = Self {
            name: root.text("name")?,
            gravity_m_s2: site.number("gravity", "m/s2", Limit::Positive)?,
            terrain: read_terrain(&root)?,
            initial: read_initial(&root, vehicle)?,
            ignition: match engine.choice("ignition", &["nominal", "never"])? {
                "never" => Ignition::Never,
                _ => Ignition::Nominal,
            },
            guidance: read_guidance(&root, vehicle)?,
            touchdown: read_touchdown(&root)?,
            stop_time: Ticks::from_seconds(stop_s)
                .map_err(|error| run.error("stop_time", error.to_string()))?,
        };
        for section in [site, run, engine] {
            section.finish()?;
        }
        root.finish()?;
        Ok(scenario)
    }
}

fn read_terrain(root: &Section) -> Result<Terrain, ConfigError> {
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

fn read_initial(root: &Section, vehicle: &Vehicle) -> Result<Initial, ConfigError> {
    let s = root.section("initial")?;
    let capacity_kg = vehicle.mass.propellant.capacity_kg;
    let initial = Initial {
        position_w: s.vector("position_w", "m", Limit::Any)?.into(),
        velocity_w: s.vector("velocity_w", "m/s", Limit::Any)?.into(),
        attitude_wb: attitude_from_roll_pitch_yaw_deg(s.vector(
            "roll_pitch_yaw",
            "deg",
            Limit::Within(-180.0, 180.0),
        )?),
        rate_b: Vector3::from(s.vector("rate_b", "deg/s", Limit::Any)?).map(f64::to_radians),
        propellant_kg: s.number("propellant", "kg", Limit::Within(0.0, capacity_kg))?,
    };
    s.finish()?;
    Ok(initial)
}

fn read_guidance(root: &Section, vehicle: &Vehicle) -> Result<Guidance, ConfigError> {
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
        tilt_max_rad: s.number_or("tilt_max", "deg", Limit::Within(1.0, 80.0), 29.0)?.to_radians(),
        plan_thrust_min_n: s.number_or(
            "plan_thrust_min",
            "N",
            Limit::Within(floor_n, plan_thrust_max_n),
            900.0,
        )?,
        plan_thrust_max_n,
        replan_period: Ticks::from_seconds(replan_s)
            .map_err(|error| s.error("replan_period", error.to_string()))?,
        gate_height_m: s.number_or("gate_height", "m", Limit::Positive, 12.0)?,
        terminal_deceleration_m_s2: s.number_or(
            "terminal_deceleration",
            "m/s2",
            Limit::Positive,
            3.0,
        )?,
        cutoff_height_m: s.number_or("cutoff_height", "m", Limit::Positive, 0.6)?,
        cutoff_speed_m_s: s.number_or("cutoff_speed", "m/s", Limit::NotNegative, 0.3)?,
        lift_off_height_m: s.number_or("lift_off_height", "m", Limit::Positive, 3.0)?,
    };
    s.finish()?;
    Ok(guidance)
}

fn read_touchdown(root: &Section) -> Result<TouchdownLimits, ConfigError> {
    let s = root.section("touchdown")?;
    let limits = TouchdownLimits {
        crash_speed_m_s: s.number("crash_speed", "m/s", Limit::Positive)?,
        slide_limit_m: s.number("slide_limit", "m", Limit::Positive)?,
    };
    s.finish()?;
    Ok(limits)
}
