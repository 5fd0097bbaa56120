//! Cold and warm planning: which start, which structure, which error.

use super::conic::Program;
use super::error::PlanError;
use super::outer_loop::{self, Budget, End, Outcome};
use super::plan::{Plan, Report};
use super::problem::{Problem, Settings, within};
use super::start;
use super::structure::{Grid, Structure};
use super::trajectory::Iterate;
use super::verify;

/// Plans from nothing: a relaxed solve gives the switching structure, a refined one the plan.
pub fn plan(problem: &Problem, settings: &Settings) -> Result<Plan, PlanError> {
    problem.validate()?;
    settings.validate()?;
    verify::initial_path(problem)?;
    cold(problem, settings, &mut Budget::new(settings))
}

/// Plans from the part of `last` that is left after `elapsed_s`, in its switching structure, and
/// from nothing when that fails.
pub fn replan(
    problem: &Problem,
    settings: &Settings,
    last: &Plan,
    elapsed_s: f64,
) -> Result<Plan, PlanError> {
    problem.validate()?;
    settings.validate()?;
    within("elapsed_s", elapsed_s, 0.0, f64::MAX, "[0, ∞) s")?;
    verify::initial_path(problem)?;
    let mut budget = Budget::new(settings);
    let warm = start::from_plan(last, elapsed_s, settings).and_then(|(grid, start)| {
        let mut plan = attempt(problem, settings, &grid, start, &mut budget).ok()?;
        plan.first_phase_age_s = last.phase_age_s(elapsed_s);
        plan.report.warm = true;
        Some(plan)
    });
    warm.map_or_else(|| cold(problem, settings, &mut budget), Ok)
}

/// The first conic program that [`replan`] solves, to measure solvers on; `None` when nothing of
/// `last` is left.
pub fn subproblem(
    problem: &Problem,
    settings: &Settings,
    last: &Plan,
    elapsed_s: f64,
) -> Option<Program> {
    let (grid, start) = start::from_plan(last, elapsed_s, settings)?;
    Some(outer_loop::first_program(problem, &grid, start))
}

fn cold(problem: &Problem, settings: &Settings, budget: &mut Budget) -> Result<Plan, PlanError> {
    let relaxed_problem = Problem { thrust_min_n: 0.0, final_tilt: None, ..problem.clone() };
    let relaxed_settings =
        Settings { single_burn_intervals: settings.relaxed_intervals, ..settings.clone() };
    let grid = Grid::new(Structure::On, &relaxed_settings);
    let guess = start::minimum_energy(problem, &grid);
    let relaxed =
        outer_loop::iterate(&relaxed_problem, &grid, guess, &relaxed_settings, budget)?.trajectory;
    let mut refine = |structure| {
        let (grid, start) = start::from_relaxed(problem, &relaxed, structure, settings);
        attempt(problem, settings, &grid, start, budget)
    };
    refine(settings.structure).or_else(|error| {
        // The relaxed switching times can hide a burn shorter than its intervals.
        let others = [Structure::OnOffOn, Structure::OffOn].map(Some);
        let mut others = others.into_iter().filter(|_| settings.structure.is_none());
        others.find_map(|structure| refine(structure).ok()).ok_or(error)
    })
}

/// One loop on one grid, its report and its verdict.
fn attempt(
    problem: &Problem,
    settings: &Settings,
    grid: &Grid,
    start: Iterate,
    budget: &mut Budget,
) -> Result<Plan, PlanError> {
    if budget.spent() {
        return Err(budget.exhausted());
    }
    let Outcome { trajectory, end } = outer_loop::iterate(problem, grid, start, settings, budget)?;
    let report = Report {
        outer_iterations: budget.outer_iterations,
        solver_iterations: budget.solver_iterations,
        lossless_gap: trajectory.lossless_gap,
        thrust_violation_n: trajectory.thrust_violation_n,
        reserve_m_s: trajectory.reserve_m_s,
        ..Report::default()
    };
    verify::path(problem, &trajectory.nodes)?;
    let mut plan = Plan::new(problem, grid, trajectory);
    let (miss_m, miss_m_s) = verify::repropagate(problem, &plan);
    plan.report = Report { miss_m, miss_m_s, ..report };
    match verify::accept(problem, &plan) {
        Err(PlanError::Target { .. }) if end == End::OutOfIterations => Err(budget.exhausted()),
        verdict => verdict.map(|()| plan),
    }
}
