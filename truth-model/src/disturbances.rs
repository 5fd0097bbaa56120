//! Errors that guidance knows nothing of (T.63 to T.68): biases drawn once a run, noise as
//! first-order Gauss-Markov processes that step once a tick and hold through it.

use lander_models::Ticks;
use lander_models::scenario::{Disturbances, Scenario};
use lander_models::time::TICK_S;
use lander_models::vehicle::Vehicle;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::random::{self, Normals};

/// Constant errors of this run, relative but for the pointing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Biases {
    pub thrust: f64,
    pub isp: f64,
    /// Of the thrust line about the gimbal axes.
    pub pointing_rad: Vector2<f64>,
}

/// Present values of the noise processes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// As a share of thrust.
    pub thrust: f64,
    pub pointing_rad: Vector2<f64>,
    pub acceleration_w: Vector3<f64>,
    /// Draws of thrust, pointing and acceleration made ahead; made again where they are missing.
    #[serde(skip)]
    ahead: [Normals; 3],
}

impl Biases {
    pub fn draw(sigma: &Disturbances, seed: u64) -> Self {
        let pointing = std::array::from_fn(|axis| {
            sigma.pointing_bias_rad * random::normal(seed, "pointing bias", axis as u64)
        });
        Self {
            thrust: sigma.offset.thrust + sigma.thrust_bias * once(seed, "thrust bias"),
            isp: sigma.offset.specific_impulse
                + sigma.specific_impulse * once(seed, "specific impulse bias"),
            pointing_rad: Vector2::from(sigma.offset.pointing_rad) + Vector2::from(pointing),
        }
    }
}

/// The scenario and vehicle that this run really has: start, gravity and mass as drawn (T.68).
pub fn disperse(mut scenario: Scenario, mut vehicle: Vehicle) -> (Scenario, Vehicle) {
    let (sigma, seed) = (scenario.disturbances, scenario.seed);
    let start = &mut scenario.initial;
    let mass_error = sigma.offset.mass + sigma.mass * once(seed, "mass");
    let dry = &mut vehicle.mass.dry;
    let growth = 1.0 + mass_error * (dry.mass_kg + start.propellant_kg) / dry.mass_kg;
    dry.mass_kg *= growth;
    dry.inertia_kg_m2 *= growth;
    start.position_w += random::normal3(seed, "initial position", 0) * sigma.initial_position_m;
    start.velocity_w += random::normal3(seed, "initial velocity", 0) * sigma.initial_velocity_m_s;
    scenario.gravity_m_s2 *= 1.0 + sigma.offset.gravity + sigma.gravity * once(seed, "gravity");
    (scenario, vehicle)
}

fn once(seed: u64, stream: &str) -> f64 {
    random::normal(seed, stream, 0)
}

impl Noise {
    /// Steps every process that the run has to tick `now`; the others cost nothing.
    pub fn step(&mut self, sigma: &Disturbances, seed: u64, now: Ticks) {
        if [sigma.thrust_noise, sigma.pointing_jitter_rad, sigma.acceleration_noise_m_s2]
            == [0.0; 3]
        {
            return;
        }
        let process = Process::new(sigma.correlation_s, now);
        let [thrust, pointing, acceleration] = &mut self.ahead;
        if sigma.thrust_noise > 0.0 {
            let draw = thrust.at(seed, "thrust noise", now.0);
            self.thrust = process.next(self.thrust, sigma.thrust_noise, draw);
        }
        if sigma.pointing_jitter_rad > 0.0 {
            for (axis, angle_rad) in self.pointing_rad.iter_mut().enumerate() {
                let draw = pointing.at(seed, "pointing jitter", 2 * now.0 + axis as u64);
                *angle_rad = process.next(*angle_rad, sigma.pointing_jitter_rad, draw);
            }
        }
        if sigma.acceleration_noise_m_s2 > 0.0 {
            for (axis, value) in self.acceleration_w.iter_mut().enumerate() {
                let draw = acceleration.at(seed, "acceleration noise", 3 * now.0 + axis as u64);
                *value = process.next(*value, sigma.acceleration_noise_m_s2, draw);
            }
        }
    }
}

/// Gauss-Markov process, discretised exactly and stationary from the first tick (T.66).
struct Process {
    kept: f64,
    renewed: f64,
}

impl Process {
    fn new(correlation_s: f64, now: Ticks) -> Self {
        let kept = if now == Ticks::ZERO { 0.0 } else { libm::exp(-TICK_S / correlation_s) };
        Self { kept, renewed: (1.0 - kept * kept).sqrt() }
    }

    fn next(&self, last: f64, deviation: f64, draw: f64) -> f64 {
        self.kept * last + deviation * self.renewed * draw
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_deviation_and_correlation_time() {
        let sigma = Disturbances { thrust_noise: 0.01, ..Disturbances::NONE };
        let mut noise = Noise::default();
        let n = 100_000_u64;
        let values: Vec<f64> = (0..n)
            .map(|tick| {
                noise.step(&sigma, 3, Ticks(tick));
                noise.thrust
            })
            .collect();
        let lag = 50; // one correlation time
        let covariance = |shift: usize| {
            let pairs = values.iter().zip(&values[shift..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / (n as usize - shift) as f64 / 1e-4
        };
        // Bartlett: the variance of a sample covariance of such a process is at most
        // 2 tau/T (1 + exp(-2) (1 + 2)) = 1.4e-3 here; five of its roots.
        assert!((covariance(0) - 1.0).abs() < 0.19, "variance {}", covariance(0));
        assert!((covariance(lag) - (-1.0_f64).exp()).abs() < 0.19, "{}", covariance(lag));
        assert!(noise.pointing_rad == Vector2::zeros() && noise.acceleration_w.norm() == 0.0);
    }

    #[test]
    fn a_run_s_noise_is_a_function_of_its_seed() {
        let sigma = Disturbances::MONTE_CARLO_TABLE;
        let end = |seed| {
            let mut noise = Noise::default();
            (0..100).for_each(|tick| noise.step(&sigma, seed, Ticks(tick)));
            noise
        };
        assert_eq!(end(1), end(1));
        assert_ne!(end(1).pointing_rad.x, end(1).pointing_rad.y);
        assert_ne!(end(1), end(2));
    }
}
