//! The filter itself: covariance propagation and the gated update (G.52 to G.56).

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
            (triad.random_walk.powi(2) + density) * duration_s
        };
        let velocity = walk(&imu.accelerometer, BRIDGED_FORCE_M_S2);
        let attitude = walk(&imu.gyro, BRIDGED_RATE_RAD_S);
        let drift = |triad: &TriadSpec| {
            2.0 * triad.drift.powi(2) * duration_s / triad.drift_time_s.max(f64::MIN_POSITIVE)
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
