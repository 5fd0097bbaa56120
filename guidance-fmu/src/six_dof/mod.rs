mod dynamics;
mod error;
mod guess;
mod outer_loop;
mod problem;
mod shooting;
mod subproblem;
mod trajectory;
pub use error::SixDofError;
pub use problem::{Actuators, Limits, SixDofProblem, SixDofSettings, Start};

pub fn solve(problem: &SixDofProblem, settings: &SixDofSettings) -> Result<bool, SixDofError> {
    problem.validate()?;
    let s3 = crate::scvx::Settings { structure: settings.structure, ..Default::default() };
    let plan = crate::scvx::plan(&problem.translation(), &s3).map_err(SixDofError::Translation)?;
    eprintln!("3dof {} {:?} {:?}", plan.propellant_kg(), plan.structure, plan.phases);
    let (grid, guess) = guess::from_translation(problem, settings, &plan);
    let scale = trajectory::Scale::new(problem, plan.propellant_kg(), plan.duration_s());
    let t = std::time::Instant::now();
    let o = outer_loop::iterate(problem, settings, &grid, &scale, guess)?;
    eprintln!("{:?} solves {} ipm {} refused {}", t.elapsed(), o.solves, o.solver_iterations, o.refused);
    for (k, x) in o.trajectory.iterate.states.iter().enumerate() {
        eprintln!("{k} {:.2?}", x.as_slice());
    }
    for (k, x) in o.trajectory.iterate.controls.iter().enumerate() {
        eprintln!("{k} {:.1?}", x.as_slice());
    }
    Ok(o.converged)
}
