//! What the filter estimates, and the place of each error in its error state.

use lander_models::frames::Attitude;
use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::inputs::ImuSample;

/// Of the IMU's mounting, world frame, m and m/s.
pub const POSITION: usize = 0;
pub const VELOCITY: usize = 3;
/// Turn about body axes, rad: true attitude = estimate ∘ exp(error).
pub const ATTITUDE: usize = 6;
/// Constant or slowly drifting, in body axes unless said otherwise.
pub const GYRO_BIAS: usize = 9;
pub const ACCELEROMETER_BIAS: usize = 12;
pub const GYRO_SCALE: usize = 15;
pub const ACCELEROMETER_SCALE: usize = 18;
/// As a share of nominal gravity.
pub const GRAVITY: usize = 21;
/// Errors from here on don't enter the motion.
pub const MOVING: usize = 22;
/// Star tracker's misalignment, rad.
pub const MISALIGNMENT: usize = 22;
pub const VELOCIMETER_BIAS: usize = 25;
pub const VELOCIMETER_SCALE: usize = 28;
pub const ALTIMETER_BIAS: usize = 31;
pub const ALTIMETER_SCALE: usize = 32;
/// The map's offset, world frame, m.
pub const LANDMARK_BIAS: usize = 33;
/// Rise per run of the ground along world x and y, and its height at the target's place.
pub const SLOPE: usize = 36;
pub const GROUND: usize = 38;
pub const ERRORS: usize = 39;

/// Those of them that are no motion.
const PARAMETERS: usize = ERRORS - GYRO_BIAS;

pub type Errors = SVector<f64, ERRORS>;
pub type Covariance = SMatrix<f64, ERRORS, ERRORS>;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Nominal {
    /// Of the IMU's mounting.
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    /// Biases, scale factors and the like, by their place in the error state.
    parameters: SVector<f64, PARAMETERS>,
}

impl Nominal {
    /// With every parameter zero.
    pub fn new(position_w: Vector3<f64>, velocity_w: Vector3<f64>, attitude_wb: Attitude) -> Self {
        Self { position_w, velocity_w, attitude_wb, parameters: SVector::zeros() }
    }

    pub fn parameter(&self, place: usize) -> f64 {
        self.parameters[place - GYRO_BIAS]
    }

    pub fn parameters3(&self, place: usize) -> Vector3<f64> {
        self.parameters.fixed_rows::<3>(place - GYRO_BIAS).into()
    }

    /// A reading without the errors that are estimated (G.51).
    pub fn corrected(&self, sample: &ImuSample) -> ImuSample {
        let undo = |value: Vector3<f64>, bias, scale| {
            (value - self.parameters3(bias)).component_div(&self.parameters3(scale).add_scalar(1.0))
        };
        ImuSample {
            specific_force_b: undo(
                sample.specific_force_b,
                ACCELEROMETER_BIAS,
                ACCELEROMETER_SCALE,
            ),
            rate_b: undo(sample.rate_b, GYRO_BIAS, GYRO_SCALE),
        }
    }

    /// Site gravity.
    pub fn gravity_w(&self, nominal_m_s2: f64) -> Vector3<f64> {
        Vector3::z() * (-nominal_m_s2 * (1.0 + self.parameter(GRAVITY)))
    }

    /// Moved by `duration_s`, which may be negative, under true means (G.50).
    pub fn moved(&self, means: &ImuSample, gravity_m_s2: f64, duration_s: f64) -> Self {
        let turn_b = means.rate_b * duration_s;
        let middle_wb = self.attitude_wb * UnitQuaternion::from_scaled_axis(turn_b * 0.5);
        let acceleration_w = middle_wb * means.specific_force_b + self.gravity_w(gravity_m_s2);
        let velocity_w = self.velocity_w + acceleration_w * duration_s;
        Self {
            position_w: self.position_w + (self.velocity_w + velocity_w) * (0.5 * duration_s),
            velocity_w,
            attitude_wb: self.attitude_wb * UnitQuaternion::from_scaled_axis(turn_b),
            ..*self
        }
    }

    /// Corrected by an estimated error (G.56).
    pub fn plus(&self, error: &Errors) -> Self {
        let part = |place| Vector3::from(error.fixed_rows::<3>(place));
        Self {
            position_w: self.position_w + part(POSITION),
            velocity_w: self.velocity_w + part(VELOCITY),
            attitude_wb: self.attitude_wb * UnitQuaternion::from_scaled_axis(part(ATTITUDE)),
            parameters: self.parameters + error.fixed_rows::<PARAMETERS>(GYRO_BIAS),
        }
    }
}
