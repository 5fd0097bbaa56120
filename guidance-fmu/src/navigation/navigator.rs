//! Feeds the filter: which samples are new, how old they are, and what to do when none come.

use lander_models::ModelError;
use lander_models::scenario::{PerSensor, Scenario};
use lander_models::time::Ticks;
use lander_models::vehicle::{G0_M_S2, Sensors, Vehicle};
use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::filter::{Filter, Update};
use super::inputs::{ImuSample, Inputs};
use super::nominal::*;
use super::sensors::{self, Ground};
use super::{Sigma, Solution, start};

/// Constant configuration: nominal values and standard deviations only.
#[derive(Clone, Debug)]
pub struct Navigator {
    vehicle: Vehicle,
    sensors: Sensors,
    ground: Ground,
    gravity_m_s2: f64,
    start: Estimator,
}

/// All that changes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Estimator {
    pub filter: Filter,
    /// Up to which the filter has propagated.
    pub(super) epoch: Ticks,
    /// Last means, corrected: rates for outputs, and motion between samples.
    pub(super) means: Means,
    /// By nominal flow.
    pub(super) propellant_kg: f64,
    /// That were seen to arrive.
    pub(super) samples: PerSensor<f64>,
    /// Refused by the gate.
    pub(super) rejected: PerSensor<f64>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Means {
    pub specific_force_b: Vector3<f64>,
    pub rate_b: Vector3<f64>,
}

/// What the actuators are thought to do: drives the estimate while the IMU is silent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Actuation {
    pub thrust_n: f64,
    pub gimbal_rad: [f64; 2],
    pub rcs_torque_b: Vector3<f64>,
}

impl Navigator {
    /// None if the vehicle has no sensors.
    pub fn new(scenario: &Scenario, vehicle: &Vehicle) -> Option<Self> {
        let sensors = vehicle.sensors.clone()?;
        let ground = Ground {
            target_w: scenario.guidance.target_w,
            roughness_m: scenario.prior.ground_roughness_m,
        };
        Some(Self {
            ground,
            gravity_m_s2: scenario.gravity_m_s2,
            start: start::start(scenario, &sensors),
            vehicle: vehicle.clone(),
            sensors,
        })
    }

    /// At t = 0: the scenario's initial state with drawn errors.
    pub fn start(&self) -> Estimator {
        self.start.clone()
    }

    /// Takes what arrived until `now`. Returns what became of each new sample.
    pub fn step(
        &self,
        estimator: &mut Estimator,
        now: Ticks,
        inputs: &Inputs,
        actuation: &Actuation,
    ) -> Result<PerSensor<Option<Update>>, ModelError> {
        self.follow(estimator, now, inputs, actuation);
        let updates = self.observe(estimator, now, inputs)?;
        let refused = |update: Option<Update>| {
            if update.is_some_and(|update| !update.taken) { 1.0 } else { 0.0 }
        };
        let new = updates.to_array().map(refused);
        let sums = estimator.rejected.to_array();
        estimator.rejected = PerSensor::from_array(std::array::from_fn(|n| sums[n] + new[n]));
        estimator.samples = inputs.samples;
        Ok(updates)
    }

    /// Propagates to the end of the IMU's last period.
    fn follow(
        &self,
        estimator: &mut Estimator,
        now: Ticks,
        inputs: &Inputs,
        actuation: &Actuation,
    ) {
        let imu = &self.sensors.imu;
        let end = last_multiple(now, imu.period);
        if end <= estimator.epoch {
            return;
        }
        let duration_s = end.seconds() - estimator.epoch.seconds();
        let arrived = inputs.valid.imu && inputs.samples.imu > estimator.samples.imu;
        let means = if arrived {
            estimator.filter.nominal.corrected(&inputs.imu)
        } else {
            self.expected(estimator, actuation, duration_s)
        };
        let covered = arrived && end == estimator.epoch + imu.period;
        estimator.filter.propagate(&means, imu, self.gravity_m_s2, duration_s, !covered);
        estimator.epoch = end;
        estimator.means = Means { specific_force_b: means.specific_force_b, rate_b: means.rate_b };
    }

    /// What an ideal IMU would tell if the actuators did what was asked of them.
    fn expected(&self, estimator: &Estimator, actuation: &Actuation, duration_s: f64) -> ImuSample {
        let mass = self.vehicle.mass.at(estimator.propellant_kg);
        let [about_x, about_y] = actuation.gimbal_rad;
        let line_b = Rotation3::from_axis_angle(&Vector3::y_axis(), about_y)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), about_x)
            * Vector3::z();
        let force_b = line_b * actuation.thrust_n;
        let arm_b = self.vehicle.engine.pivot_b - mass.com_b;
        let rate_b = estimator.means.rate_b;
        let torque_b = arm_b.cross(&force_b) + actuation.rcs_torque_b
            - rate_b.cross(&(mass.inertia_b * rate_b));
        // A tensor that the vehicle file was accepted with is invertible.
        let turn_b = mass.inertia_b.try_inverse().unwrap_or_default() * torque_b;
        ImuSample { specific_force_b: force_b / mass.mass_kg, rate_b: rate_b + turn_b * duration_s }
    }

    /// Updates by every sample that is new, in the order of the table.
    fn observe(
        &self,
        estimator: &mut Estimator,
        now: Ticks,
        inputs: &Inputs,
    ) -> Result<PerSensor<Option<Update>>, ModelError> {
        let Sensors { imu, altimeter, velocimeter, star_tracker, landmark, .. } = &self.sensors;
        let (valid, old) = (inputs.valid, estimator.samples);
        let mut updates = PerSensor::default();
        if valid.altimeter && inputs.samples.altimeter > old.altimeter {
            let then = self.at(estimator, last_multiple(now, altimeter.period));
            let filter = &mut estimator.filter;
            let arm_b = altimeter.mount_b - imu.mount_b;
            let innovation = sensors::altimeter(
                &then,
                altimeter,
                &arm_b,
                &self.ground,
                inputs.altimeter_range_m,
            );
            updates.altimeter = innovation.map(|innovation| filter.update(&innovation));
        }
        if valid.velocimeter && inputs.samples.velocimeter > old.velocimeter {
            let then = self.at(estimator, last_multiple(now, velocimeter.period));
            let arm_b = velocimeter.mount_b - imu.mount_b;
            let rate_b = &estimator.means.rate_b;
            let innovation =
                sensors::velocimeter(&then, velocimeter, &arm_b, rate_b, &inputs.velocimeter_b);
            updates.velocimeter = Some(estimator.filter.update(&innovation));
        }
        if valid.star_tracker && inputs.samples.star_tracker > old.star_tracker {
            let then = self.at(estimator, last_multiple(now, star_tracker.period));
            let innovation = sensors::star_tracker(&then, star_tracker, &inputs.star_tracker_wb()?);
            updates.star_tracker = Some(estimator.filter.update(&innovation));
        }
        if let Some(landmark) = landmark
            && valid.landmark
            && inputs.samples.landmark > old.landmark
        {
            let then = self.at(estimator, last_multiple(now, landmark.period));
            let innovation = sensors::landmark(&then, landmark, &-imu.mount_b, &inputs.landmark_w);
            updates.landmark = Some(estimator.filter.update(&innovation));
        }
        Ok(updates)
    }

    /// The estimate at an instant near the filter's epoch, under the last means.
    fn at(&self, estimator: &Estimator, instant: Ticks) -> Nominal {
        let nominal = &estimator.filter.nominal;
        if instant == estimator.epoch {
            return *nominal;
        }
        let Means { specific_force_b, rate_b } = estimator.means;
        let duration_s = instant.seconds() - estimator.epoch.seconds();
        nominal.moved(&ImuSample { specific_force_b, rate_b }, self.gravity_m_s2, duration_s)
    }

    /// What is known of O at `now`.
    pub fn solution(&self, estimator: &Estimator, now: Ticks) -> Solution {
        let filter = &estimator.filter;
        let nominal = self.at(estimator, now);
        let rate_b = estimator.means.rate_b;
        let arm_b = -self.sensors.imu.mount_b;
        let position_w = nominal.position_w + nominal.attitude_wb * arm_b;
        let position = sensors::point_sensitivity(&nominal, &arm_b);
        let (height_m, height) = self.ground.height_m(&nominal, &arm_b);
        Solution {
            // As measured, not as predicted: the caller has the IMU's sample.
            specific_force_b: None,
            position_w,
            velocity_w: nominal.velocity_w + nominal.attitude_wb * rate_b.cross(&arm_b),
            attitude_wb: nominal.attitude_wb,
            rate_b,
            height_m,
            mass_kg: self.vehicle.mass.dry.mass_kg + estimator.propellant_kg,
            gyro_bias_b: nominal.parameters3(GYRO_BIAS),
            accelerometer_bias_b: nominal.parameters3(ACCELEROMETER_BIAS),
            sigma: Sigma {
                position_w: filter.sigma_of(&position),
                velocity_w: filter.sigma3(VELOCITY),
                attitude_b: filter.sigma3(ATTITUDE),
                gyro_bias_b: filter.sigma3(GYRO_BIAS),
                accelerometer_bias_b: filter.sigma3(ACCELEROMETER_BIAS),
                height_m: filter.sigma_of(&height)[0],
            },
            rejected: estimator.rejected,
        }
    }

    /// Nominal flow: of the engine's impulse, and of thrusters that give their torque as a couple.
    pub fn spend(&self, estimator: &mut Estimator, impulse_n_s: f64, rcs_n_m_s: f64) {
        let rcs = &self.vehicle.rcs;
        let flow_kg = impulse_n_s / (self.vehicle.engine.isp_s * G0_M_S2)
            + rcs_n_m_s / (rcs.lever_arm_m * rcs.isp_s * G0_M_S2);
        estimator.propellant_kg = (estimator.propellant_kg - flow_kg).max(0.0);
    }
}

/// The last instant that a sensor of this period sampled.
fn last_multiple(now: Ticks, period: Ticks) -> Ticks {
    Ticks(now.0 - now.0 % period.0)
}
