//! Touchdowns that must be alike: scaled, mirrored, turned.

mod common;
mod scatter;

use claims::{Bound, Claim};
use common::{Setup, on_plane, rigid_bug, run_to_verdict, symmetric_bug};
use lander_models::vehicle::Leg;
use lander_models::{Outcome, Ticks};
use nalgebra::{UnitQuaternion, Vector3};
use scatter::{above_ground, count, touchdown};
use truth_model::State;

/// Full size over model of Langley's lunar landing models: about the ratio of the gravities, so
/// that speeds are equal.
const FROUDE: f64 = 6.03;

fn land(setup: &Setup, seconds: f64) -> State {
    let model = setup.model();
    let mut state = model.initial_state();
    state.airborne = true;
    run_to_verdict(&model, &mut state, seconds);
    state
}

/// The same touchdown `scale` times as large at equal speeds: lengths and times grow by the scale,
/// gravity and rates shrink by it, and at equal density masses grow by its cube.
fn scaled(setup: &Setup, scale: f64) -> Setup {
    let mut big = setup.clone();
    let mass_scale = scale.powi(3);
    let force_scale = mass_scale / scale;
    big.scenario.gravity_m_s2 /= scale;
    big.scenario.initial.position_w *= scale;
    big.scenario.initial.rate_b /= scale;
    big.scenario.initial.propellant_kg *= mass_scale;
    big.scenario.touchdown.slide_limit_m *= scale;
    big.scenario.stop_time = Ticks((setup.scenario.stop_time.0 as f64 * scale) as u64);
    let (dry, fuel) = (&mut big.vehicle.mass.dry, &mut big.vehicle.mass.propellant);
    dry.mass_kg *= mass_scale;
    dry.com_b *= scale;
    dry.inertia_kg_m2 *= mass_scale * scale * scale;
    fuel.capacity_kg *= mass_scale;
    fuel.com_b *= scale;
    fuel.gyration_radius_b *= scale;
    let (hull, engine) = (&mut big.vehicle.hull, &mut big.vehicle.engine);
    for length_m in [
        &mut hull.radius_m,
        &mut hull.bottom_height_m,
        &mut hull.top_height_m,
        &mut engine.nozzle_exit_radius_m,
        &mut engine.nozzle_exit_height_m,
        &mut engine.pivot_b.z,
        &mut big.vehicle.gear.pad_radius_m,
        &mut big.vehicle.gear.bearing_radius_m,
    ] {
        *length_m *= scale;
    }
    big.vehicle.gear.foot_mass_kg *= mass_scale;
    if let Some(lateral) = &mut big.vehicle.gear.lateral {
        lateral.stiffness_n_m *= force_scale / scale;
        lateral.damping_n_s_m *= force_scale;
    }
    for Leg { foot_b, strut, .. } in &mut big.vehicle.gear.legs {
        *foot_b *= scale;
        strut.stiffness_n_m *= force_scale / scale;
        strut.damping_n_s_m *= force_scale;
        strut.crush_1_n *= force_scale;
        strut.crush_2_n *= force_scale;
        strut.stroke_1_m *= scale;
        strut.stroke_max_m *= scale;
    }
    big
}

/// BUG, and BUG's 1/6.03 model's prototype: BUG is the model of a lander 6.03 times as large.
fn froude_pair(setup: &Setup, seconds: f64) -> (State, State) {
    (land(setup, seconds), land(&scaled(setup, FROUDE), seconds * FROUDE))
}

fn froude_claim<'a>(id: &'a str, claim: &'a str) -> Claim<'a> {
    Claim {
        id,
        section: "Contact: similarity",
        claim,
        reference: "Froude scaling: the same lander 6.03 times as large, equal speeds",
        unit: "%",
        bound: Bound::AtMost(2.0),
        origin: "acceptance list",
        noise: 0.0,
    }
}

#[test]
fn a_larger_lander_strokes_and_slides_in_proportion() {
    let mut strokes = Vec::new();
    let mut slides = Vec::new();
    // Strokes of 5 to 9 cm. Rapier's look-ahead costs the model 1 mm (README, "Limits"), which of
    // a shorter stroke is more than 2 %.
    for (friction, across_m_s, down_m_s, tilt_deg) in
        [(0.6, 0.0, 1.8, 0.0), (0.2, 1.5, 2.5, 0.0), (0.5, 1.2, 3.0, 8.0)]
    {
        let mut setup = on_plane(symmetric_bug(), 20.0);
        setup.scenario.terrain.friction = friction;
        let start = &mut setup.scenario.initial;
        start.velocity_w = Vector3::new(across_m_s, 0.0, -down_m_s);
        let tilt_rad = f64::to_radians(tilt_deg);
        start.attitude_wb = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt_rad);
        above_ground(&mut setup, 0.02);
        let (model, prototype) = froude_pair(&setup, 20.0);
        assert_eq!(model.touchdown.outcome, prototype.touchdown.outcome);
        let ratio = |of: &dyn Fn(&State) -> f64| of(&prototype) / (FROUDE * of(&model)) - 1.0;
        strokes.push(100.0 * ratio(&|state| state.touchdown.peak_stroke_m));
        if across_m_s > 0.0 {
            slides.push(100.0 * ratio(&|state| state.touchdown.slide_m));
        }
    }
    froude_claim("froude-stroke", "peak stroke of three touchdowns, 5 to 9 cm").holds_for(strokes);
    froude_claim("froude-slide", "slide distance of two touchdowns").holds_for(slides);
}

#[test]
fn a_larger_lander_tips_over_at_the_same_speed() {
    let tips = |scale: f64, speed_m_s: f64| {
        let mut setup = rigid_bug(0.0);
        setup.scenario.terrain.pads_captured = true;
        setup.scenario.initial.velocity_w.x = speed_m_s;
        land(&scaled(&setup, scale), 10.0 * scale).touchdown.outcome == Outcome::Tipped
    };
    let (mut stands, mut falls) = (1.9, 2.1);
    while falls - stands > 0.004 {
        let middle = 0.5 * (stands + falls);
        if tips(1.0, middle) { falls = middle } else { stands = middle }
    }
    // 1 % either way: half of what the acceptance list allows.
    let wrong = u32::from(tips(FROUDE, 0.99 * stands)) + u32::from(!tips(FROUDE, 1.01 * falls));
    Claim {
        unit: "",
        bound: Bound::AtMost(0.0),
        origin: "acceptance list: 2 %",
        ..froude_claim(
            "froude-tip-speed",
            "wrong classes of captured touchdowns 1 % below and above the model's tip-over speed",
        )
    }
    .holds(f64::from(wrong));
}

/// A random touchdown of a lander that is its own mirror image and looks the same turned by 90°.
fn symmetric_touchdown(number: u64) -> Setup {
    let mut setup = touchdown(number);
    let mut vehicle = symmetric_bug();
    vehicle.mass.dry.inertia_kg_m2.x = vehicle.mass.dry.inertia_kg_m2.y;
    vehicle.mass.propellant.gyration_radius_b.x = vehicle.mass.propellant.gyration_radius_b.y;
    setup.vehicle = vehicle;
    setup.scenario.terrain.pads_captured = false;
    above_ground(&mut setup, 0.01);
    setup
}

/// The touchdown seen in a mirror: world and body y change sign.
fn mirrored(setup: &Setup) -> Setup {
    let mut other = setup.clone();
    other.scenario.terrain.downhill_rad *= -1.0;
    let start = &mut other.scenario.initial;
    start.position_w.y *= -1.0;
    start.velocity_w.y *= -1.0;
    // A rotation's axis is an axial vector.
    let axial = Vector3::new(-1.0, 1.0, -1.0);
    start.rate_b.component_mul_assign(&axial);
    let turn = start.attitude_wb.scaled_axis().component_mul(&axial);
    start.attitude_wb = UnitQuaternion::from_scaled_axis(turn);
    other
}

fn quarter_turn() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2)
}

/// The touchdown turned about the vertical by 90°.
fn turned(setup: &Setup) -> Setup {
    let (mut other, turn) = (setup.clone(), quarter_turn());
    other.scenario.terrain.downhill_rad += std::f64::consts::FRAC_PI_2;
    let start = &mut other.scenario.initial;
    start.position_w = turn * start.position_w;
    start.velocity_w = turn * start.velocity_w;
    start.attitude_wb = turn * start.attitude_wb;
    other
}

/// The lander turned by 90° under the same touchdown: it looks the same, but other legs touch.
fn other_legs(setup: &Setup) -> Setup {
    let mut other = setup.clone();
    let (start, turn) = (&mut other.scenario.initial, quarter_turn());
    start.attitude_wb *= turn;
    start.rate_b = turn.inverse() * start.rate_b;
    other
}

/// How far off a touchdown ends that starts 0.1 mm/s faster or slower, m, and 1 mm at least.
fn sensitivity_m(setup: &Setup, place_w: &Vector3<f64>) -> f64 {
    const FLOOR_M: f64 = 1e-3;
    [-1e-4, 1e-4].into_iter().fold(FLOOR_M, |most_m: f64, faster_m_s| {
        let mut other = setup.clone();
        other.scenario.initial.velocity_w.x += faster_m_s;
        most_m.max((land(&other, 20.0).motion.position_w - place_w).norm())
    })
}

#[test]
fn mirrored_and_turned_touchdowns_are_the_same() {
    let mut classes_apart = 0_u32;
    let (mut turned_m, mut reordered) = (Vec::new(), Vec::new());
    for number in 0..count(8) {
        let setup = symmetric_touchdown(number);
        let original = land(&setup, 20.0);
        let place_w = original.motion.position_w;
        let mut apart_m = |twin: &Setup, expected_w: Vector3<f64>| {
            let end = land(twin, 20.0);
            classes_apart += u32::from(end.touchdown.outcome != original.touchdown.outcome);
            (end.motion.position_w - expected_w).norm()
        };
        turned_m.push(apart_m(&turned(&setup), quarter_turn() * place_w));
        let worth_m = sensitivity_m(&setup, &place_w);
        let mirror_w = place_w.component_mul(&Vector3::new(1.0, -1.0, 1.0));
        reordered.push(apart_m(&mirrored(&setup), mirror_w) / worth_m);
        reordered.push(apart_m(&other_legs(&setup), place_w) / worth_m);
    }
    let claim = Claim {
        id: "symmetry-class",
        section: "Contact: similarity",
        claim: "random touchdowns whose class changes when mirrored, turned by 90° or put on other legs",
        reference: "a lander of four-fold symmetry",
        unit: "",
        bound: Bound::AtMost(0.0),
        origin: "acceptance list",
        noise: 0.0,
    };
    claim.holds(f64::from(classes_apart));
    Claim {
        id: "symmetry-turned",
        claim: "distance between the ends of touchdowns turned by 90°",
        unit: "m",
        bound: Bound::AtMost(1e-6),
        origin: "rounding of the turn, 1e-16, which impacts and slides magnify",
        noise: 1e-8,
        ..claim
    }
    .holds_for(turned_m);
    Claim {
        id: "symmetry-reordered",
        claim: "distance between the ends of touchdowns mirrored or put on other legs, over what 0.1 mm/s \
                at the start do, or 1 mm",
        unit: "",
        bound: Bound::AtMost(2.0),
        origin: "the solver takes the feet in file order: what its sweeps leave is worth 0.1 mm/s, to a \
                 factor of two, and impacts magnify it",
        ..claim
    }
    .holds_for(reordered);
}
