//! When a sensor takes a sample, whether the sample arrives, and what is held between.

use lander_models::scenario::SensorSettings;
use lander_models::time::Ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Scene;
use crate::random;

/// What a sensor last told, held until its next sample arrives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading<T> {
    pub value: T,
    /// The last sample arrived.
    pub valid: bool,
    /// That arrived so far.
    pub samples: u64,
}

impl<T: Copy> Reading<T> {
    /// No sample yet.
    pub(super) fn before_any(value: T) -> Self {
        Self { value, valid: false, samples: 0 }
    }

    /// A sample was due: `None` if it was lost.
    pub(super) fn take(&mut self, sample: Option<T>) {
        self.valid = sample.is_some();
        if let Some(value) = sample {
            self.value = value;
            self.samples += 1;
        }
    }
}

/// The times of one sensor's samples, and their losses. Draws are indexed by sample, so a lost
/// sample shifts no later one.
#[derive(Clone, Debug)]
pub struct Schedule {
    seed: u64,
    /// Stream of the losses.
    stream: &'static str,
    period: Ticks,
    settings: SensorSettings,
}

impl Schedule {
    pub(super) fn new(
        seed: u64,
        stream: &'static str,
        period: Ticks,
        settings: SensorSettings,
    ) -> Self {
        Self { seed, stream, period, settings }
    }

    /// Index of the sample that is due now, if one is.
    pub(super) fn due(&self, now: Ticks) -> Option<u64> {
        now.0.is_multiple_of(self.period.0).then(|| now.0 / self.period.0)
    }

    pub(super) fn is_lost(&self, now: Ticks, index: u64) -> bool {
        let probability = self.settings.drop_out_probability;
        self.settings.drop_outs.iter().any(|drop_out| drop_out.covers(now))
            || (probability > 0.0 && random::uniform(self.seed, self.stream, index) < probability)
    }
}

/// A sensor that reads the scene at an instant.
pub(super) trait Instrument {
    type Value: Copy;

    /// The true value, and whether there is anything to be measured at all.
    fn exact(&self, scene: &Scene) -> (Self::Value, bool);

    /// Sample `index` with its errors. `None` outside the sensor's limits.
    fn measure(&self, scene: &Scene, index: u64) -> Option<Self::Value>;
}

/// An instrument with its times.
#[derive(Clone, Debug)]
pub(super) struct Channel<I> {
    pub schedule: Schedule,
    pub instrument: I,
}

impl<I: Instrument> Channel<I> {
    /// Takes a sample if one is due.
    pub fn sense(&self, scene: &Scene, failed: bool, reading: &mut Reading<I::Value>) {
        if let Some(index) = self.schedule.due(scene.now) {
            let lost = failed || self.schedule.is_lost(scene.now, index);
            reading.take(if lost { None } else { self.instrument.measure(scene, index) });
        }
    }

    /// Exact and of this tick; `held` while the sensor has failed.
    pub fn perfect(
        &self,
        scene: &Scene,
        failed: bool,
        held: &Reading<I::Value>,
    ) -> Reading<I::Value> {
        if failed {
            return Reading { valid: false, ..*held };
        }
        let (value, valid) = self.instrument.exact(scene);
        Reading { value, valid, samples: scene.now.0 + 1 }
    }
}

/// The errors' draws: all zero where the scenario has switched errors off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Draws {
    seed: u64,
    on: bool,
}

impl Draws {
    pub fn new(seed: u64, settings: &SensorSettings) -> Self {
        Self { seed, on: settings.errors }
    }

    /// Standard normal: draw `index` of a stream.
    pub fn normal(&self, stream: &str, index: u64) -> f64 {
        if self.on { random::normal(self.seed, stream, index) } else { 0.0 }
    }

    /// Three independent standard normals.
    pub fn normal3(&self, stream: &str, index: u64) -> Vector3<f64> {
        if self.on { random::normal3(self.seed, stream, index) } else { Vector3::zeros() }
    }

    /// True with this probability.
    pub fn chance(&self, probability: f64, stream: &str, index: u64) -> bool {
        self.on && random::uniform(self.seed, stream, index) < probability
    }
}
