//! Laser altimeter along body −z (T.79, T.80).

use lander_models::scenario::SensorSettings;
use lander_models::vehicle::AltimeterSpec;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::sampling::{Channel, Draws, Instrument, Schedule};
use super::{Scene, beam};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Of O above the ground below it, m.
    pub height_m: f64,
    /// From the mounting point along the beam, m; 0 without a return.
    pub range_m: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Altimeter {
    spec: AltimeterSpec,
    draws: Draws,
    bias_m: f64,
    scale: f64,
}

impl Altimeter {
    pub fn channel(spec: AltimeterSpec, settings: SensorSettings, seed: u64) -> Channel<Self> {
        let draws = Draws::new(seed, &settings);
        Channel {
            schedule: Schedule::new(seed, "altimeter.drop_out", spec.period, settings),
            instrument: Self {
                bias_m: draws.normal("altimeter.bias", 0) * spec.bias_m,
                scale: draws.normal("altimeter.scale", 0) * spec.scale,
                spec,
                draws,
            },
        }
    }
}

impl Instrument for Altimeter {
    type Value = Sample;

    fn exact(&self, scene: &Scene) -> (Sample, bool) {
        let range_m = slant_range_m(scene, &self.spec.mount_b);
        let sample = Sample { height_m: scene.height_m(), range_m: range_m.unwrap_or(0.0) };
        (sample, range_m.is_some())
    }

    fn measure(&self, scene: &Scene, index: u64) -> Option<Sample> {
        let (exact, seen) = self.exact(scene);
        if !seen || !self.spec.range_m.contains(&exact.range_m) {
            return None;
        }
        // (T.80)
        let sigma_m = libm::hypot(self.spec.noise_m, self.spec.noise_relative * exact.range_m);
        let noise_m = self.draws.normal("altimeter.noise", index) * sigma_m;
        let error_m = self.bias_m + self.scale * exact.range_m + noise_m;
        let cos_tilt = -beam_w(scene).z;
        Some(Sample {
            height_m: exact.height_m + error_m * cos_tilt,
            range_m: exact.range_m + error_m,
        })
    }
}

/// Along the beam of a sensor that looks down the body's axis.
pub(super) fn slant_range_m(scene: &Scene, mount_b: &Vector3<f64>) -> Option<f64> {
    let height_m = |x_m: f64, y_m: f64| scene.ground.height_m(x_m, y_m);
    beam::range_m(height_m, &scene.motion.point_position_w(mount_b), &beam_w(scene))
}

fn beam_w(scene: &Scene) -> Vector3<f64> {
    scene.motion.attitude_wb * -Vector3::z()
}
