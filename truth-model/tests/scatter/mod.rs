//! Random touchdowns, and the mechanical energy of a lander.
#![allow(dead_code)] // Each test binary uses its own part.

use lander_models::vehicle::{Leg, Vehicle};
use lander_models::{Ticks, time::TICK_S};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::contact::Contact;
use truth_model::random::uniform;
use truth_model::{State, TruthModel};

use crate::common::{Setup, bug, on_plane};

/// Natural frequency at which contact holds a pad on the ground (README, "Contact").
const PAD_FREQUENCY_HZ: f64 = 500.0;
/// Radius of BUG's footprint, m.
pub const FOOT_CIRCLE_M: f64 = 1.885;

/// How many touchdowns to draw: `default`, or more by the environment's `TOUCHDOWNS`.
pub fn count(default: u64) -> u64 {
    std::env::var("TOUCHDOWNS").ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// The vehicle on `count` upright legs evenly round its footprint circle.
pub fn on_legs(mut vehicle: Vehicle, count: usize) -> Vehicle {
    let leg = vehicle.gear.legs[0].clone();
    vehicle.gear.legs = (0..count)
        .map(|n| {
            let angle_rad = (n as f64 + 0.5) * std::f64::consts::TAU / count as f64;
            let foot_b = Vector3::new(angle_rad.cos(), angle_rad.sin(), 0.0) * FOOT_CIRCLE_M;
            Leg { foot_b, ..leg.clone() }
        })
        .collect();
    vehicle
}

/// Touchdown `number`, just clear of the ground, with everything drawn that a landing may bring:
/// 4 m/s down, 3 m/s across, 20° of tilt, 30°/s about each axis, slopes to 20°.
pub fn touchdown(number: u64) -> Setup {
    let draw = |name: &str, low: f64, high: f64| low + (high - low) * uniform(1, name, number);
    let legs = draw("legs", 3.0, 7.0) as usize;
    let mut setup = on_plane(on_legs(bug(), legs), draw("propellant", 0.0, 85.0));
    let terrain = &mut setup.scenario.terrain;
    terrain.slope_rad = draw("slope", 0.0, 20.0).to_radians();
    terrain.downhill_rad = draw("downhill", 0.0, std::f64::consts::TAU);
    terrain.friction = draw("friction", 0.2, 1.0);
    terrain.pads_captured = draw("captured", 0.0, 1.0) < 0.2;
    let start = &mut setup.scenario.initial;
    let travel_rad = draw("travel", 0.0, std::f64::consts::TAU);
    let across_m_s = draw("across", 0.0, 3.0);
    start.velocity_w = Vector3::new(travel_rad.cos(), travel_rad.sin(), 0.0) * across_m_s
        - Vector3::z() * draw("down", 0.0, 4.0);
    let (lean_rad, tilt_rad) =
        (draw("lean", 0.0, std::f64::consts::TAU), draw("tilt", 0.0, 20.0).to_radians());
    let tilt = Vector3::new(lean_rad.cos(), lean_rad.sin(), 0.0) * tilt_rad;
    let yaw = UnitQuaternion::from_axis_angle(
        &Vector3::z_axis(),
        draw("yaw", 0.0, std::f64::consts::TAU),
    );
    start.attitude_wb = UnitQuaternion::from_scaled_axis(tilt) * yaw;
    start.rate_b =
        Vector3::new(draw("roll", -1.0, 1.0), draw("pitch", -1.0, 1.0), draw("turn", -1.0, 1.0))
            .map(|share| 30_f64.to_radians() * share);
    setup.scenario.stop_time = Ticks(6000);
    above_ground(&mut setup, 0.01);
    setup
}

/// Lifts the start until its lowest point is `gap_m` clear of the ground.
pub fn above_ground(setup: &mut Setup, gap_m: f64) {
    let model = setup.model();
    let short_m = gap_m - model.lowest_m(&model.initial_state());
    setup.scenario.initial.position_w.z += short_m / model.scenario().terrain.slope_rad.cos();
}

/// Kinetic, potential and elastic energy, J; the potential counts from the world's origin.
///
/// `before` is the state a tick earlier, for the feet's speed along their struts.
pub fn mechanical_energy_j(model: &TruthModel, before: &State, state: &State) -> f64 {
    let (vehicle, motion) = (model.vehicle(), &state.motion);
    let gravity_m_s2 = model.scenario().gravity_m_s2;
    let mass = vehicle.mass.at(motion.propellant_kg);
    let weight_n = mass.mass_kg * gravity_m_s2;
    // As one rigid body with the feet at free length ...
    let velocity_w = model.com_velocity_w(motion);
    let spin_j = 0.5 * motion.rate_b.dot(&(mass.inertia_b * motion.rate_b));
    let rigid_j = 0.5 * mass.mass_kg * velocity_w.norm_squared()
        + spin_j
        + weight_n * motion.point_position_w(&mass.com_b).z;
    // ... corrected for where the feet are, how they move, and what struts and pads store.
    let gear = &vehicle.gear;
    let grips_j = match &state.contact {
        Some(Contact::Strut(contact)) => contact.grip_energy_j(),
        _ => 0.0,
    };
    let strokes = gear.legs.iter().zip(before.legs.iter().zip(&state.legs));
    let legs_j: f64 = strokes
        .map(|(leg, (was, now))| {
            let free_b = gear.pad_centre_b(leg);
            let stroke_b = leg.stroke_axis_b * now.stroke_m;
            let stroke_rate_m_s = (now.stroke_m - was.stroke_m) / TICK_S;
            let axis_w = motion.attitude_wb * leg.stroke_axis_b;
            let speed_w = motion.point_velocity_w(&(free_b + stroke_b)) + axis_w * stroke_rate_m_s;
            let free_speed_w = motion.point_velocity_w(&free_b);
            let kinetic_j =
                0.5 * gear.foot_mass_kg * (speed_w.norm_squared() - free_speed_w.norm_squared());
            let lift_j = gear.foot_mass_kg * gravity_m_s2 * now.stroke_m * axis_w.z;
            let strain_m = now.stroke_m - now.crushed_m;
            kinetic_j + lift_j + 0.5 * leg.strut.stiffness_n_m * strain_m * strain_m
        })
        .sum();
    rigid_j + legs_j + grips_j + pressed_j(model, state)
}

/// What the pads' hold on the ground stores, by their depth.
fn pressed_j(model: &TruthModel, state: &State) -> f64 {
    let pad_kg = model.vehicle().gear.foot_mass_kg;
    let pad_n_m = pad_kg * (std::f64::consts::TAU * PAD_FREQUENCY_HZ).powi(2);
    let depths_m = model.foot_clearances_m(state).map(|clearance_m| clearance_m.min(0.0));
    depths_m.map(|depth_m| 0.5 * pad_n_m * depth_m * depth_m).sum()
}

/// Most that ground, stops and braces may store, which only their engine knows: the pads' share by
/// their depth; anything while hull or nozzle touch or a strut is beyond its stop.
pub fn stored_at_most_j(model: &TruthModel, state: &State) -> f64 {
    let structure_m = model.structure_clearance_m(&state.motion);
    let legs = model.vehicle().gear.legs.iter().zip(&state.legs);
    let beyond_stop = legs.into_iter().any(|(leg, now)| now.stroke_m > leg.strut.stroke_max_m);
    if beyond_stop || structure_m.hull.min(structure_m.nozzle) <= 0.0 {
        return f64::INFINITY;
    }
    let braces_j = match &state.contact {
        Some(Contact::Rapier(_)) => braces_j(model, state),
        _ => 0.0,
    };
    pressed_j(model, state) + braces_j
}

/// What legs store across their strokes, by the ground's force on their pads.
fn braces_j(model: &TruthModel, state: &State) -> f64 {
    let gear = &model.vehicle().gear;
    let Some(lateral) = gear.lateral else { return 0.0 };
    let across_n2 = gear.legs.iter().zip(&state.legs).map(|(leg, now)| {
        let axis_w = state.motion.attitude_wb * leg.stroke_axis_b;
        (now.ground_force_w - axis_w * axis_w.dot(&now.ground_force_w)).norm_squared()
    });
    across_n2.sum::<f64>() / (2.0 * lateral.stiffness_n_m)
}
