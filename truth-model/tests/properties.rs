//! Random touchdowns: whatever is drawn, the motion stays finite, nothing sinks through the ground,
//! no energy comes from nothing, and there is a verdict. `TOUCHDOWNS=1000` draws more than the
//! default; a failure names the touchdown's number.

mod common;
mod scatter;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use lander_models::scenario::ContactEngine;
use scatter::{count, mechanical_energy_j, stored_at_most_j, touchdown};
use truth_model::State;

/// What one touchdown came to, at its worst.
#[derive(Default)]
struct Worst {
    /// A strut bottomed out, or hull or nozzle touched.
    struck: bool,
    captured: bool,
    /// Growth of the energy above its least value so far, % of the energy at the start.
    growth_percent: f64,
    /// Depth of the lowest point of pads, hull and nozzle.
    depth_m: f64,
}

/// Runs touchdown `number` to its verdict.
fn run(engine: ContactEngine, number: u64) -> Worst {
    let model = touchdown(number).on(engine, 1).model();
    let mut state = model.initial_state();
    let mut before: State = state.clone();
    let start_j = mechanical_energy_j(&model, &before, &state);
    let mut least_j = start_j;
    let captured = model.scenario().terrain.pads_captured;
    let mut worst = Worst::default();
    loop {
        before.legs.clone_from(&state.legs);
        let report = model.tick(&mut state).unwrap_or_else(|error| panic!("{number}: {error}"));
        let finite = state.legs.iter().all(|leg| {
            leg.stroke_m.is_finite() && leg.crushed_m.is_finite() && leg.load_n.is_finite()
        });
        assert!(finite && state.motion.is_finite(), "{number}: {:?}", state.motion);
        if stored_at_most_j(&model, &state) < 1e-4 * start_j {
            let energy_j = mechanical_energy_j(&model, &before, &state);
            least_j = least_j.min(energy_j);
            worst.growth_percent = worst.growth_percent.max(100.0 * (energy_j - least_j) / start_j);
        }
        worst.depth_m = worst.depth_m.max(-model.lowest_m(&state));
        if report.terminate {
            assert!(state.touchdown.decided(), "{number} ended without a verdict");
            worst.struck = state.touchdown.struck.any() || state.touchdown.bottomed;
            worst.captured = captured;
            let Worst { growth_percent, depth_m, .. } = worst;
            println!("{number}: {growth_percent:.4} % {:.2} mm captured {captured}", 1e3 * depth_m);
            return worst;
        }
    }
}

#[test]
fn random_touchdowns_are_finite_hold_the_ground_and_make_no_energy() {
    for engine in ENGINES {
        hold_the_ground_and_make_no_energy(
            engine,
            (0..count(60)).map(|n| run(engine, n)).collect(),
        );
    }
}

fn hold_the_ground_and_make_no_energy(engine: ContactEngine, worst: Vec<Worst>) {
    let engine = name(engine);
    let claim = Claim {
        id: &format!("random-depth-{engine}"),
        section: "Contact: random touchdowns",
        claim: &format!(
            "deepest that a sliding pad sinks while struts have stroke: 3 to 6 legs, 4 m/s down, \
             3 m/s across, tilt and slope to 20°, μ 0.2 to 1, {engine} engine"
        ),
        reference: "rigid ground",
        unit: "mm",
        bound: Bound::AtMost(1.3),
        origin: "pads are held at 500 Hz: an impact at 4 m/s goes v/ω = 1.3 mm deep",
        noise: 0.0,
    };
    let depth = |struck: bool, captured: &'static [bool]| {
        let runs = worst.iter();
        let runs = runs.filter(move |run| run.struck == struck && captured.contains(&run.captured));
        runs.map(|run| 1e3 * run.depth_m)
    };
    claim.holds_for(depth(false, &[false]));
    Claim {
        id: &format!("random-depth-captured-{engine}"),
        claim: &format!("the same of a captured pad, {engine} engine"),
        bound: Bound::AtMost(3.4),
        origin: "the same, and v √(k m/3) sin 40° over the pad's stiffness, 2.1 mm: what a third of \
                 the vehicle at 3 m/s presses through a leg of k across its stroke, tilt and slope \
                 together",
        ..claim
    }
    .holds_for(depth(false, &[true]));
    Claim {
        id: &format!("random-depth-struck-{engine}"),
        claim: &format!("the same, and hull and nozzle, when a strut bottoms out or the hull strikes, {engine} engine"),
        bound: Bound::AtMost(20.0),
        origin: "a pad's radius: its centre stays above ground, so nothing tunnels",
        ..claim
    }
    .holds_for(depth(true, &[false, true]));
    let growth = |struck: bool| {
        let runs = worst.iter().filter(move |run| run.struck == struck);
        runs.map(|run| run.growth_percent)
    };
    let energy = Claim {
        id: &format!("random-energy-{engine}"),
        claim: &format!(
            "growth of kinetic, potential and elastic energy over its least so far, sliding and \
             captured pads, while struts have stroke, {engine} engine"
        ),
        reference: "first law of thermodynamics",
        unit: "%",
        bound: Bound::AtMost(0.1),
        origin: "acceptance list; of the energy at the start",
        ..claim
    };
    energy.holds_for(growth(false));
    Claim {
        id: &format!("random-energy-struck-{engine}"),
        claim: &format!(
            "the same, when a strut bottoms out or the hull strikes, at all instants at which \
             ground and stops store less than 0.01 %, {engine} engine"
        ),
        ..energy
    }
    .holds_for(growth(true));
}
