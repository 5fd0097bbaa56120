//! Inertial measurement unit: accelerometers and gyros of a strapdown unit (T.75 to T.78).

use lander_models::frames::Attitude;
use lander_models::scenario::SensorSettings;
use lander_models::time::Ticks;
use lander_models::vehicle::{ImuSpec, TriadSpec};
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::sampling::{Draws, Reading, Schedule};
use crate::flight::Motion;

/// Means over one period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Specific force of the mounting point, in the body axes half way through the period, m/s².
    pub specific_force_b: Vector3<f64>,
    /// Rotation vector of the period over its length, rad/s.
    pub rate_b: Vector3<f64>,
}

/// Motion of the mounting point at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instant {
    pub velocity_w: Vector3<f64>,
    pub attitude_wb: Attitude,
}

impl Instant {
    pub fn of(motion: &Motion, mount_b: &Vector3<f64>) -> Self {
        Self { velocity_w: motion.point_velocity_w(mount_b), attitude_wb: motion.attitude_wb }
    }
}

/// What an ideal unit tells of the motion between two instants (T.75, T.76): with these means
/// strapdown integration over the period is exact, so they are free of coning and sculling.
pub fn means(from: &Instant, to: &Instant, gravity_w: &Vector3<f64>, period_s: f64) -> Sample {
    let turn_b = (from.attitude_wb.inverse() * to.attitude_wb).scaled_axis();
    let middle_wb = from.attitude_wb * UnitQuaternion::from_scaled_axis(turn_b * 0.5);
    let gained_w = to.velocity_w - from.velocity_w - gravity_w * period_s;
    Sample {
        specific_force_b: middle_wb.inverse() * gained_w / period_s,
        rate_b: turn_b / period_s,
    }
}

/// Three like axes with their errors.
#[derive(Clone, Debug)]
struct Triad {
    spec: TriadSpec,
    draws: Draws,
    noise_stream: &'static str,
    drift_stream: &'static str,
    bias: Vector3<f64>,
    scale: Vector3<f64>,
}

impl Triad {
    fn new(
        spec: TriadSpec,
        draws: Draws,
        [bias, scale, noise_stream, drift_stream]: [&'static str; 4],
    ) -> Self {
        Self {
            bias: draws.normal3(bias, 0) * spec.bias,
            scale: draws.normal3(scale, 0) * spec.scale,
            spec,
            draws,
            noise_stream,
            drift_stream,
        }
    }

    /// Bias instability at t = 0: the process is stationary.
    fn first_drift(&self) -> Vector3<f64> {
        self.draws.normal3(self.drift_stream, 0) * self.spec.drift
    }

    /// (T.78)
    fn next_drift(&self, drift: &Vector3<f64>, index: u64, period_s: f64) -> Vector3<f64> {
        let kept = libm::exp(-period_s / self.spec.drift_time_s.max(f64::MIN_POSITIVE));
        let new = self.spec.drift * (1.0 - kept * kept).sqrt();
        drift * kept + self.draws.normal3(self.drift_stream, index) * new
    }

    /// (T.77)
    fn measured(
        &self,
        value: &Vector3<f64>,
        drift: &Vector3<f64>,
        index: u64,
        period_s: f64,
    ) -> Vector3<f64> {
        let noise = self.draws.normal3(self.noise_stream, index);
        value
            + value.component_mul(&self.scale)
            + self.bias
            + drift
            + noise * (self.spec.random_walk / period_s.sqrt())
    }
}

/// From tick to tick.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Memory {
    /// Where the present period began.
    from: Instant,
    accelerometer_drift: Vector3<f64>,
    gyro_drift: Vector3<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct Imu {
    schedule: Schedule,
    mount_b: Vector3<f64>,
    period: Ticks,
    accelerometer: Triad,
    gyro: Triad,
}

impl Imu {
    pub fn new(spec: ImuSpec, settings: SensorSettings, seed: u64) -> Self {
        let draws = Draws::new(seed, &settings);
        Self {
            accelerometer: Triad::new(
                spec.accelerometer,
                draws,
                [
                    "imu.accelerometer.bias",
                    "imu.accelerometer.scale",
                    "imu.accelerometer.noise",
                    "imu.accelerometer.drift",
                ],
            ),
            gyro: Triad::new(
                spec.gyro,
                draws,
                ["imu.gyro.bias", "imu.gyro.scale", "imu.gyro.noise", "imu.gyro.drift"],
            ),
            mount_b: spec.mount_b,
            period: spec.period,
            schedule: Schedule::new(seed, "imu.drop_out", spec.period, settings),
        }
    }

    /// At t = 0, where the first period begins.
    pub fn start(&self, motion: &Motion) -> Memory {
        Memory {
            from: Instant::of(motion, &self.mount_b),
            accelerometer_drift: self.accelerometer.first_drift(),
            gyro_drift: self.gyro.first_drift(),
        }
    }

    /// Ends a period if this tick does. What was measured in a lost one is lost.
    pub fn sense(
        &self,
        now: Ticks,
        motion: &Motion,
        gravity_w: &Vector3<f64>,
        failed: bool,
        memory: &mut Memory,
        reading: &mut Reading<Sample>,
    ) {
        // The first period ends with sample 1: there is no sample 0.
        let Some(index) = self.schedule.due(now).filter(|index| *index > 0) else { return };
        let period_s = self.period.seconds();
        let to = Instant::of(motion, &self.mount_b);
        let exact = means(&memory.from, &to, gravity_w, period_s);
        let (accelerometer, gyro) = (&self.accelerometer, &self.gyro);
        *memory = Memory {
            from: to,
            accelerometer_drift: accelerometer.next_drift(
                &memory.accelerometer_drift,
                index,
                period_s,
            ),
            gyro_drift: gyro.next_drift(&memory.gyro_drift, index, period_s),
        };
        let lost = failed || self.schedule.is_lost(now, index);
        reading.take((!lost).then(|| Sample {
            specific_force_b: accelerometer.measured(
                &exact.specific_force_b,
                &memory.accelerometer_drift,
                index,
                period_s,
            ),
            rate_b: gyro.measured(&exact.rate_b, &memory.gyro_drift, index, period_s),
        }));
    }
}
