//! The proximal loop: solve about the reference, measure the merit, accept or stiffen (G.78).

use super::error::SixDofError;
use super::problem::{SixDofProblem, SixDofSettings};
use super::subproblem::{DEFECT_WEIGHT, Margin, Subproblem};
use super::trajectory::{Grid, Iterate, Scale, Trajectory};
use crate::scvx::{ConicSolver, PlanError};

/// Converged largest scaled shooting defect: 1e-7 of a few hundred metres is some 20 µm an interval.
const DEFECT: f64 = 1e-7;
/// Converged change of the scaled propellant between two iterations.
const FUEL_CHANGE: f64 = 1e-4;
/// Change of the scaled propellant, and largest scaled defect, below which only the defects are left
/// to mend: the proximal weight then only grows.
const FUEL_FLAT: f64 = 2e-3;
const DEFECT_SMALL: f64 = 1e-3;
/// Proximal weight: initial, of a loop that mends, factors after a good and a bad step, and its range.
pub(super) const STIFFNESS_START: f64 = 0.1;
const STIFFNESS_MEND: f64 = 1.0;
const STIFFNESS_CUT: f64 = 0.25;
const STIFFNESS_GROWTH: f64 = 5.0;
const STIFFNESS_RANGE: [f64; 2] = [1e-3, 1e4];
/// Share of the predicted decrease below which a step is refused, and above which it is good.
const REFUSED: f64 = 0.05;
const GOOD: f64 = 0.6;
/// Predicted decrease of the merit below which nothing more is gained.
const STALL: f64 = 1e-9;

/// Work done by one call, against its budget.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    pub solves: u32,
    pub refused: u32,
    pub solver_iterations: u32,
    pub tightenings: u32,
    solves_max: u32,
    solver_iterations_max: u32,
    phase_min_s: f64,
}

impl Work {
    pub fn new(settings: &SixDofSettings) -> Self {
        Self {
            solves: 0,
            refused: 0,
            solver_iterations: 0,
            tightenings: 0,
            solves_max: settings.solves_max,
            solver_iterations_max: settings.solver_iterations_max,
            phase_min_s: settings.phase_min_s,
        }
    }

    pub fn spent(&self) -> bool {
        self.solves >= self.solves_max
    }
}

/// Best trajectory of a loop.
pub(super) struct Outcome {
    pub trajectory: Trajectory,
    pub converged: bool,
    /// Virtual control of the last accepted solution, scaled sum.
    pub virtual_control: f64,
}

/// Iterates from `start` until the defects vanish and the propellant rests, or the budget is spent.
pub(super) fn iterate(
    problem: &SixDofProblem,
    grid: &Grid,
    scale: &Scale,
    margins: &[Margin],
    start: Iterate,
    work: &mut Work,
) -> Result<Outcome, SixDofError> {
    let subproblem = Subproblem { problem, grid, scale, margins, phase_min_s: work.phase_min_s };
    let merit =
        |end_mass_kg: f64, defect: f64| DEFECT_WEIGHT * defect - end_mass_kg / scale.state[0];
    let mut outcome = Outcome {
        trajectory: Trajectory::new(problem, grid, start),
        converged: false,
        virtual_control: f64::INFINITY,
    };
    let mut solver: Option<ConicSolver> = None;
    // A loop that only mends what drawn-in limits changed starts settled.
    let mut settled = work.tightenings > 0;
    let mut stiffness = if settled { STIFFNESS_MEND } else { STIFFNESS_START };
    // The guess need not keep the limits: the first step is always taken.
    let mut reference_merit = f64::INFINITY;
    // After a refused step the next good one doesn't soften, or steps would be refused in turn.
    let mut cautious = false;

    while !work.spent() {
        work.solves += 1;
        let program = subproblem.build(&outcome.trajectory, stiffness);
        let solved = match &mut solver {
            Some(solver) => solver.solve(&program),
            empty => ConicSolver::new(&program, work.solver_iterations_max)
                .and_then(|new| empty.insert(new).solve(&program)),
        };
        let solution = match solved {
            Ok(solution) => solution,
            // A stiffer program is better conditioned.
            Err(PlanError::Solver { .. }) if stiffness < STIFFNESS_RANGE[1] => {
                stiffness *= STIFFNESS_GROWTH;
                work.refused += 1;
                continue;
            }
            Err(error) => return Err(SixDofError::Solver(error)),
        };
        work.solver_iterations += solution.iterations;
        let (next, virtual_control) = subproblem.extract(&outcome.trajectory.iterate, &solution.x);
        let model = merit(next.states[grid.nodes() - 1][0], virtual_control);
        let candidate = Trajectory::new(problem, grid, next);
        let (defect_sum, defect_max) = candidate.defect(scale);
        let candidate_merit = merit(candidate.end_mass_kg(), defect_sum);
        let share = (reference_merit - candidate_merit) / (reference_merit - model);
        let fuel_change =
            (candidate.end_mass_kg() - outcome.trajectory.end_mass_kg()).abs() / scale.state[0];
        let converged = defect_max <= DEFECT && fuel_change <= FUEL_CHANGE;
        let accepted = converged || reference_merit.is_infinite() || share > REFUSED;
        if accepted {
            outcome.trajectory = candidate;
            outcome.virtual_control = virtual_control;
            reference_merit = candidate_merit;
        } else {
            work.refused += 1;
        }
        if converged {
            outcome.converged = true;
            break;
        }
        if reference_merit - model < STALL {
            break;
        }
        settled |= accepted && fuel_change < FUEL_FLAT && defect_max < DEFECT_SMALL;
        if settled {
            stiffness *= STIFFNESS_GROWTH;
        } else if share > GOOD {
            stiffness *= if cautious { 1.0 } else { STIFFNESS_CUT };
        } else if share < 0.5 * GOOD {
            stiffness *= STIFFNESS_GROWTH;
        }
        cautious = !accepted;
        stiffness = stiffness.clamp(STIFFNESS_RANGE[0], STIFFNESS_RANGE[1]);
    }
    Ok(outcome)
}
