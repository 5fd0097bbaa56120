//! The two contact engines, for claims that both must keep.

use lander_models::scenario::ContactEngine;

use super::Setup;

pub const ENGINES: [ContactEngine; 2] = [ContactEngine::Rapier, ContactEngine::Strut];

/// As an id and as a word.
pub fn name(engine: ContactEngine) -> &'static str {
    match engine {
        ContactEngine::Rapier => "rapier",
        ContactEngine::Strut => "strut",
    }
}

impl Setup {
    /// With this engine, at so many steps for each of its own.
    pub fn on(mut self, engine: ContactEngine, refinement: u32) -> Self {
        self.scenario.contact_engine = engine;
        self.scenario.contact_refinement = refinement;
        self
    }
}
