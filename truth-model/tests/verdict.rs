//! The verdict on whole touchdowns: what it says of first contact, of rest, and of what only looks
//! like rest.

mod common;

use common::{GRAVITY_M_S2, Setup, bug, on_plane, rigid_bug, run, run_to_verdict, symmetric_bug};
use lander_models::component::Component;
use lander_models::signals::FOOT_SLOTS;
use lander_models::{Outcome, Ticks};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::{State, TruthModel};

fn output(model: &TruthModel, state: &State, name: &str) -> [f64; FOOT_SLOTS] {
    let mut values = vec![0.0; TruthModel::INTERFACE.output_len() + FOOT_SLOTS];
    let len = TruthModel::INTERFACE.output_len();
    model.outputs(state, &mut values[..len]);
    let at = TruthModel::INTERFACE.output_offset(name).unwrap();
    std::array::from_fn(|n| values[at + n])
}

fn scalar(model: &TruthModel, state: &State, name: &str) -> f64 {
    output(model, state, name)[0]
}

/// A touchdown on a slope that falls towards x, feet parallel to it, run to the verdict.
fn touch_down_on_slope(setup: &mut Setup, slope_rad: f64, velocity_w: Vector3<f64>) -> State {
    setup.stand_on_slope(slope_rad, 0.3);
    setup.scenario.terrain.friction = 0.9;
    setup.scenario.initial.position_w = Vector3::new(0.0, 0.0, 0.01);
    setup.scenario.initial.velocity_w = velocity_w;
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    state
}

#[test]
fn each_foots_first_contact_is_measured_against_the_local_ground() {
    let (slope_rad, velocity_w) = (0.15_f64, Vector3::new(0.1, 0.05, -1.0));
    let mut setup = rigid_bug(0.0);
    let state = touch_down_on_slope(&mut setup, slope_rad, velocity_w);
    let model = setup.model();
    let normal_w = Vector3::new(slope_rad.sin(), 0.0, slope_rad.cos());
    let normal_m_s = -velocity_w.dot(&normal_w);
    let tangential_m_s = (velocity_w + normal_w * normal_m_s).norm();
    let first_s = output(&model, &state, "foot_contact_time_s");
    let normal = output(&model, &state, "foot_contact_speed_normal_m_s");
    let tangential = output(&model, &state, "foot_contact_speed_tangential_m_s");
    for n in 0..4 {
        // 1 cm of fall at 1 m/s: 10 ms, in which gravity adds 16 mm/s.
        assert!((normal[n] - normal_m_s).abs() < 0.02, "{} {normal_m_s}", normal[n]);
        assert!((tangential[n] - tangential_m_s).abs() < 0.02, "{} m/s", tangential[n]);
        assert!((first_s[n] - first_s[0]).abs() < 2.5e-3, "parallel feet: within two ticks");
    }
    assert!(normal[4].is_nan() && first_s[5].is_nan() && tangential[4].is_nan());
}

#[test]
fn feet_touch_in_the_order_of_their_height() {
    let mut setup = on_plane(symmetric_bug(), 0.0);
    setup.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(0.0, 0.1, 0.0);
    setup.scenario.initial.position_w.z = 0.5;
    let model = setup.model();
    let mut state = model.initial_state();
    let clearance: Vec<_> = model.foot_clearances_m(&state).collect();
    run_to_verdict(&model, &mut state, 20.0);
    let feet = state.touchdown.feet.map(|foot| foot.map_or(f64::NAN, |foot| foot.normal_m_s));
    let time = output(&model, &state, "foot_contact_time_s");
    // Nose down about y: the feet at +x come first, at the speed of a free fall from there.
    let expected_m_s = (2.0 * GRAVITY_M_S2 * clearance[0]).sqrt();
    // One tick of free fall: 1.6 mm/s.
    assert!((feet[0] - expected_m_s).abs() < 2e-3 && (feet[3] - expected_m_s).abs() < 2e-3);
    assert!(time[0] < time[1] && time[3] < time[2]);
    assert_eq!(time[0], scalar(&model, &state, "contact_time_s"));
}

#[test]
fn at_rest_on_a_slope_attitude_clearance_and_distance_are_those_of_the_geometry() {
    let slope_rad = 0.15_f64;
    let mut setup = rigid_bug(0.0);
    let state = touch_down_on_slope(&mut setup, slope_rad, Vector3::new(0.0, 0.0, -0.3));
    let model = setup.model();
    assert_eq!(state.touchdown.outcome, Outcome::Landed);
    let of = |name: &str| scalar(&model, &state, name);
    // Struts of 1e6 N/m give 0.1 mm under the weight, on a footprint of 2.7 m: 0.004°; the pads'
    // slop of 1 mm in Rapier the tenfold.
    assert!((of("rest_tilt_deg") - slope_rad.to_degrees()).abs() < 0.05);
    assert!(of("rest_tilt_to_ground_deg") < 0.05);
    assert!(of("rest_heading_change_deg").abs() < 0.1);
    let (hull, engine) = (&setup.vehicle.hull, &setup.vehicle.engine);
    assert!((of("rest_hull_clearance_m") - hull.bottom_height_m).abs() < 2e-3);
    assert!((of("rest_nozzle_clearance_m") - engine.nozzle_exit_height_m).abs() < 2e-3);
    assert!(of("least_nozzle_clearance_m") <= of("rest_nozzle_clearance_m"));
    // Heading 0.3 rad: the edge whose outward normal is nearest to the fall line (T.20).
    let com_m = setup.vehicle.mass.at(0.0).com_b.z;
    let edge_m = setup.vehicle.gear.legs[0].foot_b.x;
    let along = |heading_rad: f64| {
        let (fall, across) = (slope_rad.tan(), slope_rad.sin());
        let outward = Vector3::new(heading_rad.cos(), heading_rad.sin(), 0.0);
        let level = (1.0 - (heading_rad.sin() * across).powi(2)).sqrt();
        (edge_m - com_m * fall * outward.x) * slope_rad.cos() / level
    };
    let expected_m = [0.3, -1.27, 1.87].map(along).into_iter().fold(f64::INFINITY, f64::min);
    let distance_m = of("stability_distance_now_m");
    assert!((distance_m - expected_m).abs() < 2e-3, "{distance_m} m, geometry {expected_m} m");
    assert!(of("stability_distance_m") <= distance_m && of("tip_margin_now_j") > 0.0);
    assert!(of("tip_energy_margin_j") <= of("tip_margin_now_j"));
}

#[test]
fn nothing_is_measured_before_first_contact() {
    let mut setup = on_plane(bug(), 0.0);
    setup.scenario.initial.position_w.z = 1.0;
    let model = setup.model();
    let mut state = model.initial_state();
    run(&model, &mut state, 0.5);
    for name in [
        "tip_margin_now_j",
        "stability_distance_now_m",
        "stability_distance_m",
        "peak_acceleration_m_s2",
        "peak_angular_acceleration_rad_s2",
        "foot_contact_time_s",
        "rest_tilt_to_ground_deg",
        "rest_heading_change_deg",
        "rest_hull_clearance_m",
        "least_nozzle_clearance_m",
    ] {
        assert!(scalar(&model, &state, name).is_nan(), "{name}");
    }
    while state.touchdown.first.is_none() {
        model.tick(&mut state).unwrap();
    }
    assert!(scalar(&model, &state, "tip_margin_now_j") > 0.0);
    assert!(scalar(&model, &state, "rest_hull_clearance_m").is_nan(), "not at rest yet");
}

#[test]
fn a_flat_drop_is_felt_as_the_crush_load_over_the_sprung_mass() {
    let mut setup = on_plane(symmetric_bug(), 0.0);
    setup.scenario.initial.position_w.z = 1.0;
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    let gear = &setup.vehicle.gear;
    // All four struts at their first crush load, and never the second: the stroke is 5 cm.
    let expected_m_s2 = 4.0 * gear.legs[0].strut.crush_1_n / (174.0 - 4.0 * gear.foot_mass_kg);
    let peak_m_s2 = scalar(&model, &state, "peak_acceleration_m_s2");
    // 1 %: the feet's stops leak into the hull through the joint within a tick.
    assert!((peak_m_s2 / expected_m_s2 - 1.0).abs() < 1e-2, "{peak_m_s2} {expected_m_s2}");
    // Symmetric: what turns it is the solver's order of feet.
    assert!(scalar(&model, &state, "peak_angular_acceleration_rad_s2") < 0.1 * peak_m_s2);
}

#[test]
fn a_slide_too_slow_to_see_is_not_called_a_landing() {
    let slope_rad = 10_f64.to_radians();
    for (friction_short_of_tangent, outcome) in
        [(0.004, Outcome::InFlight), (-0.1, Outcome::Landed)]
    {
        let mut setup = rigid_bug(0.0);
        setup.stand_on_slope(slope_rad, 0.0);
        setup.scenario.terrain.friction = slope_rad.tan() - friction_short_of_tangent;
        let model = setup.model();
        let mut state = model.initial_state();
        // Let it settle before its touchdown is declared.
        run(&model, &mut state, 0.05);
        state.airborne = true;
        state.feet_down.fill(false);
        run_to_verdict(&model, &mut state, 3.0);
        // 6.4 mm/s²: below 5 mm/s for 0.8 s.
        assert_eq!(state.touchdown.outcome, outcome, "{:?}", state.touchdown);
    }
}

/// Stands on its two feet at +x, tilted about their edge to `short_deg` short of balance.
fn balance(short_deg: f64) -> (TruthModel, State) {
    let mut setup = rigid_bug(0.0);
    let foot_b = setup.vehicle.gear.legs[0].foot_b;
    let com_m = setup.vehicle.mass.at(0.0).com_b.z;
    // Balls of pads roll by their radius times the tilt; captured, they hold where they touch.
    let pad_m = setup.vehicle.gear.pad_radius_m;
    let tilt_rad = foot_b.x.atan2(com_m - pad_m) - short_deg.to_radians();
    setup.scenario.terrain.pads_captured = true;
    setup.scenario.initial.attitude_wb =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt_rad);
    let state = setup.model().initial_state();
    let lowest_m = setup.model().lowest_m(&state);
    setup.scenario.initial.position_w.z = -lowest_m;
    setup.scenario.stop_time = Ticks(30_000);
    let model = setup.model();
    let mut state = model.initial_state();
    state.airborne = true;
    (model, state)
}

#[test]
fn a_vehicle_that_teeters_is_judged_when_it_has_fallen() {
    for (short_deg, outcomes) in
        [(1.0, [Outcome::Landed, Outcome::Slid]), (-1.0, [Outcome::Tipped, Outcome::Tipped])]
    {
        let (model, mut state) = balance(short_deg);
        run_to_verdict(&model, &mut state, 30.0);
        assert!(outcomes.contains(&state.touchdown.outcome), "{:?}", state.touchdown);
        // It leaves 1° as exp(t/1.2 s): two time constants and more until it has fallen.
        assert!(state.now > Ticks(500), "{:?}", state.now);
    }
}

/// BUG on a ring of `feet` feet, one leg for each.
fn legged(feet: usize) -> Setup {
    let mut setup = rigid_bug(0.0);
    let radius_m = setup.vehicle.gear.legs[0].foot_b.norm();
    let leg = setup.vehicle.gear.legs[0].clone();
    setup.vehicle.gear.legs = (0..feet)
        .map(|n| {
            let angle = std::f64::consts::TAU * n as f64 / feet as f64;
            let foot_b = Vector3::new(angle.cos(), angle.sin(), 0.0) * radius_m;
            lander_models::vehicle::Leg { foot_b, ..leg.clone() }
        })
        .collect();
    setup
}

#[test]
fn three_to_six_legs_are_judged_alike() {
    for feet in 3..=6 {
        let mut setup = legged(feet);
        setup.scenario.initial.position_w.z = 0.2;
        let model = setup.model();
        let mut state = model.initial_state();
        run_to_verdict(&model, &mut state, 20.0);
        assert_eq!(state.touchdown.outcome, Outcome::Landed, "{feet} legs");
        let radius_m = setup.vehicle.gear.legs[0].foot_b.norm();
        let apothem_m = radius_m * (std::f64::consts::PI / feet as f64).cos();
        let distance_m = scalar(&model, &state, "stability_distance_now_m");
        // Struts give 0.1 mm, on a base of 2 m and at a height of 1.4 m.
        assert!((distance_m - apothem_m).abs() < 1e-3, "{feet} legs: {distance_m} {apothem_m}");

        // Thrown over the edge at -x, or the foot there: beyond the tip-over speed of each. At the
        // higher speed springy legs throw six feet into the air, for a somersault onto their feet.
        for speed_m_s in [4.0, 6.5] {
            let mut setup = legged(feet);
            setup.scenario.terrain.pads_captured = true;
            setup.scenario.initial.velocity_w = Vector3::new(-speed_m_s, 0.0, 0.0);
            let model = setup.model();
            let mut state = model.initial_state();
            run_to_verdict(&model, &mut state, 20.0);
            let touchdown = state.touchdown;
            assert_eq!(touchdown.outcome, Outcome::Tipped, "{feet} legs at {speed_m_s} m/s");
            let (first, left) = (touchdown.first.unwrap().time, touchdown.tip_time().unwrap());
            assert!(first < left && left < state.now);
        }
    }
}
