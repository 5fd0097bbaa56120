//! What drives the vehicle: engine and attitude thrusters as a force, a torque and a flow.

use lander_models::scenario::Scenario;
use lander_models::vehicle::Rcs;
use lander_models::{Ticks, Vehicle};
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::burn::Burn;
use crate::disturbances::{Biases, Noise};
use crate::engine::{self, Actuators, Following, Phase};
use crate::faults::{self, Damage};
use crate::flight::Motion;
use crate::rcs::{self, Firing, Modulator};

/// What was last asked of engine and thrusters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    pub thrust_n: f64,
    pub gimbal_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
}

/// What drives the vehicle during one tick, held constant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Target of the lag, before errors.
    pub thrust_target_n: f64,
    pub phase: Phase,
    /// Delivered thrust over that of the lag (T.63).
    pub thrust_factor: f64,
    /// I_sp over the engine's own (T.64).
    pub isp_factor: f64,
    pub gimbal_target_rad: Vector2<f64>,
    /// Angles between thrust line and gimbal, about the gimbal axes (T.65).
    pub pointing_error_rad: Vector2<f64>,
    pub rcs_torque_b: Vector3<f64>,
    /// Of the attitude thrusters and a leak.
    pub other_flow_kg_s: f64,
    /// Through the centre of mass: what the model leaves out (T.67).
    pub disturbance_b: Vector3<f64>,
}

/// An engine that is off, ready to follow its throttle without errors.
impl Default for Drive {
    fn default() -> Self {
        Self {
            thrust_target_n: 0.0,
            phase: Phase::Running,
            thrust_factor: 1.0,
            isp_factor: 1.0,
            gimbal_target_rad: Vector2::zeros(),
            pointing_error_rad: Vector2::zeros(),
            rcs_torque_b: Vector3::zeros(),
            other_flow_kg_s: 0.0,
            disturbance_b: Vector3::zeros(),
        }
    }
}

/// What propulsion remembers from tick to tick, besides thrust and gimbal angles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Propulsion {
    /// That reached the actuators last.
    pub command: Command,
    pub phase: Phase,
    pub rcs: [Modulator; 3],
    pub noise: Noise,
}

/// What propulsion works with, constant over a run.
#[derive(Clone, Copy, Debug)]
pub struct Plant<'a> {
    pub scenario: &'a Scenario,
    pub vehicle: &'a Vehicle,
    pub biases: &'a Biases,
}

/// Force and torque on the vehicle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wrench {
    pub force_b: Vector3<f64>,
    /// About the centre of mass, where nothing else is said.
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

impl Propulsion {
    /// What the vehicle is driven by during tick `now`, for a motion at its start. The
    /// acceleration noise acts `in_flight` alone: it stands for what the equations of flight miss,
    /// and a lander that stands still must be able to.
    pub fn drive(
        &mut self,
        plant: &Plant,
        now: Ticks,
        asked: &Command,
        motion: &Motion,
        in_flight: bool,
    ) -> Drive {
        let Plant { scenario, vehicle, biases } = *plant;
        let damage = Damage::at(&scenario.faults, &vehicle.engine, now);
        self.command = faults::command_in_force(&scenario.faults, now, asked, &self.command);
        self.noise.step(&scenario.disturbances, scenario.seed, now);
        let thrust_target_n = self.burn(plant, &damage, now, motion);
        let rcs = self.fire(&vehicle.rcs, &damage);
        let noise = &self.noise;
        // (T.63) Errors so large that thrust would turn round stop at none.
        let error_factor = (1.0 + biases.thrust + noise.thrust).max(0.0);
        Drive {
            thrust_target_n,
            phase: self.phase,
            thrust_factor: damage.thrust_factor * error_factor,
            isp_factor: damage.isp_factor * (1.0 + biases.isp),
            gimbal_target_rad: if damage.powered && damage.gimbal_free {
                engine::gimbal_target_rad(&vehicle.engine, self.command.gimbal_rad)
            } else {
                motion.gimbal_rad
            },
            pointing_error_rad: damage.pointing_rad + biases.pointing_rad + noise.pointing_rad,
            rcs_torque_b: rcs.torque_b,
            other_flow_kg_s: rcs.flow_kg_s + damage.leak_kg_s,
            disturbance_b: if in_flight && scenario.disturbances.acceleration_noise_m_s2 > 0.0 {
                self.disturbance_b(vehicle, motion)
            } else {
                Vector3::zeros()
            },
        }
    }

    /// Moves the engine to its next phase and tells the thrust that it heads for.
    fn burn(&mut self, plant: &Plant, damage: &Damage, now: Ticks, motion: &Motion) -> f64 {
        let (engine, scenario) = (&plant.vehicle.engine, plant.scenario);
        let command_n = self.command.thrust_n;
        let open = damage.powered && damage.engine_valves;
        let asked_n =
            if open { engine::thrust_asked_n(engine, scenario.ignition, command_n) } else { 0.0 };
        self.phase = self.phase.next(engine, asked_n, motion.thrust_n);
        let flickers = engine::in_dead_zone(engine, command_n);
        let lit = self.phase.burns()
            && (!flickers || engine::is_lit(engine, command_n, scenario.seed, now));
        if lit { asked_n } else { 0.0 }
    }

    fn fire(&mut self, rcs: &Rcs, damage: &Damage) -> Firing {
        if !damage.powered {
            self.rcs = Default::default();
        }
        let asked_b = if damage.powered { self.command.rcs_torque_b } else { Vector3::zeros() };
        rcs::fire(rcs, &mut self.rcs, &asked_b, damage.rcs_stuck)
    }

    /// Force of the acceleration noise on the mass at the tick's start (T.67).
    fn disturbance_b(&self, vehicle: &Vehicle, motion: &Motion) -> Vector3<f64> {
        let mass_kg = vehicle.mass.at(motion.propellant_kg).mass_kg;
        motion.attitude_wb.inverse() * self.noise.acceleration_w * mass_kg
    }
}

impl Drive {
    /// How thrust and gimbal follow what they head for.
    #[inline]
    pub fn following<'a>(&self, vehicle: &'a Vehicle, time_s: f64) -> Following<'a> {
        let target =
            Actuators { thrust_n: self.thrust_target_n, gimbal_rad: self.gimbal_target_rad };
        Following::through(&vehicle.engine, self.phase, target, time_s)
    }

    /// Thrust delivered, N (T.63). Dry tanks give nothing, whatever the lag still says.
    pub fn thrust_n(&self, motion: &Motion) -> f64 {
        if motion.propellant_kg <= 0.0 { 0.0 } else { motion.thrust_n * self.thrust_factor }
    }

    /// Propellant flow of the main engine at a thrust before errors, kg/s (T.64).
    #[inline]
    pub fn engine_flow_kg_s(&self, vehicle: &Vehicle, thrust_n: f64) -> f64 {
        let isp_s = engine::isp_s(&vehicle.engine, thrust_n) * self.isp_factor;
        engine::flow_kg_s(thrust_n * self.thrust_factor, isp_s)
    }

    /// Propellant flow of engine, thrusters and leak, kg/s (T.7).
    #[inline]
    pub fn flow_kg_s(&self, vehicle: &Vehicle, thrust_n: f64) -> f64 {
        self.engine_flow_kg_s(vehicle, thrust_n) + self.other_flow_kg_s
    }

    /// Mass and propulsion with the thrust, gimbal angles and propellant of `motion`.
    pub fn burn(&self, vehicle: &Vehicle, motion: &Motion) -> Burn {
        let engine_flow_kg_s = self.engine_flow_kg_s(vehicle, motion.thrust_n);
        Burn::at(vehicle, self, motion.actuators(), engine_flow_kg_s, motion.propellant_kg)
    }
}
