//! What the engine may do: the propulsion mode, the engine's past, and the orders of burns and
//! coasts that both leave.

use serde::{Deserialize, Serialize};

use super::structure::Structure;

/// A phase with less than this left may end at once, s.
pub(super) const PHASE_REMAINDER_MIN_S: f64 = 0.02;
/// Shortest flight of an engine that is always on, s: keeps the grid from collapsing.
const FLIGHT_MIN_S: f64 = 0.2;

/// Declared use of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Propulsion {
    /// Runs from the start of the plan to its end, above its floor.
    AlwaysOn,
    /// Off, or above its floor; switches when the plan wants.
    OnOff {
        /// Shortest burn, s.
        on_min_s: f64,
        /// Shortest time between a shut-down and the next ignition, s.
        off_min_s: f64,
        /// Ignitions after the first one of the flight.
        restarts_max: u32,
    },
}

impl Default for Propulsion {
    /// Short burns and coasts, and the one restart that a burn, a coast and a burn need.
    fn default() -> Self {
        Self::OnOff { on_min_s: 0.2, off_min_s: 0.2, restarts_max: 1 }
    }
}

/// What the engine has done when a plan starts; the default has never been lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EngineState {
    /// Whether it runs.
    pub running: bool,
    /// How long it has been running, or off since its shut-down, s.
    pub for_s: f64,
    /// Ignitions so far in the flight.
    pub ignitions: u32,
}

impl EngineState {
    /// The state after a phase of `duration_s`.
    pub(super) fn after(self, powered: bool, duration_s: f64) -> Self {
        let ignited = powered && !self.running;
        let held_s = if powered == self.running { self.for_s } else { 0.0 };
        Self {
            running: powered,
            for_s: held_s + duration_s,
            ignitions: self.ignitions + u32::from(ignited),
        }
    }

    fn never_lit(self) -> bool {
        !self.running && self.ignitions == 0
    }
}

impl Propulsion {
    /// The limit that `structure` breaks from `engine` on, by its name.
    pub(super) fn broken_by(
        self,
        engine: EngineState,
        structure: Structure,
    ) -> Option<&'static str> {
        let Self::OnOff { on_min_s, off_min_s, restarts_max } = self else {
            return (structure != Structure::On).then_some("always on");
        };
        let powered = structure.powered();
        let end = powered.iter().fold(engine, |state, &powered| state.after(powered, 0.0));
        let switches_at_once = powered[0] != engine.running && !engine.never_lit();
        let (held_min_s, name) =
            if engine.running { (on_min_s, "on_min_s") } else { (off_min_s, "off_min_s") };
        if switches_at_once && engine.for_s < held_min_s - PHASE_REMAINDER_MIN_S {
            Some(name)
        } else if end.ignitions > engine.ignitions && end.ignitions > restarts_max.saturating_add(1)
        {
            Some("restarts_max")
        } else {
            None
        }
    }

    /// Shortest length of a phase, s; the first one counts what `engine` has done of it already.
    pub(super) fn phase_min_s(self, engine: EngineState, powered: bool, first: bool) -> f64 {
        let Self::OnOff { on_min_s, off_min_s, .. } = self else { return FLIGHT_MIN_S };
        let least_s = if powered { on_min_s } else { off_min_s };
        if first && !powered && engine.never_lit() {
            PHASE_REMAINDER_MIN_S
        } else if first && powered == engine.running {
            (least_s - engine.for_s).max(PHASE_REMAINDER_MIN_S)
        } else {
            least_s
        }
    }
}
