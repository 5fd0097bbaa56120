//! Three to six legs, upright and as tripods: crush stroke, static tip angle, loads at rest.

mod common;
mod scatter;

use claims::{Bound, Claim};
use common::{GRAVITY_M_S2, on_plane, rigid_bug, run, run_to_verdict, symmetric_bug};
use lander_models::frames::tilt_rad;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use scatter::{FOOT_CIRCLE_M, on_legs};
use truth_model::contact::Contact;
use truth_model::propulsion::Drive;
use truth_model::stability::static_tip_angle_rad;
use truth_model::{State, TruthModel};

const LEGS: std::ops::RangeInclusive<usize> = 3..=6;

/// Drops the vehicle flat from 1 m on ground without friction.
fn drop(vehicle: Vehicle) -> (TruthModel, State) {
    let mut setup = on_plane(vehicle, 0.0);
    setup.scenario.terrain.friction = 0.0;
    setup.scenario.initial.position_w.z = 1.0;
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    (model, state)
}

/// Relative error of the pads' peak stroke against the energy balance of hull and feet.
fn stroke_error(model: &TruthModel, state: &State) -> f64 {
    let gear = &model.vehicle().gear;
    let (count, leg) = (gear.legs.len() as f64, &gear.legs[0]);
    let feet_kg = count * gear.foot_mass_kg;
    let hull_kg = model.vehicle().mass.dry.mass_kg - feet_kg;
    let (up, out) = (leg.stroke_axis_b.z, leg.stroke_axis_b.xy().norm());
    // The impact stops the feet's fall and makes them spread: what is left of the hull's momentum
    // along the one way that both can go, for a stroke rate s': hull down by up s', feet out by
    // out s'.
    let fall_m_s = (2.0 * GRAVITY_M_S2).sqrt();
    let along_kg = hull_kg * up * up + feet_kg * out * out;
    let left_j = 0.5 * (hull_kg * fall_m_s * up).powi(2) / along_kg;
    // left_j + hull weight times up s = n F s, at the first stage's crush load throughout.
    let stroke_m = left_j / (count * leg.strut.crush_1_n - hull_kg * GRAVITY_M_S2 * up);
    assert!(stroke_m < leg.strut.stroke_1_m, "{stroke_m} m is beyond the first stage");
    state.touchdown.peak_stroke_m / leg.strut_ratio / stroke_m - 1.0
}

fn stroke_claim<'a>(id: &'a str, claim: &'a str) -> Claim<'a> {
    Claim {
        id,
        section: "Contact: crush",
        claim,
        reference: "momentum at the impact, then energy balance",
        unit: "%",
        bound: Bound::AtMost(0.5),
        origin: "acceptance list",
        noise: 0.0,
    }
}

#[test]
fn three_to_six_legs_crush_what_the_energy_balance_says() {
    let errors = LEGS.map(|count| {
        let mut vehicle = on_legs(symmetric_bug(), count);
        // The same crush load in all, so that three legs stay in the first stage, too.
        vehicle.gear.legs.iter_mut().for_each(|leg| leg.strut.crush_1_n *= 4.0 / count as f64);
        let (model, state) = drop(vehicle);
        100.0 * stroke_error(&model, &state)
    });
    stroke_claim("crush-stroke-n-legs", "peak stroke of a flat drop from 1 m, 3 to 6 legs")
        .holds_for(errors);
}

/// BUG's file with the upper ends of three struts a leg.
fn tripod_bug() -> Vehicle {
    let text = include_str!("../../models/vehicles/bug.toml");
    let place = |reach_m: f64, side_m: f64, height_m: f64| {
        let points: Vec<String> = (0..4)
            .map(|n| {
                let angle_rad = (f64::from(n) + 0.5) * std::f64::consts::FRAC_PI_2;
                let (sin, cos) = angle_rad.sin_cos();
                let (x, y) = (reach_m * cos - side_m * sin, reach_m * sin + side_m * cos);
                format!("[{x}, {y}, {height_m}]")
            })
            .collect();
        let points = points.join(", ");
        format!("{{ value = [{points}], unit = \"m\", source = \"test\", grade = \"assumed\" }}")
    };
    let tops = format!(
        "[gear]\nprimary_top_b = {}\nsecondary_left_top_b = {}\nsecondary_right_top_b = {}\n",
        place(0.7, 0.0, 1.6),
        place(0.7, 0.4, 0.6),
        place(0.7, -0.4, 0.6)
    );
    let text = text.replacen("[gear]\n", &tops, 1);
    let mut vehicle = Vehicle::parse("tripod.toml".as_ref(), &text).unwrap();
    vehicle.mass.dry.com_b.x = 0.0;
    vehicle
}

#[test]
fn tripod_legs_crush_what_the_energy_balance_says() {
    let (model, state) = drop(tripod_bug());
    let axis_b = model.vehicle().gear.legs[0].stroke_axis_b;
    assert!(axis_b.xy().norm() > 0.3, "the pads spread outwards: {axis_b}");
    let claim = stroke_claim(
        "crush-stroke-tripod",
        "peak stroke of a flat drop from 1 m on tripod legs that spread, no friction",
    );
    claim.holds(100.0 * stroke_error(&model, &state));
}

#[test]
fn struts_and_feet_at_rest_carry_the_weight() {
    let errors = LEGS.map(|count| {
        let (model, mut state) = drop(on_legs(symmetric_bug(), count));
        run(&model, &mut state, 0.5);
        let feet_n = count as f64 * model.vehicle().gear.foot_mass_kg * GRAVITY_M_S2;
        let carried_n = feet_n + state.legs.iter().map(|leg| leg.load_n).sum::<f64>();
        100.0 * (carried_n / (model.vehicle().mass.dry.mass_kg * GRAVITY_M_S2) - 1.0)
    });
    Claim {
        id: "loads-at-rest",
        section: "Contact: rest",
        claim: "loads of the struts and weight of the feet at rest, 3 to 6 legs",
        reference: "m g",
        unit: "%",
        bound: Bound::AtMost(0.1),
        origin: "acceptance list",
        noise: 1e-3,
    }
    .holds_for(errors);
}

/// Whether the vehicle goes over on a table that tilts to `table_deg` within 2 s and is then held
/// for 6 s, five times the time constant of its fall. The table falls `toward_b`.
fn goes_over(model: &TruthModel, toward_b: &Vector3<f64>, table_deg: f64) -> bool {
    let State { mut motion, mut legs, .. } = model.initial_state();
    let mut site = model.site();
    let mut contact = Contact::take_over(model.scenario().contact_engine, &site, &motion, &legs);
    (0..8000).any(|tick| {
        let s = (f64::from(tick) / 2000.0).min(1.0);
        let angle = (table_deg - (1.0 - s * s * (3.0 - 2.0 * s))).to_radians();
        site.gravity_w = (toward_b * angle.sin() - Vector3::z() * angle.cos()) * GRAVITY_M_S2;
        contact.step(&site, &mut motion, &mut legs, &Drive::default()).unwrap();
        tilt_rad(&motion.attitude_wb).to_degrees() > 1.0
    })
}

#[test]
fn each_number_of_legs_has_its_static_tip_angle() {
    let wrong = LEGS.map(|count| {
        let mut setup = rigid_bug(0.0);
        setup.vehicle = on_legs(setup.vehicle, count);
        setup.scenario.terrain.pads_captured = true;
        let model = setup.model();
        let feet_b: Vec<_> = model.vehicle().gear.feet_b().collect();
        let edge_distance_m = FOOT_CIRCLE_M * (std::f64::consts::PI / count as f64).cos();
        let height_m = model.vehicle().mass.dry.com_b.z;
        let limit_deg = static_tip_angle_rad(edge_distance_m, height_m).to_degrees();
        let across_b = (feet_b[0] + feet_b[1]).normalize();
        let (stands, falls) = (limit_deg - 0.3, limit_deg + 0.3);
        let fell_early = goes_over(&model, &across_b, stands);
        f64::from(u8::from(fell_early) + u8::from(!goes_over(&model, &across_b, falls)))
    });
    Claim {
        id: "static-tip-n-legs",
        section: "Contact: tip-over",
        claim: "3 to 6 legs: wrong answers 0.3° short of the tip angle over an edge and beyond it",
        reference: "closed form (T.16), d = R cos(π/n)",
        unit: "",
        bound: Bound::AtMost(0.0),
        origin: "the fall from 0.3° takes as long as the table is held; four legs are searched to 0.004°",
        noise: 0.0,
    }
    .holds_for(wrong);
}
