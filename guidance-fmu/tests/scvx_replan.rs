//! Chains of warm replans every 0.5 s until 2 s to go, with and without a thrust bias.

mod scvx_scenarios;

use guidance_fmu::scvx::{Plan, Problem, Reserve, Settings, replan, solve};
use scvx_scenarios::{descent, flown_descent};

const PERIOD_S: f64 = 0.5;
const FREEZE_S: f64 = 2.0;

/// What a chain of replans did.
struct Chain {
    replans: u32,
    cold: u32,
    outer_iterations: u32,
    /// Propellant of the whole flight, flown and planned, after each plan, kg.
    totals_kg: Vec<f64>,
}

/// Flies the plan at `1 + bias` times its thrust and replans; every replan must succeed.
fn fly(mut problem: Problem, bias: f64) -> Chain {
    let settings = Settings::default();
    let start_kg = problem.mass_kg;
    let mut current = solve(&problem, &settings).expect("feasible");
    let totals_kg = vec![current.propellant_kg()];
    let mut chain = Chain { replans: 0, cold: 0, outer_iterations: 0, totals_kg };
    while current.time_to_go(PERIOD_S) > FREEZE_S {
        propagate(&mut problem, &current, bias);
        current = replan(&problem, &settings, &current, PERIOD_S)
            .unwrap_or_else(|e| panic!("replan {}: {e}", chain.replans));
        chain.replans += 1;
        chain.cold += u32::from(!current.report.warm);
        chain.outer_iterations += current.report.outer_iterations;
        chain.totals_kg.push(start_kg - problem.mass_kg + current.propellant_kg());
    }
    chain
}

/// One period of flight: closed form on steps short enough that a switch inside one moves the
/// velocity by less than 0.02 m/s; exactly along the plan without a bias.
fn propagate(problem: &mut Problem, current: &Plan, bias: f64) {
    const STEPS: usize = 500;
    if bias == 0.0 {
        let end = current.sample(PERIOD_S);
        (problem.r0_w, problem.v0_w, problem.mass_kg) = (end.r_w, end.v_w, end.mass_kg);
        return;
    }
    let step_s = PERIOD_S / STEPS as f64;
    for k in 0..STEPS {
        let thrust_w = current.sample((k as f64 + 0.5) * step_s).thrust_w * (1.0 + bias);
        let a_w = thrust_w / problem.mass_kg + problem.gravity_w();
        problem.r0_w += problem.v0_w * step_s + a_w * (0.5 * step_s * step_s);
        problem.v0_w += a_w * step_s;
        problem.mass_kg -= thrust_w.norm() * problem.mass_flow_s_m() * step_s;
    }
}

/// On its own plan the fuel of the flight never rises: 0.1 % is the discretisation error of a plan.
fn assert_undisturbed(problem: Problem) {
    let chain = fly(problem, 0.0);
    assert!(chain.replans >= 25 && chain.cold == 0, "{} replans", chain.replans);
    assert!(chain.outer_iterations <= 3 * chain.replans, "{} solves", chain.outer_iterations);
    for pair in chain.totals_kg.windows(2) {
        assert!(pair[1] < 1.001 * pair[0], "{} kg after {} kg", pair[1], pair[0]);
    }
}

#[test]
fn undisturbed_descent() {
    assert_undisturbed(descent());
}

#[test]
fn undisturbed_flown_descent() {
    assert_undisturbed(flown_descent());
}

/// A bias of 3 % in one burn is 3 % of its impulse; 1 % of the fuel covers mending it.
fn assert_biased(problem: Problem, bias: f64) {
    let chain = fly(problem, bias);
    let (first_kg, last_kg) = (chain.totals_kg[0], chain.totals_kg[chain.totals_kg.len() - 1]);
    assert!(last_kg < 1.01 * first_kg, "{last_kg} kg, planned {first_kg} kg");
}

#[test]
fn strong_engine() {
    assert_biased(descent(), 0.03);
    assert_biased(flown_descent(), 0.03);
}

#[test]
fn weak_engine_needs_the_reserve() {
    // Nominal limits leave a saturated burn nothing to mend a weak engine with.
    let reserve = Some(Reserve { thrust_max_n: 3000.0, tilt_max_rad: 33_f64.to_radians() });
    assert_biased(Problem { reserve, ..flown_descent() }, -0.03);
}

#[test]
fn reserve_is_left_alone_when_nominal_limits_suffice() {
    let reserve = Some(Reserve { thrust_max_n: 3000.0, tilt_max_rad: 33_f64.to_radians() });
    let nominal = solve(&flown_descent(), &Settings::default()).expect("feasible");
    let problem = Problem { reserve, ..flown_descent() };
    let reserved = solve(&problem, &Settings::default()).expect("feasible");
    // 1e-3 m/s in 50 m/s is the solver's 1e-8 against bounds frozen at the reference mass.
    assert!(reserved.report.reserve_m_s < 1e-3, "{} m/s", reserved.report.reserve_m_s);
    let change = reserved.propellant_kg() / nominal.propellant_kg() - 1.0;
    // The stopping rule's own fuel change.
    assert!(change.abs() < 2e-5, "fuel changed by {change:.1e}");
}

#[test]
fn a_useless_plan_falls_back_to_a_cold_start() {
    let settings = Settings::default();
    let last = solve(&descent(), &settings).expect("feasible");
    let found = replan(&descent(), &settings, &last, last.duration_s() + 1.0).expect("feasible");
    assert!(!found.report.warm);
    assert_eq!(found.nodes, last.nodes);
}
