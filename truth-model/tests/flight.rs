//! Flight against closed forms: torque-free motion, the rocket equation, constant thrust.

mod common;

use common::{GRAVITY_M_S2, bug, on_plane};
use lander_models::vehicle::G0_M_S2;
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use truth_model::flight::{Motion, advance, free};
use truth_model::propulsion::Drive;

fn aloft(propellant_kg: f64) -> Motion {
    let mut motion = on_plane(bug(), propellant_kg).model().initial_state().motion;
    motion.position_w.z = 1e4;
    motion
}

fn fly(motion: &Motion, drive: &Drive, gravity_m_s2: f64, step_s: f64, steps: usize) -> Motion {
    let (vehicle, gravity_w) = (bug(), Vector3::z() * -gravity_m_s2);
    (0..steps).fold(*motion, |m, _| advance(&vehicle, &gravity_w, &m, drive, step_s, free))
}

/// Angular momentum about the centre of mass, world frame.
fn spin_w(motion: &Motion) -> Vector3<f64> {
    let inertia_b = bug().mass.at(motion.propellant_kg).inertia_b;
    motion.attitude_wb * (inertia_b * motion.rate_b)
}

#[test]
fn torque_free_tumbling_keeps_energy_momentum_and_the_path_of_the_centre_of_mass() {
    let mut start = aloft(40.0);
    start.rate_b = Vector3::new(0.4, -0.9, 0.3);
    let end = fly(&start, &Drive::default(), 0.0, 1e-3, 60_000);
    let mass = bug().mass.at(40.0);
    let energy = |m: &Motion| 0.5 * m.rate_b.dot(&(mass.inertia_b * m.rate_b));
    // Origin: the acceptance list's 1e-9; fourth order at 1 ms leaves about 1e-13.
    assert!((energy(&end) / energy(&start) - 1.0).abs() < 1e-9);
    assert!((spin_w(&end) - spin_w(&start)).norm() / spin_w(&start).norm() < 1e-9);
    let com_w = |m: &Motion| m.point_position_w(&mass.com_b);
    let drift_w = com_w(&end) - com_w(&start) - start.point_velocity_w(&mass.com_b) * 60.0;
    // Metre-sized numbers, 60,000 roundings near 1e4 m (2e-12 each), adding at random.
    assert!(drift_w.norm() < 1e-8, "centre of mass drifted by {} m", drift_w.norm());
}

#[test]
fn the_rocket_equation_holds_over_a_long_burn() {
    let vehicle = bug();
    let thrust_n = 3000.0;
    let mut start = aloft(85.5);
    start.thrust_n = thrust_n;
    // A thrust line through the centre of mass at every fill: only the speed is of interest.
    let mut balanced = vehicle.clone();
    balanced.mass.dry.com_b = Vector3::new(0.0, 0.0, 1.38);
    balanced.mass.propellant.com_b = Vector3::new(0.0, 0.0, 1.65);
    let drive = Drive { thrust_target_n: thrust_n, ..Drive::default() };
    let end = (0..30_000)
        .fold(start, |m, _| advance(&balanced, &Vector3::zeros(), &m, &drive, 1e-3, free));
    let (m0, m1) = (vehicle.mass.wet_mass_kg(), vehicle.mass.dry.mass_kg + end.propellant_kg);
    let burnt_kg = thrust_n / (225.0 * G0_M_S2) * 30.0;
    assert!((m0 - m1 - burnt_kg).abs() < 1e-9 * burnt_kg);
    let expected_m_s = 225.0 * G0_M_S2 * (m0 / m1).ln();
    assert!((end.velocity_w.z / expected_m_s - 1.0).abs() < 1e-9, "{}", end.velocity_w.z);
}

#[test]
fn the_step_converges_at_fourth_order() {
    let mut start = aloft(85.5);
    start.attitude_wb = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
    start.rate_b = Vector3::new(0.02, 0.05, -0.03);
    // Small gimbal steps stay below the rate limit: its corner, a jump in the second derivative,
    // would show as third order.
    let drive = Drive {
        thrust_target_n: 2500.0,
        gimbal_target_rad: Vector2::new(0.01, -0.005),
        rcs_torque_b: Vector3::new(5.0, -3.0, 2.0),
    };
    let at =
        |step_s: f64| fly(&start, &drive, GRAVITY_M_S2, step_s, (2.0 / step_s).round() as usize);
    let reference = at(5e-4);
    let error = |step_s| (at(step_s).position_w - reference.position_w).norm();
    let order = (error(0.02) / error(0.01)).log2();
    // Acceptance of the plant: at least 3.8.
    assert!(order > 3.8, "observed order {order}");
}
