//! Whole touchdowns: verdicts, hand-over, and a state that restarts bit for bit.

mod common;

use claims::{Bound, Claim};
use common::{GRAVITY_M_S2, Setup, bug, on_plane, rigid_bug, run, run_to_verdict};
use lander_models::component::{Component, Settings};
use lander_models::{Outcome, Ticks};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::contact::Structure;
use truth_model::{State, TruthModel};

fn scenario(name: &str) -> (TruthModel, State) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/");
    TruthModel::create(&Settings { scenario_file: format!("{folder}{name}.toml").into() }).unwrap()
}

/// Drops the vehicle flat from `height_m` and runs to the verdict.
fn drop_from(setup: &mut Setup, height_m: f64) -> State {
    setup.scenario.initial.position_w = Vector3::new(0.0, 0.0, height_m);
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    state
}

#[test]
fn first_contact_is_seen_before_the_impact() {
    let mut speed_errors_m_s = Vec::new();
    // Heights that put the contact at different phases of a tick; one foot touches first.
    for height_m in [0.5, 0.5003, 0.5006, 0.5009, 0.5012] {
        let mut setup = on_plane(bug(), 0.0);
        setup.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(0.03, 0.05, 0.0);
        setup.scenario.initial.velocity_w.x = 0.7;
        let model = setup.model();
        let fall_m = height_m + model.foot_clearances_m(&model.initial_state()).fold(0.0, f64::min);
        let state = drop_from(&mut setup, height_m);
        let first = state.touchdown.first.unwrap();
        let expected_m_s = (2.0 * GRAVITY_M_S2 * fall_m).sqrt();
        speed_errors_m_s.push(-first.com_velocity_w.z - expected_m_s);
        // Free flight: nothing else has changed but for rounding.
        assert!((first.com_velocity_w.x - 0.7).abs() < 1e-9 && first.rate_rad_s < 1e-9);
    }
    Claim {
        id: "first-contact-speed",
        section: "Verdict",
        claim: "speed at first contact, one foot first, five phases of a tick",
        reference: "free fall: √(2 g h)",
        unit: "m/s",
        bound: Bound::AtMost(2e-3),
        origin: "one tick of free fall is 1.6 mm/s; after the impact it would be off by decimetres",
        noise: 0.0,
    }
    .holds_for(speed_errors_m_s);
}

#[test]
fn the_bad_touchdown_tips_over_and_says_when() {
    let (model, mut state) = scenario("tip-over");
    run_to_verdict(&model, &mut state, 30.0);
    assert_eq!(state.touchdown.outcome, Outcome::Tipped);
    let first = state.touchdown.first.unwrap();
    let tip_time = state.touchdown.unsupported_since.unwrap();
    assert!(tip_time > first.time && tip_time < state.now);
    assert!(state.touchdown.margin_j.unwrap() < 0.0);
}

#[test]
fn the_same_touchdown_with_free_pads_and_no_sideways_speed_stands() {
    let (model, _) = scenario("tip-over");
    let (mut scenario, vehicle) = (model.scenario().clone(), model.vehicle().clone());
    scenario.terrain.pads_captured = false;
    scenario.initial.velocity_w.x = 0.0;
    let model = TruthModel::new(scenario, vehicle);
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 30.0);
    assert_eq!(state.touchdown.outcome, Outcome::Landed, "{:?}", state.touchdown);
}

#[test]
fn a_fall_from_the_sky_is_a_crash() {
    let (model, mut state) = scenario("no-ignition");
    let report = model.step(&mut state, &[3000.0, 0.0, 0.0, 0.0, 0.0, 0.0], Ticks(60_000)).unwrap();
    assert!(report.terminate && report.event);
    assert_eq!(state.touchdown.outcome, Outcome::Crashed);
}

#[test]
fn a_slide_that_comes_to_rest_beyond_the_limit_is_a_slide() {
    // 2 m/s against μ g = 0.33 m/s² would stop after 6.2 m.
    for (limit_m, outcome) in [(5.0, Outcome::Slid), (7.0, Outcome::Landed)] {
        let mut setup = rigid_bug(0.0);
        setup.scenario.terrain.friction = 0.2;
        setup.scenario.touchdown.slide_limit_m = limit_m;
        setup.scenario.initial.velocity_w = Vector3::new(2.0, 0.0, 0.0);
        let model = setup.model();
        let mut state = model.initial_state();
        run_to_verdict(&model, &mut state, 20.0);
        assert_eq!(state.touchdown.outcome, outcome, "slid {} m", state.touchdown.slide_m);
        let expected_m = 2.0 * 2.0 / (2.0 * 0.2 * GRAVITY_M_S2);
        // 0.5 %: the acceptance of slides; the first tick finds the pads not yet loaded.
        assert!((state.touchdown.slide_m / expected_m - 1.0).abs() < 5e-3);
    }
}

#[test]
fn a_hard_second_impact_is_a_crash_and_a_used_up_stroke_is_said() {
    let mut setup = on_plane(bug(), 0.0);
    setup.scenario.touchdown.crash_speed_m_s = 5.0;
    setup.scenario.initial.position_w.z = 0.05;
    let model = setup.model();
    let mut state = model.initial_state();
    while state.touchdown.first.is_none() {
        model.tick(&mut state).unwrap();
    }
    // As after an engine-on bounce: up again, and down at 7 m/s.
    state.contact = None;
    state.feet_down.fill(false);
    state.motion.position_w.z = 14.0;
    run_to_verdict(&model, &mut state, 20.0);
    assert_eq!(state.touchdown.outcome, Outcome::Crashed);

    // 6.5 m/s brings 3.7 kJ; the four struts take 3.5 kJ.
    let state = drop_from(&mut on_plane(bug(), 0.0), 13.0);
    let touchdown = state.touchdown;
    // The hull is 0.55 m above ground on bottomed legs, so nothing but the legs took the blow.
    assert_eq!(touchdown.outcome, Outcome::Bottomed, "{touchdown:?}");
    assert!(touchdown.bottomed && !touchdown.struck.any());
}

#[test]
fn a_body_that_turns_non_finite_in_contact_is_an_error() {
    let model = on_plane(bug(), 20.0).model();
    let mut state = model.initial_state();
    run(&model, &mut state, 0.1);
    assert!(state.contact.is_some());
    state.command.rcs_torque_b.x = f64::NAN;
    let errors: Vec<_> = (0..5).filter_map(|_| model.tick(&mut state).err()).collect();
    assert!(errors[0].to_string().contains("in contact"), "{}", errors[0]);
}

#[test]
fn a_nozzle_that_touches_is_a_strike() {
    let mut vehicle = bug();
    vehicle.engine.nozzle_exit_height_m = 0.005;
    let state = drop_from(&mut on_plane(vehicle, 0.0), 0.5);
    assert_eq!(state.touchdown.outcome, Outcome::Struck);
    assert_eq!(state.touchdown.struck, Structure { hull: false, nozzle: true });
    // Rapier lets a part sink by its slop, 1 mm, at most.
    assert!(state.touchdown.clearance_m.unwrap().nozzle.abs() < 1e-3);
}

#[test]
fn a_slope_that_falls_towards_y_gives_the_turned_touchdown() {
    let land = |azimuth_deg: f64| {
        let mut setup = rigid_bug(0.0);
        // As much inertia about x as about y: the turned vehicle is the same vehicle.
        setup.vehicle.mass.dry.inertia_kg_m2.x = setup.vehicle.mass.dry.inertia_kg_m2.y;
        setup.scenario.terrain.slope_rad = 0.1;
        setup.scenario.terrain.friction = 0.6;
        setup.scenario.terrain.downhill_rad = azimuth_deg.to_radians();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), azimuth_deg.to_radians());
        setup.scenario.initial.position_w.z = 0.5;
        setup.scenario.initial.velocity_w = turn * Vector3::new(0.4, 0.1, 0.0);
        let model = setup.model();
        let mut state = model.initial_state();
        run_to_verdict(&model, &mut state, 20.0);
        (turn.inverse() * state.motion.position_w, state.touchdown)
    };
    let ((along_x, x), (along_y, y)) = (land(0.0), land(90.0));
    assert_eq!((x.outcome, y.outcome), (Outcome::Landed, Outcome::Landed));
    // The iterative solver takes the feet in file order, so the two differ by its residual.
    assert!((along_x - along_y).norm() < 1e-3, "{along_x} {along_y}");
    assert!((x.margin_j.unwrap() - y.margin_j.unwrap()).abs() < 0.1);
}

#[test]
fn a_start_below_ground_is_refused() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/");
    let text = std::fs::read_to_string(format!("{folder}scenarios/hop.toml")).unwrap();
    let text = text.replace("../vehicles", &format!("{folder}vehicles"));
    let text = text.replace("[200.0, 0.0, 0.0]", "[200.0, 0.0, -0.5]");
    let file = std::env::temp_dir().join(format!("below-ground-{}.toml", std::process::id()));
    std::fs::write(&file, text).unwrap();
    let error = TruthModel::create(&Settings { scenario_file: file.clone() }).err().unwrap();
    std::fs::remove_file(file).unwrap();
    let error = error.to_string();
    assert!(error.contains("`initial.position_w`") && error.contains("0.500 m"), "{error}");
}

#[test]
fn steps_after_the_verdict_change_nothing() {
    let (model, mut state) = scenario("tip-over");
    model.step(&mut state, &[0.0; 6], Ticks(30_000)).unwrap();
    let decided = outputs(&model, &state);
    let report = model.step(&mut state, &[3000.0, 0.0, 0.0, 0.0, 0.0, 0.0], Ticks(500)).unwrap();
    assert!(report.terminate && !report.event);
    assert_eq!(outputs(&model, &state), decided);
}

#[test]
fn a_vehicle_at_rest_on_the_ground_has_not_landed() {
    let model = on_plane(bug(), 0.0).model();
    let mut state = model.initial_state();
    run(&model, &mut state, 3.0);
    assert!(state.touchdown.first.is_none() && !state.touchdown.decided());
}

#[test]
fn contact_hands_back_to_flight_at_lift_off_and_takes_over_again() {
    let mut setup = on_plane(bug(), 20.0);
    setup.scenario.stop_time = Ticks(100_000);
    let model = setup.model();
    let mut state = model.initial_state();
    let full = [3000.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    model.step(&mut state, &full, Ticks(10)).unwrap();
    assert!(state.contact.is_some());
    model.step(&mut state, &full, Ticks(1200)).unwrap();
    assert!(state.contact.is_none() && state.airborne && state.motion.velocity_w.z > 1.0);
    for _ in 0..60_000 {
        model.step(&mut state, &[0.0; 6], Ticks(1)).unwrap();
        if state.touchdown.first.is_some() {
            break;
        }
    }
    assert!(state.touchdown.first.is_some() && state.contact.is_some());
}

/// Bits of everything the outside can see.
fn outputs(model: &TruthModel, state: &State) -> Vec<u64> {
    let mut values = vec![0.0; TruthModel::INTERFACE.output_len()];
    model.outputs(state, &mut values);
    values.into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_copy_taken_mid_impact_continues_bit_for_bit() {
    let mut setup = on_plane(bug(), 20.0);
    setup.scenario.initial.position_w.z = 0.5;
    setup.scenario.initial.velocity_w = Vector3::new(0.5, 0.2, 0.0);
    let model = setup.model();
    let mut state = model.initial_state();
    while state.touchdown.first.is_none() {
        model.tick(&mut state).unwrap();
    }
    run(&model, &mut state, 0.02);
    let mut clone = state.clone();
    let bytes = postcard::to_allocvec(&state).unwrap();
    let mut restored: State = postcard::from_bytes(&bytes).unwrap();
    let mut differing = 0_u32;
    for _ in 0..2000 {
        for copy in [&mut state, &mut clone, &mut restored] {
            model.tick(copy).unwrap();
        }
        let expected = outputs(&model, &state);
        let same = outputs(&model, &clone) == expected && outputs(&model, &restored) == expected;
        differing += u32::from(!same);
    }
    Claim {
        id: "restart-mid-impact",
        section: "State",
        claim: "ticks of 2000 that differ in a bit after a copy, or a restore from bytes, mid-impact",
        reference: "the run that went on",
        unit: "",
        bound: Bound::AtMost(0.0),
        origin: "acceptance list: bit-identical",
        noise: 0.0,
    }
    .holds(f64::from(differing));
}
