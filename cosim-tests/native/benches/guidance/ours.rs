//! The planner and its conic solver, timed in CPU time of the one thread: the median of many runs.

use std::error::Error;
use std::time::Duration;

use guidance_fmu::scvx::{self, ConicSolver, Program};
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};

use crate::cases::Case;
use crate::table::{Plan, Solve};

const PLANS: usize = 51;
const SOLVES: usize = 501;

fn cpu_time() -> Result<Duration, nix::Error> {
    let now = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?;
    Ok(Duration::from_nanos(now.num_nanoseconds().unsigned_abs()))
}

/// Median time of `runs` calls, s, and the last result.
fn median_s<T>(runs: usize, mut call: impl FnMut() -> T) -> Result<(f64, T), nix::Error> {
    let mut timed = || -> Result<(Duration, T), nix::Error> {
        let start = cpu_time()?;
        let result = call();
        Ok((cpu_time()? - start, result))
    };
    let (first, mut result) = timed()?;
    let mut times = vec![first];
    for _ in 1..runs {
        let (time, last) = timed()?;
        times.push(time);
        result = last;
    }
    times.sort();
    Ok((times[times.len() / 2].as_secs_f64(), result))
}

/// A cold plan.
pub fn plan(case: &Case) -> Result<Plan, Box<dyn Error>> {
    let settings = case.mode.settings();
    let (median_s, plan) = median_s(PLANS, || scvx::plan(&case.problem, &settings))?;
    let plan = plan?;
    Ok(Plan {
        planner: "ours".to_owned(),
        case: case.name(),
        construction_ms: None,
        cpu_ms: Some(1e3 * median_s),
        fuel_kg: plan.propellant_kg(),
        outer_iterations: Some(plan.report.outer_iterations),
        miss_m: Some(plan.report.miss_m),
        miss_m_s: Some(plan.report.miss_m_s),
        lossless_gap: Some(plan.report.lossless_gap),
        times_ours: None,
    })
}

/// The first conic program of a replan from the converged plan.
pub fn program(case: &Case) -> Result<Program, Box<dyn Error>> {
    let settings = case.mode.settings();
    let plan = scvx::plan(&case.problem, &settings)?;
    let program = scvx::subproblem(&case.problem, &settings, &plan, 0.0);
    program.ok_or_else(|| "nothing is left of the plan".into())
}

/// One solve with the data updated in place, as the planner does it.
pub fn solve(case: &Case, program: &Program) -> Result<Solve, Box<dyn Error>> {
    let mut solver = ConicSolver::new(program, case.mode.settings().solver_iterations_max)?;
    let (median_s, solution) = median_s(SOLVES, || solver.solve(program))?;
    let solution = solution?;
    Ok(Solve {
        solver: "ours".to_owned(),
        case: case.name(),
        us: 1e6 * median_s,
        iterations: solution.iterations,
        objective: solution.objective,
        ours_times: None,
    })
}
