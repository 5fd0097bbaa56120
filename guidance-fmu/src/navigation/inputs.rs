//! The flat input slice in physical terms.

use lander_models::ModelError;
use lander_models::frames::{Attitude, attitude_from_wxyz};
use lander_models::scenario::PerSensor;
use lander_models::signals::{
    ATTITUDE_WB, FOOT_SLOTS, GUIDANCE, SENSOR_SLOTS, STAR_TRACKER_ATTITUDE_WB,
};
use nalgebra::Vector3;

/// One step's inputs. Of the first group, a filter may use the leg probes alone.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    attitude_wxyz: [f64; 4],
    pub rate_b: Vector3<f64>,
    /// Non-gravitational acceleration of the centre of mass, mean of the last step.
    pub specific_force_b: Vector3<f64>,
    pub mass_kg: f64,
    pub altimeter_m: f64,
    pub any_foot_down: bool,

    /// Of the IMU's mounting.
    pub imu: ImuSample,
    pub altimeter_range_m: f64,
    pub velocimeter_b: Vector3<f64>,
    star_tracker_wxyz: [f64; 4],
    pub landmark_w: Vector3<f64>,
    pub valid: PerSensor<bool>,
    /// That arrived so far.
    pub samples: PerSensor<f64>,
    /// Commands get through.
    pub computer_up: bool,
}

/// Means over one period of the IMU.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImuSample {
    pub specific_force_b: Vector3<f64>,
    pub rate_b: Vector3<f64>,
}

impl Inputs {
    /// From the flat slice, in table order.
    pub fn read(inputs: &[f64]) -> Self {
        let mut reader = Reader { inputs, at: 0 };
        let position_w = reader.take::<3>().into();
        let velocity_w = reader.take::<3>().into();
        let attitude_wxyz = reader.take();
        let rate_b = reader.take::<3>().into();
        let true_force_b = reader.take::<3>().into();
        let [mass_kg] = reader.take();
        let [altimeter_m] = reader.take();
        let feet: [f64; FOOT_SLOTS] = reader.take();
        let specific_force_b = reader.take::<3>().into();
        let imu = ImuSample { specific_force_b, rate_b: reader.take::<3>().into() };
        let [altimeter_range_m] = reader.take();
        let velocimeter_b = reader.take::<3>().into();
        let star_tracker_wxyz = reader.take();
        let landmark_w = reader.take::<3>().into();
        let valid: [f64; SENSOR_SLOTS] = reader.take();
        let samples = reader.take();
        let [computer_up] = reader.take();
        debug_assert_eq!(reader.at, GUIDANCE.input_len());
        Self {
            position_w,
            velocity_w,
            attitude_wxyz,
            rate_b,
            specific_force_b: true_force_b,
            mass_kg,
            altimeter_m,
            any_foot_down: feet.iter().any(|down| *down > 0.5),
            imu,
            altimeter_range_m,
            velocimeter_b,
            star_tracker_wxyz,
            landmark_w,
            valid: PerSensor::from_array(valid.map(|flag| flag > 0.5)),
            samples: PerSensor::from_array(samples),
            computer_up: computer_up > 0.5,
        }
    }

    /// Of perfect navigation. Refused if it is no rotation.
    pub fn attitude_wb(&self) -> Result<Attitude, ModelError> {
        unit(ATTITUDE_WB.name, self.attitude_wxyz)
    }

    /// Refused if it is no rotation.
    pub fn star_tracker_wb(&self) -> Result<Attitude, ModelError> {
        unit(STAR_TRACKER_ATTITUDE_WB.name, self.star_tracker_wxyz)
    }
}

fn unit(name: &'static str, quaternion: [f64; 4]) -> Result<Attitude, ModelError> {
    let norm = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
    // Wider than any sensor's rounding, far from a quaternion that was never connected.
    if (norm - 1.0).abs() > 1e-3 {
        return Err(ModelError::NotAUnit { name, norm });
    }
    Ok(attitude_from_wxyz(quaternion))
}

struct Reader<'a> {
    inputs: &'a [f64],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [f64; N] {
        let from = self.at;
        self.at += N;
        std::array::from_fn(|n| self.inputs[from + n])
    }
}
