//! Whole touchdowns: crush stroke, verdicts, hand-over, and a state that restarts bit for bit.

mod common;

use common::{GRAVITY_M_S2, bug, on_plane, rigid_bug, run, run_to_verdict};
use lander_models::component::{Component, Settings};
use lander_models::{Outcome, Ticks};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::stability::captured_tip_speed_m_s;
use truth_model::{State, TruthModel};

fn scenario(name: &str) -> (TruthModel, State) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/");
    TruthModel::create(&Settings { scenario_file: format!("{folder}{name}.toml").into() }).unwrap()
}

/// Drops the vehicle flat from `height_m` and runs to the verdict.
fn drop_from(model: &mut TruthModel, height_m: f64) -> State {
    model.scenario.initial.position_w = Vector3::new(0.0, 0.0, height_m);
    let mut state = model.initial_state();
    run_to_verdict(model, &mut state, 20.0);
    state
}

#[test]
fn a_flat_drop_crushes_what_the_energy_balance_says() {
    let mut vehicle = bug();
    vehicle.mass.dry.com_b.x = 0.0;
    let gear = vehicle.gear.clone();
    let mut model = on_plane(vehicle, 0.0);
    let state = drop_from(&mut model, 1.0);
    // The hull falls 1 m + s; each foot stops dead at contact and brings nothing. The damper
    // (c v = 7 kN at first) has the strut at its crush load F from the start, so all four take
    // 4 F s: no elastic ramp.
    let sprung_kg = 174.0 - 4.0 * gear.foot_mass_kg;
    let weight_n = sprung_kg * GRAVITY_M_S2;
    let stroke_m = weight_n * 1.0 / (4.0 * gear.crush_1_n - weight_n);
    let error = state.peak_stroke_m / stroke_m - 1.0;
    println!(
        "stroke {} m, energy balance {stroke_m} m, {:.2} %",
        state.peak_stroke_m,
        100.0 * error
    );
    // Rapier brakes a foot from the start of the tick in which it would touch, so the crush load
    // acts up to one tick too long: 2 a dt / v of the energy, 3.8 % here. README, "Limits".
    let (braking_m_s2, speed_m_s) = (4.0 * gear.crush_1_n / sprung_kg, (2.0 * GRAVITY_M_S2).sqrt());
    let bound = 2.0 * braking_m_s2 * 1e-3 / speed_m_s;
    assert!(error.abs() < bound, "{} m, not {stroke_m} m", state.peak_stroke_m);
    assert_eq!(state.touchdown.outcome, Outcome::Landed);
}

#[test]
fn first_contact_is_seen_before_the_impact() {
    // Heights that put the contact at different phases of a tick; one foot touches first.
    for height_m in [0.5, 0.5003, 0.5006, 0.5009, 0.5012] {
        let mut model = on_plane(bug(), 0.0);
        model.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(0.03, 0.05, 0.0);
        model.scenario.initial.velocity_w.x = 0.7;
        let fall_m = height_m + model.foot_clearances_m(&model.initial_state()).fold(0.0, f64::min);
        let state = drop_from(&mut model, height_m);
        let first = state.touchdown.first.unwrap();
        let expected_m_s = (2.0 * GRAVITY_M_S2 * fall_m).sqrt();
        // One tick of free fall: 1.6 mm/s. After the impact it would be off by decimetres.
        let error_m_s = -first.com_velocity_w.z - expected_m_s;
        assert!(error_m_s.abs() < 2e-3, "{height_m} m: {error_m_s} m/s");
        // Free flight: nothing else has changed but for rounding.
        assert!((first.com_velocity_w.x - 0.7).abs() < 1e-9 && first.rate_rad_s < 1e-9);
    }
}

#[test]
fn captured_pads_tip_over_at_the_closed_form_speed() {
    let mut model = rigid_bug(0.0);
    model.scenario.terrain.pads_captured = true;
    let mass = model.vehicle.mass.at(0.0);
    let edge_m = model.vehicle.gear.feet_b[0].x;
    let expected_m_s = captured_tip_speed_m_s(
        mass.mass_kg,
        mass.inertia_b[(1, 1)],
        edge_m,
        mass.com_b.z,
        GRAVITY_M_S2,
    );
    let mut tips = |speed_m_s: f64| {
        model.scenario.initial.velocity_w = Vector3::new(speed_m_s, 0.0, 0.0);
        let mut state = model.initial_state();
        state.airborne = true;
        run_to_verdict(&model, &mut state, 20.0);
        state.touchdown.outcome == Outcome::Tipped
    };
    let (mut stands, mut falls) = (0.97 * expected_m_s, 1.03 * expected_m_s);
    assert!(!tips(stands) && tips(falls), "not within 3 % of {expected_m_s} m/s");
    while falls - stands > 1e-3 * expected_m_s {
        let middle = 0.5 * (stands + falls);
        if tips(middle) { falls = middle } else { stands = middle }
    }
    let error = stands / expected_m_s - 1.0;
    println!("tip speed {stands} m/s, closed form {expected_m_s} m/s, {:.2} %", 100.0 * error);
    // 1 %: ball-shaped pads, struts of 1e6 N/m and 1 ms steps, measured near half of it.
    assert!(error.abs() < 1e-2);
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
    let (mut model, _) = scenario("tip-over");
    model.scenario.terrain.pads_captured = false;
    model.scenario.initial.velocity_w.x = 0.0;
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
fn a_frictionless_incline_is_a_slide() {
    let mut model = on_plane(bug(), 0.0);
    model.scenario.terrain.friction = 0.0;
    common::stand_on_slope(&mut model, 0.1, 0.0);
    let mut state = model.initial_state();
    state.airborne = true;
    model.scenario.stop_time = Ticks(5000);
    run_to_verdict(&model, &mut state, 20.0);
    assert_eq!(state.touchdown.outcome, Outcome::Slid);
}

#[test]
fn a_vehicle_at_rest_on_the_ground_has_not_landed() {
    let model = on_plane(bug(), 0.0);
    let mut state = model.initial_state();
    run(&model, &mut state, 3.0);
    assert!(state.touchdown.first.is_none() && !state.touchdown.decided());
}

#[test]
fn contact_hands_back_to_flight_at_lift_off_and_takes_over_again() {
    let mut model = on_plane(bug(), 20.0);
    model.scenario.stop_time = Ticks(100_000);
    let mut state = model.initial_state();
    let full = [3000.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    model.step(&mut state, &full, Ticks(10)).unwrap();
    assert!(state.contact.is_some());
    model.step(&mut state, &full, Ticks(1200)).unwrap();
    assert!(state.contact.is_none() && state.airborne && state.motion.velocity_w.z > 1.0);
    model.step(&mut state, &[0.0; 6], Ticks(60_000)).unwrap();
    assert!(state.touchdown.first.is_some() && state.contact.is_some());
}

/// Bits of everything the outside can see.
fn outputs(model: &TruthModel, state: &State) -> Vec<u64> {
    let mut values = vec![0.0; TruthModel::INTERFACE.output_len()];
    model.outputs(state, &mut values);
    values.into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_clone_taken_mid_impact_continues_bit_for_bit() {
    let mut model = on_plane(bug(), 20.0);
    model.scenario.initial.position_w.z = 0.5;
    model.scenario.initial.velocity_w = Vector3::new(0.5, 0.2, 0.0);
    let mut state = model.initial_state();
    while state.touchdown.first.is_none() {
        model.tick(&mut state).unwrap();
    }
    run(&model, &mut state, 0.02);
    let mut copy = state.clone();
    for tick in 0..2000 {
        model.tick(&mut state).unwrap();
        model.tick(&mut copy).unwrap();
        assert_eq!(outputs(&model, &state), outputs(&model, &copy), "tick {tick}");
    }
}
