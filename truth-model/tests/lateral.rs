//! Legs that give across their stroke (T.19): how far, and that held pads then have one answer.

mod common;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use common::{GRAVITY_M_S2, bug, on_plane, rigid_bug, run, run_to_verdict};
use lander_models::scenario::ContactEngine;
use lander_models::vehicle::Lateral;
use nalgebra::Vector3;

#[test]
fn held_pads_carry_the_weight_down_a_slope_as_springs() {
    const STIFFNESS_N_M: f64 = 2e4;
    const SLOPE_RAD: f64 = 0.1;
    for engine in ENGINES {
        let mut setup = rigid_bug(0.0).on(engine, 1);
        let dry_kg = setup.vehicle.mass.dry.mass_kg;
        // Critical for a quarter of the vehicle.
        let damping_n_s_m = 2.0 * (STIFFNESS_N_M * 0.25 * dry_kg).sqrt();
        setup.vehicle.gear.lateral = Some(Lateral { stiffness_n_m: STIFFNESS_N_M, damping_n_s_m });
        setup.scenario.terrain.pads_captured = true;
        setup.stand_on_slope(SLOPE_RAD, 0.0);
        let model = setup.model();
        let mut state = model.initial_state();
        let start_w = state.motion.position_w;
        run(&model, &mut state, 3.0);
        let downhill_w = Vector3::new(SLOPE_RAD.cos(), 0.0, -SLOPE_RAD.sin());
        let given_m = (state.motion.position_w - start_w).dot(&downhill_w);
        // Rapier's feet are bodies that stand on the ground by themselves.
        let feet_kg = match engine {
            ContactEngine::Rapier => 4.0 * setup.vehicle.gear.foot_mass_kg,
            ContactEngine::Strut => 0.0,
        };
        let borne_n = (dry_kg - feet_kg) * GRAVITY_M_S2 * SLOPE_RAD.sin();
        let expected_m = borne_n / (4.0 * STIFFNESS_N_M);
        Claim {
            id: &format!("lateral-give-{}", name(engine)),
            section: "Contact: crush",
            claim: &format!(
                "give of held pads' legs across their stroke under the weight on a slope, {} engine",
                name(engine)
            ),
            reference: "m g sin β/(4 k_q)",
            unit: "%",
            bound: Bound::AtMost(0.5),
            origin: "that of a crush stroke in the acceptance list",
            noise: 0.0,
        }
        .holds(100.0 * (given_m / expected_m - 1.0).abs());
    }
}

/// Peak stroke of a rocking touchdown on held pads, m.
fn held_stroke_m(engine: ContactEngine, refinement: u32) -> f64 {
    let mut setup = on_plane(bug(), 5.0).on(engine, refinement);
    setup.scenario.terrain.pads_captured = true;
    setup.scenario.initial.position_w.z = 0.001;
    setup.scenario.initial.velocity_w = Vector3::new(1.1, 0.0, -1.0);
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 10.0);
    state.touchdown.peak_stroke_m
}

#[test]
fn a_touchdown_on_held_pads_has_one_stroke_at_any_step() {
    for engine in ENGINES {
        let fine_m = held_stroke_m(engine, 8);
        Claim {
            id: &format!("held-stroke-{}", name(engine)),
            section: "Contact: crush",
            claim: &format!(
                "peak stroke of a rocking touchdown on held pads against an eighth of the step, {} engine",
                name(engine)
            ),
            reference: "its own convergence",
            unit: "%",
            bound: Bound::AtMost(0.5),
            origin: "acceptance list: crush strokes within 0.5 %",
            noise: 0.0,
        }
        .holds(100.0 * (held_stroke_m(engine, 1) / fine_m - 1.0).abs());
    }
}
