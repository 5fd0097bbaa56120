//! The closed-form bounds refuse nothing that can be flown, and most of what can't.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{
    PathLimits, Plan, PlanError, Problem, Propulsion, Settings, Terminal, disprove, solve,
};
use nalgebra::Vector3;
use scvx_scenarios::descent;
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

/// Reference descent's numbers, straight down, for an engine that never stops.
fn straight_down(height_m: f64, speed_m_s: f64, tilt_deg: f64) -> Problem {
    let (r0_w, v0_w) = (Vector3::new(0.0, 0.0, height_m), Vector3::new(0.0, 0.0, -speed_m_s));
    let (propulsion, tilt_max_rad) = (Propulsion::AlwaysOn, tilt_deg.to_radians());
    Problem { r0_w, v0_w, propulsion, tilt_max_rad, ..descent() }
}

#[test]
fn no_plan_of_an_engine_that_never_stops_ends_lower_than_its_floor_allows() {
    let blind = Settings { bounds: false, ..Settings::default() };
    let mut plans = 0;
    for (height_m, tilt_deg) in [(50.0, 29.0), (100.0, 45.0), (200.0, 55.0), (500.0, 60.0)] {
        for tenths in 1..12 {
            // From a tenth of the speed that an upright vehicle needs to somewhat more than that.
            let upright_m_s = (2.0 * height_m * (800.0 / 259.5 - 1.625_f64)).sqrt();
            let problem = straight_down(height_m, 0.1 * f64::from(tenths) * upright_m_s, tilt_deg);
            if solve(&problem, &blind).is_ok() {
                plans += 1;
                assert_eq!(disprove(&problem), Ok(()), "{height_m} m, {tenths}, {tilt_deg} deg");
            }
        }
    }
    assert!(plans >= 8, "{plans}");
}

/// At the edge of (G.102) the floor at its widest tilt is the only flight: by Runge-Kutta it ends at rest, a centimetre above
/// the target, which is what the planner takes for met.
#[test]
fn at_the_least_speed_the_floor_itself_lands() {
    for (height_m, tilt_deg) in [(100.0, 29.0), (500.0, 45.0), (1000.0, 60.0)] {
        let (mut slow, mut fast) = (0.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (slow + fast);
            match disprove(&straight_down(height_m, middle, tilt_deg)) {
                Ok(()) => fast = middle,
                Err(PlanError::Tilt { .. }) => slow = middle,
                Err(other) => panic!("{other}"),
            }
        }
        let lift_n = 800.0 * tilt_deg.to_radians().cos();
        let flow_kg_s = 800.0 / (225.0 * 9.80665);
        let rate = |t: f64, [_, v]: [f64; 2]| [v, lift_n / (259.5 - flow_kg_s * t) - 1.625];
        let (step_s, mut t_s, mut state) = (1e-3, 0.0, [height_m, -fast]);
        while state[1] < 0.0 {
            let at = |k: [f64; 2], h: f64| [state[0] + h * k[0], state[1] + h * k[1]];
            let k1 = rate(t_s, state);
            let k2 = rate(t_s + 0.5 * step_s, at(k1, 0.5 * step_s));
            let k3 = rate(t_s + 0.5 * step_s, at(k2, 0.5 * step_s));
            let k4 = rate(t_s + step_s, at(k3, step_s));
            let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            state = [state[0] + step_s * mean(0), state[1] + step_s * mean(1)];
            t_s += step_s;
        }
        // A step's way at the least speed.
        assert!((state[0] - 0.01).abs() < 1e-5, "{height_m} m: {} m", state[0]);
    }
}
