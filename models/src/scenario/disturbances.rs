//! How truth differs from what guidance assumes: `[disturbances]` of a scenario.

use crate::quantity::{ConfigError, Limit, Section};
use crate::vehicle::Vehicle;

/// Standard deviations of normal errors with zero mean. A bias is drawn once a run; a noise is a
/// first-order Gauss-Markov process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbances {
    /// Of each axis, once a run.
    pub initial_position_m: f64,
    pub initial_velocity_m_s: f64,
    /// Of the structure, as a share of the whole vehicle's nominal initial mass, once a run.
    pub mass: f64,
    /// As a share of thrust, once a run.
    pub thrust_bias: f64,
    /// As a share of thrust.
    pub thrust_noise: f64,
    /// Of the thrust line about each gimbal axis, once a run.
    pub pointing_bias_rad: f64,
    /// Of the thrust line about each gimbal axis.
    pub pointing_jitter_rad: f64,
    /// As a share of gravity, once a run.
    pub gravity: f64,
    /// As a share of I_sp, once a run.
    pub specific_impulse: f64,
    /// Of each world axis.
    pub acceleration_noise_m_s2: f64,
    /// Correlation time of every noise.
    pub correlation_s: f64,
    pub offset: Offsets,
}

/// Known errors, added to the drawn ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offsets {
    /// As a share of the whole vehicle's nominal initial mass.
    pub mass: f64,
    /// As a share of thrust.
    pub thrust: f64,
    /// About the two gimbal axes.
    pub pointing_rad: [f64; 2],
    /// As a share of gravity.
    pub gravity: f64,
    /// As a share of I_sp.
    pub specific_impulse: f64,
}

const DEG: f64 = std::f64::consts::PI / 180.0;

impl Disturbances {
    pub const NONE: Self = Self {
        initial_position_m: 0.0,
        initial_velocity_m_s: 0.0,
        mass: 0.0,
        thrust_bias: 0.0,
        thrust_noise: 0.0,
        pointing_bias_rad: 0.0,
        pointing_jitter_rad: 0.0,
        gravity: 0.0,
        specific_impulse: 0.0,
        acceleration_noise_m_s2: 0.0,
        // The paper holds a draw for its step h = 0.1 s: its spectral density at low frequency is
        // sigma² h, that of this process 2 sigma² tau. Equal for tau = h/2.
        correlation_s: 0.05,
        offset: Offsets {
            mass: 0.0,
            thrust: 0.0,
            pointing_rad: [0.0; 2],
            gravity: 0.0,
            specific_impulse: 0.0,
        },
    };

    /// Paper, Table VIII. It names no distribution: taken as one standard deviation of a normal.
    pub const MONTE_CARLO_TABLE: Self = Self {
        initial_position_m: 10.0,
        initial_velocity_m_s: 2.0,
        mass: 0.01,
        thrust_bias: 0.03,
        thrust_noise: 0.01,
        pointing_bias_rad: 1.0 * DEG,
        pointing_jitter_rad: 0.5 * DEG,
        gravity: 0.005,
        specific_impulse: 0.02,
        acceleration_noise_m_s2: 0.05,
        ..Self::NONE
    };

    /// Paper, Table VI: the engine's own errors (1 sigma), taken as drawn once a run.
    pub const ENGINE_TABLE: Self =
        Self { thrust_bias: 0.017, pointing_bias_rad: 0.5 * DEG, ..Self::NONE };
}

/// Largest magnitude that `random::normal` can give: sqrt(2 · 53 ln 2).
const LARGEST_DRAW: f64 = 8.6;
/// Errors as a share of something; with the largest draw and an offset it stays above zero.
const SHARE: Limit = Limit::Within(0.0, 0.1);
const OFFSET: Limit = Limit::Within(-0.1, 0.1);

pub(super) fn read(root: &Section, vehicle: &Vehicle) -> Result<Disturbances, ConfigError> {
    let s = root.optional_section("disturbances")?;
    let preset = match s.choice("preset", &["none", "monte-carlo-table", "engine-table"])? {
        "monte-carlo-table" => Disturbances::MONTE_CARLO_TABLE,
        "engine-table" => Disturbances::ENGINE_TABLE,
        _ => Disturbances::NONE,
    };
    // However unlucky the draw, and with an offset of as much, some structure is left.
    let mass_max = 0.45 * vehicle.mass.dry.mass_kg / vehicle.mass.wet_mass_kg();
    let share = |key, default| s.number_or(key, "1", SHARE, default);
    let angle_rad = |key, default_rad: f64| {
        let limit = Limit::Within(0.0, 5.0);
        s.number_or(key, "deg", limit, default_rad.to_degrees()).map(f64::to_radians)
    };
    let disturbances = Disturbances {
        initial_position_m: s.number_or(
            "initial_position",
            "m",
            Limit::NotNegative,
            preset.initial_position_m,
        )?,
        initial_velocity_m_s: s.number_or(
            "initial_velocity",
            "m/s",
            Limit::NotNegative,
            preset.initial_velocity_m_s,
        )?,
        mass: s.number_or("mass", "1", Limit::Within(0.0, mass_max / LARGEST_DRAW), preset.mass)?,
        thrust_bias: share("thrust_bias", preset.thrust_bias)?,
        thrust_noise: share("thrust_noise", preset.thrust_noise)?,
        pointing_bias_rad: angle_rad("pointing_bias", preset.pointing_bias_rad)?,
        pointing_jitter_rad: angle_rad("pointing_jitter", preset.pointing_jitter_rad)?,
        gravity: share("gravity", preset.gravity)?,
        specific_impulse: share("specific_impulse", preset.specific_impulse)?,
        acceleration_noise_m_s2: s.number_or(
            "acceleration_noise",
            "m/s2",
            Limit::NotNegative,
            preset.acceleration_noise_m_s2,
        )?,
        correlation_s: s.number_or("correlation", "s", Limit::Positive, preset.correlation_s)?,
        offset: read_offsets(&s, mass_max)?,
    };
    s.finish()?;
    Ok(disturbances)
}

fn read_offsets(root: &Section, mass_max: f64) -> Result<Offsets, ConfigError> {
    let s = root.optional_section("offset")?;
    let share = |key| s.number_or(key, "1", OFFSET, 0.0);
    let pointing_deg: [f64; 2] = if s.has("pointing") {
        s.vector("pointing", "deg", Limit::Within(-10.0, 10.0))?
    } else {
        [0.0; 2]
    };
    let offsets = Offsets {
        mass: s.number_or("mass", "1", Limit::Within(-mass_max, mass_max), 0.0)?,
        thrust: share("thrust")?,
        pointing_rad: pointing_deg.map(f64::to_radians),
        gravity: share("gravity")?,
        specific_impulse: share("specific_impulse")?,
    };
    s.finish()?;
    Ok(offsets)
}
