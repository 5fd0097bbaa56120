//! Propulsion modes, tilt and thrust rate: what each allows, against closed forms.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{
    EngineState, Plan, PlanError, Problem, Propulsion, Settings, Structure, disprove, replan, solve,
};
use nalgebra::Vector3;
use scvx_scenarios::{descent, hop};

fn found(problem: &Problem) -> Plan {
    solve(problem, &Settings::default()).expect("feasible")
}

fn refusal(problem: &Problem) -> PlanError {
    solve(problem, &Settings::default()).expect_err("no plan exists")
}

fn always_on(flight: Problem, tilt_deg: f64, mass_kg: f64) -> Problem {
    let (propulsion, tilt_max_rad) = (Propulsion::AlwaysOn, tilt_deg.to_radians());
    Problem { propulsion, tilt_max_rad, mass_kg, ..flight }
}

/// A wider limit cannot cost fuel. The flight time is the optimum's own choice and falls too; it is
/// flat where the limit no longer binds, known to the last step's own change.
#[test]
fn fuel_and_flight_time_never_increase_with_tilt() {
    let mut rises = Vec::new();
    for flight in [descent(), hop()] {
        let at = |tilt_deg: i32| {
            found(&Problem { tilt_max_rad: f64::from(tilt_deg).to_radians(), ..flight.clone() })
        };
        let sweep: Vec<Plan> = (10..=60).step_by(2).map(at).collect();
        for pair in sweep.windows(2) {
            rises.push(1e6 * (pair[1].propellant_kg() / pair[0].propellant_kg() - 1.0));
            let change_s = |plan: &Plan| plan.report.last_step.duration_change_s;
            let longer_s = pair[1].duration_s() - pair[0].duration_s();
            assert!(longer_s <= change_s(&pair[0]) + change_s(&pair[1]), "{longer_s} s longer");
        }
    }
    Claim {
        id: "tilt-sweep-propellant",
        section: "Guidance",
        claim: "rise of the propellant with the tilt limit, 10° to 60° by 2°, descent and hop, on/off",
        reference: "a wider limit cannot cost more",
        unit: "1e-6",
        bound: Bound::AtMost(20.0),
        origin: "the planner's stopping rule on fuel",
        noise: 0.0,
    }
    .holds(rises.into_iter().fold(0.0, f64::max));
}

/// Near the least tilt no guess leads to a plan at once (G.100), and a wider limit cannot cost more.
#[test]
fn an_engine_that_never_stops_has_plans_at_every_tilt_from_49_deg_on() {
    let at = |half_deg: i32| found(&always_on(descent(), 0.5 * f64::from(half_deg), 259.5));
    let sweep: Vec<Plan> = (98..=120).map(at).collect();
    for pair in sweep.windows(2) {
        // The planner's stopping rule on fuel.
        assert!(pair[1].propellant_kg() <= pair[0].propellant_kg() * (1.0 + 2e-5));
    }
}

/// With the engine on, a vehicle at rest can only sink where m g > ρ_min cos θ (G.20), beyond θ_crit = arccos(m g/ρ_min), and
/// down to its target only if it gets there before it has burnt itself so light that the floor lifts it (G.102).
#[test]
fn the_critical_tilt_of_an_engine_that_is_always_on() {
    let mut gaps_deg = Vec::new();
    for mass_kg in [259.5, 246.15, 240.0, 220.0, 200.0, 180.0] {
        let critical_deg = (mass_kg * 1.625 / 800.0_f64).acos().to_degrees();
        let disproven = |tilt_deg: f64| {
            matches!(disprove(&always_on(hop(), tilt_deg, mass_kg)), Err(PlanError::Tilt { .. }))
        };
        assert!(disproven(critical_deg - 1e-9), "{mass_kg} kg");
        let least_deg = last(disproven, critical_deg, critical_deg + 2.0);
        // The mass falls by 6 kg on the way, which raises the critical tilt by 1.2° at most.
        assert!((0.3..1.2).contains(&(least_deg - critical_deg)), "{least_deg} for {critical_deg}");
        let below = refusal(&always_on(hop(), least_deg, mass_kg));
        assert!(matches!(below, PlanError::Tilt { .. }), "{mass_kg} kg below: {below}");
        let refused = |tilt_deg: f64| {
            solve(&always_on(hop(), tilt_deg, mass_kg), &Settings::default()).is_err()
        };
        gaps_deg.push(last(refused, least_deg, least_deg + 2.0) - least_deg);
    }
    Claim {
        id: "critical-tilt",
        section: "Guidance",
        claim: "tilt limit from which a hop of 200 m is planned for an engine that never stops, over that up to which none exists",
        reference: "least height that the floor lets it reach (G.102), six masses",
        unit: "deg",
        bound: Bound::AtMost(1.0),
        origin: "the hop's way across, which the bound leaves out",
        noise: 0.01,
    }
    .holds_for(gaps_deg);
}

/// The last value for which `holds` does, between one that does and one that does not.
fn last(holds: impl Fn(f64) -> bool, from: f64, to: f64) -> f64 {
    let (mut inside, mut outside) = (from, to);
    assert!(holds(inside) && !holds(outside), "nothing ends between {from} and {to}");
    while outside - inside > 1e-3 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// A floor that lifts an upright vehicle lets one sink that swings from side to side (G.101).
#[test]
fn an_engine_that_never_stops_swings_straight_down() {
    let mut found = 0;
    for (tilt_deg, speed_m_s) in
        [(29.0, 15.5), (29.0, 16.0), (45.0, 11.5), (45.0, 12.5), (55.0, 9.0)]
    {
        let (r0_w, v0_w) = (Vector3::new(0.0, 0.0, 100.0), Vector3::new(0.0, 0.0, -speed_m_s));
        let straight = Problem { r0_w, v0_w, ..descent() };
        let upright = disprove(&always_on(straight.clone(), 1.0, 259.5));
        assert!(matches!(upright, Err(PlanError::Tilt { .. })), "{upright:?}");
        let plan = solve(&always_on(straight, tilt_deg, 259.5), &Settings::default());
        found += u32::from(plan.is_ok());
    }
    // Three of the five; upright guesses alone lead to none.
    assert!(found >= 3, "{found}");
}

#[test]
fn always_on_at_the_paper_s_tilt_limits() {
    for flight in [descent(), hop()] {
        let error = refusal(&always_on(flight, 29.0, 259.5));
        assert!(matches!(error, PlanError::Tilt { .. }), "{error}");
    }
    // ρ_min cos 60° / g = 246.15 kg: a lighter vehicle at rest is lifted at 60°.
    assert_eq!(found(&always_on(hop(), 60.0, 259.5)).structure, Structure::On);
    for mass_kg in [246.0, 230.0, 200.0] {
        let error = refusal(&always_on(hop(), 60.0, mass_kg));
        assert!(matches!(error, PlanError::Tilt { .. }), "{mass_kg} kg: {error}");
    }
}

fn on_off(on_min_s: f64, off_min_s: f64, restarts_max: u32) -> Propulsion {
    Propulsion::OnOff { on_min_s, off_min_s, restarts_max }
}

#[test]
fn a_restart_limit_takes_the_first_burn_away() {
    let once = Problem { propulsion: on_off(0.2, 0.2, 0), ..descent() };
    // Held accelerations cost this burn 0.5 % on eight intervals.
    let settings = Settings { last_burn_intervals: 60, ..Settings::default() };
    let plan = solve(&once, &settings).expect("feasible");
    assert_eq!(plan.structure, Structure::OffOn);
    // 7.25 kg is a reference for coast and burn, given to three figures.
    assert!((plan.propellant_kg() - 7.25).abs() < 0.005, "{} kg", plan.propellant_kg());
    assert_eq!(plan.engine_at(plan.duration_s()).ignitions, 1);
    assert_eq!(found(&descent()).engine_at(60.0).ignitions, 2);
}

#[test]
fn orders_that_no_limit_allows_are_named() {
    // Lit once already and off: nothing can be lit again.
    let engine = EngineState { running: false, for_s: 10.0, ignitions: 1 };
    let spent = Problem { engine, propulsion: on_off(0.2, 0.2, 0), ..descent() };
    match refusal(&spent) {
        PlanError::Structure { limit: "restarts_max", instead: None, .. } => {}
        other => panic!("{other}"),
    }
    // Running, with no restart left: burning without a coast cannot descend, and says so.
    let engine = EngineState { running: true, for_s: 10.0, ignitions: 1 };
    let running = Problem { engine, propulsion: on_off(0.2, 0.2, 0), ..hop() };
    let error = refusal(&running);
    assert!(error.is_infeasible(), "{error}");
    match error {
        PlanError::Structure { wanted: Structure::OnOffOn, limit: "restarts_max", instead } => {
            assert!(instead.is_some());
        }
        other => panic!("{other}"),
    }
}

/// Durations at a limit are met to the solver's tolerance, 1e-8 in units of about 20 s.
const DURATION_TOLERANCE_S: f64 = 1e-6;

#[test]
fn least_times_hold_and_count_what_has_passed() {
    let first_s = |engine, propulsion| {
        let plan = found(&Problem { engine, propulsion, ..descent() });
        (plan.structure, plan.phases[0].duration_s)
    };
    // The free optimum burns for 0.39 s first.
    let unlit = EngineState::default();
    let (_, free_s) = first_s(unlit, on_off(0.2, 0.2, 1));
    assert!((0.3..0.5).contains(&free_s), "{free_s} s");
    let (structure, held_s) = first_s(unlit, on_off(1.0, 0.2, 1));
    let whole_s = if structure == Structure::OnOffOn { 1.0 } else { 0.0 };
    assert!(held_s >= whole_s - DURATION_TOLERANCE_S, "{structure:?} {held_s} s");
    // A burn 0.3 s old must last for 0.7 s more.
    let running = EngineState { running: true, for_s: 0.3, ignitions: 1 };
    let (structure, rest_s) = first_s(running, on_off(1.0, 0.2, 1));
    assert_eq!(structure, Structure::OnOffOn);
    assert!((rest_s - 0.7).abs() < 1e-3, "{rest_s} s: the limit binds");
    // A coast 1 s old of at least 5 s cannot end for another 4 s.
    let off = EngineState { running: false, for_s: 1.0, ignitions: 1 };
    let (structure, rest_s) = first_s(off, on_off(0.2, 5.0, 2));
    assert_eq!(structure, Structure::OffOn);
    assert!(rest_s >= 4.0 - DURATION_TOLERANCE_S, "{rest_s} s");
}

#[test]
fn a_replan_in_a_burn_finishes_it() {
    let problem = Problem { propulsion: on_off(1.0, 0.2, 1), ..descent() };
    let running = EngineState { running: true, for_s: 0.0, ignitions: 1 };
    let last = found(&Problem { engine: running, ..problem.clone() });
    let first_s = last.phases[0].duration_s;
    let elapsed_s = 0.5 * first_s;
    let now = last.sample(elapsed_s);
    let moved = Problem { r0_w: now.r_w, v0_w: now.v_w, mass_kg: now.mass_kg, ..problem };
    let plan = replan(&moved, &Settings::default(), &last, elapsed_s).expect("feasible");
    assert!(plan.report.warm);
    assert_eq!(plan.engine, last.engine_at(elapsed_s));
    assert!((plan.engine.for_s - elapsed_s).abs() < 1e-12, "rounding only");
    assert!(plan.phases[0].duration_s + elapsed_s >= 1.0 - DURATION_TOLERANCE_S);
}

#[test]
fn a_thrust_rate_limit_binds_and_holds() {
    // The free optima turn their thrust by up to 288 and 388 N/s.
    for flight in [descent(), hop()] {
        let free = found(&flight);
        let limited = found(&Problem { thrust_rate_max_n_s: Some(50.0), ..flight });
        assert!(free.report.thrust_rate_n_s > 200.0, "{} N/s", free.report.thrust_rate_n_s);
        // Measured again, from the thrust on either side of each node of a burn.
        let mut largest_n_s = 0.0_f64;
        for phase in limited.phases.iter().filter(|phase| phase.powered) {
            let step_s = phase.duration_s / phase.intervals as f64;
            for k in 1..phase.intervals {
                let node_s = phase.start_s + k as f64 * step_s;
                let [before, after] = [-1e-9, 1e-9].map(|s| limited.sample(node_s + s).thrust_w);
                largest_n_s = largest_n_s.max((after - before).norm() / step_s);
            }
        }
        // 0.1 % is the planner's acceptance limit.
        assert!(largest_n_s < 50.0 * 1.001, "{largest_n_s} N/s");
        assert!(limited.propellant_kg() > free.propellant_kg());
    }
}
