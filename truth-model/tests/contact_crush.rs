//! Crush stroke of flat drops, both engines, against the balance of energy.
//!
//! The feet stop dead and bring nothing; the hull falls h + s against four struts. What their
//! damper and their elastic strain bear while they flow is the crush load, no more, so that the
//! energy alone gives the stroke.

mod common;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use common::{GRAVITY_M_S2, Setup, on_plane, run_to_verdict, symmetric_bug};
use lander_models::Outcome;
use lander_models::scenario::ContactEngine;
use truth_model::State;

/// From 4.6 m the hull enters stage two at 3.3 m/s. The damper bears the step of 4.2 kN above
/// 1.05 m/s; after 21 mm, when the elastic strain alone bears it, the hull still has 2.3 m/s.
const DROPS: [(&str, &str, f64); 2] =
    [("one-stage", "1 m, stage one", 1.0), ("two-stages", "4.6 m, both stages", 4.6)];

fn drop_from(engine: ContactEngine, height_m: f64) -> (Setup, State) {
    let mut setup = on_plane(symmetric_bug(), 0.0).on(engine, 1);
    setup.scenario.initial.position_w.z = height_m;
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    (setup, state)
}

fn balance_m(setup: &Setup, height_m: f64) -> f64 {
    let gear = &setup.vehicle.gear;
    let strut = gear.legs[0].strut;
    let hull_kg = setup.vehicle.mass.dry.mass_kg - 4.0 * gear.foot_mass_kg;
    let weight_n = hull_kg * GRAVITY_M_S2;
    let one_m = weight_n * height_m / (4.0 * strut.crush_1_n - weight_n);
    if one_m < strut.stroke_1_m {
        return one_m;
    }
    let left_j =
        weight_n * (height_m + strut.stroke_1_m) - 4.0 * strut.crush_1_n * strut.stroke_1_m;
    strut.stroke_1_m + left_j / (4.0 * strut.crush_2_n - weight_n)
}

#[test]
fn a_flat_drop_crushes_what_the_energy_balance_says() {
    for engine in ENGINES {
        for (id, text, height_m) in DROPS {
            let (setup, state) = drop_from(engine, height_m);
            assert_eq!(state.touchdown.outcome, Outcome::Landed);
            let error = state.touchdown.peak_stroke_m / balance_m(&setup, height_m) - 1.0;
            let engine = name(engine);
            Claim {
                id: &format!("crush-stroke-{id}-{engine}"),
                section: "Contact: crush",
                claim: &format!("peak stroke of a flat drop from {text}, {engine} engine"),
                reference: "energy balance",
                unit: "%",
                bound: Bound::AtMost(0.5),
                origin: "acceptance list",
                noise: 1e-6,
            }
            .holds(100.0 * error);
        }
    }
}

#[test]
fn energy_beyond_the_full_stroke_bottoms_out_at_the_stop() {
    for engine in ENGINES {
        // 4.1 kJ with the way down; the four struts take 3.55 kJ.
        let (setup, state) = drop_from(engine, 15.0);
        let stop_m = setup.vehicle.gear.legs[0].strut.stroke_max_m;
        assert!(balance_m(&setup, 15.0) > stop_m);
        assert_eq!(state.touchdown.outcome, Outcome::Bottomed);
        let engine = name(engine);
        Claim {
            id: &format!("crush-stop-{engine}"),
            section: "Contact: crush",
            claim: &format!("peak stroke of a flat drop beyond the full stroke, {engine} engine"),
            reference: "the stop",
            unit: "mm",
            bound: Bound::AtMost(1.0),
            origin: "acceptance list: 0.5 % of the stroke",
            noise: 1e-6,
        }
        .holds(1e3 * (state.touchdown.peak_stroke_m - stop_m));
    }
}
