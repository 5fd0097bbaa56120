//! What drives the vehicle: engine and attitude thrusters as a force, a torque and a flow.

use lander_models::Vehicle;
use lander_models::scenario::Scenario;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::engine;
use crate::flight::Motion;

/// What was last asked of engine and thrusters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    pub thrust_n: f64,
    pub gimbal_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
}

/// What drives the vehicle during one tick, held constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    pub thrust_target_n: f64,
    pub gimbal_target_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
}

/// Force and torque on the vehicle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wrench {
    pub force_b: Vector3<f64>,
    /// About the centre of mass.
    pub torque_b: Vector3<f64>,
}

impl Command {
    /// From the truth's inputs in the order of the signal table.
    pub fn from_inputs(inputs: &[f64]) -> Self {
        let [thrust_n, gimbal_x, gimbal_y, torque_x, torque_y, torque_z] =
            std::array::from_fn(|n| inputs[n]);
        Self {
            thrust_n,
            gimbal_rad: Vector2::new(gimbal_x, gimbal_y),
            rcs_torque_b: Vector3::new(torque_x, torque_y, torque_z),
        }
    }
}

impl Drive {
    /// What a command makes of engine and thrusters.
    pub fn of(scenario: &Scenario, vehicle: &Vehicle, command: &Command) -> Self {
        let engine = &vehicle.engine;
        Self {
            thrust_target_n: engine::thrust_target_n(engine, scenario.ignition, command.thrust_n),
            gimbal_target_rad: engine::gimbal_target_rad(engine, command.gimbal_rad),
            rcs_torque_b: command
                .rcs_torque_b
                .zip_map(&vehicle.rcs.torque_max_b, |torque, max| torque.clamp(-max, max)),
        }
    }

    /// Thrust and gimbal angles `time_s` into the tick.
    pub fn actuators_after(
        &self,
        vehicle: &Vehicle,
        motion: &Motion,
        time_s: f64,
    ) -> (f64, Vector2<f64>) {
        let engine = &vehicle.engine;
        (
            engine::thrust_after_n(engine, motion.thrust_n, self.thrust_target_n, time_s),
            engine::gimbal_after_rad(engine, motion.gimbal_rad, self.gimbal_target_rad, time_s),
        )
    }

    /// Wrench at this instant. Dry tanks give nothing, whatever the lag still says.
    pub fn wrench(&self, vehicle: &Vehicle, motion: &Motion, com_b: &Vector3<f64>) -> Wrench {
        if motion.propellant_kg <= 0.0 {
            return Wrench::default();
        }
        let force_b = engine::thrust_direction_b(motion.gimbal_rad) * motion.thrust_n;
        let torque_b = (vehicle.engine.pivot_b - com_b).cross(&force_b) + self.rcs_torque_b;
        Wrench { force_b, torque_b }
    }

    /// Propellant flow of engine and thrusters, kg/s (T.7).
    pub fn flow_kg_s(&self, vehicle: &Vehicle, motion: &Motion) -> f64 {
        if motion.propellant_kg <= 0.0 {
            return 0.0;
        }
        let rcs_thrust_n = self.rcs_torque_b.abs().sum() / vehicle.rcs.lever_arm_m;
        engine::flow_kg_s(motion.thrust_n, vehicle.engine.isp_s)
            + engine::flow_kg_s(rcs_thrust_n, vehicle.rcs.isp_s)
    }
}
