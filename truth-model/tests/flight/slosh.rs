//! Slosh: conservation, natural frequency, damping, limits, order of the step.

use claims::{Bound, Claim};
use lander_models::vehicle::{G0_M_S2, Slosh, Vehicle};
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use truth_model::flight::Motion;
use truth_model::propulsion::Drive;
use truth_model::slosh::{Pendulums, bobs, rest, set_bobs};

use crate::common::{GRAVITY_M_S2, bug, symmetric_bug};
use crate::{aloft, burning, fly};

fn sloshing(vehicle: &Vehicle, propellant_kg: f64) -> Motion {
    let slosh = Pendulums::hanging(vehicle.slosh.as_ref().unwrap());
    Motion { slosh, ..aloft(propellant_kg) }
}

/// BUG with other slosh than the file's.
fn bug_with(change: impl Fn(&mut Slosh)) -> Vehicle {
    let mut vehicle = bug();
    change(vehicle.slosh.as_mut().unwrap());
    vehicle
}

/// Energy without gravity's, momentum, and angular momentum about the world's origin.
fn conserved(vehicle: &Vehicle, motion: &Motion) -> (f64, Vector3<f64>, Vector3<f64>) {
    let rest = rest(vehicle, motion);
    let spin_b = rest.inertia_b * motion.rate_b;
    let velocity_w = motion.point_velocity_w(&rest.com_b);
    let mut energy_j =
        0.5 * (motion.rate_b.dot(&spin_b) + rest.mass_kg * velocity_w.norm_squared());
    let mut momentum_w = velocity_w * rest.mass_kg;
    let mut angular_w =
        motion.attitude_wb * spin_b + motion.point_position_w(&rest.com_b).cross(&momentum_w);
    for bob in bobs(vehicle, motion) {
        energy_j += 0.5 * bob.mass_kg * bob.velocity_w.norm_squared();
        momentum_w += bob.velocity_w * bob.mass_kg;
        angular_w += bob.position_w.cross(&(bob.velocity_w * bob.mass_kg));
    }
    (energy_j, momentum_w, angular_w)
}

#[test]
fn hanging_bobs_and_the_rest_are_the_whole_vehicle() {
    let vehicle = bug();
    let motion = sloshing(&vehicle, 50.0);
    let (whole, rest) = (vehicle.mass.at(50.0), rest(&vehicle, &motion));
    let swinging_kg: f64 = bobs(&vehicle, &motion).map(|bob| bob.mass_kg).sum();
    // Roundings of numbers up to 1e4.
    assert!((rest.mass_kg + swinging_kg - whole.mass_kg).abs() < 1e-12);
    assert!((swinging_kg - 0.6 * 50.0).abs() < 1e-12);
    let spinning = Motion { rate_b: Vector3::new(0.3, 0.5, -0.2), ..motion };
    let (energy_j, momentum_w, _) = conserved(&vehicle, &spinning);
    let com_velocity_w = spinning.point_velocity_w(&whole.com_b);
    let expected_j = 0.5
        * (spinning.rate_b.dot(&(whole.inertia_b * spinning.rate_b))
            + whole.mass_kg * com_velocity_w.norm_squared());
    assert!((energy_j / expected_j - 1.0).abs() < 1e-12);
    assert!((momentum_w - com_velocity_w * whole.mass_kg).norm() < 1e-10);
}

#[test]
fn a_tumbling_vehicle_with_free_bobs_keeps_energy_and_momentum() {
    let vehicle = bug_with(|slosh| slosh.damping_ratio = 0.0);
    let mut start = sloshing(&vehicle, 50.0);
    // Near the origin: angular momentum about it would lose digits from 10 km.
    start.position_w = Vector3::zeros();
    start.rate_b = Vector3::new(0.4, -0.9, 0.7);
    start.slosh.excite(1.2, 2.0, 0.5);
    let end = fly(&vehicle, &start, &Drive::default(), 0.0, 1e-3, 60_000);
    let (energy_0, momentum_0, angular_0) = conserved(&vehicle, &start);
    let (energy_1, momentum_1, angular_1) = conserved(&vehicle, &end);
    // The bobs went somewhere, or nothing was tested.
    let angle = |m: &Motion| m.slosh.as_slice()[0].direction_b;
    assert!((angle(&end) - angle(&start)).norm() > 0.1);
    Claim {
        id: "slosh-energy",
        section: "Flight: slosh",
        claim: "relative change of energy, body and undamped bobs tumbling for 60 s",
        reference: "conservation of energy",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list, as for a rigid body",
        noise: 1e-11,
    }
    .holds(energy_1 / energy_0 - 1.0);
    Claim {
        id: "slosh-momentum",
        section: "Flight: slosh",
        claim: "relative change of momentum and of angular momentum in the same",
        reference: "conservation of both",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list, as for a rigid body",
        noise: 1e-11,
    }
    .holds_for([
        (momentum_1 - momentum_0).norm() / momentum_0.norm(),
        (angular_1 - angular_0).norm() / angular_0.norm(),
    ]);
}

/// Symmetric vehicle with one tank on its axis, and an engine that uses no propellant.
fn one_tank(change: impl Fn(&mut Slosh)) -> Vehicle {
    let mut vehicle = symmetric_bug();
    vehicle.engine.isp_s = 1e15;
    let slosh = vehicle.slosh.as_mut().unwrap();
    slosh.hinges_b = vec![Vector3::new(0.0, 0.0, 1.75)];
    change(slosh);
    vehicle
}

/// Swing angle towards body x at the end of every step.
fn swings(vehicle: &Vehicle, thrust_n: f64, step_s: f64, steps: usize) -> Vec<f64> {
    let mut start = sloshing(vehicle, 60.0);
    // Small: a pendulum's period grows by (angle/4)², 6e-10 here.
    start.slosh.excite(1e-4, 0.0, 0.0);
    let (mut motion, drive) = burning(&start, thrust_n);
    (0..steps)
        .map(|_| {
            motion = fly(vehicle, &motion, &drive, 0.0, step_s, 1);
            motion.slosh.as_slice()[0].direction_b.x
        })
        .collect()
}

#[test]
fn the_natural_frequency_is_that_of_body_and_pendulum_together() {
    let vehicle = one_tank(|slosh| slosh.damping_ratio = 0.0);
    let (tanks, thrust_n, step_s) = (vehicle.slosh.as_ref().unwrap(), 2000.0, 1e-3);
    let angles = swings(&vehicle, thrust_n, step_s, 20_000);
    // (T.57)
    let rest = rest(&vehicle, &sloshing(&vehicle, 60.0));
    let bob_kg = tanks.bob_kg(60.0);
    let (length_m, above_m) = (tanks.length_m, 1.75 - rest.com_b.z);
    let coupling =
        1.0 + bob_kg / rest.mass_kg + bob_kg * above_m * (above_m - length_m) / rest.inertia_b.m22;
    let acceleration_m_s2 = thrust_n / (rest.mass_kg + bob_kg);
    let omega_rad_s = (acceleration_m_s2 / length_m * coupling).sqrt();
    let crossings: Vec<f64> = (1..angles.len())
        .filter(|n| angles[n - 1].signum() != angles[*n].signum())
        .map(|n| (n as f64 + angles[n - 1] / (angles[n - 1] - angles[n])) * step_s)
        .collect();
    let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
    let measured_rad_s = std::f64::consts::PI * (crossings.len() - 1) as f64 / (last - first);
    assert!(coupling > 1.15, "the coupling of {coupling} would not show");
    Claim {
        id: "slosh-frequency",
        section: "Flight: slosh",
        claim: "natural frequency of body and pendulum together, relative",
        reference: "closed form (T.57)",
        unit: "",
        bound: Bound::AtMost(1e-8),
        origin: "a crossing between two samples is missed by (ω h)²/24 of a step: 1e-8 s in 20 s",
        noise: 0.0,
    }
    .holds(measured_rad_s / omega_rad_s - 1.0);
}

#[test]
fn the_drag_takes_what_its_damping_ratio_says() {
    // A light bob under Earth's gravity, where the ratio is defined: a simple damped pendulum.
    let vehicle = one_tank(|slosh| slosh.share = 1e-9);
    let thrust_n = G0_M_S2 * vehicle.mass.at(60.0).mass_kg;
    let tanks = vehicle.slosh.as_ref().unwrap();
    let (ratio, omega_rad_s) = (tanks.damping_ratio, (G0_M_S2 / tanks.length_m).sqrt());
    let damped_rad_s = omega_rad_s * (1.0 - ratio * ratio).sqrt();
    let step_s = std::f64::consts::TAU / damped_rad_s / 1000.0;
    let angles = swings(&vehicle, thrust_n, step_s, 10_000);
    let expected =
        1e-4 * (-std::f64::consts::TAU * 10.0 * ratio / (1.0 - ratio * ratio).sqrt()).exp();
    Claim {
        id: "slosh-damping",
        section: "Flight: slosh",
        claim: "swing left after ten periods, relative",
        reference: "damped oscillator of the file's ratio",
        unit: "",
        bound: Bound::AtMost(1e-6),
        origin: "the swing's nonlinearity, (angle/4)² of the period, stays far below",
        noise: 1e-9,
    }
    .holds(angles[9_999] / expected - 1.0);
}

fn gimballed(start: &Motion) -> (Motion, Drive) {
    let mut start = *start;
    start.rate_b = Vector3::new(0.02, 0.05, -0.03);
    start.attitude_wb = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
    let drive = Drive {
        thrust_target_n: 2500.0,
        gimbal_target_rad: Vector2::new(0.01, -0.005),
        rcs_torque_b: Vector3::new(5.0, -3.0, 2.0),
        ..Drive::default()
    };
    (start, drive)
}

#[test]
fn bobs_without_mass_and_rods_without_length_leave_a_rigid_vehicle() {
    let (start, drive) = gimballed(&aloft(60.0));
    let rigid = fly(&bug(), &start, &drive, GRAVITY_M_S2, 1e-3, 5_000);
    let end = |vehicle: &Vehicle| {
        let slosh = Pendulums::hanging(vehicle.slosh.as_ref().unwrap());
        fly(vehicle, &Motion { slosh, ..start }, &drive, GRAVITY_M_S2, 1e-3, 5_000)
    };
    let massless = end(&bug_with(|slosh| slosh.share = 0.0));
    // Another order of the same roundings, 5,000 of them near 1e4 m.
    assert!((massless.position_w - rigid.position_w).norm() < 1e-9);
    assert!((massless.rate_b - rigid.rate_b).norm() < 1e-12);
    // A rod of length L changes levers of about 0.3 m by up to L, so the error is linear in L, to
    // within 1 % for 2 mm: two lengths extrapolate to none at L = 0.
    let error_w = |length_m| {
        let short = bug_with(|slosh| slosh.length_m = length_m);
        end(&short).position_w - rigid.position_w
    };
    let (long_w, short_w) = (error_w(2e-3), error_w(1e-3));
    let left_m = (short_w * 2.0 - long_w).norm();
    assert!(left_m < 0.01 * long_w.norm(), "{left_m} m of {} m are left", long_w.norm());
}

#[test]
fn the_step_converges_at_fourth_order_with_slosh() {
    let vehicle = bug();
    let mut start = sloshing(&vehicle, 60.0);
    start.slosh.excite(0.3, 0.5, 1.0);
    let (start, drive) = gimballed(&start);
    let at = |step_s: f64| {
        fly(&vehicle, &start, &drive, GRAVITY_M_S2, step_s, (2.0 / step_s).round() as usize)
    };
    let reference = at(5e-4);
    let error = |step_s| {
        let end = at(step_s);
        let bob = |m: &Motion| m.slosh.as_slice()[0].direction_b;
        (end.position_w - reference.position_w).norm() + (bob(&end) - bob(&reference)).norm()
    };
    let order = (error(0.02) / error(0.01)).log2();
    Claim {
        id: "slosh-order",
        section: "Flight: slosh",
        claim: "order in which the error falls with the step, 20 to 10 ms",
        reference: "4: classical Runge-Kutta",
        unit: "",
        bound: Bound::AtLeast(3.8),
        origin: "acceptance list",
        noise: 0.0,
    }
    .holds(order);
}

#[test]
fn bobs_survive_the_way_to_world_coordinates_and_back() {
    let vehicle = bug();
    let mut motion = sloshing(&vehicle, 60.0);
    motion.velocity_w = Vector3::new(-15.0, -5.0, -25.0);
    motion.slosh.excite(0.3, 0.5, 1.0);
    let (motion, _) = gimballed(&motion);
    assert!((motion.slosh.angle_rad() - 0.3).abs() < 1e-15);
    let seen: Vec<_> =
        bobs(&vehicle, &motion).map(|bob| (bob.position_w, bob.velocity_w)).collect();
    let mut back = Motion { slosh: Pendulums::hanging(vehicle.slosh.as_ref().unwrap()), ..motion };
    set_bobs(&vehicle, &mut back, seen);
    for (one, other) in back.slosh.as_slice().iter().zip(motion.slosh.as_slice()) {
        // Positions near 1e4 m lose 2e-12 m, over a rod of 0.135 m.
        assert!((one.direction_b - other.direction_b).norm() < 1e-10);
        assert!((one.swing_b - other.swing_b).norm() < 1e-10);
    }
}
