//! Where the filter starts, and how well that is known.

use lander_models::frames::Attitude;
use lander_models::random;
use lander_models::scenario::{Initial, PerSensor, Prior, Scenario};
use lander_models::time::Ticks;
use lander_models::vehicle::Sensors;
use nalgebra::{UnitQuaternion, Vector3};

use super::filter::Filter;
use super::navigator::{Estimator, Means};
use super::nominal::*;

/// The scenario's initial state with errors drawn from the run's seed, and its covariance.
pub fn start(scenario: &Scenario, sensors: &Sensors) -> Estimator {
    let (prior, seed) = (&scenario.prior, scenario.seed);
    let Initial { position_w, velocity_w, attitude_wb, rate_b, propellant_kg } = scenario.initial;
    let draw = |stream: &str, sigma: f64| random::normal3(seed, stream, 0) * sigma;
    let attitude_wb: Attitude = attitude_wb
        * UnitQuaternion::from_scaled_axis(draw("navigation attitude", prior.attitude_rad));
    let mount_b = sensors.imu.mount_b;
    let nominal = Nominal::new(
        position_w + draw("navigation position", prior.position_m) + attitude_wb * mount_b,
        velocity_w
            + draw("navigation velocity", prior.velocity_m_s)
            + attitude_wb * rate_b.cross(&mount_b),
        attitude_wb,
    );
    Estimator {
        filter: Filter { nominal, covariance: covariance(scenario, prior, sensors) },
        epoch: Ticks::ZERO,
        means: Means { specific_force_b: Vector3::zeros(), rate_b },
        propellant_kg,
        samples: PerSensor::default(),
        rejected: PerSensor::default(),
    }
}

/// Of the start. Where the scenario disperses the truth, that adds to what is unknown.
fn covariance(scenario: &Scenario, prior: &Prior, sensors: &Sensors) -> Covariance {
    let dispersed = &scenario.disturbances;
    let Sensors { imu, altimeter, velocimeter, star_tracker, landmark, .. } = sensors;
    let mut p = Covariance::zeros();
    let mut set = |place, sigma: Vector3<f64>| {
        for axis in 0..3 {
            p[(place + axis, place + axis)] = sigma[axis] * sigma[axis];
        }
    };
    let all = Vector3::repeat;
    set(POSITION, all(libm::hypot(prior.position_m, dispersed.initial_position_m)));
    set(VELOCITY, all(libm::hypot(prior.velocity_m_s, dispersed.initial_velocity_m_s)));
    set(ATTITUDE, all(prior.attitude_rad));
    set(GYRO_BIAS, all(libm::hypot(imu.gyro.bias, imu.gyro.drift)));
    set(ACCELEROMETER_BIAS, all(libm::hypot(imu.accelerometer.bias, imu.accelerometer.drift)));
    set(GYRO_SCALE, all(imu.gyro.scale));
    set(ACCELEROMETER_SCALE, all(imu.accelerometer.scale));
    set(MISALIGNMENT, all(star_tracker.misalignment_rad));
    set(VELOCIMETER_BIAS, all(velocimeter.bias_m_s));
    set(VELOCIMETER_SCALE, all(velocimeter.scale));
    let map_bias_w = |landmark| scenario.guidance.map_bias_w(landmark);
    set(LANDMARK_BIAS, landmark.as_ref().map_or(Vector3::zeros(), map_bias_w));
    let mut set = |place, sigma: f64| p[(place, place)] = sigma * sigma;
    set(GRAVITY, libm::hypot(prior.gravity, dispersed.gravity));
    set(ALTIMETER_BIAS, altimeter.bias_m);
    set(ALTIMETER_SCALE, altimeter.scale);
    set(SLOPE, prior.ground_slope);
    set(SLOPE + 1, prior.ground_slope);
    // The product of slope and position errors, which a linear model of the range leaves out.
    let position_m = libm::hypot(prior.position_m, dispersed.initial_position_m);
    set(GROUND, std::f64::consts::SQRT_2 * prior.ground_slope * position_m);
    p
}
