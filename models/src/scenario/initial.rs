//! The state at t = 0: `[initial]` of a scenario.

use nalgebra::Vector3;

use crate::frames::{Attitude, attitude_from_roll_pitch_yaw_deg};
use crate::quantity::{ConfigError, Limit, Section};
use crate::vehicle::Vehicle;

#[derive(Clone, Debug)]
pub struct Initial {
    /// Of the structural origin O.
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    pub propellant_kg: f64,
}

pub(super) fn read(root: &Section, vehicle: &Vehicle) -> Result<Initial, ConfigError> {
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
