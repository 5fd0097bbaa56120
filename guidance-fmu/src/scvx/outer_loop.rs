//! The successive-convexification loop: solve about the reference, roll out exactly, restore the target, accept on
//! merit, until the defect is small and so is what the linearisation leaves out of the fuel (G.18, G.94, G.95).

use lander_models::math::square;

use super::conic::{self, ConicSolver, Program};
use super::error::PlanError;
use super::problem::{Problem, Settings};
use super::residuals::LastStep;
use super::restore::restore;
use super::structure::Grid;
use super::subproblem::{Local, RESERVE_WEIGHT, SLACK_WEIGHT, Scale, Subproblem, TURN_WEIGHT};
use super::trajectory::{Iterate, Trajectory};
use super::verify::{LOSSLESS_GAP_MAX, MISS_MAX};

/// Tolerance of conic solves whose step is only to lead nearer: a hundredth of the fuel change of a structure.
const ROUGH: f64 = 1e-5;
/// Relative fuel change of a step that was the last rough one: the next one changes about the square of it, 4e-4, and
/// may end the loop.
const ROUGH_FUEL_CHANGE: f64 = 2e-2;
/// Converged relative thrust excursion.
const THRUST_DEFECT: f64 = 1e-5;
/// Node excursion that counts as a violated path limit, m.
const PATH_DEFECT_M: f64 = 1e-3;
/// Relative merit decrease below which an accepted step is no progress.
const STALL: f64 = 1e-6;
/// Relative merit increase below which a rejected stiff step that misses the target is the last: a
/// reference slightly out of its thrust bounds can't be bettered by one within them.
const LEVEL: f64 = 1e-5;
/// Relative trust radius on the durations: initial, cap, and factor of a rejected step.
const TRUST_START: f64 = 0.5;
const TRUST_CAP: f64 = 0.8;
const TRUST_CUT: f64 = 0.35;
/// Proximal weight on the durations: initial, growth on a rejected step, and the weight that holds
/// them once the fuel is flat, so that the last steps only mend the defect.
const STIFFNESS_START: f64 = 1e-2;
const STIFFNESS_GROWTH: f64 = 10.0;
const STIFFNESS_MAX: f64 = 1.0;

/// Largest curvature that is taken from a restoration: durations then move by a hundredth for all the fuel.
const CURVATURE_MAX: f64 = 1e2;
/// Squared relative change of the durations below which restoration costs too little to show their curvature: with the
/// largest curvature some 1e-4 of the fuel. From 1e-8 to 1e-4 400 plans from about the reference descents take as many solves.
const MOVED_MIN: f64 = 1e-6;

/// What the trajectory of a loop is for, which says when the loop has converged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To be flown.
    Plan,
    /// To be flown, by an engine that never stops: from a guess that has no such engine, so that first steps lead far.
    PlanFromGuess,
    /// To read switching times from, which the next loop refines.
    Structure,
}

impl Purpose {
    /// Converged position and velocity defect, m and m/s: a tenth of the millimetre and mm/s that a
    /// flight could notice, or of what counts as met.
    fn defect(self) -> f64 {
        match self {
            Self::Plan | Self::PlanFromGuess => 1e-4,
            Self::Structure => 0.1 * MISS_MAX,
        }
    }

    /// Converged relative fuel change between two outer iterations.
    fn fuel_change(self) -> f64 {
        match self {
            Self::Plan | Self::PlanFromGuess => 2e-5,
            Self::Structure => 1e-3,
        }
    }
}

/// Work done so far by one call, against its limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    pub outer_iterations: u32,
    pub solver_iterations: u32,
    pub solves_max: u32,
}

impl Budget {
    pub fn new(settings: &Settings) -> Self {
        Self { outer_iterations: 0, solver_iterations: 0, solves_max: settings.solves_max }
    }

    pub fn spent(&self) -> bool {
        self.outer_iterations >= self.solves_max
    }

    /// The error of a loop that ends for want of iterations.
    pub fn exhausted(&self) -> PlanError {
        PlanError::IterationBudget { solves: self.outer_iterations }
    }
}

/// How a loop ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Defect and fuel change are small.
    Converged,
    /// The merit no longer falls although the defect is not small.
    Stalled,
    OutOfIterations,
}

/// Best trajectory of a loop.
#[derive(Clone)]
pub(super) struct Outcome {
    pub trajectory: Trajectory,
    pub last_step: LastStep,
    pub end: End,
}

/// Iterates from `start` until convergence, a spent budget or `settings.outer_max`.
pub(super) fn iterate(
    problem: &Problem,
    grid: &Grid,
    start: Iterate,
    settings: &Settings,
    purpose: Purpose,
    budget: &mut Budget,
) -> Result<Outcome, PlanError> {
    let scale = Scale::new(problem);
    let subproblem = Subproblem { problem, grid, scale };
    let mut reference = Trajectory::new(problem, grid, clamp_durations(grid, start));
    // The guess need not satisfy anything: the first step is always taken.
    let mut reference_merit = f64::INFINITY;
    let mut local = first_local();
    let mut solver: Option<ConicSolver> = None;
    let mut last_step = LastStep::default();
    let mut rough = purpose != Purpose::Plan;

    for _ in 0..settings.outer_max {
        if budget.spent() {
            break;
        }
        budget.outer_iterations += 1;
        let program = subproblem.build(&reference, &local);
        let factorised = match &mut solver {
            Some(factorised) if factorised.fits(&program) => factorised,
            empty => empty.insert(ConicSolver::new(&program, settings.solver_iterations_max)?),
        };
        factorised.set_tolerance(if rough { ROUGH } else { conic::TOLERANCE })?;
        let solution = factorised.solve(&program)?;
        budget.solver_iterations += solution.iterations;
        let solved = Trajectory::new(problem, grid, subproblem.extract(&solution.x));
        let slack = subproblem.terminal_slack(&reference, &solution.x);
        let mut step = LastStep::new(&reference, &solved, slack);
        let moved = Moved::new(grid, &reference, &solved, local.trust);
        let Candidate { trajectory: candidate, merit: candidate_merit, restored } =
            Candidate::new(problem, grid, &scale, solved);
        step.restoration_m_s = restored.unwrap_or(0.0);

        let violated = candidate.path_violations(problem, PATH_DEFECT_M);
        let unwatched = violated.iter().filter(|(node, _)| !local.path_nodes.contains(node));
        let added: Vec<usize> = unwatched.map(|&(node, _)| node).collect();
        // Without a floor a gap is harmless: any ‖u‖ below σ is allowed.
        let lossy = problem.thrust_min_n > 0.0 && candidate.lossless_gap > LOSSLESS_GAP_MAX;
        let feasible = violated.is_empty()
            && candidate.miss_r_w.amax() <= purpose.defect()
            && candidate.miss_v_w.amax() <= purpose.defect()
            && !lossy
            && candidate.thrust_violation_n <= THRUST_DEFECT * problem.thrust_max_n;
        let fuel_change = (candidate.cost_m_s / reference.cost_m_s - 1.0).abs();
        let fuel_flat = match restored {
            // A linearised floor (G.13) is not part of what restoration measures.
            Some(left_out_m_s) if !local.thrust_floor => {
                let held_m_s = local.stiffness * moved.squared * scale.velocity_m_s;
                let flat_m_s = purpose.fuel_change() * candidate.cost_m_s;
                left_out_m_s.abs() <= flat_m_s && held_m_s <= flat_m_s && moved.freely
            }
            _ => fuel_change <= purpose.fuel_change(),
        };
        let accurate = !rough || purpose == Purpose::Structure;
        if feasible && fuel_flat && accurate {
            return Ok(Outcome { trajectory: candidate, last_step: step, end: End::Converged });
        }

        rough = purpose == Purpose::Structure || rough && fuel_change > ROUGH_FUEL_CHANGE;
        let more_rows = !added.is_empty() || (lossy && !local.thrust_floor);
        let curvature = restored
            .filter(|_| moved.squared > MOVED_MIN)
            .map(|left_out_m_s| 2.0 * left_out_m_s / (scale.velocity_m_s * moved.squared));
        if fuel_flat {
            local.stiffness = STIFFNESS_MAX;
        } else if let Some(curvature) = curvature {
            // (G.95)
            local.stiffness = curvature.clamp(STIFFNESS_START, CURVATURE_MAX);
        }
        if candidate_merit < reference_merit {
            let stalled = reference_merit - candidate_merit <= STALL * candidate_merit;
            local.trust = (2.0 * local.trust).min(TRUST_CAP);
            (reference, reference_merit, last_step) = (candidate, candidate_merit, step);
            if stalled && !more_rows {
                return Ok(Outcome { trajectory: reference, last_step, end: End::Stalled });
            }
        } else {
            let missed = reference.miss_r_w.norm().max(reference.miss_v_w.norm()) > MISS_MAX;
            let level = candidate_merit - reference_merit <= LEVEL * reference_merit;
            if missed && level && local.stiffness >= STIFFNESS_MAX && !more_rows {
                return Ok(Outcome { trajectory: reference, last_step, end: End::Stalled });
            }
            local.trust *= TRUST_CUT;
            if curvature.is_none() {
                local.stiffness = (STIFFNESS_GROWTH * local.stiffness).min(STIFFNESS_MAX);
            }
        }
        if more_rows {
            local.thrust_floor |= lossy;
            local.path_nodes.extend(added);
            local.path_nodes.sort_unstable();
            // More rows make the merits incomparable.
            reference_merit = f64::INFINITY;
        }
    }
    Ok(Outcome { trajectory: reference, last_step, end: End::OutOfIterations })
}

/// The program of the first iteration from `start`.
pub(super) fn first_program(problem: &Problem, grid: &Grid, start: Iterate) -> Program {
    let reference = Trajectory::new(problem, grid, clamp_durations(grid, start));
    Subproblem { problem, grid, scale: Scale::new(problem) }.build(&reference, &first_local())
}

fn first_local() -> Local {
    Local {
        trust: TRUST_START,
        stiffness: STIFFNESS_START,
        path_nodes: Vec::new(),
        thrust_floor: false,
    }
}

/// Fuel plus the penalised target, thrust and path defects, in scaled units.
fn merit(problem: &Problem, scale: &Scale, trajectory: &Trajectory) -> f64 {
    let path_m: f64 = trajectory.path_violations(problem, 0.0).iter().map(|(_, m)| m).sum();
    let thrust = trajectory.thrust_violation_n.max(0.0) / problem.thrust_max_n;
    let priced_m_s = trajectory.cost_m_s + RESERVE_WEIGHT * trajectory.reserve_m_s;
    priced_m_s / scale.velocity_m_s
        + TURN_WEIGHT * trajectory.turn_excess_rad
        + SLACK_WEIGHT
            * (trajectory.miss_v_w.lp_norm(1) / scale.velocity_m_s
                + (trajectory.miss_r_w.lp_norm(1) + path_m) / scale.length_m
                + thrust)
}

/// A subproblem's solution, or what restoration makes of it when that is better.
struct Candidate {
    trajectory: Trajectory,
    merit: f64,
    /// Cost of restoration, m/s: what the linearisation left out (G.94).
    restored: Option<f64>,
}

impl Candidate {
    fn new(problem: &Problem, grid: &Grid, scale: &Scale, solved: Trajectory) -> Self {
        let solved_merit = merit(problem, scale, &solved);
        if let Some(flown) = restore(problem, grid, &solved) {
            let flown_merit = merit(problem, scale, &flown);
            if flown_merit <= solved_merit {
                let restored = Some(flown.cost_m_s - solved.cost_m_s);
                return Self { trajectory: flown, merit: flown_merit, restored };
            }
        }
        Self { trajectory: solved, merit: solved_merit, restored: None }
    }
}

/// How far a step moved the durations, in the units of (G.16).
struct Moved {
    squared: f64,
    /// Whether the trust region held none of them back.
    freely: bool,
}

impl Moved {
    fn new(grid: &Grid, from: &Trajectory, to: &Trajectory, trust: f64) -> Self {
        /// Room for the conic solver's tolerance.
        const INSIDE: f64 = 0.99;
        let steps_s = from.iterate.step_s.iter().zip(&to.iterate.step_s).zip(&grid.phases);
        let relative =
            steps_s.map(|((from_s, to_s), phase)| (to_s - from_s) / phase.softened_s(*from_s));
        let (mut squared, mut freely) = (0.0, true);
        for change in relative {
            squared += square(change);
            freely &= change.abs() < INSIDE * trust;
        }
        Self { squared, freely }
    }
}

fn clamp_durations(grid: &Grid, mut start: Iterate) -> Iterate {
    for (step_s, phase) in start.step_s.iter_mut().zip(&grid.phases) {
        *step_s = step_s.max(phase.step_min_s);
    }
    start
}
