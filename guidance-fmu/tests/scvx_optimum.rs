//! Cold plans against independent optima, over dispersed states, and their own claims.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{
    FinalTilt, PathLimits, Plan, Problem, Propulsion, Settings, Structure, solve,
};
use nalgebra::Vector3;
use scvx_scenarios::random::Lcg;
use scvx_scenarios::{descent, flown_descent, hop};

/// Optima by Pontryagin shooting, kg, found without the planner. The tolerance covers held
/// accelerations: a burn at constant u gives up the mass flow of one interval, below 0.1 %.
fn assert_optimum(id: &str, flight: &str, problem: &Problem, optimum_kg: f64) {
    let found = solve(problem, &Settings::default()).expect("feasible");
    let excess = found.propellant_kg() / optimum_kg - 1.0;
    Claim {
        id,
        section: "Guidance",
        claim: &format!("propellant of the {flight}, {optimum_kg} kg"),
        reference: "Pontryagin shooting, found without the planner",
        unit: "%",
        bound: Bound::AtMost(0.1),
        origin: "held accelerations: a burn at constant u gives up the flow of one interval",
        noise: 0.0,
    }
    .holds(100.0 * excess);
    // A discretised plan cannot beat the optimum by more than the optimum's own last digit.
    assert!(excess > -1e-5, "better than optimal by {excess:.1e}");
}

#[test]
fn descent_matches_the_pontryagin_optimum() {
    assert_optimum("propellant-descent", "descent", &descent(), 6.74907);
}

#[test]
fn hop_matches_the_pontryagin_optimum() {
    assert_optimum("propellant-hop", "hop", &hop(), 4.68829);
}

/// docs/validation/pontryagin.csv: random states about the descent and their optima, made by
/// `touchdown_cosim.pontryagin --table 20`.
#[test]
fn random_descents_match_their_pontryagin_optima() {
    let table = include_str!("../../docs/validation/pontryagin.csv");
    let mut rows = table.lines();
    assert!(rows.next().is_some_and(|head| {
        head.starts_with("r0_x_m,r0_y_m,r0_z_m,v0_x_m_s,v0_y_m_s,v0_z_m_s,propellant_kg,")
    }));
    let excess = |row: &str| {
        let row: Vec<f64> = row.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let (r0_w, v0_w) =
            (Vector3::from_column_slice(&row[..3]), Vector3::from_column_slice(&row[3..6]));
        let problem = Problem { r0_w, v0_w, ..descent() };
        solve(&problem, &Settings::default()).expect("feasible").propellant_kg() / row[6] - 1.0
    };
    let excesses: Vec<f64> = rows.map(excess).collect();
    assert_eq!(excesses.len(), 20);
    let (low, high) =
        excesses.iter().fold((0.0_f64, 0.0_f64), |(low, high), &e| (low.min(e), high.max(e)));
    Claim {
        id: "propellant-random-descents",
        section: "Guidance",
        claim: "propellant of 20 random descents, most above the optimum",
        reference: "Pontryagin shooting, docs/validation/pontryagin.csv",
        unit: "%",
        bound: Bound::AtMost(0.1),
        origin: "held accelerations: a burn at constant u gives up the flow of one interval",
        noise: 0.0,
    }
    .holds(100.0 * high);
    // As for the descent itself: no plan beats the optimum by more than its last digit.
    assert!(low > -1e-5, "better than optimal by {low:.1e}");
}

/// Every dispersed state (60 m, 6 m/s per axis) is plannable: the required share is all of them.
fn assert_all_found(id: &str, flight: &str, nominal: &Problem) {
    let mut random = Lcg(1);
    let mut refused = Vec::new();
    for run in 0..200 {
        let mut problem = nominal.clone();
        problem.r0_w += random.normal_w() * 60.0;
        problem.v0_w += random.normal_w() * 6.0;
        match solve(&problem, &Settings::default()) {
            Ok(found) => assert_sound(&problem, &found),
            Err(error) => refused.push(format!("{run}: {error}")),
        }
    }
    assert!(refused.is_empty(), "found {} of 200; {refused:?}", 200 - refused.len());
    Claim {
        id,
        section: "Guidance",
        claim: &format!(
            "dispersed starts of 200 with a sound plan: {flight}, 60 m and 6 m/s an axis"
        ),
        reference: "every one is feasible",
        unit: "",
        bound: Bound::AtLeast(200.0),
        origin: "all of them",
        noise: 0.0,
    }
    .holds(200.0 - refused.len() as f64);
}

/// The miss is measured by the planner's independent re-propagation; a millimetre is ten times its
/// own convergence limit. The thrust is checked inside the intervals, to a thousandth of a percent.
fn assert_sound(problem: &Problem, found: &Plan) {
    assert!(found.report.miss_m < 1e-3, "miss {} m", found.report.miss_m);
    assert!(found.report.miss_m_s < 1e-3, "miss {} m/s", found.report.miss_m_s);
    assert!(found.report.lossless_gap < 1e-4);
    let tolerance_n = 2e-5 * problem.thrust_max_n;
    let allowed_n = problem.thrust_min_n - tolerance_n..=problem.thrust_max_n + tolerance_n;
    for k in 0..400 {
        let t_s = found.duration_s() * (k as f64 + 0.5) / 400.0;
        let sample = found.sample(t_s);
        assert_eq!(sample.powered, sample.thrust_n > 0.0);
        if sample.powered {
            assert!(allowed_n.contains(&sample.thrust_n), "{} N at {t_s} s", sample.thrust_n);
            let tilt_rad = (sample.thrust_w.z / sample.thrust_n).acos();
            // 1e-6 rad is the solver's 1e-8 on the cosine at these angles, with a margin.
            assert!(tilt_rad < problem.tilt_max_rad + 1e-6, "tilt {tilt_rad} rad at {t_s} s");
        }
    }
}

#[test]
fn dispersed_descents_are_all_found() {
    assert_all_found("dispersed-descents", "descent to rest", &descent());
}

#[test]
fn dispersed_flown_descents_are_all_found() {
    assert_all_found("dispersed-flown-descents", "descent to the gate", &flown_descent());
}

#[test]
fn final_tilt_costs_fuel_and_holds() {
    let end = FinalTilt { tilt_max_rad: 5_f64.to_radians(), intervals: 2 };
    let problem = Problem { final_tilt: Some(end), ..flown_descent() };
    let free = solve(&flown_descent(), &Settings::default()).expect("feasible");
    let upright = solve(&problem, &Settings::default()).expect("feasible");
    assert!(upright.propellant_kg() > free.propellant_kg());
    let last = upright.phases.last().expect("phases");
    let from_s = last.end_s() - 2.0 * last.duration_s / last.intervals as f64;
    let thrust_w = upright.sample(0.5 * (from_s + last.end_s())).thrust_w;
    assert!((thrust_w.z / thrust_w.norm()).acos() < end.tilt_max_rad + 1e-6);
}

#[test]
fn glide_slope_binds_and_holds() {
    // Nearly at the edge and falling fast: the free optimum leaves the cone by 0.8 m. 1 cm is the
    // planner's path tolerance.
    let angle_rad = 57_f64.to_radians();
    let path = PathLimits { glide_slope_rad: Some(angle_rad), altitude_min_m: Some(0.0) };
    let r0_w = Vector3::new(200.0, 0.0, 150.0);
    let free = Problem { r0_w, v0_w: Vector3::new(0.0, 0.0, -30.0), ..descent() };
    let outside_m = |found: &Plan| {
        let excess = |r_w: &Vector3<f64>| r_w.xy().norm() - r_w.z * angle_rad.tan();
        found.nodes.iter().map(|node| excess(&node.r_w)).fold(f64::NEG_INFINITY, f64::max)
    };
    let unlimited = solve(&free, &Settings::default()).expect("feasible");
    assert!(outside_m(&unlimited) > 0.5, "{}", outside_m(&unlimited));
    let limited = solve(&Problem { path, ..free }, &Settings::default()).expect("feasible");
    assert!(outside_m(&limited) < 1e-2, "{}", outside_m(&limited));
    assert!(limited.propellant_kg() > unlimited.propellant_kg());
}

#[test]
fn strictly_on_at_sixty_degrees_stays_lossless() {
    // Without the linearised floor this plan thrusts at 411 N where its bound says 800 N. 9.44 kg is
    // a 30-interval reference; 0.5 % covers the coarser grid.
    let tilt_max_rad = 60_f64.to_radians();
    let problem = Problem { tilt_max_rad, propulsion: Propulsion::AlwaysOn, ..descent() };
    let settings = Settings { single_burn_intervals: 25, ..Settings::default() };
    let found = solve(&problem, &settings).expect("feasible");
    assert_sound(&problem, &found);
    assert!((found.propellant_kg() / 9.44 - 1.0).abs() < 5e-3, "{} kg", found.propellant_kg());
}

#[test]
fn samples_follow_the_phases() {
    let found = solve(&descent(), &Settings::default()).expect("feasible");
    assert_eq!(found.structure, Structure::OnOffOn);
    let coast = found.phases[1];
    let t_s = coast.start_s + 1.0;
    let sample = found.sample(t_s);
    assert!(!sample.powered && sample.phase == 1 && sample.thrust_n == 0.0);
    // The three times are sums of the same durations; only rounding separates them.
    let ignition_s = found.time_to_ignition_s(t_s).expect("a burn is left");
    assert!((ignition_s - (coast.duration_s - 1.0)).abs() < 1e-12);
    assert!((found.time_to_go(t_s) + t_s - found.duration_s()).abs() < 1e-12);
    let at_ignition_w = found.sample(coast.end_s() + 1e-6).thrust_w.normalize();
    let next_w = found.next_burn_direction(t_s).expect("a burn is left");
    assert!((next_w - at_ignition_w).norm() < 1e-12);
    assert_eq!(found.time_to_ignition_s(found.duration_s() + 1.0), None);
}

#[test]
fn plans_repeat_bit_for_bit() {
    let once = solve(&flown_descent(), &Settings::default());
    assert_eq!(once, solve(&flown_descent(), &Settings::default()));
}
