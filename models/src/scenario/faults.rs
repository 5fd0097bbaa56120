//! What breaks, and when: `[faults]` of a scenario, one sub-table a mode. The paper's ten failure
//! modes (section V-C); any may be combined.

use super::sensors::PerSensor;
use crate::quantity::{ConfigError, Limit, Section};
use crate::time::Ticks;

/// `None`: the mode doesn't occur.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// The main valves close and stay closed.
    pub engine_shutoff: Option<Onset>,
    pub thrust_degradation: Option<ThrustDegradation>,
    pub power_brownout: Option<PowerBrownout>,
    pub sensor_failure: Option<SensorFailure>,
    pub rcs_stuck: Option<RcsStuck>,
    pub propellant_leak: Option<PropellantLeak>,
    /// The gimbal holds its angles.
    pub gimbal_seizure: Option<Onset>,
    pub computer_reset: Option<ComputerReset>,
    pub slosh: Option<Slosh>,
    pub nozzle_erosion: Option<NozzleErosion>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    pub onset: Ticks,
}

/// Thrust and flow fall together, I_sp stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustDegradation {
    pub onset: Ticks,
    /// Of thrust that is lost.
    pub fraction: f64,
}

/// No power for actuators: valves of engine and thrusters close by their springs, the gimbal
/// holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerBrownout {
    pub onset: Ticks,
    pub duration: Ticks,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFailure {
    pub onset: Ticks,
    pub sensor: Sensor,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    Imu,
    Altimeter,
    Velocimeter,
    StarTracker,
    LegProbes,
}

/// A pair of thrusters that doesn't close any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcsStuck {
    pub onset: Ticks,
    /// Body axis: 0, 1 or 2.
    pub axis: usize,
    /// 1 or -1.
    pub sign: f64,
}

/// Propellant lost without thrust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropellantLeak {
    pub onset: Ticks,
    pub flow_kg_s: f64,
}

/// Commands don't reach the actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComputerReset {
    pub onset: Ticks,
    pub duration: Ticks,
    pub commands: ResetCommands,
}

/// What actuators get while the computer restarts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCommands {
    Zero,
    /// The last one before.
    Held,
}

/// A kick to the propellant: its pendulums stand at this angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slosh {
    pub onset: Ticks,
    pub angle_rad: f64,
}

/// The throat widens, and unevenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NozzleErosion {
    pub onset: Ticks,
    /// Growth of the throat's area, as a share of it.
    pub rate_s: f64,
    /// Growth of the thrust line's error about body x.
    pub pointing_rate_rad_s: f64,
}

impl Faults {
    /// Onsets of the modes that this run has.
    pub fn onsets(&self) -> impl Iterator<Item = Ticks> {
        [
            self.engine_shutoff.map(|fault| fault.onset),
            self.thrust_degradation.map(|fault| fault.onset),
            self.power_brownout.map(|fault| fault.onset),
            self.sensor_failure.map(|fault| fault.onset),
            self.rcs_stuck.map(|fault| fault.onset),
            self.propellant_leak.map(|fault| fault.onset),
            self.gimbal_seizure.map(|fault| fault.onset),
            self.computer_reset.map(|fault| fault.onset),
            self.slosh.map(|fault| fault.onset),
            self.nozzle_erosion.map(|fault| fault.onset),
        ]
        .into_iter()
        .flatten()
    }

    /// Number of modes past their onset.
    pub fn active(&self, now: Ticks) -> usize {
        self.onsets().filter(|onset| now >= *onset).count()
    }

    /// Whether the computer is restarting.
    pub fn computer_resets(&self, now: Ticks) -> bool {
        self.computer_reset
            .is_some_and(|fault| now >= fault.onset && now < fault.onset + fault.duration)
    }

    pub fn sensor_failed(&self, now: Ticks, sensor: Sensor) -> bool {
        self.sensor_failure.is_some_and(|fault| fault.sensor == sensor && now >= fault.onset)
    }

    pub fn failed_sensors(&self, now: Ticks) -> PerSensor<bool> {
        let failed = |sensor| self.sensor_failed(now, sensor);
        PerSensor {
            imu: failed(Sensor::Imu),
            altimeter: failed(Sensor::Altimeter),
            velocimeter: failed(Sensor::Velocimeter),
            star_tracker: failed(Sensor::StarTracker),
            leg_probes: failed(Sensor::LegProbes),
            landmark: false,
        }
    }

    /// Angle of the pendulums in rad, at the tick of the kick alone.
    pub fn slosh_onset(&self, now: Ticks) -> Option<f64> {
        self.slosh.filter(|fault| now == fault.onset).map(|fault| fault.angle_rad)
    }
}

pub(super) fn read(root: &Section) -> Result<Faults, ConfigError> {
    let s = root.optional_section("faults")?;
    let only_onset = |_: &Section, onset| Ok(Onset { onset });
    let faults = Faults {
        engine_shutoff: read_mode(&s, "engine_shutoff", only_onset)?,
        thrust_degradation: read_mode(&s, "thrust_degradation", |s, onset| {
            let fraction = s.number("fraction", "1", Limit::Within(0.0, 1.0))?;
            Ok(ThrustDegradation { onset, fraction })
        })?,
        power_brownout: read_mode(&s, "power_brownout", |s, onset| {
            Ok(PowerBrownout { onset, duration: s.ticks("duration", Limit::Positive)? })
        })?,
        sensor_failure: read_mode(&s, "sensor_failure", |s, onset| {
            Ok(SensorFailure { onset, sensor: read_sensor(s)? })
        })?,
        rcs_stuck: read_mode(&s, "rcs_stuck", |s, onset| {
            let axis = match s.choice("axis", &["x", "y", "z"])? {
                "y" => 1,
                "z" => 2,
                _ => 0,
            };
            let negative = s.choice("sense", &["positive", "negative"])? == "negative";
            Ok(RcsStuck { onset, axis, sign: if negative { -1.0 } else { 1.0 } })
        })?,
        propellant_leak: read_mode(&s, "propellant_leak", |s, onset| {
            Ok(PropellantLeak { onset, flow_kg_s: s.number("flow", "kg/s", Limit::NotNegative)? })
        })?,
        gimbal_seizure: read_mode(&s, "gimbal_seizure", only_onset)?,
        computer_reset: read_mode(&s, "computer_reset", |s, onset| {
            let held = s.choice("commands", &["zero", "held"])? == "held";
            Ok(ComputerReset {
                onset,
                duration: s.ticks("duration", Limit::Positive)?,
                commands: if held { ResetCommands::Held } else { ResetCommands::Zero },
            })
        })?,
        slosh: read_mode(&s, "slosh", |s, onset| {
            let angle_deg = s.number("angle", "deg", Limit::Within(-90.0, 90.0))?;
            Ok(Slosh { onset, angle_rad: angle_deg.to_radians() })
        })?,
        nozzle_erosion: read_mode(&s, "nozzle_erosion", |s, onset| {
            Ok(NozzleErosion {
                onset,
                rate_s: s.number("rate", "1/s", Limit::NotNegative)?,
                pointing_rate_rad_s: s
                    .number("pointing_rate", "deg/s", Limit::Within(-1.0, 1.0))?
                    .to_radians(),
            })
        })?,
    };
    s.finish()?;
    Ok(faults)
}

/// A mode's sub-table, if it is there.
fn read_mode<T>(
    root: &Section,
    key: &str,
    read: impl Fn(&Section, Ticks) -> Result<T, ConfigError>,
) -> Result<Option<T>, ConfigError> {
    if !root.has(key) {
        return Ok(None);
    }
    let s = root.section(key)?;
    let fault = read(&s, s.ticks("onset", Limit::NotNegative)?)?;
    s.finish()?;
    Ok(Some(fault))
}

fn read_sensor(s: &Section) -> Result<Sensor, ConfigError> {
    const NAMES: [&str; 5] = ["imu", "altimeter", "velocimeter", "star_tracker", "leg_probes"];
    s.text("sensor")?; // No sensor is more likely to fail than another: it must be named.
    Ok(match s.choice("sensor", &NAMES)? {
        "altimeter" => Sensor::Altimeter,
        "velocimeter" => Sensor::Velocimeter,
        "star_tracker" => Sensor::StarTracker,
        "leg_probes" => Sensor::LegProbes,
        _ => Sensor::Imu,
    })
}
