//! Speed at which captured pads tip the vehicle over, both engines, against (T.24).

mod common;

use claims::{Bound, Claim};
use common::engines::name;
use common::{GRAVITY_M_S2, Setup, rigid_bug};
use lander_models::Outcome;
use lander_models::scenario::ContactEngine::{self, Rapier, Strut};
use nalgebra::Vector3;
use truth_model::stability::Captured;

const WET_KG: f64 = 85.5;
/// What the search leaves of the tip speed.
const RESOLUTION: f64 = 6.3e-4;

fn setup(engine: ContactEngine, refinement: u32, propellant_kg: f64, slope_deg: f64) -> Setup {
    let mut setup = rigid_bug(propellant_kg).on(engine, refinement);
    setup.scenario.terrain.pads_captured = true;
    // Dampers twice as strong take the blow before springs store it: struts give back 0.03 % of the
    // energy of tip-over in place of 1 %. A rigid edge gives back nothing.
    let mut setup = setup.with_struts(|strut| strut.damping_n_s_m *= 2.0);
    setup.stand_on_slope(slope_deg.to_radians(), 0.0);
    setup
}

fn closed_form_m_s(setup: &Setup) -> f64 {
    let Setup { scenario, vehicle } = setup;
    let mass = vehicle.mass.at(scenario.initial.propellant_kg);
    let standing = Captured {
        mass_kg: mass.mass_kg,
        inertia_kg_m2: mass.inertia_b[(1, 1)],
        distance_m: vehicle.gear.legs[0].foot_b.x,
        height_m: mass.com_b.z,
        pad_radius_m: vehicle.gear.pad_radius_m,
        slope_rad: scenario.terrain.slope_rad,
    };
    standing.tip_speed_m_s(GRAVITY_M_S2)
}

/// Whether it tips over when its pads meet the slope at this speed along it.
fn tips(setup: &Setup, speed_m_s: f64) -> bool {
    let mut setup = setup.clone();
    setup.scenario.initial.velocity_w =
        setup.scenario.initial.attitude_wb * Vector3::x() * speed_m_s;
    let model = setup.model();
    let mut state = model.initial_state();
    state.airborne = true;
    // A few time constants of 1.2 s from the top, where it hesitates.
    for tick in 0..20_000 {
        if model.tick(&mut state).unwrap().terminate {
            return state.touchdown.outcome == Outcome::Tipped;
        }
        // Once past the impact, one that turns back has stood.
        if tick > 200 && state.motion.rate_b.y < -1e-3 {
            return false;
        }
    }
    panic!("neither over nor back at {speed_m_s} m/s");
}

/// Measured tip speed against the closed form, less 1, sought `within` so much of it.
fn error(setup: &Setup, within: f64) -> f64 {
    let expected_m_s = closed_form_m_s(setup);
    let (mut stands, mut falls) = (1.0 - within, 1.0 + within);
    assert!(!tips(setup, stands * expected_m_s), "tips at {stands} of the closed form");
    assert!(tips(setup, falls * expected_m_s), "stands at {falls} of the closed form");
    while falls - stands > RESOLUTION {
        let middle = 0.5 * (stands + falls);
        if tips(setup, middle * expected_m_s) { falls = middle } else { stands = middle }
    }
    0.5 * (stands + falls) - 1.0
}

fn errors_percent(engine: ContactEngine, refinement: u32, cases: &[Case]) -> Vec<f64> {
    let error = |&(propellant_kg, slope_deg): &Case| {
        100.0 * error(&setup(engine, refinement, propellant_kg, slope_deg), 0.01)
    };
    cases.iter().map(error).collect()
}

fn claim(engine: ContactEngine, refinement: u32, bound_percent: f64, origin: &str, cases: &[Case]) {
    let slope = if cases == LEVEL { "level" } else { "downhill" };
    let engine_name = name(engine);
    Claim {
        id: &format!("tip-speed-{slope}-{engine_name}-{refinement}"),
        section: "Contact: tip-over",
        claim: &format!(
            "tip-over speed of captured pads over an edge, {slope}, {engine_name} engine, \
             refinement {refinement}"
        ),
        reference: "closed form (T.24), rigid gear",
        unit: "%",
        bound: Bound::AtMost(bound_percent),
        origin,
        noise: 100.0 * RESOLUTION,
    }
    .holds_for(errors_percent(engine, refinement, cases));
}

/// Propellant, kg, and slope, °.
type Case = (f64, f64);
const LEVEL: &[Case] = &[(0.0, 0.0), (WET_KG, 0.0)];
const DOWNHILL: &[Case] = &[(0.0, 5.0), (0.0, 10.0), (0.0, 12.0), (0.0, 15.0)];

#[test]
fn rapier_tips_over_at_the_closed_form_speed() {
    claim(Rapier, 1, 0.5, "acceptance list", LEVEL);
    claim(Rapier, 1, 0.5, "acceptance list", DOWNHILL);
}

#[test]
fn rapier_at_half_the_step_is_closer() {
    claim(Rapier, 2, 0.2, "acceptance list", LEVEL);
    claim(Rapier, 2, 0.2, "acceptance list", &DOWNHILL[1..2]);
}

#[test]
fn the_engines_agree_on_the_tip_speed() {
    let dry = &LEVEL[..1];
    let [rapier, strut] = [Rapier, Strut].map(|engine| errors_percent(engine, 1, dry)[0]);
    Claim {
        id: "tip-speed-of-engines",
        section: "Contact: tip-over",
        claim: "tip-over speed of the strut engine, level, over an edge, dry",
        reference: "the same with Rapier",
        unit: "%",
        bound: Bound::AtMost(1.0),
        origin: "acceptance list",
        noise: 100.0 * RESOLUTION,
    }
    .holds(strut - rapier);
}

#[test]
fn strut_tips_over_at_the_closed_form_speed() {
    claim(Strut, 1, 0.5, "acceptance list", LEVEL);
    claim(Strut, 1, 0.5, "acceptance list", DOWNHILL);
    claim(Strut, 2, 0.2, "acceptance list", LEVEL);
    claim(Strut, 2, 0.2, "acceptance list", DOWNHILL);
}
