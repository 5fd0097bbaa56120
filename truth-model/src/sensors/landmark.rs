//! Terrain-relative position fix (T.84).

use lander_models::scenario::SensorSettings;
use lander_models::vehicle::LandmarkSpec;
use nalgebra::Vector3;

use super::Scene;
use super::sampling::{Channel, Draws, Instrument, Schedule};

#[derive(Clone, Debug)]
pub(super) struct Landmark {
    spec: LandmarkSpec,
    draws: Draws,
    bias_w: Vector3<f64>,
}

impl Landmark {
    pub fn channel(spec: LandmarkSpec, settings: SensorSettings, seed: u64) -> Channel<Self> {
        let draws = Draws::new(seed, &settings);
        Channel {
            schedule: Schedule::new(seed, "landmark.drop_out", spec.period, settings),
            instrument: Self {
                bias_w: draws.normal3("landmark.bias", 0).component_mul(&spec.bias_w),
                spec,
                draws,
            },
        }
    }
}

impl Instrument for Landmark {
    type Value = Vector3<f64>;

    fn exact(&self, scene: &Scene) -> (Vector3<f64>, bool) {
        (scene.motion.position_w, true)
    }

    fn measure(&self, scene: &Scene, index: u64) -> Option<Vector3<f64>> {
        // (T.84)
        let noise_w = self.draws.normal3("landmark.noise", index).component_mul(&self.spec.noise_w);
        let in_sight = self.spec.height_m.contains(&scene.height_m());
        in_sight.then(|| scene.motion.position_w + self.bias_w + noise_w)
    }
}
