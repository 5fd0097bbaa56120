//! What impacts do to the vehicle's momentum and turn, both engines.

mod common;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use common::{GRAVITY_M_S2, Setup, on_plane, run, symmetric_bug};
use lander_models::scenario::ContactEngine;
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::{State, TruthModel};

/// Just clear of the ground, 2 m/s down.
fn drop(engine: ContactEngine, friction: f64, across_m_s: f64, pitch_deg: f64) -> TruthModel {
    let mut setup: Setup = on_plane(symmetric_bug(), 10.0).on(engine, 1);
    setup.scenario.terrain.friction = friction;
    let start = &mut setup.scenario.initial;
    start.velocity_w = Vector3::new(across_m_s, 0.0, -2.0);
    start.attitude_wb = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch_deg.to_radians());
    let model = setup.model();
    let low_m = model.lowest_m(&model.initial_state());
    setup.scenario.initial.position_w.z += 2e-3 - low_m;
    setup.model()
}

fn fall(model: &TruthModel, seconds: f64) -> State {
    let mut state = model.initial_state();
    run(model, &mut state, seconds);
    state
}

#[test]
fn friction_takes_its_share_of_all_that_stops_the_fall() {
    // 0.6 s: pads stop their feet, struts crush and spring back, feet lift and come down again.
    const TIME_S: f64 = 0.6;
    for engine in ENGINES {
        let errors = [(0.2, 2.0), (0.05, 1.0)].map(|(friction, across_m_s)| {
            let model = drop(engine, friction, across_m_s, 0.0);
            let velocity_w = |state: &State| model.com_velocity_w(&state.motion);
            let gained_w = velocity_w(&fall(&model, TIME_S)) - velocity_w(&model.initial_state());
            let due_m_s = friction * (gained_w.z + GRAVITY_M_S2 * TIME_S);
            100.0 * (-gained_w.x / due_m_s - 1.0)
        });
        let engine = name(engine);
        Claim {
            id: &format!("friction-impulse-{engine}"),
            section: "Contact: sliding",
            claim: &format!(
                "impulse of friction over an impact, a bounce and the next touch, {engine} engine"
            ),
            reference: "μ times the vertical impulse",
            unit: "%",
            bound: Bound::AtMost(0.5),
            origin: "that of the acceleration of a slide",
            noise: 1e-3,
        }
        .holds_for(errors);
    }
}

#[test]
fn the_engines_agree_how_an_impact_turns_the_vehicle() {
    // Without friction the struts alone turn it: two feet first, then the others by the turn.
    for pitch_deg in [2.0, 5.0] {
        let [rapier, strut] = ENGINES.map(|engine| {
            let state = fall(&drop(engine, 0.0, 0.0, pitch_deg), 2.0);
            state.touchdown.peak_stroke_m
        });
        Claim {
            id: "pitched-drop-of-engines",
            section: "Contact: crush",
            claim: "peak stroke of a drop pitched by 2° and 5° without friction, strut engine",
            reference: "the same with Rapier",
            unit: "%",
            bound: Bound::AtMost(1.0),
            origin: "that of the engines' tip speeds",
            noise: 1e-3,
        }
        .holds(100.0 * (strut / rapier - 1.0));
    }
}
