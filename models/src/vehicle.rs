//! The vehicle file: every number with unit, source and grade.

use std::path::Path;

use nalgebra::Vector3;

use crate::mass::{DryMass, MassModel, Propellant};
use crate::quantity::{ConfigError, Limit, Section};
use crate::signals::FOOT_SLOTS;

/// Standard gravity of the I_sp definition, m/s² (CGPM 1901).
pub const G0_M_S2: f64 = 9.80665;

#[derive(Clone, Debug)]
pub struct Vehicle {
    pub name: String,
    pub mass: MassModel,
    pub engine: Engine,
    pub rcs: Rcs,
    pub gear: Gear,
    pub hull: Hull,
}

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

/// Attitude thrusters, as torque about each body axis.
#[derive(Clone, Debug)]
pub struct Rcs {
    pub torque_max_b: Vector3<f64>,
    pub lever_arm_m: f64,
    pub isp_s: f64,
}

/// Landing legs: each foot strokes along one axis against a crushable strut.
#[derive(Clone, Debug)]
pub struct Gear {
    /// Footpad contact points from O, struts uncompressed, counter-clockwise from above.
    pub feet_b: Vec<Vector3<f64>>,
    pub pad_radius_m: f64,
    pub foot_mass_kg: f64,
    /// Elastic stiffness of a strut below its crush load.
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    pub crush_1_n: f64,
    /// Stroke at which the second stage takes over.
    pub stroke_1_m: f64,
    pub crush_2_n: f64,
    /// Stroke at which the strut is bottomed out.
    pub stroke_max_m: f64,
}

/// What may strike the ground besides the feet: a cylinder on the vehicle's axis.
#[derive(Clone, Debug)]
pub struct Hull {
    pub radius_m: f64,
    pub bottom_height_m: f64,
    pub top_height_m: f64,
}

impl Vehicle {
    pub fn load(file: &Path) -> Result<Self, ConfigError> {
        Self::from_section(Section::read(file, true)?)
    }

    /// Parses `text`; `file` only names it in errors.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ConfigError> {
        Self::from_section(Section::parse(file, text, true)?)
    }

    fn from_section(root: Section) -> Result<Self, ConfigError> {
        let mass = read_mass(&root)?;
        let vehicle = Self {
            name: root.text("name")?,
            gear: read_gear(&root, &mass)?,
            mass,
            engine: read_engine(&root)?,
            rcs: read_rcs(&root)?,
            hull: read_hull(&root)?,
        };
        // Numbers the paper prints but the models derive; `tests/paper.rs` holds one against the other.
        root.optional_section("as_printed")?;
        root.finish()?;
        Ok(vehicle)
    }
}

fn read_mass(root: &Section) -> Result<MassModel, ConfigError> {
    let s = root.section("mass")?;
    let model = MassModel {
        dry: DryMass {
            mass_kg: s.number("dry_mass", "kg", Limit::Positive)?,
            com_b: s.vector("dry_com_b", "m", Limit::Any)?.into(),
            inertia_kg_m2: s.vector("dry_inertia_b", "kg.m2", Limit::Positive)?.into(),
        },
        propellant: Propellant {
            capacity_kg: s.number("propellant_mass", "kg", Limit::Positive)?,
            com_b: s.vector("propellant_com_b", "m", Limit::Any)?.into(),
            gyration_radius_b: s
                .vector("propellant_gyration_radius_b", "m", Limit::Positive)?
                .into(),
        },
    };
    s.finish()?;
    Ok(model)
}

fn read_engine(root: &Section) -> Result<Engine, ConfigError> {
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

fn read_rcs(root: &Section) -> Result<Rcs, ConfigError> {
    let s = root.section("rcs")?;
    let rcs = Rcs {
        torque_max_b: s.vector("torque_max_b", "N.m", Limit::NotNegative)?.into(),
        lever_arm_m: s.number("lever_arm", "m", Limit::Positive)?,
        isp_s: s.number("specific_impulse", "s", Limit::Positive)?,
    };
    s.finish()?;
    Ok(rcs)
}

/// Lightest foot body, kg: at 0.1 kg and 1 ms contact diverges, at 2 kg it is proven.
const FOOT_MASS_MIN_KG: f64 = 0.5;
/// Largest share of the dry yaw inertia that the feet may carry: the rest is the hull body's, and
/// contact needs it well away from zero.
const FOOT_INERTIA_SHARE: f64 = 0.75;

fn read_gear(root: &Section, mass: &MassModel) -> Result<Gear, ConfigError> {
    let s = root.section("gear")?;
    let feet = s.points::<3>("feet_b", "m")?;
    if !(3..=FOOT_SLOTS).contains(&feet.len()) {
        return Err(
            s.error("feet_b", format!("has {} feet, must be 3 to {FOOT_SLOTS}", feet.len()))
        );
    }
    let feet_b: Vec<Vector3<f64>> = feet.into_iter().map(Vector3::from).collect();
    if !is_convex_counter_clockwise(&feet_b) {
        return Err(s.error("feet_b", "must go round the axis once, counter-clockwise from above"));
    }
    let reach_m2: f64 = feet_b.iter().map(|foot_b| foot_b.xy().norm_squared()).sum();
    let foot_mass_max_kg = FOOT_INERTIA_SHARE * mass.dry.inertia_kg_m2.z / reach_m2;
    let stroke_max_m = s.number("stroke_max", "m", Limit::Positive)?;
    let crush_1_n = s.number("crush_load_1", "N", Limit::Positive)?;
    let gear = Gear {
        feet_b,
        pad_radius_m: s.number("pad_radius", "m", Limit::Positive)?,
        foot_mass_kg: s.number(
            "foot_mass",
            "kg",
            Limit::Within(FOOT_MASS_MIN_KG, foot_mass_max_kg),
        )?,
        stiffness_n_m: s.number("stiffness", "N/m", Limit::Positive)?,
        damping_n_s_m: s.number("damping", "N.s/m", Limit::NotNegative)?,
        crush_1_n,
        stroke_1_m: s.number("stroke_1", "m", Limit::Within(0.0, stroke_max_m))?,
        crush_2_n: s.number("crush_load_2", "N", Limit::Within(crush_1_n, f64::MAX))?,
        stroke_max_m,
    };
    s.finish()?;
    Ok(gear)
}

/// Whether the polygon of feet turns left at every foot, once round: tip-over is judged per edge.
fn is_convex_counter_clockwise(feet_b: &[Vector3<f64>]) -> bool {
    let n = feet_b.len();
    let corner = |i: usize| (feet_b[i], feet_b[(i + 1) % n], feet_b[(i + 2) % n]);
    let turns_left = (0..n).all(|i| {
        let (a, b, c) = corner(i);
        (b - a).xy().perp(&(c - b).xy()) > 0.0
    });
    let turned_rad: f64 = (0..n)
        .map(|i| {
            let (a, b, c) = corner(i);
            let (into, out) = ((b - a).xy(), (c - b).xy());
            into.perp(&out).atan2(into.dot(&out))
        })
        .sum();
    // One full turn, not two as in a star.
    turns_left && turned_rad < 3.0 * std::f64::consts::PI
}

fn read_hull(root: &Section) -> Result<Hull, ConfigError> {
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
