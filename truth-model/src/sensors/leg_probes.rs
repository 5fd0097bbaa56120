//! Contact probes of the legs (T.83).

use lander_models::scenario::SensorSettings;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::Ticks;
use lander_models::vehicle::LegProbeSpec;

use super::Scene;
use super::sampling::{Channel, Draws, Instrument, Schedule};

#[derive(Clone, Debug)]
pub(super) struct LegProbes {
    spec: LegProbeSpec,
    /// Never tells a contact in this run.
    dead: [bool; FOOT_SLOTS],
}

impl LegProbes {
    pub fn channel(spec: LegProbeSpec, settings: SensorSettings, seed: u64) -> Channel<Self> {
        let draws = Draws::new(seed, &settings);
        let dead = std::array::from_fn(|leg| {
            draws.chance(spec.miss_probability, "leg_probes.miss", leg as u64)
        });
        Channel {
            schedule: Schedule::new(seed, "leg_probes.drop_out", spec.period, settings),
            instrument: Self { spec, dead },
        }
    }

    /// How far a probe reaches below its pad, m.
    pub fn length_m(&self) -> f64 {
        self.spec.length_m
    }
}

impl Instrument for LegProbes {
    type Value = [bool; FOOT_SLOTS];

    fn exact(&self, scene: &Scene) -> (Self::Value, bool) {
        (scene.touching, true)
    }

    fn measure(&self, scene: &Scene, _: u64) -> Option<Self::Value> {
        // (T.83)
        Some(std::array::from_fn(|leg| {
            let told = |since: Ticks| scene.now >= since + self.spec.delay;
            !self.dead[leg] && scene.touched_since[leg].is_some_and(told)
        }))
    }
}
