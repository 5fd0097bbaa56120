//! Random fields: `[terrain.craters]` and `[terrain.rocks]`.

use std::f64::consts::PI;

use crate::quantity::{ConfigError, Limit, Section};

/// Bodies that one field may be expected to draw.
const EXPECTED_MAX: f64 = 2e5;

/// Craters by a cumulative power law, N(>D) = density × (D / 1 m)^-exponent per area.
#[derive(Clone, Debug)]
pub struct Craters {
    /// Radius of the disc about the world origin that holds the centres.
    pub extent_m: f64,
    pub diameter_min_m: f64,
    pub diameter_max_m: f64,
    /// Craters wider than 1 m per square metre. Default 10^-1.1 (Trask 1966, JPL TR 32-800:
    /// 10^10.9 D^-2 per 10^6 km², D in m).
    pub density_at_1m_m2: f64,
    /// Default 2 (Trask 1966).
    pub exponent: f64,
    /// Depth from rim crest to floor over diameter, of a fresh crater. Default 0.12 (Stopar et
    /// al. 2017 for 30 to 100 m; Pike 1977 has 0.196 above 400 m).
    pub depth_ratio: f64,
    /// Height of the rim over depth. Default 0.036/0.196 (Pike 1977, simple craters).
    pub rim_ratio: f64,
    /// The most worn craters keep this part of a fresh one's relief; the field is uniform between
    /// it and 1. Default 0.25, assumed.
    pub freshness_min: f64,
}

/// Rocks, as spheres partly buried.
#[derive(Clone, Debug)]
pub struct Rocks {
    /// Radius of the disc about the world origin that holds the centres.
    pub extent_m: f64,
    pub diameter_min_m: f64,
    pub diameter_max_m: f64,
    pub law: RockLaw,
    /// Part of the diameter below ground. Default 0.5: height is half the width (Golombek and
    /// Rapp 1997).
    pub burial: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RockLaw {
    /// Area covered by rocks wider than D: F = k exp(-q D), q = 1.79 + 0.152/k per metre
    /// (Golombek et al. 2003, fitted on Mars; the Chang'E-3 site follows the same form, Di et
    /// al. 2016).
    Exponential { abundance: f64 },
    /// N(>D) = density × (D / 1 m)^-exponent per area.
    Power { density_at_1m_m2: f64, exponent: f64 },
}

impl RockLaw {
    /// The decay q of the exponential law, 1/m.
    pub fn decay_per_m(abundance: f64) -> f64 {
        1.79 + 0.152 / abundance
    }
}

pub(super) fn read_craters(s: &Section) -> Result<Craters, ConfigError> {
    let (extent_m, diameter_min_m, diameter_max_m) = sizes(s, 15e3)?;
    let craters = Craters {
        extent_m,
        diameter_min_m,
        diameter_max_m,
        density_at_1m_m2: density(s, libm::pow(10.0, -1.1))?,
        exponent: exponent(s, 2.0)?,
        depth_ratio: s.number_or("depth_ratio", "1", Limit::Within(0.0, 0.25), 0.12)?,
        rim_ratio: s.number_or("rim_ratio", "1", Limit::Within(0.0, 0.5), 0.036 / 0.196)?,
        freshness_min: s.number_or("freshness_min", "1", Limit::Within(0.0, 1.0), 0.25)?,
    };
    let per_m2 = craters.density_at_1m_m2 * libm::pow(diameter_min_m, -craters.exponent);
    bounded(s, extent_m, per_m2)?;
    Ok(craters)
}

pub(super) fn read_rocks(s: &Section) -> Result<Rocks, ConfigError> {
    let (extent_m, diameter_min_m, diameter_max_m) = sizes(s, 20.0)?;
    let (law, per_m2) = if s.choice("law", &["exponential", "power"])? == "power" {
        // VIPER-MSE-SPEC-001 (2021), as NASA's synthterrain quotes it.
        let (density_at_1m_m2, exponent) = (density(s, 0.0003)?, exponent(s, 2.482)?);
        let per_m2 = density_at_1m_m2 * libm::pow(diameter_min_m, -exponent);
        (RockLaw::Power { density_at_1m_m2, exponent }, per_m2)
    } else {
        let abundance = s.number("abundance", "1", Limit::Within(0.001, 0.4))?;
        let q_per_m = RockLaw::decay_per_m(abundance);
        // The bound from which the field is thinned.
        let per_m2 = 4.0 / PI * abundance * q_per_m * libm::exp(-q_per_m * diameter_min_m);
        (RockLaw::Exponential { abundance }, per_m2 / diameter_min_m)
    };
    bounded(s, extent_m, per_m2)?;
    let burial = s.number_or("burial", "1", Limit::Within(0.0, 0.5), 0.5)?;
    Ok(Rocks { extent_m, diameter_min_m, diameter_max_m, law, burial })
}

fn sizes(s: &Section, largest_m: f64) -> Result<(f64, f64, f64), ConfigError> {
    let extent_m = s.number("extent", "m", Limit::Within(1.0, 1e5))?;
    let diameter_min_m = s.number("diameter_min", "m", Limit::Within(0.01, largest_m))?;
    let within = Limit::Within(diameter_min_m, largest_m);
    Ok((extent_m, diameter_min_m, s.number("diameter_max", "m", within)?))
}

fn density(s: &Section, default: f64) -> Result<f64, ConfigError> {
    s.number_or("density_at_1m", "1/m2", Limit::Within(0.0, 10.0), default)
}

fn exponent(s: &Section, default: f64) -> Result<f64, ConfigError> {
    s.number_or("exponent", "1", Limit::Within(0.5, 5.0), default)
}

fn bounded(s: &Section, extent_m: f64, per_m2: f64) -> Result<(), ConfigError> {
    let expected = PI * extent_m * extent_m * per_m2;
    if expected <= EXPECTED_MAX {
        return Ok(());
    }
    let reason =
        format!("lets {expected:.0} bodies be drawn within extent, at most {EXPECTED_MAX}");
    Err(s.error("diameter_min", reason))
}
