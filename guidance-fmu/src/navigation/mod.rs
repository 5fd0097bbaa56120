//! What guidance takes for true: its inputs as they are where navigation is perfect, or else a
//! filter's estimate from raw readings.
//!
//! The filter is an error-state extended Kalman filter with a multiplicative attitude error
//! (G.50 to G.59): [`nominal`] is what it estimates, [`filter`] propagates and updates, [`sensors`]
//! predicts what each sensor reads, [`navigator`] feeds samples as they arrive.

mod filter;
mod inputs;
mod navigator;
pub mod nominal;
mod sensors;
#[cfg(test)]
mod sensors_tests;
mod start;

use lander_models::ModelError;
use lander_models::frames::Attitude;
use lander_models::mass::MassProperties;
use lander_models::scenario::PerSensor;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub use filter::{Filter, Update};
pub use inputs::{ImuSample, Inputs};
pub use navigator::{Actuation, Estimator, Navigator};

/// The navigation solution with nominal mass properties at the mass taken for true.
#[derive(Clone, Copy, Debug)]
pub struct Navigation {
    /// Of the centre of mass: the point that obeys the planner's equations.
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    /// Non-gravitational acceleration, mean of the last step or IMU period; `None` while unknown.
    pub specific_force_b: Option<Vector3<f64>>,
    pub mass: MassProperties,
    /// Of the structural origin O above the ground below it.
    pub altimeter_m: f64,
    pub any_foot_down: bool,
}

impl Navigation {
    pub fn new(vehicle: &Vehicle, solution: &Solution, any_foot_down: bool) -> Self {
        let Solution { position_w, velocity_w, attitude_wb, rate_b, .. } = *solution;
        let propellant_kg = (solution.mass_kg - vehicle.mass.dry.mass_kg).max(0.0);
        let mass = vehicle.mass.at(propellant_kg);
        Self {
            position_w: position_w + attitude_wb * mass.com_b,
            velocity_w: velocity_w + attitude_wb * rate_b.cross(&mass.com_b),
            attitude_wb,
            rate_b,
            specific_force_b: solution.specific_force_b,
            mass,
            altimeter_m: solution.height_m,
            any_foot_down,
        }
    }

    /// Perfect navigation from the flat input slice, in table order. An attitude that is no
    /// rotation is refused.
    #[cfg(test)]
    pub fn read(vehicle: &Vehicle, inputs: &[f64]) -> Result<Self, ModelError> {
        let inputs = Inputs::read(inputs);
        Ok(Self::new(vehicle, &Solution::perfect(&inputs)?, inputs.any_foot_down))
    }
}

/// What is taken for true of the structural origin O, and how well it is known.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Solution {
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    /// Above the ground below.
    pub height_m: f64,
    pub mass_kg: f64,
    /// Non-gravitational acceleration, mean of the last step or IMU period; `None` while unknown.
    pub specific_force_b: Option<Vector3<f64>>,
    pub gyro_bias_b: Vector3<f64>,
    pub accelerometer_bias_b: Vector3<f64>,
    pub sigma: Sigma,
    /// Samples that the innovation gate refused.
    pub rejected: PerSensor<f64>,
}

/// Standard deviations; zero where navigation is perfect.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Sigma {
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    /// Of the turn about each body axis, rad.
    pub attitude_b: Vector3<f64>,
    pub gyro_bias_b: Vector3<f64>,
    pub accelerometer_bias_b: Vector3<f64>,
    pub height_m: f64,
}

impl Solution {
    /// The inputs as they are.
    pub fn perfect(inputs: &Inputs) -> Result<Self, ModelError> {
        Ok(Self {
            position_w: inputs.position_w,
            velocity_w: inputs.velocity_w,
            attitude_wb: inputs.attitude_wb()?,
            rate_b: inputs.rate_b,
            height_m: inputs.altimeter_m,
            mass_kg: inputs.mass_kg,
            specific_force_b: Some(inputs.specific_force_b),
            ..Self::default()
        })
    }
}
