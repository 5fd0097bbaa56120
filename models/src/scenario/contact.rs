//! Which engine computes the contact: `[contact]` of a scenario.

use crate::quantity::{ConfigError, Limit, Section};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactEngine {
    /// Rapier: footpads and hull as bodies. The reference.
    #[default]
    Rapier,
    /// Massless pads on the flight integrator's rigid body. For large campaigns.
    Strut,
}

/// Engine and refinement.
pub(super) fn read(root: &Section) -> Result<(ContactEngine, u32), ConfigError> {
    let s = root.optional_section("contact")?;
    let engine = match s.choice("engine", &["rapier", "strut"])? {
        "strut" => ContactEngine::Strut,
        _ => ContactEngine::Rapier,
    };
    // Beyond a thousand steps of a microsecond rounding takes over.
    let refinement = s.number_or("refinement", "1", Limit::Within(1.0, 1000.0), 1.0)?;
    if refinement.fract() != 0.0 {
        return Err(s.error("refinement", format!("is {refinement}, must be a whole number")));
    }
    s.finish()?;
    Ok((engine, refinement as u32))
}
