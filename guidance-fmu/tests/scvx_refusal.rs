//! What the planner refuses, and the reason it gives.

mod scvx_scenarios;

use guidance_fmu::scvx::{
    EngineState, PathLimits, PlanError, Problem, Propulsion, Settings, Terminal, replan, solve,
};
use nalgebra::Vector3;
use scvx_scenarios::{descent, flown_descent};

fn refusal(problem: &Problem, settings: &Settings) -> PlanError {
    solve(problem, settings).expect_err("no plan exists")
}

#[test]
fn strictly_on_within_the_tilt_limit() {
    // 800 N · cos 29° / 259.5 kg − 1.625 m/s² = 1.071 m/s² upwards, and more as the mass falls: 25 m/s are gone after 22.5 s, 288 m
    // further down at most, which is 212 m above the target.
    let problem = Problem { propulsion: Propulsion::AlwaysOn, ..descent() };
    match refusal(&problem, &Settings::default()) {
        PlanError::Tilt { above_m, t_s, .. } => {
            let (seconds, metres) = (25.0 / 1.0713, 500.0 - 25.0 * 25.0 / (2.0 * 1.0713));
            assert!((0.95 * seconds..seconds).contains(&t_s), "{t_s} s");
            assert!((metres..1.1 * metres).contains(&above_m), "{above_m} m");
        }
        other => panic!("{other}"),
    }
}

#[test]
fn too_little_fuel() {
    let problem = Problem { dry_mass_kg: 255.0, ..descent() };
    match refusal(&problem, &Settings::default()) {
        PlanError::FuelBound { least_kg, available_kg } => {
            // Finite burns cost 3 % here; measured by Pontryagin's optimum.
            assert!((0.96..1.0).contains(&(least_kg / 6.74907)), "{least_kg} kg");
            assert_eq!(available_kg, 4.5);
        }
        other => panic!("{other}"),
    }
    match refusal(&problem, &Settings { bounds: false, ..Settings::default() }) {
        PlanError::Fuel { needed_kg, available_kg } => {
            assert!((needed_kg / 6.74907 - 1.0).abs() < 1e-3, "{needed_kg} kg");
            assert_eq!(available_kg, 4.5);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn too_low_to_stop() {
    let (r0_w, v0_w) = (Vector3::new(0.0, 0.0, 20.0), Vector3::new(0.0, 0.0, -40.0));
    let path = PathLimits { altitude_min_m: Some(0.0), glide_slope_rad: None };
    let problem = Problem { r0_w, v0_w, path, ..descent() };
    match refusal(&problem, &Settings::default()) {
        // v²/2a − 20 m with a at the mass before and after: 259.5 kg and 5 kg less.
        PlanError::AltitudeBound { below_m, .. } => {
            assert!((22.4..23.5).contains(&below_m), "{below_m} m");
        }
        other => panic!("{other}"),
    }
    let error = refusal(&problem, &Settings { bounds: false, ..Settings::default() });
    assert!(matches!(error, PlanError::Altitude { .. }), "{error}");
}

#[test]
fn start_outside_the_glide_slope() {
    let path = PathLimits { glide_slope_rad: Some(0.3), altitude_min_m: None };
    match refusal(&Problem { path, ..descent() }, &Settings::default()) {
        PlanError::GlideSlope { t_s, outside_m } => assert!(t_s == 0.0 && outside_m > 100.0),
        other => panic!("{other}"),
    }
}

#[test]
fn spent_budget() {
    let settings = Settings { solves_max: 2, ..Settings::default() };
    assert_eq!(refusal(&flown_descent(), &settings), PlanError::IterationBudget { solves: 2 });
}

#[test]
fn inputs_are_named() {
    let nan = f64::NAN;
    let glide = PathLimits { glide_slope_rad: Some(1.0), altitude_min_m: None };
    let hasty = Propulsion::OnOff { on_min_s: 0.0, off_min_s: 0.2, restarts_max: 1 };
    let engine = EngineState { for_s: nan, ..EngineState::default() };
    let cases: [(&str, Problem); 12] = [
        ("r0_w", Problem { r0_w: Vector3::new(0.0, nan, 0.0), ..descent() }),
        ("v0_w", Problem { v0_w: Vector3::new(f64::INFINITY, 0.0, 0.0), ..descent() }),
        ("mass_kg", Problem { mass_kg: 100.0, ..descent() }),
        ("gravity_m_s2", Problem { gravity_m_s2: -1.6, ..descent() }),
        ("isp_s", Problem { isp_s: 0.0, ..descent() }),
        ("thrust_max_n", Problem { thrust_max_n: nan, ..descent() }),
        ("thrust_min_n", Problem { thrust_min_n: 6000.0, ..descent() }),
        ("thrust_rate_max_n_s", Problem { thrust_rate_max_n_s: Some(nan), ..descent() }),
        ("propulsion.on_min_s", Problem { propulsion: hasty, ..descent() }),
        ("engine.for_s", Problem { engine, ..descent() }),
        (
            "path.glide_slope_rad",
            Problem { path: glide, terminal: Terminal::Anywhere, ..descent() },
        ),
        ("tilt_max_rad", Problem { tilt_max_rad: 29.0, ..descent() }),
    ];
    for (name, problem) in cases {
        match refusal(&problem, &Settings::default()) {
            PlanError::Input { field, .. } => assert_eq!(field, name),
            other => panic!("{name}: {other}"),
        }
    }
    let last = solve(&descent(), &Settings::default()).expect("feasible");
    let error = replan(&descent(), &Settings::default(), &last, nan).expect_err("not a time");
    assert!(matches!(error, PlanError::Input { field: "elapsed_s", .. }), "{error}");
}
