//! Doppler velocimeter: velocity against the ground in body axes (T.81).

use lander_models::scenario::SensorSettings;
use lander_models::vehicle::VelocimeterSpec;
use nalgebra::Vector3;

use super::Scene;
use super::altimeter::slant_range_m;
use super::sampling::{Channel, Draws, Instrument, Schedule};

#[derive(Clone, Debug)]
pub(super) struct Velocimeter {
    spec: VelocimeterSpec,
    draws: Draws,
    bias_b: Vector3<f64>,
    scale: Vector3<f64>,
}

impl Velocimeter {
    pub fn channel(spec: VelocimeterSpec, settings: SensorSettings, seed: u64) -> Channel<Self> {
        let draws = Draws::new(seed, &settings);
        Channel {
            schedule: Schedule::new(seed, "velocimeter.drop_out", spec.period, settings),
            instrument: Self {
                bias_b: draws.normal3("velocimeter.bias", 0) * spec.bias_m_s,
                scale: draws.normal3("velocimeter.scale", 0) * spec.scale,
                spec,
                draws,
            },
        }
    }
}

impl Instrument for Velocimeter {
    type Value = Vector3<f64>;

    fn exact(&self, scene: &Scene) -> (Vector3<f64>, bool) {
        let velocity_w = scene.motion.point_velocity_w(&self.spec.mount_b);
        (scene.motion.attitude_wb.inverse() * velocity_w, true)
    }

    fn measure(&self, scene: &Scene, index: u64) -> Option<Vector3<f64>> {
        let (velocity_b, _) = self.exact(scene);
        let range_m = slant_range_m(scene, &self.spec.mount_b)?;
        let within =
            self.spec.range_m.contains(&range_m) && velocity_b.norm() <= self.spec.speed_max_m_s;
        // (T.81)
        let sigma_b = velocity_b
            .map(|speed| libm::hypot(self.spec.noise_m_s, self.spec.noise_relative * speed));
        let noise_b = self.draws.normal3("velocimeter.noise", index).component_mul(&sigma_b);
        within.then(|| velocity_b + self.bias_b + self.scale.component_mul(&velocity_b) + noise_b)
    }
}
