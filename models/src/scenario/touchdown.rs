//! Limits of the verdict: `[touchdown]` of a scenario.

use crate::quantity::{ConfigError, Limit, Section};

/// Where the verdict draws its lines.
#[derive(Clone, Debug)]
pub struct TouchdownLimits {
    pub crash_speed_m_s: f64,
    pub slide_limit_m: f64,
}

pub(super) fn read(root: &Section) -> Result<TouchdownLimits, ConfigError> {
    let s = root.section("touchdown")?;
    let limits = TouchdownLimits {
        crash_speed_m_s: s.number("crash_speed", "m/s", Limit::Positive)?,
        slide_limit_m: s.number("slide_limit", "m", Limit::Positive)?,
    };
    s.finish()?;
    Ok(limits)
}
