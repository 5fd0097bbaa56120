//! What the last convex step of a loop left over: one figure for each linearisation.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::trajectory::Trajectory;

/// The last step of the outer loop, from its reference to the exact roll-out of its solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LastStep {
    /// Thrust-mass coupling: largest relative difference of a node's mass from the reference mass
    /// that the thrust bounds (G.11) were frozen at.
    pub mass_error: f64,
    /// Free final time: end position of the linearised (G.9) against the roll-out, m.
    pub position_error_m: f64,
    /// Free final time: change of the flight's duration in the step, s.
    pub duration_change_s: f64,
    /// Cost of bringing its exact roll-out back to bounds and target (G.94), m/s: what the errors above are worth. Zero
    /// when it was taken as it was.
    pub restoration_m_s: f64,
    /// Virtual control left at the target: position, m.
    pub slack_m: f64,
    /// Virtual control left at the target: velocity, m/s.
    pub slack_m_s: f64,
}

impl LastStep {
    /// Of the step from `reference` to `candidate`, whose solution left `slack` at the target.
    pub(super) fn new(
        reference: &Trajectory,
        candidate: &Trajectory,
        (slack_r_w, slack_v_w): (Vector3<f64>, Vector3<f64>),
    ) -> Self {
        let nodes = || reference.nodes.iter().zip(&candidate.nodes);
        let mass_error = nodes().map(|(old, new)| (old.mass_kg / new.mass_kg - 1.0).abs());
        let last = nodes().next_back();
        Self {
            mass_error: mass_error.fold(0.0, f64::max),
            position_error_m: (candidate.miss_r_w - slack_r_w).norm(),
            duration_change_s: last.map_or(0.0, |(old, new)| (new.t_s - old.t_s).abs()),
            restoration_m_s: 0.0,
            slack_m: slack_r_w.norm(),
            slack_m_s: slack_v_w.norm(),
        }
    }
}
