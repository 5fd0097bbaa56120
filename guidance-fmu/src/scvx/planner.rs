//! Cold and warm planning: which start, which structure, which error.

use super::bounds;
use super::conic::Program;
use super::error::PlanError;
use super::outer_loop::{self, Budget, End, Outcome, Purpose};
use super::plan::{Plan, Report};
use super::problem::{Problem, Settings, Terminal, within};
use super::propulsion::Propulsion;
use super::start;
use super::structure::{Grid, Structure};
use super::trajectory::{Iterate, Trajectory};
use super::verify;

/// Turn beyond its limit with which a warm plan is not taken unseen, rad: 6°, which the vehicle is behind by in a slew anyway.
const TURN_EXCESS_MAX_RAD: f64 = 0.1;

/// Tilt beyond its limit of the first plan on the way to one at the limit, rad: 8°, as far as guesses fail (50° for the reference
/// descent) from where they do not (58°).
const WIDER_RAD: f64 = 0.14;

/// Plans from nothing: a relaxed solve gives the switching structure, a refined one the plan.
///
/// # Errors
/// [`PlanError`], with the reason; [`PlanError::is_infeasible`] tells "there is none" from "none
/// was found".
///
/// ```
/// use guidance_fmu::scvx::{PathLimits, Problem, Settings, Terminal, solve};
/// use nalgebra::Vector3;
///
/// let descent = Problem {
///     r0_w: Vector3::new(300.0, 100.0, 500.0),
///     v0_w: Vector3::new(-15.0, -5.0, -25.0),
///     r_f_w: Vector3::zeros(),
///     v_f_w: Vector3::zeros(),
///     terminal: Terminal::Point,
///     mass_kg: 259.5,
///     dry_mass_kg: 174.0,
///     gravity_m_s2: 1.625,
///     isp_s: 225.0,
///     thrust_min_n: 800.0,
///     thrust_max_n: 5200.0,
///     thrust_rate_max_n_s: None,
///     turn: None,
///     propulsion: Default::default(),
///     engine: Default::default(),
///     tilt_max_rad: 29_f64.to_radians(),
///     final_tilt: None,
///     reserve: None,
///     path: PathLimits::default(),
/// };
/// let plan = solve(&descent, &Settings::default())?;
/// assert!((plan.propellant_kg() - 6.749).abs() < 0.007);
/// # Ok::<(), guidance_fmu::scvx::PlanError>(())
/// ```
pub fn solve(problem: &Problem, settings: &Settings) -> Result<Plan, PlanError> {
    problem.validate()?;
    settings.validate()?;
    verify::initial_path(problem)?;
    if problem.terminal == Terminal::SoftestImpact {
        // A landing is the softest impact there is, and easier to find as such.
        let landing = Problem { terminal: Terminal::Anywhere, ..problem.clone() };
        if let Ok(plan) = cold(&landing, settings, &mut Budget::new(settings)) {
            return Ok(plan);
        }
    }
    cold(problem, settings, &mut Budget::new(settings))
}

/// Plans from the part of `last` that is left after `elapsed_s`, in its switching structure, and
/// from nothing when that fails. Until `last` ends, the engine's past is that of `last`.
///
/// # Errors
/// As [`solve`].
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
    let problem = &continued(problem, last, elapsed_s);
    let mut budget = Budget::new(settings);
    let warm = start::from_plan(problem, settings, last, elapsed_s).and_then(|(grid, start)| {
        let mut plan = attempt(problem, settings, &grid, start, Purpose::Plan, &mut budget).ok()?;
        plan.report.warm = true;
        Some(plan)
    });
    match warm {
        Some(plan) if plan.report.turn_excess_rad <= TURN_EXCESS_MAX_RAD => Ok(plan),
        // Another order of burns may do with half the turn.
        Some(plan) => {
            let eases =
                |other: &Plan| other.report.turn_excess_rad < 0.5 * plan.report.turn_excess_rad;
            Ok(cold(problem, settings, &mut budget).ok().filter(eases).unwrap_or(plan))
        }
        None => cold(problem, settings, &mut budget),
    }
}

/// The first conic program that [`replan`] solves, to measure solvers on; `None` when nothing of
/// `last` is left.
pub fn subproblem(
    problem: &Problem,
    settings: &Settings,
    last: &Plan,
    elapsed_s: f64,
) -> Option<Program> {
    let problem = &continued(problem, last, elapsed_s);
    let (grid, start) = start::from_plan(problem, settings, last, elapsed_s)?;
    Some(outer_loop::first_program(problem, &grid, start))
}

/// `problem` with the engine as `last` leaves it.
fn continued(problem: &Problem, last: &Plan, elapsed_s: f64) -> Problem {
    let flown = elapsed_s <= last.duration_s();
    let engine = if flown { last.engine_at(elapsed_s) } else { problem.engine };
    Problem { engine, ..problem.clone() }
}

fn cold(problem: &Problem, settings: &Settings, budget: &mut Budget) -> Result<Plan, PlanError> {
    let least = bounds::least_impulse(problem);
    if settings.bounds {
        bounds::check(problem, least.as_ref())?;
    }
    let relaxed_problem = Problem {
        thrust_min_n: 0.0,
        final_tilt: None,
        thrust_rate_max_n_s: None,
        turn: None,
        propulsion: Propulsion::AlwaysOn,
        ..problem.clone()
    };
    if problem.propulsion == Propulsion::AlwaysOn && problem.thrust_min_n > 0.0 {
        // No structure to find; the relaxed solve is the second chance.
        let grid = Grid::new(Structure::On, problem, settings);
        let guess = start::never_off(problem, &grid);
        let direct = Settings { outer_max: settings.outer_max / 2, ..settings.clone() };
        if let Ok(plan) = attempt(problem, &direct, &grid, guess, Purpose::PlanFromGuess, budget) {
            return Ok(plan);
        }
    }
    let relaxed_settings =
        Settings { single_burn_intervals: settings.relaxed_intervals, ..settings.clone() };
    let grid = Grid::new(Structure::On, &relaxed_problem, &relaxed_settings);
    // Nothing may be relaxed: then this loop's answer is the plan.
    let as_asked = relaxed_problem == *problem && relaxed_settings == *settings;
    let purpose = if as_asked { Purpose::Plan } else { Purpose::Structure };
    let mut relax = |guess| {
        outer_loop::iterate(&relaxed_problem, &grid, guess, &relaxed_settings, purpose, budget)
    };
    let guess = match least {
        Some(least) => start::finite_burns(problem, &grid, least.flight_s),
        None => start::minimum_energy(problem, &grid),
    };
    let mut outcome = relax(guess)?;
    if shortfall(problem, &outcome.trajectory) > verify::MISS_MAX {
        // Short and long flights are separate valleys; the linearisation leads from neither to the other.
        let short = |outcome: &Outcome| shortfall(problem, &outcome.trajectory);
        outcome = match relax(start::climb(problem, &grid)) {
            Ok(climb) if short(&climb) < short(&outcome) => climb,
            _ => outcome,
        };
    }
    if as_asked && let Ok(plan) = judge(problem, &grid, outcome.clone(), budget) {
        return Ok(plan);
    }
    let relaxed = outcome.trajectory;
    // The relaxed switching times can hide a burn shorter than its intervals, and limits can forbid
    // the structure they show.
    let wanted = start::structure(problem, &relaxed);
    // Without a floor nothing flies that the relaxed solve could not: one more look is enough.
    let out_of_reach = problem.terminal != Terminal::SoftestImpact
        && shortfall(problem, &relaxed) > verify::MISS_MAX;
    let looks = if out_of_reach { 1 } else { usize::MAX };
    let mut refusal = None;
    for structure in Structure::allowed(problem, wanted)?.into_iter().take(looks) {
        let (grid, start) = start::from_relaxed(problem, &relaxed, structure, settings);
        // Free fall is there when all else has failed, and takes a solve or two.
        let last_resort = &mut Budget::new(settings);
        let budget = if structure == Structure::Off { last_resort } else { &mut *budget };
        match attempt(problem, settings, &grid, start, Purpose::Plan, budget) {
            Ok(plan) => return Ok(plan),
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    if problem.propulsion == Propulsion::AlwaysOn
        && let Some(plan) = narrowed(problem, settings)
    {
        return Ok(plan);
    }
    let instead = refusal.unwrap_or_else(|| budget.exhausted());
    match wanted.broken_limit(problem) {
        Some(limit) if problem.propulsion != Propulsion::AlwaysOn => {
            Err(PlanError::Structure { wanted, limit, instead: Some(Box::new(instead)) })
        }
        _ => Err(instead),
    }
}

/// A plan for an engine that never stops, from plans at wider tilt limits (G.100): near the critical tilt (G.20) a
/// linearisation about a guess leads nowhere, but a plan a degree away is near enough.
fn narrowed(problem: &Problem, settings: &Settings) -> Option<Plan> {
    let budget = &mut Budget::new(settings);
    let grid = Grid::new(Structure::On, problem, settings);
    let mut start = start::never_off(problem, &grid);
    let (mut wider_rad, mut step_rad) = (WIDER_RAD, 0.5 * WIDER_RAD);
    let mut reached_rad = None;
    while !budget.spent() {
        let tilt_max_rad = problem.tilt_max_rad + wider_rad;
        let wider = Problem { tilt_max_rad, ..problem.clone() };
        let purpose = Purpose::PlanFromGuess;
        match attempt(&wider, settings, &grid, start.clone(), purpose, budget) {
            Ok(plan) if wider_rad == 0.0 => return Some(plan),
            Ok(plan) => {
                start = start::from_plan(&wider, settings, &plan, 0.0)?.1;
                reached_rad = Some(wider_rad);
            }
            Err(_) => step_rad *= 0.5,
        }
        wider_rad = (reached_rad? - step_rad).max(0.0);
    }
    None
}

/// How much a trajectory leaves to be wished for at the target and on the path, m and m/s alike.
fn shortfall(problem: &Problem, trajectory: &Trajectory) -> f64 {
    let outside_m: f64 =
        trajectory.path_violations(problem, verify::PATH_EXCESS_MAX_M).iter().map(|(_, m)| m).sum();
    let impact_m_s = trajectory.nodes.last().map_or(0.0, |end| problem.impact_m_s(&end.v_w));
    trajectory.miss_r_w.norm() + trajectory.miss_v_w.norm() + outside_m + impact_m_s
}

/// One loop on one grid, judged.
fn attempt(
    problem: &Problem,
    settings: &Settings,
    grid: &Grid,
    start: Iterate,
    purpose: Purpose,
    budget: &mut Budget,
) -> Result<Plan, PlanError> {
    if budget.spent() {
        return Err(budget.exhausted());
    }
    let outcome = outer_loop::iterate(problem, grid, start, settings, purpose, budget)?;
    judge(problem, grid, outcome, budget)
}

/// The plan of a loop's outcome, its report and its verdict.
fn judge(
    problem: &Problem,
    grid: &Grid,
    outcome: Outcome,
    budget: &Budget,
) -> Result<Plan, PlanError> {
    let Outcome { trajectory, last_step, end } = outcome;
    let report = Report {
        outer_iterations: budget.outer_iterations,
        solver_iterations: budget.solver_iterations,
        lossless_gap: trajectory.lossless_gap,
        last_step,
        thrust_violation_n: trajectory.thrust_violation_n,
        reserve_m_s: trajectory.reserve_m_s,
        turn_excess_rad: trajectory.turn_excess_rad,
        ..Report::default()
    };
    verify::path(problem, &trajectory.nodes)?;
    let mut plan = Plan::new(problem, grid, trajectory);
    plan.report = report;
    verify::measure(problem, &mut plan);
    match verify::accept(problem, &plan) {
        Err(PlanError::Target { .. }) if end == End::OutOfIterations => Err(budget.exhausted()),
        verdict => verdict.map(|()| plan),
    }
}
