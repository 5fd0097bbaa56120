//! The filter itself: covariance propagation and the gated update (G.52 to G.56).

use lander_models::math::square;
use lander_models::vehicle::{ImuSpec, TriadSpec};
use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::inputs::ImuSample;
use super::nominal::*;

/// χ² quantiles at 0.9999 for 1, 2 and 3 degrees of freedom: one good sample in ten thousand is
/// refused, as many as a flight has.
const GATE: [f64; 3] = [15.137, 18.421, 21.108];

/// Error of the means over a stretch that no sample covers: a constant that is wrong by this much
/// for about a second. Assumed, after an engine's thrust error of a few percent.
const BRIDGED_FORCE_M_S2: f64 = 0.3;
const BRIDGED_RATE_RAD_S: f64 = 0.02;
const BRIDGED_TIME_S: f64 = 1.0;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Filter {
    pub nominal: Nominal,
    pub covariance: Covariance,
}

/// A measurement less its prediction, its derivatives by the errors, and its noise.
pub struct Innovation<const M: usize> {
    pub value: SVector<f64, M>,
    pub sensitivity: SMatrix<f64, M, ERRORS>,
    pub noise: SMatrix<f64, M, M>,
}

/// What an update came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Normalised innovation squared, of as many degrees of freedom as the measurement.
    pub nis: f64,
    pub taken: bool,
}

impl Filter {
    /// Through `duration_s` under true means; `bridged` if no sample told them.
    pub fn propagate(
        &mut self,
        means: &ImuSample,
        imu: &ImuSpec,
        gravity_m_s2: f64,
        duration_s: f64,
        bridged: bool,
    ) {
        let transition = self.transition(means, gravity_m_s2, duration_s);
        let p = &mut self.covariance;
        // Only the motion's rows of the transition differ from the identity.
        let moved = transition * p.fixed_view::<MOVING, ERRORS>(0, 0);
        let own = moved.fixed_view::<GYRO_BIAS, MOVING>(0, 0) * transition.transpose();
        let cross: SMatrix<f64, GYRO_BIAS, { ERRORS - GYRO_BIAS }> =
            moved.fixed_view::<GYRO_BIAS, { ERRORS - GYRO_BIAS }>(0, GYRO_BIAS).into();
        p.fixed_view_mut::<GYRO_BIAS, GYRO_BIAS>(0, 0).copy_from(&((own + own.transpose()) * 0.5));
        p.fixed_view_mut::<GYRO_BIAS, { ERRORS - GYRO_BIAS }>(0, GYRO_BIAS).copy_from(&cross);
        p.fixed_view_mut::<{ ERRORS - GYRO_BIAS }, GYRO_BIAS>(GYRO_BIAS, 0)
            .copy_from(&cross.transpose());
        self.add_noise(imu, duration_s, bridged);
        self.nominal = self.nominal.moved(means, gravity_m_s2, duration_s);
    }

    /// How the motion's errors follow from the errors before (G.52).
    fn transition(
        &self,
        means: &ImuSample,
        gravity_m_s2: f64,
        duration_s: f64,
    ) -> SMatrix<f64, GYRO_BIAS, MOVING> {
        let ImuSample { specific_force_b: force_b, rate_b } = means;
        let half = UnitQuaternion::from_scaled_axis(rate_b * (0.5 * duration_s));
        let middle = (self.nominal.attitude_wb * half).to_rotation_matrix().into_inner();
        let half = half.to_rotation_matrix().into_inner();
        let levered = middle * force_b.cross_matrix();
        // Of the velocity at the end, by the errors at the beginning.
        let mut velocity = SMatrix::<f64, 3, MOVING>::zeros();
        let mut set = |place, block: Matrix3<f64>| {
            velocity.fixed_view_mut::<3, 3>(0, place).copy_from(&block);
        };
        set(ATTITUDE, -levered * half.transpose() * duration_s);
        set(GYRO_BIAS, levered * (0.5 * duration_s * duration_s));
        let by_scale = levered * Matrix3::from_diagonal(rate_b);
        set(GYRO_SCALE, by_scale * (0.5 * duration_s * duration_s));
        set(ACCELEROMETER_BIAS, -middle * duration_s);
        set(ACCELEROMETER_SCALE, -middle * Matrix3::from_diagonal(force_b) * duration_s);
        velocity[(2, GRAVITY)] = -gravity_m_s2 * duration_s;

        let mut transition = SMatrix::<f64, GYRO_BIAS, MOVING>::zeros();
        transition.fill_with_identity();
        let mut position = transition.fixed_rows_mut::<3>(POSITION);
        position += velocity * (0.5 * duration_s);
        position.fixed_view_mut::<3, 3>(0, VELOCITY).fill_diagonal(duration_s);
        let mut velocity_rows = transition.fixed_rows_mut::<3>(VELOCITY);
        velocity_rows += velocity;
        let mut attitude = transition.fixed_rows_mut::<3>(ATTITUDE);
        attitude.fixed_view_mut::<3, 3>(0, ATTITUDE).copy_from(&(half * half).transpose());
        attitude.fixed_view_mut::<3, 3>(0, GYRO_BIAS).fill_diagonal(-duration_s);
        attitude
            .fixed_view_mut::<3, 3>(0, GYRO_SCALE)
            .copy_from(&Matrix3::from_diagonal(&(rate_b * -duration_s)));
        transition
    }

    /// Random walks and drifts (G.53).
    fn add_noise(&mut self, imu: &ImuSpec, duration_s: f64, bridged: bool) {
        let walk = |triad: &TriadSpec, guess: f64| {
            let density = if bridged { guess * guess * BRIDGED_TIME_S } else { 0.0 };
            (square(triad.random_walk) + density) * duration_s
        };
        let velocity = walk(&imu.accelerometer, BRIDGED_FORCE_M_S2);
        let attitude = walk(&imu.gyro, BRIDGED_RATE_RAD_S);
        let drift = |triad: &TriadSpec| {
            2.0 * square(triad.drift) * duration_s / triad.drift_time_s.max(f64::MIN_POSITIVE)
        };
        let p = &mut self.covariance;
        for axis in 0..3 {
            let (r, v) = (POSITION + axis, VELOCITY + axis);
            p[(r, r)] += velocity * (0.25 * duration_s * duration_s);
            p[(r, v)] += velocity * (0.5 * duration_s);
            p[(v, r)] += velocity * (0.5 * duration_s);
            p[(v, v)] += velocity;
            p[(ATTITUDE + axis, ATTITUDE + axis)] += attitude;
            p[(GYRO_BIAS + axis, GYRO_BIAS + axis)] += drift(&imu.gyro);
            let bias = ACCELEROMETER_BIAS + axis;
            p[(bias, bias)] += drift(&imu.accelerometer);
        }
    }

    /// Takes a measurement, unless it is too far from what was predicted (G.54 to G.56).
    pub fn update<const M: usize>(&mut self, innovation: &Innovation<M>) -> Update {
        let Innovation { value, sensitivity, noise } = innovation;
        let p = &self.covariance;
        let seen = sensitivity * p;
        let spread = seen * sensitivity.transpose() + noise;
        let Some(inverse) = ((spread + spread.transpose()) * 0.5).try_inverse() else {
            return Update { nis: f64::INFINITY, taken: false };
        };
        let nis = value.dot(&(inverse * value));
        // Written so that NaN is refused.
        if !(nis >= 0.0 && nis <= GATE[M - 1]) {
            return Update { nis, taken: false };
        }
        let gain = seen.transpose() * inverse;
        let kept = Covariance::identity() - gain * sensitivity;
        let joseph = kept * p * kept.transpose() + gain * noise * gain.transpose();
        self.covariance = (joseph + joseph.transpose()) * 0.5;
        self.nominal = self.nominal.plus(&(gain * value));
        Update { nis, taken: true }
    }

    /// Standard deviations of three neighbouring errors.
    pub fn sigma3(&self, place: usize) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| self.covariance[(place + axis, place + axis)].sqrt())
    }

    /// Standard deviation of each of several linear functions of the errors.
    pub fn sigma_of<const M: usize>(
        &self,
        sensitivity: &SMatrix<f64, M, ERRORS>,
    ) -> SVector<f64, M> {
        (sensitivity * self.covariance * sensitivity.transpose()).diagonal().map(f64::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use claims::{Bound, Claim};
    use lander_models::frames::Attitude;
    use lander_models::time::Ticks;

    use super::*;

    const GRAVITY_M_S2: f64 = 1.625;
    const PERIOD_S: f64 = 0.01;

    fn imu() -> ImuSpec {
        let triad = TriadSpec { random_walk: 2e-3, ..TriadSpec::default() };
        ImuSpec { mount_b: Vector3::zeros(), period: Ticks(10), accelerometer: triad, gyro: triad }
    }

    /// At rest on level ground, where every error was nought but those given, for `seconds`.
    fn drifted(errors: &[(usize, f64)], imu: &ImuSpec, seconds: f64) -> Filter {
        let nominal = Nominal::new(Vector3::zeros(), Vector3::zeros(), Attitude::identity());
        let mut filter = Filter { nominal, covariance: Covariance::zeros() };
        for (place, sigma) in errors {
            filter.covariance[(*place, *place)] = sigma * sigma;
        }
        let means =
            ImuSample { specific_force_b: Vector3::z() * GRAVITY_M_S2, rate_b: Vector3::zeros() };
        for _ in 0..(seconds / PERIOD_S).round() as usize {
            filter.propagate(&means, imu, GRAVITY_M_S2, PERIOD_S, false);
        }
        filter
    }

    fn quiet() -> ImuSpec {
        let triad = TriadSpec::default();
        ImuSpec { accelerometer: triad, gyro: triad, ..imu() }
    }

    #[test]
    fn free_inertial_drift_is_the_closed_form_of_each_source() {
        let seconds: f64 = 60.0;
        let (t, walk, g) = (seconds, 2e-3, GRAVITY_M_S2);
        let noisy = drifted(&[], &imu(), seconds);
        let biased = drifted(&[(ACCELEROMETER_BIAS + 2, 7e-3)], &quiet(), seconds);
        let tilted = drifted(&[(ATTITUDE, 1e-3)], &quiet(), seconds);
        let turning = drifted(&[(GYRO_BIAS, 2e-5)], &quiet(), seconds);
        let light = drifted(&[(GRAVITY, 1e-3)], &quiet(), seconds);
        let sigma = |filter: &Filter, place: usize| filter.covariance[(place, place)].sqrt();
        let pairs = [
            // White noise: velocity N √t, position N √(t³/3) along the force; tilt N √t.
            (sigma(&noisy, VELOCITY + 2), walk * t.sqrt()),
            (sigma(&noisy, POSITION + 2), walk * (t.powi(3) / 3.0).sqrt()),
            (sigma(&noisy, ATTITUDE), walk * t.sqrt()),
            // Across it a walking tilt adds g N √(t³/3).
            (sigma(&noisy, VELOCITY), walk * (t + g * g * t.powi(3) / 3.0).sqrt()),
            // Bias: b t and b t²/2; tilt: g θ t; gyro bias: g b t²/2 and g b t³/6.
            (sigma(&biased, VELOCITY + 2), 7e-3 * t),
            (sigma(&biased, POSITION + 2), 7e-3 * t * t / 2.0),
            (sigma(&tilted, VELOCITY + 1), g * 1e-3 * t),
            (sigma(&turning, VELOCITY + 1), g * 2e-5 * t * t / 2.0),
            (sigma(&turning, POSITION + 1), g * 2e-5 * t.powi(3) / 6.0),
            (sigma(&light, POSITION + 2), 1e-3 * g * t * t / 2.0),
        ];
        Claim {
            id: "navigation-inertial-drift",
            section: "Navigation",
            claim: "deviations after 60 s without any fix, from noise, bias, tilt and gravity",
            reference: "closed forms: N √t, N √(t³/3), b t²/2, g b t³/6 and the like",
            unit: "",
            bound: Bound::AtMost(3e-4),
            origin: "sums over periods of 10 ms stand for integrals: 1.5 T/t = 2.5e-4 at most",
            noise: 0.0,
        }
        .holds_for(pairs.map(|(found, exact)| found / exact - 1.0));
    }

    #[test]
    fn a_scalar_update_is_the_textbook_s_and_an_outlier_is_left_alone() {
        let mut filter = drifted(&[(POSITION, 3.0)], &quiet(), 0.0);
        let at = |value: f64| {
            let mut sensitivity = SMatrix::<f64, 1, ERRORS>::zeros();
            sensitivity[POSITION] = 1.0;
            Innovation {
                value: SVector::from([value]),
                sensitivity,
                noise: SMatrix::from([[16.0]]),
            }
        };
        // Deviation 5 of the innovation: 3.8 of them pass a gate at 3.89, 4 don't.
        let before = filter.clone();
        let refused = filter.update(&at(20.0));
        assert!(!refused.taken && (refused.nis - 16.0).abs() < 1e-12);
        assert_eq!(filter.covariance, before.covariance);
        assert!(!filter.update(&at(f64::NAN)).taken);
        assert!(filter.update(&at(19.0)).taken);
        // Gain 9/25, variance 9 · 16/25; roundings.
        assert!((filter.nominal.position_w.x - 19.0 * 9.0 / 25.0).abs() < 1e-12);
        assert!((filter.covariance[(0, 0)] - 9.0 * 16.0 / 25.0).abs() < 1e-12);
    }
}
