//! What the planner in six degrees of freedom refuses, and the reason it gives.

mod six_dof_scenarios;

use guidance_fmu::scvx::{PlanError, Propulsion};
use guidance_fmu::six_dof::{SixDofError, SixDofProblem, SixDofSettings, solve};
use nalgebra::{UnitQuaternion, Vector3};
use six_dof_scenarios::descent;

fn refusal(problem: &SixDofProblem, settings: &SixDofSettings) -> SixDofError {
    solve(problem, settings).map(|_| ()).expect_err("no plan exists")
}

#[test]
fn a_body_that_cannot_turn() {
    // Without thrusters and with 0.01° of gimbal, 5200 N give 0.6 N m: 0.3 mrad/s². Braking 16 m/s
    // of drift takes a tilt that it can't reach.
    let mut problem = descent();
    problem.actuators.torque_max_b = Vector3::zeros();
    problem.actuators.gimbal_max_rad = 0.01_f64.to_radians();
    let error = refusal(&problem, &SixDofSettings::default());
    assert!(matches!(error, SixDofError::VirtualControl { .. }), "{error}");
}

#[test]
fn a_translation_without_a_plan() {
    let settings = SixDofSettings { propulsion: Propulsion::AlwaysOn, ..SixDofSettings::default() };
    let error = refusal(&descent(), &settings);
    assert!(matches!(error, SixDofError::Translation(PlanError::Tilt { .. })), "{error}");
}

#[test]
fn a_start_outside_its_limits() {
    let mut tilted = descent();
    tilted.start.attitude_wb = Some(UnitQuaternion::new(Vector3::new(0.6, 0.0, 0.0)));
    match refusal(&tilted, &SixDofSettings::default()) {
        SixDofError::Start { limit: "tilt", excess } => {
            assert!((excess - (0.6 - 29_f64.to_radians())).abs() < 1e-12, "{excess}");
        }
        other => panic!("{other}"),
    }
    let mut spinning = descent();
    spinning.start.rate_b = Vector3::new(0.0, 0.0, 0.9);
    let error = refusal(&spinning, &SixDofSettings::default());
    assert!(matches!(error, SixDofError::Start { limit: "body rate", .. }), "{error}");
}

#[test]
fn too_little_propellant() {
    // Nearly dry, the translation alone takes 4.65 kg and the body 4.86 kg.
    let mut problem = descent();
    problem.start.propellant_kg = 4.5;
    let error = refusal(&problem, &SixDofSettings::default());
    assert!(matches!(error, SixDofError::Translation(PlanError::FuelBound { .. })), "{error}");
    problem.start.propellant_kg = 4.75;
    match refusal(&problem, &SixDofSettings::default()) {
        SixDofError::Fuel { needed_kg, available_kg } => {
            assert!(needed_kg > 4.75 && available_kg == 4.75, "{needed_kg} {available_kg}");
        }
        other => panic!("{other}"),
    }
}

#[test]
fn spent_budget() {
    let settings = SixDofSettings { solves_max: 3, ..SixDofSettings::default() };
    assert_eq!(refusal(&descent(), &settings), SixDofError::IterationBudget { solves: 3 });
}

#[test]
fn inputs_are_named() {
    let nan = f64::NAN;
    type Set = fn(&mut SixDofProblem, f64);
    let cases: [(&str, Set); 6] = [
        ("propellant_kg", |p, x| p.start.propellant_kg = x),
        ("rate_b", |p, x| p.start.rate_b.y = x),
        ("torque_max_b", |p, x| p.actuators.torque_max_b.z = x),
        ("thrust_min_n", |p, x| p.actuators.thrust_min_n = x),
        ("gimbal_max_rad", |p, x| p.actuators.gimbal_max_rad = x),
        ("end_tilt_max_rad", |p, x| p.limits.end_tilt_max_rad = x),
    ];
    for (name, set) in cases {
        let mut problem = descent();
        set(&mut problem, nan);
        match refusal(&problem, &SixDofSettings::default()) {
            SixDofError::Input { field, .. } => assert_eq!(field, name),
            other => panic!("{name}: {other}"),
        }
    }
    // The translation's planner names what is its own.
    let mut problem = descent();
    problem.start.v_w.x = nan;
    let error = refusal(&problem, &SixDofSettings::default());
    assert!(matches!(error, SixDofError::Translation(PlanError::Input { .. })), "{error}");
}
