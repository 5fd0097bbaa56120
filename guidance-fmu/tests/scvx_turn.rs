//! How fast plans turn their thrust (G.97), measured from the plans themselves.

use guidance_fmu::scvx::{Plan, Problem, Settings, Turn, solve};
use nalgebra::Vector3;

mod scvx_scenarios;
use scvx_scenarios::{descent, flown_descent};

/// What convergence leaves of a turn beyond its limit, rad: fuel has converged to 2e-5 (G.18), and where that is flat
/// directions have to the root of it, 4.5e-3.
const EXCESS_MAX_RAD: f64 = 4.5e-3;

fn limited(problem: Problem, rate_max_rad_s: f64, axis_w: Option<Vector3<f64>>) -> Problem {
    Problem { turn: Some(Turn { rate_max_rad_s, axis_w }), ..problem }
}

fn found(problem: &Problem) -> Plan {
    solve(problem, &Settings::default()).expect("feasible")
}

/// Horizontal parts of the directions of the burn intervals, each with the middle of its interval, s.
fn directions(plan: &Plan) -> Vec<(f64, [f64; 2])> {
    let burns = plan.u_w.iter().zip(plan.nodes.windows(2)).filter(|(u_w, _)| u_w.norm() > 0.0);
    burns
        .map(|(u_w, ends)| {
            let unit_w = u_w.normalize();
            (0.5 * (ends[0].t_s + ends[1].t_s), [unit_w.x, unit_w.y])
        })
        .collect()
}

/// Largest turn beyond a rate, rad; across coasts too.
fn excess_rad(plan: &Plan, rate_max_rad_s: f64) -> f64 {
    let turns = directions(plan);
    let excess = turns.windows(2).map(|pair| {
        let [(before_s, before), (after_s, after)] = [pair[0], pair[1]];
        let turned = (after[0] - before[0]).hypot(after[1] - before[1]);
        turned - rate_max_rad_s * (after_s - before_s)
    });
    excess.fold(0.0, f64::max)
}

#[test]
fn a_turn_limit_binds_and_holds() {
    let rate_max_rad_s = 0.05;
    for flight in [descent(), flown_descent()] {
        let free = found(&flight);
        let free_rad = excess_rad(&free, rate_max_rad_s);
        assert!(free_rad > 0.05, "no limit needed: {free_rad} rad");
        let plan = found(&limited(flight, rate_max_rad_s, None));
        let excess_rad = excess_rad(&plan, rate_max_rad_s);
        assert!(excess_rad < EXCESS_MAX_RAD, "{excess_rad} rad");
        assert!((plan.report.turn_excess_rad - excess_rad).abs() < 1e-9, "rounding only");
        assert!(plan.propellant_kg() > free.propellant_kg());
    }
}

#[test]
fn a_limit_that_does_not_bind_changes_nothing() {
    let free = found(&descent());
    let plan = found(&limited(descent(), 1.0, None));
    // The fuel that plans converge to (G.18).
    assert!((plan.propellant_kg() / free.propellant_kg() - 1.0).abs() < 2e-5);
    assert_eq!(plan.report.turn_excess_rad, 0.0);
}

#[test]
fn a_plan_begins_near_where_the_vehicle_points() {
    let rate_max_rad_s = 0.25;
    // Leaning by 27° the way that the first burn does not push.
    let axis_w = Vector3::new(0.45, 0.0, 0.893).normalize();
    let beyond_rad = |plan: &Plan| {
        let (middle_s, first) = directions(plan)[0];
        (first[0] - axis_w.x).hypot(first[1] - axis_w.y) - rate_max_rad_s * middle_s
    };
    let free_rad = beyond_rad(&found(&limited(flown_descent(), rate_max_rad_s, None)));
    let plan = found(&limited(flown_descent(), rate_max_rad_s, Some(axis_w)));
    let plan_rad = beyond_rad(&plan);
    // The first burn is short and worth its turn in part: the limit has a price.
    assert!(plan_rad < 0.25 * free_rad, "{plan_rad} of {free_rad} rad");
}

#[test]
fn no_plan_fails_for_its_turns() {
    let plan = found(&limited(descent(), 1e-3, None));
    assert!(plan.report.turn_excess_rad > 0.1, "{} rad", plan.report.turn_excess_rad);
    assert!(plan.report.miss_m < 1e-3, "{} m", plan.report.miss_m);
}
