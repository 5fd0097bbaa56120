//! Sensors that have fallen silent.

use lander_models::scenario::PerSensor;
use serde::{Deserialize, Serialize};

use super::Evidence;

/// Silence that counts, s: three periods of the altimeter and the velocimeter.
const SILENT_S: f64 = 0.15;

/// For how long each sensor has sent nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorWatch {
    samples: PerSensor<f64>,
    silent_s: PerSensor<f64>,
}

impl SensorWatch {
    pub fn altimeter_silent(&self) -> bool {
        self.silent_s.altimeter > SILENT_S
    }

    /// Of those that a flight can't do without.
    pub fn any_silent(&self) -> bool {
        self.silent_s.imu > SILENT_S || self.altimeter_silent()
    }

    pub fn observe(&mut self, evidence: &Evidence) {
        let step_s = evidence.duration.seconds();
        let (last, new) = (self.samples.to_array(), evidence.samples.to_array());
        let before_s = self.silent_s.to_array();
        self.silent_s = PerSensor::from_array(std::array::from_fn(|n| {
            // One that never sent anything isn't there.
            if new[n] > last[n] || new[n] <= 0.0 { 0.0 } else { before_s[n] + step_s }
        }));
        self.samples = evidence.samples;
    }
}
