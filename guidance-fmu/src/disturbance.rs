//! What the engine really gives, from the measured specific force (G.60 to G.62).
//!
//! A thrust off by a few per cent and a thrust line off by a degree are what disturbs a descent
//! most: the first moves the point of arrival, the second turns the vehicle. Both are constant over
//! a burn but for noise, so they are averaged, then taken out of the commands.

use lander_models::Ticks;
use lander_models::vehicle::Engine;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Time over which measurements are averaged, s: ten correlation times of the engine's noise, yet
/// short enough to learn of a failing engine within a burn.
const MEMORY_S: f64 = 0.5;
/// Age that the first guess (no error) counts for, s: about one correlation time of the noise.
const PRIOR_S: f64 = 0.05;
/// Nothing is learned while the expected thrust is farther from its command than this share: a rise
/// or a tail-off measures the lag, not the engine.
const SETTLED_SHARE: f64 = 0.1;
/// Errors beyond these are no calibration but a failure, and are not compensated further.
const THRUST_ERROR_MAX: f64 = 0.3;
const POINTING_ERROR_MAX_RAD: f64 = 0.08;

/// The engine as guidance sees it: what it should do by its nominal lags, and how it differs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineEstimate {
    /// Thrust by the nominal lag, before errors.
    nominal_n: f64,
    /// Its mean over the last step.
    nominal_mean_n: f64,
    /// Gimbal angles by the nominal lag and rate limit, and their mean over the last step.
    gimbal_rad: Vector2<f64>,
    gimbal_mean_rad: Vector2<f64>,
    /// Whether the thrust had settled over the last step.
    settled: bool,
    /// Thrust delivered over nominal.
    pub scale: f64,
    /// Of the thrust line about the gimbal axes.
    pub pointing_rad: Vector2<f64>,
    /// For how long there was something to learn from, s.
    seen_s: f64,
}

impl Default for EngineEstimate {
    fn default() -> Self {
        Self {
            nominal_n: 0.0,
            nominal_mean_n: 0.0,
            gimbal_rad: Vector2::zeros(),
            gimbal_mean_rad: Vector2::zeros(),
            settled: false,
            scale: 1.0,
            pointing_rad: Vector2::zeros(),
            seen_s: 0.0,
        }
    }
}

impl EngineEstimate {
    /// Thrust delivered now, N.
    pub fn thrust_n(&self) -> f64 {
        self.scale * self.nominal_n
    }

    /// Learns from the mean specific force of the last step (G.60), at a mass.
    pub fn learn(&mut self, specific_force_b: &Vector3<f64>, mass_kg: f64, duration: Ticks) {
        let force_n = specific_force_b.norm() * mass_kg;
        if !self.settled || force_n <= 0.0 {
            return;
        }
        let step_s = duration.seconds();
        let gain = step_s / (self.seen_s + PRIOR_S).min(MEMORY_S).max(step_s);
        self.seen_s += step_s;
        let direction_b = specific_force_b * (mass_kg / force_n);
        let line_rad = Vector2::new((-direction_b.y).asin(), direction_b.x.atan2(direction_b.z));
        let scale = force_n / self.nominal_mean_n;
        self.scale = (self.scale + gain * (scale - self.scale))
            .clamp(1.0 - THRUST_ERROR_MAX, 1.0 + THRUST_ERROR_MAX);
        let error_rad = line_rad - self.gimbal_mean_rad;
        self.pointing_rad = (self.pointing_rad + gain * (error_rad - self.pointing_rad))
            .map(|angle| angle.clamp(-POINTING_ERROR_MAX_RAD, POINTING_ERROR_MAX_RAD));
    }

    /// Follows the nominal lags through a step of held commands (G.61).
    pub fn expect(
        &mut self,
        engine: &Engine,
        command_n: f64,
        gimbal_rad: &Vector2<f64>,
        duration: Ticks,
    ) {
        let step_s = duration.seconds();
        let lag_s = if command_n > 0.0 { engine.thrust_lag_s } else { engine.tail_off_lag_s };
        let (before_n, before_rad) = (self.nominal_n, self.gimbal_rad);
        self.nominal_n = command_n + (before_n - command_n) * (-step_s / lag_s).exp();
        self.gimbal_rad = self.gimbal_after_rad(engine, gimbal_rad, step_s);
        self.nominal_mean_n = 0.5 * (before_n + self.nominal_n);
        self.gimbal_mean_rad = 0.5 * (before_rad + self.gimbal_rad);
        let off_n = (before_n - command_n).abs();
        self.settled = command_n > 0.0 && off_n < SETTLED_SHARE * command_n;
    }

    /// Gimbal angles after `time_s` of a held command, by the nominal lag and rate limit.
    pub fn gimbal_after_rad(
        &self,
        engine: &Engine,
        command_rad: &Vector2<f64>,
        time_s: f64,
    ) -> Vector2<f64> {
        let most_rad = engine.gimbal_rate_rad_s * time_s;
        let share = 1.0 - (-time_s / engine.gimbal_lag_s).exp();
        let turn_rad = (command_rad - self.gimbal_rad) * share;
        self.gimbal_rad + turn_rad.map(|angle| angle.clamp(-most_rad, most_rad))
    }

    /// Command that delivers `wanted_n`, within the throttle (G.62): never between zero and the
    /// floor.
    pub fn command_n(&self, engine: &Engine, wanted_n: f64) -> f64 {
        (wanted_n / self.scale).clamp(engine.thrust_min_n, engine.thrust_max_n)
    }
}
