//! How the sensors behave in this run: `[sensors]` of a scenario.

use serde::{Deserialize, Serialize};

use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;
use crate::vehicle::Vehicle;

/// What the truth hands out as measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Navigation {
    /// Exact readings at every output, and guidance takes the true state as it is; the settings
    /// of the sensors have no effect.
    #[default]
    Perfect,
    /// Sampled readings with errors, limits and drop-outs, from which guidance estimates.
    Sensors,
}

/// One `T` for each sensor, in the order of the signals `sensor_valid` and `sensor_samples`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PerSensor<T> {
    pub imu: T,
    pub altimeter: T,
    pub velocimeter: T,
    pub star_tracker: T,
    pub leg_probes: T,
    pub landmark: T,
}

impl<T: Copy> PerSensor<T> {
    /// In signal order.
    pub fn from_array(values: [T; crate::signals::SENSOR_SLOTS]) -> Self {
        let [imu, altimeter, velocimeter, star_tracker, leg_probes, landmark] = values;
        Self { imu, altimeter, velocimeter, star_tracker, leg_probes, landmark }
    }

    /// In signal order.
    pub fn to_array(&self) -> [T; crate::signals::SENSOR_SLOTS] {
        let Self { imu, altimeter, velocimeter, star_tracker, leg_probes, landmark } = *self;
        [imu, altimeter, velocimeter, star_tracker, leg_probes, landmark]
    }
}

/// One sensor in this run.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Noise, bias, scale factor, drift and missed contacts; limits and drop-outs stay.
    pub errors: bool,
    /// Of each sample to be lost, independently.
    pub drop_out_probability: f64,
    pub drop_outs: Vec<DropOut>,
}

impl Default for SensorSettings {
    fn default() -> Self {
        Self { errors: true, drop_out_probability: 0.0, drop_outs: Vec::new() }
    }
}

/// Samples from `onset` on and before `end` are lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DropOut {
    pub onset: Ticks,
    pub end: Ticks,
}

impl DropOut {
    pub fn covers(&self, now: Ticks) -> bool {
        (self.onset..self.end).contains(&now)
    }
}

#[derive(Clone, Debug, Default)]
pub struct Sensing {
    pub navigation: Navigation,
    pub sensors: PerSensor<SensorSettings>,
}

pub(super) fn read(root: &Section, vehicle: &Vehicle) -> Result<Sensing, ConfigError> {
    let s = root.optional_section("sensors")?;
    let navigation = match s.choice("navigation", &["perfect", "sensors"])? {
        "sensors" => Navigation::Sensors,
        _ => Navigation::Perfect,
    };
    if navigation == Navigation::Sensors && vehicle.sensors.is_none() {
        let reason = format!("is \"sensors\", but {} has no section [sensors]", vehicle.name);
        return Err(s.error("navigation", reason));
    }
    let sensing = Sensing {
        navigation,
        sensors: PerSensor {
            imu: read_settings(&s, "imu")?,
            altimeter: read_settings(&s, "altimeter")?,
            velocimeter: read_settings(&s, "velocimeter")?,
            star_tracker: read_settings(&s, "star_tracker")?,
            leg_probes: read_settings(&s, "leg_probes")?,
            landmark: read_settings(&s, "landmark")?,
        },
    };
    s.finish()?;
    Ok(sensing)
}

fn read_settings(sensors: &Section, name: &str) -> Result<SensorSettings, ConfigError> {
    let s = sensors.optional_section(name)?;
    let settings = SensorSettings {
        errors: s.choice("errors", &["on", "off"])? == "on",
        drop_out_probability: s.number_or(
            "drop_out_probability",
            "1",
            Limit::Within(0.0, 1.0),
            0.0,
        )?,
        drop_outs: if s.has("drop_outs") { read_drop_outs(&s)? } else { Vec::new() },
    };
    s.finish()?;
    Ok(settings)
}

/// A list of (onset, duration).
fn read_drop_outs(s: &Section) -> Result<Vec<DropOut>, ConfigError> {
    let ticks = |seconds: f64| {
        Ticks::from_seconds(seconds).map_err(|error| s.error("drop_outs", error.to_string()))
    };
    let rows = s.points::<2>("drop_outs", "s")?;
    rows.into_iter()
        .map(|[onset_s, duration_s]| {
            let onset = ticks(onset_s)?;
            Ok(DropOut { onset, end: onset + ticks(duration_s)? })
        })
        .collect()
}
