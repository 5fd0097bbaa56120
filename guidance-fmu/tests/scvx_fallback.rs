//! The fall-backs of a target that cannot be had: landing anywhere, and the softest impact.

mod scvx_scenarios;

use claims::{Bound, Claim};
use guidance_fmu::scvx::{
    PathLimits, Plan, PlanError, Problem, Settings, Structure, Terminal, solve,
};
use nalgebra::Vector3;
use scvx_scenarios::descent;

fn found(problem: &Problem) -> Plan {
    solve(problem, &Settings::default()).expect("feasible")
}

/// Speed of a fall to the ground without thrust, m/s.
fn free_fall_m_s(problem: &Problem) -> f64 {
    let drop_m = problem.r0_w.z - problem.r_f_w.z;
    (problem.v0_w.norm_squared() + 2.0 * problem.gravity_m_s2 * drop_m).sqrt()
}

#[test]
fn a_target_out_of_reach_is_landed_beside() {
    // 6.5 kg on board, 6.75 kg to the target.
    let short = Problem { dry_mass_kg: 253.0, ..descent() };
    let error = solve(&short, &Settings::default()).expect_err("too little propellant");
    assert!(matches!(error, PlanError::FuelBound { .. }), "{error}");
    let plan = found(&Problem { terminal: Terminal::Anywhere, ..short.clone() });
    let end = plan.nodes.last().expect("nodes");
    assert!(end.r_w.xy().norm() > 50.0, "beside the target: {}", end.r_w);
    // The planner's acceptance limit.
    assert!(end.r_w.z.abs() < 1e-2 && end.v_w.norm() < 1e-2, "{} {}", end.r_w, end.v_w);
    // Energy: thrust takes off most per Δv at the highest speed, which is that of the ground. No
    // landing needs less; a burn of 2.5 s loses its gravity and its tilt, a few percent.
    let flow_s_m = short.mass_flow_s_m();
    let bound_kg = short.mass_kg * -(-flow_s_m * free_fall_m_s(&short)).exp_m1();
    let excess = plan.propellant_kg() / bound_kg - 1.0;
    assert!((0.0..0.05).contains(&excess), "{excess}");
}

#[test]
fn a_landing_anywhere_costs_no_more_than_one_at_the_target() {
    let anywhere = found(&Problem { terminal: Terminal::Anywhere, ..descent() });
    assert!(anywhere.propellant_kg() < found(&descent()).propellant_kg());
    let softest = found(&Problem { terminal: Terminal::SoftestImpact, ..descent() });
    // With propellant enough the softest impact is that landing: the stopping rule on fuel.
    assert!((softest.propellant_kg() / anywhere.propellant_kg() - 1.0).abs() < 2e-5);
    assert!(softest.report.impact_m_s < 1e-3, "{} m/s", softest.report.impact_m_s);
}

#[test]
fn too_little_propellant_gives_the_softest_impact() {
    let mut excesses = Vec::new();
    for on_board_kg in [1.0, 2.0, 3.5, 5.0] {
        let dry_mass_kg = descent().mass_kg - on_board_kg;
        let terminal = Terminal::SoftestImpact;
        let problem = Problem { terminal, dry_mass_kg, ..descent() };
        let plan = found(&problem);
        // As for the landing anywhere: no impact is softer than free fall less the whole Δv.
        let delta_v_m_s = (problem.mass_kg / dry_mass_kg).ln() / problem.mass_flow_s_m();
        let bound_m_s = free_fall_m_s(&problem) - delta_v_m_s;
        assert!(plan.report.impact_m_s > bound_m_s, "{} m/s", plan.report.impact_m_s);
        assert!(plan.report.propellant_left_kg >= 0.0);
        excesses.push((plan.report.impact_m_s - bound_m_s) / delta_v_m_s);
    }
    Claim {
        id: "softest-impact-energy",
        section: "Guidance",
        claim: "speed left at impact above free fall less the whole Δv, against that Δv; 1 to 5 kg on board",
        reference: "closed form: an impulse at the ground",
        unit: "%",
        bound: Bound::AtMost(10.0),
        origin: "gravity over the burn, 1.625 m/s² for up to 2.2 s of 44 m/s",
        noise: 0.0,
    }
    .holds_for(excesses.into_iter().map(|excess| 100.0 * excess));
}

/// Straight down, the best is to fall and then to burn all at full thrust: the ignition height is the
/// only unknown, and is scanned.
fn brute_force_impact_m_s(problem: &Problem) -> f64 {
    let burn_s =
        (problem.mass_kg - problem.dry_mass_kg) / (problem.thrust_max_n * problem.mass_flow_s_m());
    let impact_m_s = |coast_s: f64| {
        let g_m_s2 = problem.gravity_m_s2;
        let (mut z_m, mut v_m_s, mut mass_kg) = (problem.r0_w.z, problem.v0_w.z, problem.mass_kg);
        z_m += v_m_s * coast_s - 0.5 * g_m_s2 * coast_s * coast_s;
        v_m_s -= g_m_s2 * coast_s;
        if z_m < 0.0 {
            return f64::INFINITY;
        }
        const STEPS: usize = 200;
        let step_s = burn_s / STEPS as f64;
        for _ in 0..STEPS {
            // Thrust over the mass in the middle of the step: second order.
            let flow_kg = problem.thrust_max_n * problem.mass_flow_s_m() * step_s;
            let a_m_s2 = problem.thrust_max_n / (mass_kg - 0.5 * flow_kg) - g_m_s2;
            z_m += v_m_s * step_s + 0.5 * a_m_s2 * step_s * step_s;
            (v_m_s, mass_kg) = (v_m_s + a_m_s2 * step_s, mass_kg - flow_kg);
            if z_m < 0.0 {
                return f64::INFINITY;
            }
        }
        (v_m_s * v_m_s + 2.0 * g_m_s2 * z_m).sqrt()
    };
    (0..20_000).map(|k| impact_m_s(1e-3 * k as f64)).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_softest_vertical_impact_matches_a_brute_force() {
    let mut differences = Vec::new();
    for on_board_kg in [1.0, 2.0, 3.5, 5.0] {
        let problem = Problem {
            terminal: Terminal::SoftestImpact,
            r0_w: Vector3::z() * 500.0,
            v0_w: Vector3::z() * -25.0,
            dry_mass_kg: descent().mass_kg - on_board_kg,
            path: PathLimits { altitude_min_m: Some(0.0), glide_slope_rad: None },
            ..descent()
        };
        let plan = found(&problem);
        assert_eq!(plan.structure, Structure::OffOn);
        differences.push(plan.report.impact_m_s - brute_force_impact_m_s(&problem));
    }
    Claim {
        id: "softest-impact-vertical",
        section: "Guidance",
        claim: "softest vertical impact with 1 to 5 kg on board, from 500 m at 25 m/s",
        reference: "scan of the ignition time at full thrust, by 1 ms",
        unit: "m/s",
        bound: Bound::AtMost(0.03),
        origin: "the scan's millisecond at 20 m/s² and held accelerations, which give up 0.1 % of 44 m/s",
        noise: 0.0,
    }
    .holds_for(differences);
}

#[test]
fn no_propellant_falls_freely() {
    let terminal = Terminal::SoftestImpact;
    let problem = Problem { terminal, dry_mass_kg: descent().mass_kg, ..descent() };
    let plan = found(&problem);
    assert_eq!(plan.structure, Structure::Off);
    let fall_m_s = free_fall_m_s(&problem);
    // The planner's converged height, 0.1 mm, at 50 m/s: 3e-6 m/s.
    assert!((plan.report.impact_m_s - fall_m_s).abs() < 1e-5, "{fall_m_s} m/s");
    assert_eq!(plan.propellant_kg(), 0.0);
}
