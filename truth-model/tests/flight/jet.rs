//! Jet damping and Coriolis force against closed forms and against the balance of momentum.

use claims::{Bound, Claim};
use lander_models::vehicle::Vehicle;
use nalgebra::{Matrix3, Vector3};
use truth_model::flight::Motion;

use crate::common::symmetric_bug;
use crate::{aloft, burning, fly};

const THRUST_N: f64 = 2000.0;

/// Exit disc's squared radius of gyration across its axis, and its height.
fn nozzle(vehicle: &Vehicle) -> (f64, f64) {
    let engine = &vehicle.engine;
    (0.25 * engine.nozzle_exit_radius_m.powi(2), engine.nozzle_exit_height_m)
}

/// A minute's burn with a spin; the rate at its end and the moments of inertia about one axis.
fn burn(vehicle: &Vehicle, rate_b: Vector3<f64>, axis: usize) -> (f64, f64) {
    let mut start = aloft(85.5);
    start.rate_b = rate_b;
    let (start, drive) = burning(&start, THRUST_N);
    let end = fly(vehicle, &start, &drive, 0.0, 1e-3, 60_000);
    let inertia = |m: &Motion| vehicle.mass.at(m.propellant_kg).inertia_b[(axis, axis)];
    (end.rate_b[axis] / rate_b[axis], inertia(&end) / inertia(&start))
}

#[test]
fn a_rolling_rocket_speeds_up_as_propellant_leaves_through_the_axis() {
    // J ω' = (k² − R²/2) flow ω and J' = −k² flow give a power law.
    let vehicle = symmetric_bug();
    let (rate_ratio, inertia_ratio) = burn(&vehicle, Vector3::z() * 0.5, 2);
    let gyration_m2 = vehicle.mass.propellant.gyration_radius_b.z.powi(2);
    let expected = inertia_ratio.powf(-(1.0 - 2.0 * nozzle(&vehicle).0 / gyration_m2));
    assert!(expected > 1.05, "the burn changes the spin by {expected} only");
    Claim {
        id: "jet-roll",
        section: "Flight: jet",
        claim: "roll rate after a minute's burn, relative",
        reference: "power law of (T.51) about the jet's axis",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "60,000 roundings of 1e-16 and the step's 1e-13, with room",
        noise: 1e-12,
    }
    .holds(rate_ratio / expected - 1.0);
}

#[test]
fn a_pitching_rocket_slows_down_as_its_jet_carries_spin_away() {
    // Propellant at the centre of mass, so that the lever l to the exit stays: the power law of
    // J ω' = −(l² + R²/4 − k²) flow ω and J' = −k² flow.
    let mut vehicle = symmetric_bug();
    vehicle.mass.propellant.com_b = vehicle.mass.dry.com_b;
    let (rate_ratio, inertia_ratio) = burn(&vehicle, Vector3::x() * 0.02, 0);
    let gyration_m2 = vehicle.mass.propellant.gyration_radius_b.x.powi(2);
    let (disc_m2, exit_m) = nozzle(&vehicle);
    let lever_m2 = (vehicle.mass.dry.com_b.z - exit_m).powi(2);
    let expected = inertia_ratio.powf((lever_m2 + disc_m2 - gyration_m2) / gyration_m2);
    assert!(expected < 0.8, "the burn leaves {expected} of the rate");
    Claim {
        id: "jet-damping",
        section: "Flight: jet",
        claim: "pitch rate after a minute's burn, relative",
        reference: "power law of (T.51): jet damping",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "60,000 roundings of 1e-16 and the step's 1e-13, with room",
        noise: 1e-12,
    }
    .holds(rate_ratio / expected - 1.0);
}

/// Momentum and angular momentum about the world's origin of all that is inside the vehicle, the
/// flow on its way from tank to nozzle included.
fn contents(vehicle: &Vehicle, motion: &Motion, flow_kg_s: f64) -> [Vector3<f64>; 2] {
    let mass = vehicle.mass.at(motion.propellant_kg);
    let com_w = motion.point_position_w(&mass.com_b);
    let path_b = Vector3::z() * nozzle(vehicle).1 - vehicle.mass.propellant.com_b;
    let momentum_w = motion.point_velocity_w(&mass.com_b) * mass.mass_kg
        + motion.attitude_wb * path_b * flow_kg_s;
    let spin_w = motion.attitude_wb * (mass.inertia_b * motion.rate_b);
    [momentum_w, com_w.cross(&momentum_w) + spin_w]
}

#[test]
fn momentum_inside_changes_by_thrust_and_by_what_the_exhaust_takes_along() {
    // The integral form, where neither a Coriolis force nor a damping torque appears. Everything on
    // the axis, so that the flow inside has no angular momentum of its own.
    let vehicle = symmetric_bug();
    let mut start = aloft(85.5);
    start.position_w = Vector3::new(1.0, -2.0, 3.0);
    start.rate_b = Vector3::new(0.4, -0.9, 0.3);
    let (start, drive) = burning(&start, THRUST_N);
    let flow_kg_s = drive.engine_flow_kg_s(&vehicle, start.thrust_n);
    let step_s = 1e-3;
    let at = |steps| fly(&vehicle, &start, &drive, 0.0, step_s, steps);
    let (before, now, after) = (at(100), at(101), at(102));
    let [p0, h0] = contents(&vehicle, &before, flow_kg_s);
    let [p1, h1] = contents(&vehicle, &after, flow_kg_s);

    let (disc_m2, exit_m) = nozzle(&vehicle);
    let exit_b = Vector3::z() * exit_m;
    let exit_w = now.point_position_w(&exit_b);
    let thrust_w = now.attitude_wb * Vector3::z() * THRUST_N;
    let taken_w = now.point_velocity_w(&exit_b) * flow_kg_s;
    let disc_b = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 2.0)) * now.rate_b * disc_m2;
    let force_w = thrust_w - taken_w;
    let torque_w = exit_w.cross(&force_w) - now.attitude_wb * disc_b * flow_kg_s;
    // A central difference errs by h²/6 of the third derivative: 2e-7 of terms that turn at about
    // 1 rad/s, up to 6e3 N m.
    Claim {
        id: "jet-force",
        section: "Flight: jet",
        claim: "force that the momentum of a turning vehicle's contents grows by",
        reference: "thrust less what the exhaust takes along: no Coriolis term",
        unit: "N",
        bound: Bound::AtMost(2e-3),
        origin: "central difference over 1 ms",
        noise: 1e-6,
    }
    .holds(((p1 - p0) / (2.0 * step_s) - force_w).norm());
    let torque_error = ((h1 - h0) / (2.0 * step_s) - torque_w).norm();
    Claim {
        id: "jet-torque",
        section: "Flight: jet",
        claim: "torque that their angular momentum grows by",
        reference: "torque of the same",
        unit: "N m",
        bound: Bound::AtMost(8e-3),
        origin: "a hundredth of the damping, flow × lever² × rate",
        noise: 1e-6,
    }
    .holds(torque_error);
}
