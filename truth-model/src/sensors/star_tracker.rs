//! Star tracker: attitude (T.82).

use lander_models::frames::Attitude;
use lander_models::scenario::SensorSettings;
use lander_models::vehicle::StarTrackerSpec;
use nalgebra::{UnitQuaternion, Vector3};

use super::Scene;
use super::sampling::{Channel, Draws, Instrument, Schedule};

#[derive(Clone, Debug)]
pub(super) struct StarTracker {
    spec: StarTrackerSpec,
    draws: Draws,
    misalignment_b: Vector3<f64>,
}

impl StarTracker {
    pub fn channel(spec: StarTrackerSpec, settings: SensorSettings, seed: u64) -> Channel<Self> {
        let draws = Draws::new(seed, &settings);
        Channel {
            schedule: Schedule::new(seed, "star_tracker.drop_out", spec.period, settings),
            instrument: Self {
                misalignment_b: draws.normal3("star_tracker.misalignment", 0)
                    * spec.misalignment_rad,
                spec,
                draws,
            },
        }
    }
}

impl Instrument for StarTracker {
    type Value = Attitude;

    fn exact(&self, scene: &Scene) -> (Attitude, bool) {
        (scene.motion.attitude_wb, true)
    }

    fn measure(&self, scene: &Scene, index: u64) -> Option<Attitude> {
        if scene.motion.rate_b.norm() > self.spec.rate_max_rad_s {
            return None;
        }
        // (T.82) The draw's part along the boresight is the error about it.
        let draw_b = self.draws.normal3("star_tracker.noise", index);
        let about_b = *self.spec.boresight_b * self.spec.boresight_b.dot(&draw_b);
        let turn_b = self.misalignment_b
            + (draw_b - about_b) * self.spec.noise_across_rad
            + about_b * self.spec.noise_about_rad;
        Some(scene.motion.attitude_wb * UnitQuaternion::from_scaled_axis(turn_b))
    }
}
