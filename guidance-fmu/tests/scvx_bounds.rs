//! The closed-form bounds refuse nothing that can be flown, and most of what can't.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{PathLimits, Plan, PlanError, Problem, Settings, Terminal, solve};
use scvx_scenarios::envelope::state;

/// Plans of the envelope's first states, as its own and as a landing anywhere.
fn plans() -> Vec<(Problem, Plan)> {
    let states = (0..60).map(state);
    let both = states.flat_map(|problem| {
        [Terminal::Point, Terminal::Anywhere]
            .map(|terminal| Problem { terminal, ..problem.clone() })
    });
    let solved = both.map(|problem| (solve(&problem, &Settings::default()), problem));
    solved.filter_map(|(plan, problem)| Some((problem, plan.ok()?))).collect()
}

/// `problem` with `share` of the propellant that `plan` takes on board.
fn with_propellant(problem: &Problem, plan: &Plan, share: f64) -> Problem {
    Problem { dry_mass_kg: problem.mass_kg - share * plan.propellant_kg(), ..problem.clone() }
}

#[test]
fn least_propellant_is_below_every_plan() {
    let mut shares = Vec::new();
    for (problem, plan) in plans() {
        // So little on board that the refusal names the bound, but enough that it is not cut short.
        let dry = with_propellant(&problem, &plan, 0.6);
        match solve(&dry, &Settings::default()) {
            Err(PlanError::FuelBound { least_kg, .. }) => {
                shares.push(least_kg / plan.propellant_kg())
            }
            other => panic!("{other:?}"),
        }
        let enough = with_propellant(&problem, &plan, 1.0 + 1e-9);
        let answer = solve(&enough, &Settings::default());
        assert!(!matches!(answer, Err(PlanError::FuelBound { .. })), "{answer:?}");
    }
    assert!(shares.len() > 60, "{}", shares.len());
    Claim {
        id: "bound-fuel",
        section: "Guidance",
        claim: "propellant by two impulses (G.92) over that of the plan, greatest",
        reference: "plans of 60 random states of the envelope, to the target and anywhere",
        unit: "",
        bound: Bound::AtMost(1.0),
        origin: "a lower bound on every flight",
        noise: 0.0,
    }
    .holds_for(shares);
}

#[test]
fn no_plan_is_below_full_thrust_straight_up() {
    /// Ground under a plan is no tighter than between its nodes.
    const SAMPLE_S: f64 = 0.01;
    for (problem, plan) in plans() {
        let times = (0..).map(|k| f64::from(k) * SAMPLE_S).take_while(|t| *t < plan.duration_s());
        let lowest_m = times.map(|t| plan.sample(t).r_w.z).fold(problem.r_f_w.z, f64::min);
        let path = PathLimits { altitude_min_m: Some(lowest_m), ..PathLimits::default() };
        let answer = solve(&Problem { path, ..problem }, &Settings::default());
        assert!(!matches!(answer, Err(PlanError::AltitudeBound { .. })), "{answer:?}");
    }
}
