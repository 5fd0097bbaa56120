//! Switching structures and the grid each one is discretised on.

use serde::{Deserialize, Serialize};

use super::error::PlanError;
use super::problem::{Problem, Settings, Terminal};

/// Order of burns and coasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Structure {
    OnOffOn,
    OffOn,
    OnOff,
    On,
    /// Free fall: only where an impact is accepted.
    Off,
}

impl Structure {
    /// The structure whose phases are `powered`, if there is one.
    pub(super) fn of(powered: &[bool]) -> Option<Self> {
        Self::ALL.into_iter().find(|structure| structure.powered() == powered)
    }

    /// In the order they are tried.
    const ALL: [Self; 5] = [Self::OnOffOn, Self::OffOn, Self::OnOff, Self::On, Self::Off];

    /// The limit of `problem` that this order breaks, by its name.
    pub(super) fn broken_limit(self, problem: &Problem) -> Option<&'static str> {
        if self == Self::Off && problem.terminal != Terminal::SoftestImpact {
            return Some("terminal");
        }
        problem.propulsion.broken_by(problem.engine, self)
    }

    /// The orders that `problem` allows, `wanted` first. Errors: [`PlanError::Structure`] when none.
    pub(super) fn allowed(problem: &Problem, wanted: Self) -> Result<Vec<Self>, PlanError> {
        let others = Self::ALL.into_iter().filter(|&structure| structure != wanted);
        let all = std::iter::once(wanted).chain(others);
        let allowed: Vec<Self> = all.filter(|s| s.broken_limit(problem).is_none()).collect();
        match (allowed.is_empty(), wanted.broken_limit(problem)) {
            (true, Some(limit)) => Err(PlanError::Structure { wanted, limit, instead: None }),
            _ => Ok(allowed),
        }
    }

    /// Whether the engine runs, phase by phase.
    pub(super) fn powered(self) -> &'static [bool] {
        match self {
            Self::OnOffOn => &[true, false, true],
            Self::OffOn => &[false, true],
            Self::OnOff => &[true, false],
            Self::On => &[true],
            Self::Off => &[false],
        }
    }
}

/// One phase of a grid: equal intervals, one closed-form interval for a coast.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PhaseGrid {
    pub powered: bool,
    pub intervals: usize,
    /// Shortest interval, s.
    pub step_min_s: f64,
}

impl PhaseGrid {
    /// Unit of a change of an interval that is `step_s` long, s (G.15, G.16): its length, softened so that a nearly
    /// vanished phase stays free to grow again.
    pub fn softened_s(&self, step_s: f64) -> f64 {
        const PHASE_MIN_S: f64 = 0.05;
        step_s + PHASE_MIN_S / self.intervals as f64
    }
}

/// The grid of a plan: phases, and the phase of every interval.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub structure: Structure,
    pub phases: Vec<PhaseGrid>,
    pub phase_of: Vec<usize>,
}

impl Grid {
    pub fn new(structure: Structure, problem: &Problem, settings: &Settings) -> Self {
        let powered = structure.powered();
        let last = powered.len() - 1;
        let phases: Vec<PhaseGrid> = (0..=last)
            .map(|phase| {
                let intervals = match (powered[phase], phase == last) {
                    (false, _) => 1,
                    (true, _) if last == 0 => settings.single_burn_intervals,
                    (true, true) => settings.last_burn_intervals,
                    (true, false) => settings.first_burn_intervals,
                };
                let Problem { propulsion, engine, .. } = *problem;
                let duration_min_s = propulsion.phase_min_s(engine, powered[phase], phase == 0);
                let step_min_s = duration_min_s / intervals as f64;
                PhaseGrid { powered: powered[phase], intervals, step_min_s }
            })
            .collect();
        let phase_of = phases
            .iter()
            .enumerate()
            .flat_map(|(index, phase)| std::iter::repeat_n(index, phase.intervals))
            .collect();
        Self { structure, phases, phase_of }
    }

    /// Number of intervals.
    pub fn len(&self) -> usize {
        self.phase_of.len()
    }

    /// Powered intervals in order of time.
    pub fn burns(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&j| self.phases[self.phase_of[j]].powered)
    }
}
