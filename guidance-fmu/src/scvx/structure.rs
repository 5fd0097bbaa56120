//! Switching structures and the grid each one is discretised on.

use serde::{Deserialize, Serialize};

use super::problem::Settings;

/// Order of burns and coasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Structure {
    OnOffOn,
    OffOn,
    OnOff,
    On,
}

impl Structure {
    /// The structure whose phases are `powered`, if there is one.
    pub(super) fn of(powered: &[bool]) -> Option<Self> {
        [Self::OnOffOn, Self::OffOn, Self::OnOff, Self::On]
            .into_iter()
            .find(|structure| structure.powered() == powered)
    }

    /// Whether the engine runs, phase by phase.
    pub(super) fn powered(self) -> &'static [bool] {
        match self {
            Self::OnOffOn => &[true, false, true],
            Self::OffOn => &[false, true],
            Self::OnOff => &[true, false],
            Self::On => &[true],
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

/// The grid of a plan: phases, and the phase of every interval.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub structure: Structure,
    pub phases: Vec<PhaseGrid>,
    pub phase_of: Vec<usize>,
}

impl Grid {
    pub fn new(structure: Structure, settings: &Settings) -> Self {
        let powered = structure.powered();
        let last = powered.len() - 1;
        let phases: Vec<PhaseGrid> = (0..=last)
            .map(|phase| {
                let (intervals, duration_min_s) = match (powered[phase], phase == last) {
                    (false, _) => (1, settings.coast_min_s),
                    (true, _) if last == 0 => (settings.single_burn_intervals, settings.burn_min_s),
                    (true, true) => (settings.last_burn_intervals, settings.burn_min_s),
                    (true, false) => (settings.first_burn_intervals, settings.burn_min_s),
                };
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
