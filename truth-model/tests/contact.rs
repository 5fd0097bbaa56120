//! Standing on the ground, both engines: creep, loads that carry the weight, and a meshed plane
//! that is the plane.

mod common;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use common::relief::meshed;
use common::{GRAVITY_M_S2, Setup, bug, on_plane, rigid_bug, run, run_to_verdict, symmetric_bug};
use nalgebra::{UnitQuaternion, Vector3};

const SLOPE_DEG: f64 = 15.0;
/// Holds on 15°, whose tangent is 0.27.
const FRICTION: f64 = 0.5;

fn on_slope(mut setup: Setup, slope_deg: f64) -> Setup {
    setup.scenario.terrain.friction = FRICTION;
    setup.stand_on_slope(slope_deg.to_radians(), 0.3);
    setup
}

#[test]
fn a_vehicle_at_rest_on_a_slope_creeps_less_than_10_um_a_minute() {
    for engine in ENGINES {
        let model = on_slope(rigid_bug(0.0).on(engine, 1), SLOPE_DEG).model();
        let mut state = model.initial_state();
        run(&model, &mut state, 3.0);
        let settled_w = state.motion.position_w;
        run(&model, &mut state, 20.0);
        let per_minute_m = 3.0 * (state.motion.position_w - settled_w).norm();
        let engine = name(engine);
        Claim {
            id: &format!("creep-{engine}"),
            section: "Contact: rest",
            claim: &format!("creep at rest on 15°, rigid gear, μ = 0.5, {engine} engine"),
            reference: "Coulomb's law: none",
            unit: "µm/min",
            bound: Bound::AtMost(10.0),
            origin: "acceptance list",
            noise: 1e-3,
        }
        .holds(1e6 * per_minute_m);
    }
}

/// Upright legs, and legs whose pads spread by a quarter of their stroke.
fn gears() -> [Setup; 2] {
    let upright = on_plane(symmetric_bug(), 0.0);
    let mut tripods = upright.clone();
    for leg in &mut tripods.vehicle.gear.legs {
        let out_b = Vector3::new(leg.foot_b.x, leg.foot_b.y, 0.0).normalize();
        leg.stroke_axis_b = (Vector3::z() + 0.25 * out_b).normalize();
    }
    [upright, tripods]
}

#[test]
fn at_rest_the_ground_s_forces_on_the_pads_carry_the_weight() {
    for engine in ENGINES {
        let mut errors = Vec::new();
        for setup in gears() {
            for slope_deg in [0.0, SLOPE_DEG] {
                let model = on_slope(setup.clone().on(engine, 1), slope_deg).model();
                let mut state = model.initial_state();
                run(&model, &mut state, 10.0);
                let sum_w: Vector3<f64> = state.legs.iter().map(|leg| leg.ground_force_w).sum();
                let weight_n = 174.0 * GRAVITY_M_S2;
                let error = (sum_w - weight_n * Vector3::z()).norm() / weight_n;
                errors.push(100.0 * error);
            }
        }
        let engine = name(engine);
        Claim {
            id: &format!("loads-at-rest-{engine}"),
            section: "Contact: rest",
            claim: &format!(
                "sum of the pads' forces, level and on 15°, upright legs and tripods, {engine} engine"
            ),
            reference: "the weight, as a vector",
            unit: "%",
            bound: Bound::AtMost(0.1),
            origin: "acceptance list",
            noise: 1e-6,
        }
        .holds_for(errors);
    }
}

#[test]
fn a_touchdown_on_a_meshed_plane_is_that_on_the_plane() {
    const SLOPE_RAD: f64 = 0.1;
    for engine in ENGINES {
        let mut setup = on_plane(bug(), 10.0).on(engine, 1);
        setup.scenario.terrain.slope_rad = SLOPE_RAD;
        let start = &mut setup.scenario.initial;
        start.position_w = Vector3::new(0.0, 0.0, 0.8);
        start.velocity_w = Vector3::new(0.5, 0.2, -1.0);
        start.attitude_wb = UnitQuaternion::from_euler_angles(0.03, 0.05, 0.4);
        let mut mesh = setup.clone();
        mesh.scenario.terrain = meshed(0.5, 20.0, |x_m, _| -SLOPE_RAD.tan() * x_m);
        let [plane, mesh] = [setup, mesh].map(|setup| {
            let model = setup.model();
            let mut state = model.initial_state();
            run_to_verdict(&model, &mut state, 20.0);
            (state.motion.position_w, state.touchdown.outcome, state.now)
        });
        assert_eq!(plane.1, mesh.1);
        let engine = name(engine);
        Claim {
            id: &format!("meshed-plane-{engine}"),
            section: "Contact: terrain",
            claim: &format!("rest of a touchdown on a meshed slope of 0.1 rad, {engine} engine"),
            reference: "the same touchdown on the plane",
            unit: "mm",
            bound: Bound::AtMost(1.0),
            origin: "a thousandth of the verdict's limit on a slide, 1 m",
            noise: 1e-6,
        }
        .holds(1e3 * (plane.0 - mesh.0).norm());
    }
}
