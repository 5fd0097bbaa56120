//! Soft soil under the pads, against Bekker's law and between the two contact engines.

mod common;

use claims::{Bound, Claim};
use common::{GRAVITY_M_S2, on_plane, run_to_verdict, symmetric_bug};
use lander_models::Outcome;
use lander_models::scenario::{ContactEngine, Soil};
use truth_model::State;

const LUNAR: Soil =
    Soil { cohesive_modulus_n_m2: 1.4e3, frictional_modulus_n_m3: 8.2e5, exponent: 1.0 };
const BEARING_RADIUS_M: f64 = 0.15;
const DROP_M: f64 = 1.0;
const CRUSH_N: f64 = 1500.0;

fn drop_on(soil: Option<Soil>, engine: ContactEngine) -> State {
    let mut setup = on_plane(symmetric_bug(), 0.0);
    setup.vehicle.gear.bearing_radius_m = BEARING_RADIUS_M;
    setup.scenario.contact_engine = engine;
    setup.scenario.terrain.soil = soil;
    setup.scenario.initial.position_w.z = DROP_M;
    let model = setup.model();
    let mut state = model.initial_state();
    run_to_verdict(&model, &mut state, 20.0);
    assert_eq!(state.touchdown.outcome, Outcome::Landed);
    state
}

#[test]
fn pads_sink_until_the_soil_bears_the_crush_load() {
    let expected_m = LUNAR.pad_sinkage_m(BEARING_RADIUS_M, CRUSH_N);
    let error =
        |engine| 100.0 * (drop_on(Some(LUNAR), engine).legs[0].sinkage_m / expected_m - 1.0);
    let claim = Claim {
        id: "soil-sinkage-strut",
        section: "Contact: soil",
        claim: "sinkage of pads whose struts crush, drop from 1 m, strut engine",
        reference: "Bekker's law at the crush load (T.48)",
        unit: "%",
        bound: Bound::AtMost(10.0),
        origin: "the share of a step is that of its start: 1.8 mm, 7 % of the hole",
        noise: 0.0,
    };
    claim.holds(error(ContactEngine::Strut));
    Claim {
        id: "soil-sinkage-rapier",
        claim: "the same, Rapier engine",
        bound: Bound::AtMost(50.0),
        origin: "foot and plate, 2 kg each, press on by their momentum: z + sqrt(z² + (v/ω)²) at most",
        ..claim
    }
    .holds(error(ContactEngine::Rapier));
}

#[test]
fn soil_spares_the_struts_what_it_takes_itself() {
    for engine in [ContactEngine::Rapier, ContactEngine::Strut] {
        let (hard, soft) = (drop_on(None, engine), drop_on(Some(LUNAR), engine));
        let spared_m = hard.touchdown.peak_stroke_m - soft.touchdown.peak_stroke_m;
        // Each hole took the work of Bekker's law, of which the way down gave m g z back.
        let sinkage_m = soft.legs[0].sinkage_m;
        let weight_n = (174.0 - 8.0) * GRAVITY_M_S2;
        let bearing_n = LUNAR.pad_load_n(BEARING_RADIUS_M, sinkage_m);
        let taken_j = 4.0 * 0.5 * bearing_n * sinkage_m - weight_n * sinkage_m;
        let expected_m = taken_j / (4.0 * CRUSH_N - weight_n);
        println!("{engine:?}: spared {spared_m} m, soil's work {expected_m} m");
        // A third: the plates' springs and dampers, the feet, and the struts' elastic part.
        assert!((spared_m / expected_m - 1.0).abs() < 0.33, "{engine:?}");
    }
}

#[test]
fn soil_a_thousand_times_as_stiff_is_hard_ground() {
    let stiff = Soil { frictional_modulus_n_m3: 8.2e8, ..LUNAR };
    for engine in [ContactEngine::Rapier, ContactEngine::Strut] {
        let stroke_m = |soil| drop_on(soil, engine).touchdown.peak_stroke_m;
        let error = stroke_m(Some(stiff)) / stroke_m(None) - 1.0;
        println!("{engine:?}: stiff soil {:.2} %", 100.0 * error);
        // 10 %: Rapier's plates, as heavy as the feet, are hit first (README, "Limits").
        assert!(error.abs() < 0.10, "{engine:?}: {error}");
    }
}
