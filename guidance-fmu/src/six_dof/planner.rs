//! From the translation's plan to a checked plan in six degrees of freedom.

use super::dynamics::{R, V};
use super::error::SixDofError;
use super::excess::Excess;
use super::guess::{self, Translation};
use super::outer_loop::{self, Outcome, Work};
use super::plan::{SixDofPlan, SixDofReport};
use super::problem::{SixDofProblem, SixDofSettings};
use super::subproblem::{Margin, Subproblem};
use super::trajectory::{Grid, Iterate, Scale, Trajectory};
use super::verify;
use crate::scvx::{self, Problem, Program};

/// Virtual control (scaled sum) above which the dynamics and the limits don't meet.
const VIRTUAL_CONTROL_MAX: f64 = 1e-6;

/// Times the limits may be drawn in.
const TIGHTENINGS_MAX: u32 = 5;
/// What is drawn in against what is exceeded: the flight between gives way by less than its nodes.
const OVERDRAW: f64 = 1.5;

/// Plans from nothing: the translation's plan gives the phases and the first guess.
pub fn solve(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
) -> Result<SixDofPlan, SixDofError> {
    let translation = translation(problem, settings)?;
    let (grid, scale, guess) = begin(problem, settings, &translation);
    let mut work = Work::new(settings);
    let mut margins = vec![Margin::default(); grid.nodes()];
    let mut start = guess;
    loop {
        let outcome = outer_loop::iterate(problem, &grid, &scale, &margins, start, &mut work)?;
        let (plan, excesses) = measure(problem, &grid, &outcome, &work, &translation);
        converged(&outcome, &work, plan.report.miss_m)?;
        if !draw_in(&mut margins, problem, &excesses) || work.tightenings == TIGHTENINGS_MAX {
            return verify::accept(problem, &plan).map(|()| plan);
        }
        work.tightenings += 1;
        start = outcome.trajectory.iterate;
    }
}

/// Draws the limits of the nodes in by what the flight beside them exceeds (G.79); whether any is.
fn draw_in(margins: &mut [Margin], problem: &SixDofProblem, excesses: &[Excess]) -> bool {
    let allowed = verify::BetweenNodes::new(problem);
    let mut any = false;
    for (node, excess) in excesses.iter().enumerate() {
        for beside in [node, node + 1] {
            let margin = &mut margins[beside];
            for (drawn, excess, allowed) in [
                (&mut margin.tilt_rad, excess.tilt_rad, allowed.tilt_rad),
                (&mut margin.rate_rad_s, excess.rate_rad_s, allowed.rate_rad_s),
                (&mut margin.glide_slope_m, excess.glide_slope_m, allowed.glide_slope_m),
            ] {
                if excess > allowed {
                    *drawn += OVERDRAW * excess;
                    any = true;
                }
            }
        }
    }
    any
}

/// The plan of a loop with its report, and the excess of each interval as flown.
fn measure(
    problem: &SixDofProblem,
    grid: &Grid,
    outcome: &Outcome,
    work: &Work,
    translation: &Translation,
) -> (SixDofPlan, Vec<Excess>) {
    let trajectory = &outcome.trajectory;
    let defect = |row: usize| {
        let parts = trajectory.defects.iter().map(|d| d.fixed_rows::<3>(row).norm());
        parts.fold(0.0, f64::max)
    };
    let mut plan = SixDofPlan::new(grid, &trajectory.iterate);
    let flown = verify::fly(problem, &plan);
    let planned = plan.nodes[grid.nodes() - 1];
    plan.report = SixDofReport {
        outer_iterations: work.solves,
        refused_steps: work.refused,
        solver_iterations: work.solver_iterations,
        tightenings: work.tightenings,
        translation_iterations: translation.plan.report.outer_iterations,
        translation_propellant_kg: translation.plan.propellant_kg(),
        virtual_control: outcome.virtual_control,
        defect_m: defect(R),
        defect_m_s: defect(V),
        miss_m: (flown.end.r_w - problem.r_f_w).norm(),
        miss_m_s: (flown.end.v_w - problem.v_f_w).norm(),
        miss_rad: flown.end.attitude_wb.angle_to(&planned.attitude_wb),
        miss_rad_s: (flown.end.rate_b - planned.rate_b).norm(),
        end_tilt_rad: flown.end.tilt_rad(),
        end_rate_rad_s: flown.end.rate_b.norm(),
        at_nodes: verify::at_nodes(problem, &plan),
        between_nodes: flown.excesses.iter().fold(Excess::default(), Excess::worse),
    };
    (plan, flown.excesses)
}

/// The first conic program that [`solve`] solves, to measure solvers on. Errors: as `solve`.
pub fn subproblem(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
) -> Result<Program, SixDofError> {
    let translation = translation(problem, settings)?;
    let (grid, scale, guess) = begin(problem, settings, &translation);
    let subproblem = Subproblem {
        problem,
        grid: &grid,
        scale: &scale,
        phase_min_s: settings.phase_min_s,
        margins: &vec![Margin::default(); grid.nodes()],
    };
    let reference = Trajectory::new(problem, &grid, guess);
    Ok(subproblem.build(&reference, outer_loop::STIFFNESS_START))
}

/// Checks the inputs and plans the centre of mass alone.
fn translation(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
) -> Result<Translation, SixDofError> {
    problem.validate()?;
    settings.validate()?;
    let (start, limits) = (&problem.start, &problem.limits);
    let lean = start.attitude_wb.map_or(0.0, |q| 2.0 * libm::asin(q.imag().xy().norm().min(1.0)));
    for (limit, excess) in [
        ("tilt", lean - limits.tilt_max_rad),
        ("body rate", start.rate_b.norm() - limits.rate_max_rad_s),
    ] {
        if excess > 0.0 {
            return Err(SixDofError::Start { limit, excess });
        }
    }
    let turn_s = if start.attitude_wb.is_some() { settings.turn_s } else { 0.0 };
    let translation = Problem { propulsion: settings.propulsion, ..problem.translation(turn_s) };
    let plan = scvx::solve(&translation, &scvx::Settings::default());
    Ok(Translation { plan: plan.map_err(SixDofError::Translation)?, turn_s })
}

fn begin(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
    translation: &Translation,
) -> (Grid, Scale, Iterate) {
    let (grid, guess) = guess::from_translation(problem, settings, translation);
    let scale = Scale::new(problem, translation.plan.propellant_kg(), translation.duration_s());
    (grid, scale, guess)
}

/// Why a loop ended without convergence.
fn converged(outcome: &Outcome, work: &Work, miss_m: f64) -> Result<(), SixDofError> {
    let left = outcome.virtual_control;
    if outcome.converged {
        Ok(())
    } else if left.is_finite() && left > VIRTUAL_CONTROL_MAX {
        Err(SixDofError::VirtualControl { left, limit: VIRTUAL_CONTROL_MAX, miss_m })
    } else {
        Err(SixDofError::IterationBudget { solves: work.solves })
    }
}
