//! Which engine computes the contact: `[contact]` of a scenario.

use crate::quantity::{ConfigError, Section};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactEngine {
    /// Rapier: footpads and hull as bodies. The reference.
    #[default]
    Rapier,
    /// Massless pads on the flight integrator's rigid body. For large campaigns.
    Strut,
}

pub(super) fn read(root: &Section) -> Result<ContactEngine, ConfigError> {
    let s = root.optional_section("contact")?;
    let engine = match s.choice("engine", &["rapier", "strut"])? {
        "strut" => ContactEngine::Strut,
        _ => ContactEngine::Rapier,
    };
    s.finish()?;
    Ok(engine)
}
