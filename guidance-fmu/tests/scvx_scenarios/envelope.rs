//! The stated envelope of cold starts, and an oracle of what is feasible in it.

use guidance_fmu::scvx::{PathLimits, Plan, PlanError, Problem, Propulsion, Settings, solve};
use lander_models::random::uniforms;
use nalgebra::Vector3;

use super::descent;

/// Intervals of the oracle's one grid.
const ORACLE_INTERVALS: usize = 60;

/// State `index` of the envelope, an independent draw: within 500 m of the target on either axis, 10 to 1000 m above
/// it, at up to 30 m/s on either axis, 80 m/s down to 10 m/s up, 176 to 259.5 kg of which 174 kg
/// are dry. To rest at the target without sinking below it.
pub fn state(index: u64) -> Problem {
    let mut draws = uniforms(index, "envelope");
    let mut between = |low: f64, high: f64| low + (high - low) * draws.next().unwrap();
    Problem {
        r0_w: Vector3::new(between(-500.0, 500.0), between(-500.0, 500.0), between(10.0, 1000.0)),
        v0_w: Vector3::new(between(-30.0, 30.0), between(-30.0, 30.0), between(-80.0, 10.0)),
        mass_kg: between(176.0, 259.5),
        path: PathLimits { glide_slope_rad: None, altitude_min_m: Some(0.0) },
        ..descent()
    }
}

/// The same flight on one fine grid without a thrust floor: no order of burns and coasts to choose,
/// none to get wrong. Whatever the planner can do on and off, this can too, as far as its intervals
/// resolve it.
pub fn oracle(problem: &Problem) -> Result<Plan, PlanError> {
    let relaxed =
        Problem { thrust_min_n: 0.0, propulsion: Propulsion::AlwaysOn, ..problem.clone() };
    let settings = Settings {
        relaxed_intervals: ORACLE_INTERVALS,
        single_burn_intervals: ORACLE_INTERVALS,
        outer_max: 40,
        solves_max: 80,
        bounds: false,
        ..Settings::default()
    };
    solve(&relaxed, &settings)
}

/// `plan`, the reason of infeasibility, or `no answer`.
pub fn verdict(answer: &Result<Plan, PlanError>) -> &'static str {
    match answer {
        Ok(_) => "plan",
        Err(error) if !error.is_infeasible() => "no answer",
        Err(PlanError::Fuel { .. } | PlanError::FuelBound { .. }) => "fuel",
        Err(PlanError::Altitude { .. } | PlanError::AltitudeBound { .. }) => "altitude",
        Err(PlanError::Tilt { .. }) => "tilt",
        Err(PlanError::Structure { .. }) => "structure",
        Err(_) => "target",
    }
}
