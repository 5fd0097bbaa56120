//! What guidance knows about the vehicle now: its inputs, in physical terms.

use lander_models::ModelError;
use lander_models::frames::{Attitude, attitude_from_wxyz};
use lander_models::mass::MassProperties;
use lander_models::signals::{ATTITUDE_WB, FOOT_SLOTS, GUIDANCE};
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;

/// The navigation solution with nominal mass properties at the measured mass.
#[derive(Clone, Copy, Debug)]
pub struct Navigation {
    /// Of the centre of mass: the point that obeys the planner's equations.
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
    pub rate_b: Vector3<f64>,
    /// Non-gravitational acceleration of the centre of mass, mean of the last step.
    pub specific_force_b: Vector3<f64>,
    pub mass: MassProperties,
    /// Of the structural origin O above the ground below it.
    pub altimeter_m: f64,
    pub any_foot_down: bool,
}

impl Navigation {
    /// From the flat input slice, in table order. An attitude that is no rotation is refused.
    pub fn read(vehicle: &Vehicle, inputs: &[f64]) -> Result<Self, ModelError> {
        let mut reader = Reader { inputs, at: 0 };
        let origin_w: Vector3<f64> = reader.take::<3>().into();
        let origin_velocity_w: Vector3<f64> = reader.take::<3>().into();
        let quaternion: [f64; 4] = reader.take();
        let norm = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
        // Wider than any sensor's rounding, far from a quaternion that was never connected.
        if (norm - 1.0).abs() > 1e-3 {
            return Err(ModelError::NotAUnit { name: ATTITUDE_WB.name, norm });
        }
        let attitude_wb = attitude_from_wxyz(quaternion);
        let rate_b: Vector3<f64> = reader.take::<3>().into();
        let specific_force_b: Vector3<f64> = reader.take::<3>().into();
        let [mass_kg] = reader.take();
        let [altimeter_m] = reader.take();
        let feet: [f64; FOOT_SLOTS] = reader.take();
        debug_assert_eq!(reader.at, GUIDANCE.input_len());

        let propellant_kg = (mass_kg - vehicle.mass.dry.mass_kg).max(0.0);
        let mass = vehicle.mass.at(propellant_kg);
        Ok(Self {
            position_w: origin_w + attitude_wb * mass.com_b,
            velocity_w: origin_velocity_w + attitude_wb * rate_b.cross(&mass.com_b),
            attitude_wb,
            rate_b,
            specific_force_b,
            mass,
            altimeter_m,
            any_foot_down: feet.iter().any(|down| *down > 0.5),
        })
    }
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
