//! The planner's problems of the report: BUG's numbers, the kit's own starts. The paper gives none.

use guidance_fmu::scvx::{
    EngineState, PathLimits, Plan, PlanError, Problem, Propulsion, Settings, Terminal, solve,
};
use lander_models::Vehicle;
use nalgebra::Vector3;

use super::printed::Printed;
use lander_models::ConfigError;

/// What a plan starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// (300, 100, 500) m at (-15, -5, -25) m/s, as models/scenarios/landing.toml.
    Descent,
    /// At rest 200 m away and 5 m up, as models/scenarios/hop.toml after its lift-off.
    Hop,
}

impl Start {
    pub fn name(self) -> &'static str {
        match self {
            Self::Descent => "descent",
            Self::Hop => "hop",
        }
    }
}

/// To rest at the origin within the paper's limits.
pub fn problem(start: Start, bug: &Vehicle, printed: &Printed) -> Result<Problem, ConfigError> {
    let (r0_w, v0_w) = match start {
        Start::Descent => (Vector3::new(300.0, 100.0, 500.0), Vector3::new(-15.0, -5.0, -25.0)),
        Start::Hop => (Vector3::new(200.0, 0.0, 5.0), Vector3::zeros()),
    };
    Ok(Problem {
        r0_w,
        v0_w,
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        terminal: Terminal::Point,
        mass_kg: bug.mass.wet_mass_kg(),
        dry_mass_kg: bug.mass.dry.mass_kg,
        gravity_m_s2: printed.number("gravity", "m/s2")?,
        isp_s: bug.engine.isp_s,
        thrust_min_n: bug.engine.thrust_min_n,
        thrust_max_n: bug.engine.thrust_max_n,
        thrust_rate_max_n_s: None,
        turn: None,
        propulsion: Propulsion::default(),
        engine: EngineState::default(),
        tilt_max_rad: printed.number("guidance_tilt_max", "deg")?.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    })
}

/// The same with an engine that never stops.
pub fn always_on(problem: &Problem, tilt_deg: f64, mass_kg: f64) -> Problem {
    let (propulsion, tilt_max_rad) = (Propulsion::AlwaysOn, tilt_deg.to_radians());
    Problem { propulsion, tilt_max_rad, mass_kg, ..problem.clone() }
}

/// # Errors
/// As `solve`.
pub fn plan(problem: &Problem) -> Result<Plan, PlanError> {
    solve(problem, &Settings::default())
}
