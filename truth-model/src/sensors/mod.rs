//! Sensors: what is measured of the truth, when, and how wrongly (T.75 to T.84 in the README).

mod altimeter;
pub mod beam;
pub mod imu;
mod landmark;
mod leg_probes;
mod sampling;
mod star_tracker;
mod velocimeter;

use lander_models::frames::Attitude;
use lander_models::scenario::{Navigation, PerSensor, Scenario, SensorSettings};
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::Ticks;
use lander_models::vehicle::{LandmarkSpec, Sensors, Vehicle};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::flight::Motion;
use crate::model::{State, TruthModel};
use crate::terrain::Ground;
use altimeter::Altimeter;
pub use altimeter::Sample as AltimeterSample;
use imu::Imu;
use landmark::Landmark;
use leg_probes::LegProbes;
pub use sampling::Reading;
use sampling::{Channel, Instrument};
use star_tracker::StarTracker;
use velocimeter::Velocimeter;

/// The vehicle's sensors in this run, with the errors that were drawn at turn-on. Constant.
#[derive(Clone, Debug)]
pub struct SensorSuite {
    navigation: Navigation,
    imu: Imu,
    altimeter: Channel<Altimeter>,
    velocimeter: Channel<Velocimeter>,
    star_tracker: Channel<StarTracker>,
    leg_probes: Channel<LegProbes>,
    landmark: Option<Channel<Landmark>>,
}

/// The readings of all sensors. Before its first sample a sensor's holds what was true at the
/// start, as handed over from the flight before, and is not valid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Readings {
    pub imu: Reading<imu::Sample>,
    pub altimeter: Reading<AltimeterSample>,
    /// Velocity of the mounting point, body frame, m/s.
    pub velocimeter: Reading<Vector3<f64>>,
    pub star_tracker: Reading<Attitude>,
    /// Per leg: in contact.
    pub leg_probes: Reading<[bool; FOOT_SLOTS]>,
    /// Position of O, world frame, m.
    pub landmark: Reading<Vector3<f64>>,
}

/// What sensors remember from tick to tick.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SensorState {
    /// The last samples. With perfect navigation only those of the IMU and of failed sensors
    /// count: `TruthModel::readings` knows.
    last: Readings,
    failed: PerSensor<bool>,
    imu: imu::Memory,
    touched_since: [Option<Ticks>; FOOT_SLOTS],
}

/// What there is to be sensed at one instant.
struct Scene<'a> {
    now: Ticks,
    motion: Motion,
    ground: &'a Ground,
    /// Per leg: the probe or the pad touches the ground.
    touching: [bool; FOOT_SLOTS],
    /// Without a break.
    touched_since: [Option<Ticks>; FOOT_SLOTS],
}

impl Scene<'_> {
    /// Of O above the ground below it, m.
    fn height_m(&self) -> f64 {
        let position_w = &self.motion.position_w;
        position_w.z - self.ground.height_m(position_w.x, position_w.y)
    }
}

impl SensorSuite {
    pub fn new(scenario: &Scenario, vehicle: &Vehicle) -> Self {
        let fit = vehicle.sensors.clone().unwrap_or_else(Sensors::ideal);
        let navigation = scenario.sensing.navigation;
        let chosen = &scenario.sensing.sensors;
        let settings = |chosen: &SensorSettings| match navigation {
            Navigation::Sensors => chosen.clone(),
            Navigation::Perfect => SensorSettings { errors: false, ..SensorSettings::default() },
        };
        let seed = scenario.seed;
        Self {
            navigation,
            imu: Imu::new(fit.imu, settings(&chosen.imu), seed),
            altimeter: Altimeter::channel(fit.altimeter, settings(&chosen.altimeter), seed),
            velocimeter: Velocimeter::channel(fit.velocimeter, settings(&chosen.velocimeter), seed),
            star_tracker: StarTracker::channel(
                fit.star_tracker,
                settings(&chosen.star_tracker),
                seed,
            ),
            leg_probes: LegProbes::channel(fit.leg_probes, settings(&chosen.leg_probes), seed),
            landmark: fit.landmark.map(|spec| {
                let bias_w = scenario.guidance.map_bias_w(&spec);
                let spec = LandmarkSpec { bias_w, ..spec };
                Landmark::channel(spec, settings(&chosen.landmark), seed)
            }),
        }
    }

    /// Before any sample: true at this instant, but valid nowhere.
    fn start(&self, scene: &Scene) -> SensorState {
        fn held<I: Instrument>(channel: &Channel<I>, scene: &Scene) -> Reading<I::Value> {
            Reading::before_any(channel.instrument.exact(scene).0)
        }
        SensorState {
            last: Readings {
                imu: Reading::before_any(imu::Sample::default()),
                altimeter: held(&self.altimeter, scene),
                velocimeter: held(&self.velocimeter, scene),
                star_tracker: held(&self.star_tracker, scene),
                leg_probes: held(&self.leg_probes, scene),
                landmark: Reading::before_any(scene.motion.position_w),
            },
            failed: PerSensor::default(),
            imu: self.imu.start(&scene.motion),
            touched_since: scene.touched_since,
        }
    }

    /// Exact readings of this instant; `last` for sensors that have failed and for the IMU, whose
    /// readings are of no instant.
    fn perfect(&self, scene: &Scene, failed: &PerSensor<bool>, last: &Readings) -> Readings {
        let landmark = self.landmark.as_ref();
        Readings {
            imu: last.imu,
            altimeter: self.altimeter.perfect(scene, failed.altimeter, &last.altimeter),
            velocimeter: self.velocimeter.perfect(scene, failed.velocimeter, &last.velocimeter),
            star_tracker: self.star_tracker.perfect(scene, failed.star_tracker, &last.star_tracker),
            leg_probes: self.leg_probes.perfect(scene, failed.leg_probes, &last.leg_probes),
            landmark: landmark.map_or(last.landmark, |channel| {
                channel.perfect(scene, failed.landmark, &last.landmark)
            }),
        }
    }

    fn sample(&self, scene: &Scene, failed: &PerSensor<bool>, last: &mut Readings) {
        self.altimeter.sense(scene, failed.altimeter, &mut last.altimeter);
        self.velocimeter.sense(scene, failed.velocimeter, &mut last.velocimeter);
        self.star_tracker.sense(scene, failed.star_tracker, &mut last.star_tracker);
        self.leg_probes.sense(scene, failed.leg_probes, &mut last.leg_probes);
        if let Some(landmark) = &self.landmark {
            landmark.sense(scene, failed.landmark, &mut last.landmark);
        }
    }
}

impl Readings {
    /// Whether the last sample arrived.
    pub fn valid(&self) -> PerSensor<bool> {
        PerSensor {
            imu: self.imu.valid,
            altimeter: self.altimeter.valid,
            velocimeter: self.velocimeter.valid,
            star_tracker: self.star_tracker.valid,
            leg_probes: self.leg_probes.valid,
            landmark: self.landmark.valid,
        }
    }

    /// Samples that arrived so far.
    pub fn samples(&self) -> PerSensor<u64> {
        PerSensor {
            imu: self.imu.samples,
            altimeter: self.altimeter.samples,
            velocimeter: self.velocimeter.samples,
            star_tracker: self.star_tracker.samples,
            leg_probes: self.leg_probes.samples,
            landmark: self.landmark.samples,
        }
    }
}

impl TruthModel {
    /// What the sensors tell at this instant.
    pub fn readings(&self, state: &State) -> Readings {
        let (suite, sensors) = (self.sensors(), &state.sensors);
        match suite.navigation {
            Navigation::Sensors => sensors.last.clone(),
            Navigation::Perfect => {
                suite.perfect(&self.scene(state), &sensors.failed, &sensors.last)
            }
        }
    }

    /// Sensors at t = 0, which is a sampling instant of all but the IMU.
    pub(crate) fn start_sensors(&self, motion: &Motion) -> SensorState {
        let scene = Scene {
            now: Ticks::ZERO,
            motion: *motion,
            ground: self.ground(),
            touching: [false; FOOT_SLOTS],
            touched_since: [None; FOOT_SLOTS],
        };
        let mut sensors = self.sensors().start(&scene);
        if self.sensors().navigation == Navigation::Sensors {
            self.sensors().sample(&scene, &PerSensor::default(), &mut sensors.last);
        }
        sensors
    }

    /// Takes the samples that are due after this tick. A sensor that has `failed` delivers none:
    /// its last reading is held.
    pub(crate) fn sense(&self, state: &mut State, failed: &PerSensor<bool>) {
        let suite = self.sensors();
        if suite.navigation == Navigation::Perfect {
            if *failed != state.sensors.failed {
                state.sensors.last = self.readings(state);
            }
        } else {
            let mut scene = self.scene(state);
            for (since, touching) in scene.touched_since.iter_mut().zip(scene.touching) {
                *since = touching.then(|| since.unwrap_or(state.now));
            }
            suite.sample(&scene, failed, &mut state.sensors.last);
            state.sensors.touched_since = scene.touched_since;
        }
        state.sensors.failed = *failed;
        let SensorState { last, imu, .. } = &mut state.sensors;
        let gravity_w = self.site().gravity_w;
        suite.imu.sense(state.now, &state.motion, &gravity_w, failed.imu, imu, &mut last.imu);
    }

    fn scene(&self, state: &State) -> Scene<'_> {
        let length_m = self.sensors().leg_probes.instrument.length_m();
        let mut touching = [false; FOOT_SLOTS];
        for (slot, down) in touching.iter_mut().zip(&state.feet_down) {
            *slot = *down;
        }
        if length_m > 0.0 {
            for (slot, clearance_m) in touching.iter_mut().zip(self.foot_clearances_m(state)) {
                *slot |= clearance_m < length_m;
            }
        }
        Scene {
            now: state.now,
            motion: state.motion,
            ground: self.ground(),
            touching,
            touched_since: state.sensors.touched_since,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(navigation: Navigation) -> TruthModel {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");
        let (mut scenario, vehicle) = Scenario::load(file.as_ref()).unwrap();
        scenario.sensing.navigation = navigation;
        TruthModel::new(scenario, vehicle)
    }

    /// Readings after `ticks` more, with these failures.
    fn after(
        model: &TruthModel,
        state: &mut State,
        ticks: u64,
        failed: &PerSensor<bool>,
    ) -> Readings {
        for _ in 0..ticks {
            state.motion.position_w.z -= 0.02;
            state.now += Ticks(1);
            model.sense(state, failed);
        }
        model.readings(state)
    }

    #[test]
    fn a_failed_sensor_holds_its_last_reading_until_it_recovers() {
        for navigation in [Navigation::Perfect, Navigation::Sensors] {
            let model = model(navigation);
            let mut state = model.initial_state();
            let fine = PerSensor::default();
            let broken = PerSensor { altimeter: true, imu: true, ..fine };
            let before = after(&model, &mut state, 100, &fine);
            // A perfect altimeter still tells the height at the onset, one tick later.
            let onset = after(&model, &mut state, 1, &broken);
            let during = after(&model, &mut state, 99, &broken);
            assert_eq!(during.valid().to_array(), [false, false, true, true, true, true]);
            assert_eq!(during.altimeter.value, onset.altimeter.value, "{navigation:?}");
            assert_eq!(during.imu.value, before.imu.value);
            assert_eq!(during.altimeter.samples, onset.altimeter.samples);
            assert_ne!(during.landmark.samples, 0);
            let recovered = after(&model, &mut state, 100, &fine);
            assert_eq!(recovered.valid().to_array(), [true; 6]);
            // 0.02 m a tick over 199 ticks, against errors of decimetres.
            let fallen_m = onset.altimeter.value.height_m - recovered.altimeter.value.height_m;
            assert!((fallen_m - 3.98).abs() < 2.5, "{fallen_m}");
        }
    }
}
