//! Sensors, their mounting and their errors: `[sensors]` of a vehicle.
//!
//! Errors are standard deviations. A bias, a scale factor and a misalignment are drawn once a
//! run; noise is drawn for each sample. The optical axis of altimeter and velocimeter is −z of
//! the body.

use std::ops::RangeInclusive;

use nalgebra::{Unit, Vector3};

use crate::quantity::{ConfigError, Limit, Section};
use crate::time::{TICK_S, Ticks};

#[derive(Clone, Debug)]
pub struct Sensors {
    pub imu: ImuSpec,
    pub altimeter: AltimeterSpec,
    pub velocimeter: VelocimeterSpec,
    pub star_tracker: StarTrackerSpec,
    pub leg_probes: LegProbeSpec,
    /// Terrain-relative position fix, if the vehicle has it.
    pub landmark: Option<LandmarkSpec>,
}

#[derive(Clone, Debug)]
pub struct ImuSpec {
    pub mount_b: Vector3<f64>,
    /// Between samples; each is the mean over it.
    pub period: Ticks,
    /// Of specific force: `u` is m/s².
    pub accelerometer: TriadSpec,
    /// Of rate: `u` is rad/s.
    pub gyro: TriadSpec,
}

/// Errors of three like axes that measure in the unit `u`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TriadSpec {
    /// From one turn-on to the next, u.
    pub bias: f64,
    /// Scale factor error, 1.
    pub scale: f64,
    /// Velocity or angle random walk: white noise of u, in u·√s.
    pub random_walk: f64,
    /// Bias instability: stationary deviation of a first-order Gauss-Markov process, u.
    pub drift: f64,
    /// Its time constant.
    pub drift_time_s: f64,
}

#[derive(Clone, Debug)]
pub struct AltimeterSpec {
    pub mount_b: Vector3<f64>,
    pub period: Ticks,
    /// Slant range within which there is a return.
    pub range_m: RangeInclusive<f64>,
    pub noise_m: f64,
    /// Noise per range; the two add in squares.
    pub noise_relative: f64,
    pub bias_m: f64,
    pub scale: f64,
}

#[derive(Clone, Debug)]
pub struct VelocimeterSpec {
    pub mount_b: Vector3<f64>,
    pub period: Ticks,
    /// Slant range within which there is a return.
    pub range_m: RangeInclusive<f64>,
    pub speed_max_m_s: f64,
    pub noise_m_s: f64,
    /// Noise per speed along an axis; the two add in squares.
    pub noise_relative: f64,
    pub bias_m_s: f64,
    pub scale: f64,
}

#[derive(Clone, Debug)]
pub struct StarTrackerSpec {
    pub boresight_b: Unit<Vector3<f64>>,
    pub period: Ticks,
    /// No fix above this rate.
    pub rate_max_rad_s: f64,
    /// About each axis across the boresight.
    pub noise_across_rad: f64,
    pub noise_about_rad: f64,
    /// Of the mounting, about each axis.
    pub misalignment_rad: f64,
}

#[derive(Clone, Debug)]
pub struct LegProbeSpec {
    pub period: Ticks,
    /// How far the probe reaches below its pad.
    pub length_m: f64,
    /// A contact is told once it has lasted this long.
    pub delay: Ticks,
    /// Of a leg's probe never to tell a contact in a run.
    pub miss_probability: f64,
}

#[derive(Clone, Debug)]
pub struct LandmarkSpec {
    pub period: Ticks,
    /// Height of O above the ground within which there is a fix.
    pub height_m: RangeInclusive<f64>,
    pub noise_w: Vector3<f64>,
    /// Of the map against the site.
    pub bias_w: Vector3<f64>,
}

impl Sensors {
    /// Sensors at O without errors or limits, sampled every 10 ms: what perfect navigation assumes
    /// of a vehicle whose file says nothing about sensors.
    pub fn ideal() -> Self {
        let period = Ticks(10);
        Self {
            imu: ImuSpec {
                mount_b: Vector3::zeros(),
                period,
                accelerometer: TriadSpec::default(),
                gyro: TriadSpec::default(),
            },
            altimeter: AltimeterSpec {
                mount_b: Vector3::zeros(),
                period,
                range_m: 0.0..=f64::MAX,
                noise_m: 0.0,
                noise_relative: 0.0,
                bias_m: 0.0,
                scale: 0.0,
            },
            velocimeter: VelocimeterSpec {
                mount_b: Vector3::zeros(),
                period,
                range_m: 0.0..=f64::MAX,
                speed_max_m_s: f64::MAX,
                noise_m_s: 0.0,
                noise_relative: 0.0,
                bias_m_s: 0.0,
                scale: 0.0,
            },
            star_tracker: StarTrackerSpec {
                boresight_b: Vector3::z_axis(),
                period,
                rate_max_rad_s: f64::MAX,
                noise_across_rad: 0.0,
                noise_about_rad: 0.0,
                misalignment_rad: 0.0,
            },
            leg_probes: LegProbeSpec {
                period,
                length_m: 0.0,
                delay: Ticks::ZERO,
                miss_probability: 0.0,
            },
            landmark: Some(LandmarkSpec {
                period,
                height_m: 0.0..=f64::MAX,
                noise_w: Vector3::zeros(),
                bias_w: Vector3::zeros(),
            }),
        }
    }
}

pub(super) fn read(root: &Section) -> Result<Option<Sensors>, ConfigError> {
    if !root.has("sensors") {
        return Ok(None);
    }
    let s = root.section("sensors")?;
    let sensors = Sensors {
        imu: read_imu(s.section("imu")?)?,
        altimeter: read_altimeter(s.section("altimeter")?)?,
        velocimeter: read_velocimeter(s.section("velocimeter")?)?,
        star_tracker: read_star_tracker(s.section("star_tracker")?)?,
        leg_probes: read_leg_probes(s.section("leg_probes")?)?,
        landmark: if s.has("landmark") {
            Some(read_landmark(s.section("landmark")?)?)
        } else {
            None
        },
    };
    s.finish()?;
    Ok(Some(sensors))
}

fn read_imu(s: Section) -> Result<ImuSpec, ConfigError> {
    let error = |key: &str, unit: &str| s.number(key, unit, Limit::NotNegative);
    let imu = ImuSpec {
        mount_b: s.vector("mount_b", "m", Limit::Any)?.into(),
        period: read_period(&s)?,
        accelerometer: TriadSpec {
            bias: error("accelerometer_bias", "m/s2")?,
            scale: error("accelerometer_scale", "ppm")? * 1e-6,
            random_walk: error("velocity_random_walk", "m/s/sqrt(h)")? / 3600_f64.sqrt(),
            drift: error("accelerometer_drift", "m/s2")?,
            drift_time_s: s.number("accelerometer_drift_time", "s", Limit::Positive)?,
        },
        gyro: TriadSpec {
            bias: error("gyro_bias", "deg/h")?.to_radians() / 3600.0,
            scale: error("gyro_scale", "ppm")? * 1e-6,
            random_walk: error("angle_random_walk", "deg/sqrt(h)")?.to_radians() / 3600_f64.sqrt(),
            drift: error("gyro_drift", "deg/h")?.to_radians() / 3600.0,
            drift_time_s: s.number("gyro_drift_time", "s", Limit::Positive)?,
        },
    };
    s.finish()?;
    Ok(imu)
}

fn read_altimeter(s: Section) -> Result<AltimeterSpec, ConfigError> {
    let altimeter = AltimeterSpec {
        mount_b: s.vector("mount_b", "m", Limit::Any)?.into(),
        period: read_period(&s)?,
        range_m: read_range(&s, "range")?,
        noise_m: s.number("noise", "m", Limit::NotNegative)?,
        noise_relative: s.number("noise_relative", "1", Limit::NotNegative)?,
        bias_m: s.number("bias", "m", Limit::NotNegative)?,
        scale: s.number("scale", "ppm", Limit::NotNegative)? * 1e-6,
    };
    s.finish()?;
    Ok(altimeter)
}

fn read_velocimeter(s: Section) -> Result<VelocimeterSpec, ConfigError> {
    let velocimeter = VelocimeterSpec {
        mount_b: s.vector("mount_b", "m", Limit::Any)?.into(),
        period: read_period(&s)?,
        range_m: read_range(&s, "range")?,
        speed_max_m_s: s.number("speed_max", "m/s", Limit::Positive)?,
        noise_m_s: s.number("noise", "m/s", Limit::NotNegative)?,
        noise_relative: s.number("noise_relative", "1", Limit::NotNegative)?,
        bias_m_s: s.number("bias", "m/s", Limit::NotNegative)?,
        scale: s.number("scale", "ppm", Limit::NotNegative)? * 1e-6,
    };
    s.finish()?;
    Ok(velocimeter)
}

fn read_star_tracker(s: Section) -> Result<StarTrackerSpec, ConfigError> {
    let arcsec = |key: &str| {
        s.number(key, "arcsec", Limit::NotNegative).map(|value| value.to_radians() / 3600.0)
    };
    let direction_b = Vector3::from(s.vector("boresight_b", "1", Limit::Any)?);
    let star_tracker = StarTrackerSpec {
        boresight_b: Unit::try_new(direction_b, 1e-6)
            .ok_or_else(|| s.error("boresight_b", "has no direction"))?,
        period: read_period(&s)?,
        rate_max_rad_s: s.number("rate_max", "deg/s", Limit::Positive)?.to_radians(),
        noise_across_rad: arcsec("noise_across_boresight")?,
        noise_about_rad: arcsec("noise_about_boresight")?,
        misalignment_rad: arcsec("misalignment")?,
    };
    s.finish()?;
    Ok(star_tracker)
}

fn read_leg_probes(s: Section) -> Result<LegProbeSpec, ConfigError> {
    let leg_probes = LegProbeSpec {
        period: read_period(&s)?,
        length_m: s.number("length", "m", Limit::NotNegative)?,
        delay: read_ticks(&s, "delay", Limit::NotNegative)?,
        miss_probability: s.number("miss_probability", "1", Limit::Within(0.0, 1.0))?,
    };
    s.finish()?;
    Ok(leg_probes)
}

fn read_landmark(s: Section) -> Result<LandmarkSpec, ConfigError> {
    let landmark = LandmarkSpec {
        period: read_period(&s)?,
        height_m: read_range(&s, "height")?,
        noise_w: s.vector("noise_w", "m", Limit::NotNegative)?.into(),
        bias_w: s.vector("bias_w", "m", Limit::NotNegative)?.into(),
    };
    s.finish()?;
    Ok(landmark)
}

fn read_period(s: &Section) -> Result<Ticks, ConfigError> {
    read_ticks(s, "period", Limit::Within(TICK_S, 1e3))
}

fn read_ticks(s: &Section, key: &str, limit: Limit) -> Result<Ticks, ConfigError> {
    let seconds = s.number(key, "s", limit)?;
    Ticks::from_seconds(seconds).map_err(|error| s.error(key, error.to_string()))
}

/// `[least, most]`.
fn read_range(s: &Section, key: &str) -> Result<RangeInclusive<f64>, ConfigError> {
    let [least, most] = s.vector(key, "m", Limit::NotNegative)?;
    if least < most {
        Ok(least..=most)
    } else {
        Err(s.error(key, format!("is [{least}, {most}] m, must rise")))
    }
}
