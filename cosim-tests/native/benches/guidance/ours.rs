//! The planner and its conic solver, timed in CPU time of the one thread.

use std::error::Error;
use std::time::Duration;

use guidance_fmu::scvx::{self, ConicSolver, Program};
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};

use crate::cases::Case;
use crate::table::{Plan, Solve};

const PLANS: usize = 51;
// Seconds, so that a neighbour on the core is outlasted.
const SOLVES: usize = 4001;

fn cpu_time() -> Result<Duration, nix::Error> {
    let now = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?;
    Ok(Duration::from_nanos(now.num_nanoseconds().unsigned_abs()))
}

/// Least and median time of `runs` calls, s, and the last result.
pub fn timed<T>(runs: usize, mut call: impl FnMut() -> T) -> Result<([f64; 2], T), nix::Error> {
    let mut once = || -> Result<(f64, T), nix::Error> {
        let start = cpu_time()?;
        let result = call();
        Ok(((cpu_time()? - start).as_secs_f64(), result))
    };
    let (first_s, mut result) = once()?;
    let mut times_s = vec![first_s];
    for _ in 1..runs {
        let (time_s, last) = once()?;
        times_s.push(time_s);
        result = last;
    }
    times_s.sort_by(f64::total_cmp);
    Ok(([times_s[0], times_s[runs / 2]], result))
}

/// A cold plan.
pub fn plan(case: &Case) -> Result<Plan, Box<dyn Error>> {
    let settings = case.mode.settings();
    let (times_s, plan) = timed(PLANS, || scvx::solve(&case.problem, &settings))?;
    let plan = plan?;
    Ok(Plan {
        planner: "ours".to_owned(),
        case: case.name(),
        construction_ms: None,
        cpu_ms: Some(times_s.map(|time_s| 1e3 * time_s)),
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
    let plan = scvx::solve(&case.problem, &settings)?;
    let program = scvx::subproblem(&case.problem, &settings, &plan, 0.0);
    program.ok_or_else(|| "nothing is left of the plan".into())
}

/// One solve with the data updated in place, as the planner does it.
pub fn solve(case: &Case, program: &Program) -> Result<Solve, Box<dyn Error>> {
    let mut solver = ConicSolver::new(program, case.mode.settings().solver_iterations_max)?;
    let (times_s, solution) = timed(SOLVES, || solver.solve(program))?;
    let solution = solution?;
    Ok(Solve {
        solver: "ours".to_owned(),
        case: case.name(),
        us: times_s.map(|time_s| 1e6 * time_s),
        iterations: solution.iterations,
        objective: solution.objective,
        ours_times: None,
    })
}
