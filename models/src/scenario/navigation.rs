//! What the navigation filter knows at the start, and of the ground: `[navigation]` of a scenario.

use crate::quantity::{ConfigError, Limit, Section};

/// Standard deviations. The first three are also drawn, with the run's seed, as the errors of the
/// state that is handed over to the filter: the scenario's initial state plus the draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Of each axis.
    pub position_m: f64,
    pub velocity_m_s: f64,
    pub attitude_rad: f64,
    /// Of the site's gravity, as a share of it.
    pub gravity: f64,
    /// Of the rise per run, along x and along y, of a ground that passes through the target.
    pub ground_slope: f64,
    /// Of the ground's height about that plane, from one altimeter sample to the next.
    pub ground_roughness_m: f64,
}

pub(super) fn read(root: &Section) -> Result<Prior, ConfigError> {
    let s = root.optional_section("navigation")?;
    let prior = Prior {
        // Position and velocity: the paper's Table VIII.
        position_m: s.number_or("initial_position", "m", Limit::Positive, 10.0)?,
        velocity_m_s: s.number_or("initial_velocity", "m/s", Limit::Positive, 2.0)?,
        // Assumed: a star tracker with a loose alignment.
        attitude_rad: s.number_or("initial_attitude", "deg", Limit::Positive, 0.1)?.to_radians(),
        // Assumed: some 160 mGal, mascons and local relief.
        gravity: s.number_or("gravity_error", "1", Limit::Positive, 1e-3)?,
        // Assumed: a site chosen to be level, 1.1 degrees.
        ground_slope: s.number_or("ground_slope", "1", Limit::Positive, 0.02)?,
        // Assumed: as large as an altimeter's noise near the ground.
        ground_roughness_m: s.number_or("ground_roughness", "m", Limit::NotNegative, 0.05)?,
    };
    s.finish()?;
    Ok(prior)
}
