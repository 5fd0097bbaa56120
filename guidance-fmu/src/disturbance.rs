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
/// Least thrust, over nominal, of an engine declared weak.
const WEAK_SCALE_MIN: f64 = 0.05;
pub const POINTING_ERROR_MAX_RAD: f64 = 0.08;

/// The engine as guidance sees it: what it should do by its nominal lags, and how it differs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineEstimate {
    lit: bool,
    /// Until the first thrust after a command.
    igniting: Ticks,
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
    /// Since ignition, s; zero while off.
    burning_s: f64,
    /// Least `scale` that is believed.
    scale_min: f64,
    /// Delivered thrust not to be exceeded, N, once a failure sets one.
    limit_n: Option<f64>,
}

impl Default for EngineEstimate {
    fn default() -> Self {
        Self {
            lit: false,
            igniting: Ticks::ZERO,
            nominal_n: 0.0,
            nominal_mean_n: 0.0,
            gimbal_rad: Vector2::zeros(),
            gimbal_mean_rad: Vector2::zeros(),
            settled: false,
            scale: 1.0,
            pointing_rad: Vector2::zeros(),
            seen_s: 0.0,
            burning_s: 0.0,
            scale_min: 1.0 - THRUST_ERROR_MAX,
            limit_n: None,
        }
    }
}

impl EngineEstimate {
    /// Thrust delivered now, N.
    pub fn thrust_n(&self) -> f64 {
        self.scale * self.nominal_n
    }

    /// Impulse of the last step by the nominal lags, N s.
    pub fn nominal_impulse_n_s(&self, duration: Ticks) -> f64 {
        self.nominal_mean_n * duration.seconds()
    }

    /// How far thrust comes after its command now, s.
    pub fn lead_s(&self, engine: &Engine) -> f64 {
        let waits = if self.lit { self.igniting } else { engine.ignition_delay };
        engine.thrust_lag_s + waits.seconds()
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
        let line_rad =
            Vector2::new(libm::asin(-direction_b.y), libm::atan2(direction_b.x, direction_b.z));
        let scale = force_n / self.nominal_mean_n;
        self.scale = (self.scale + gain * (scale - self.scale))
            .clamp(self.scale_min, 1.0 + THRUST_ERROR_MAX);
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
        self.igniting = match (command_n > 0.0, self.lit) {
            (true, true) => Ticks(self.igniting.0.saturating_sub(duration.0)),
            (true, false) => engine.ignition_delay,
            (false, _) => Ticks::ZERO,
        };
        self.lit = command_n > 0.0;
        self.burning_s =
            if self.lit && self.igniting == Ticks::ZERO { self.burning_s + step_s } else { 0.0 };
        let command_n = if self.igniting > Ticks::ZERO { 0.0 } else { command_n };
        let lag_s = if command_n > 0.0 { engine.thrust_lag_s } else { engine.tail_off_lag_s };
        let (before_n, before_rad) = (self.nominal_n, self.gimbal_rad);
        self.nominal_n = command_n + (before_n - command_n) * libm::exp(-step_s / lag_s);
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
        let share = 1.0 - libm::exp(-time_s / engine.gimbal_lag_s);
        let turn_rad = (command_rad - self.gimbal_rad) * share;
        self.gimbal_rad + turn_rad.map(|angle| angle.clamp(-most_rad, most_rad))
    }

    /// Command that delivers `wanted_n`, within the throttle (G.62): never between zero and the
    /// floor.
    pub fn command_n(&self, engine: &Engine, wanted_n: f64) -> f64 {
        let wanted_n = self.limit_n.map_or(wanted_n, |limit_n| wanted_n.min(limit_n));
        (wanted_n / self.scale).clamp(engine.thrust_min_n, engine.thrust_max_n)
    }

    /// Most thrust that can be delivered, N.
    pub fn ceiling_n(&self, engine: &Engine) -> f64 {
        let ceiling_n = self.scale * engine.thrust_max_n;
        self.limit_n.map_or(ceiling_n, |limit_n| ceiling_n.min(limit_n))
    }

    /// Thrust expected by the nominal lags, mean of the last step, N, where it has settled and the
    /// burn has lasted so long; without errors.
    pub fn steady_n(&self, burning_s: f64) -> Option<f64> {
        (self.settled && self.burning_s > burning_s).then_some(self.nominal_mean_n)
    }

    /// The same, settled or not.
    pub fn burning_n(&self, burning_s: f64) -> Option<f64> {
        (self.burning_s > burning_s).then_some(self.nominal_mean_n)
    }

    /// Gimbal angles by the nominal lag and rate limit, mean of the last step.
    pub fn gimbal_mean_rad(&self) -> Vector2<f64> {
        self.gimbal_mean_rad
    }

    /// Angles of the thrust line now.
    pub fn line_rad(&self) -> Vector2<f64> {
        self.gimbal_rad + self.pointing_rad
    }

    /// Force expected, mean of the last step, body frame, N.
    pub fn force_mean_b(&self) -> Vector3<f64> {
        line_b(&(self.gimbal_mean_rad + self.pointing_rad)) * (self.scale * self.nominal_mean_n)
    }

    /// No thrust comes, whatever is commanded. What its decay taught is forgotten.
    pub fn extinguished(&mut self) {
        let Self { gimbal_rad, gimbal_mean_rad, limit_n, .. } = *self;
        *self = Self { gimbal_rad, gimbal_mean_rad, limit_n, ..Self::default() };
    }

    /// An engine thought out gives this thrust.
    pub fn relit(&mut self, thrust_n: f64) {
        self.lit = true;
        self.nominal_n = thrust_n / self.scale;
        self.nominal_mean_n = self.nominal_n;
    }

    /// The engine gives this share of what is asked.
    pub fn weakened(&mut self, share: f64) {
        self.scale_min = WEAK_SCALE_MIN;
        self.scale = share.max(WEAK_SCALE_MIN);
    }

    /// No more than this may be delivered, if anything limits it.
    pub fn limited(&mut self, thrust_n: Option<f64>) {
        self.limit_n = thrust_n;
    }
}

/// Angles about the gimbal axes of a thrust line along a force.
pub fn line_rad(force_b: &Vector3<f64>) -> Vector2<f64> {
    let direction_b = force_b.normalize();
    Vector2::new(libm::asin(-direction_b.y), libm::atan2(direction_b.x, direction_b.z))
}

/// Unit thrust line at angles about the gimbal axes.
pub fn line_b(angles_rad: &Vector2<f64>) -> Vector3<f64> {
    let ((sin_x, cos_x), (sin_y, cos_y)) = (libm::sincos(angles_rad.x), libm::sincos(angles_rad.y));
    Vector3::new(cos_x * sin_y, -sin_x, cos_x * cos_y)
}

#[cfg(test)]
mod tests {
    use lander_models::Vehicle;
    use nalgebra::Rotation3;

    use super::*;

    const STEP: Ticks = Ticks(10);

    fn yunt() -> Engine {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
        Vehicle::load(file.as_ref()).unwrap().engine
    }

    /// Thrust line of gimbal angles, written down again: body z turned about x, then about y.
    fn line_b(angles_rad: Vector2<f64>) -> Vector3<f64> {
        let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), angles_rad.x);
        let about_y = Rotation3::from_axis_angle(&Vector3::y_axis(), angles_rad.y);
        about_y * about_x * Vector3::z()
    }

    /// Two seconds of a burn with these errors, on a vehicle of 250 kg.
    fn burn(engine: &Engine, scale: f64, pointing_rad: Vector2<f64>) -> EngineEstimate {
        let (mut estimate, mass_kg) = (EngineEstimate::default(), 250.0);
        let gimbal_rad = Vector2::new(0.02, -0.01);
        for _ in 0..200 {
            estimate.expect(engine, 2000.0, &gimbal_rad, STEP);
            let thrust_n = scale * estimate.nominal_mean_n;
            let force_n = line_b(estimate.gimbal_mean_rad + pointing_rad) * thrust_n;
            estimate.learn(&(force_n / mass_kg), mass_kg, STEP);
        }
        estimate
    }

    #[test]
    fn constant_errors_are_found_and_compensated() {
        let engine = yunt();
        let pointing_rad = Vector2::new(0.03, -0.02);
        let estimate = burn(&engine, 0.93, pointing_rad);
        // Of the first guess 0.05/0.5 is left after 0.45 s of learning, and fades by e^(-t/0.5 s) in
        // the 1.3 s after that: 0.8 % of the errors.
        assert!((estimate.scale - 0.93).abs() < 0.008 * 0.07, "{}", estimate.scale);
        let error_rad = estimate.pointing_rad - pointing_rad;
        assert!(error_rad.norm() < 0.008 * pointing_rad.norm(), "{error_rad}");
        let delivered_n = 0.93 * estimate.command_n(&engine, 1500.0);
        assert!((delivered_n - 1500.0).abs() < 1.0, "{delivered_n} N");
    }

    #[test]
    fn no_estimate_makes_a_command_leave_the_throttle_range() {
        let engine = yunt();
        for scale in [0.1, 0.7, 1.0, 1.3, 5.0] {
            let estimate = burn(&engine, scale, Vector2::zeros());
            for wanted_n in [0.0, 500.0, 800.0, 5200.0, 1e6] {
                let command_n = estimate.command_n(&engine, wanted_n);
                assert!((800.0..=5200.0).contains(&command_n), "{command_n} N");
            }
        }
    }

    #[test]
    fn a_rise_or_an_engine_that_is_off_teaches_nothing() {
        let engine = Engine { ignition_delay: Ticks(300), ..yunt() };
        let mut estimate = EngineEstimate::default();
        for _ in 0..30 {
            estimate.expect(&engine, 2000.0, &Vector2::zeros(), STEP);
            estimate.learn(&Vector3::new(0.1, 0.0, 0.1), 250.0, STEP);
        }
        assert_eq!((estimate.scale, estimate.thrust_n()), (1.0, 0.0), "still igniting");
        estimate.expect(&engine, 2000.0, &Vector2::zeros(), STEP);
        assert!(estimate.thrust_n() > 0.0);
        estimate.learn(&Vector3::new(0.1, 0.0, 0.1), 250.0, STEP);
        assert_eq!(estimate.scale, 1.0, "still rising");
    }
}
