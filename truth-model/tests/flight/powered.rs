//! Powered flight: the rocket equation, constant thrust, order of the step, mass that only goes.

use lander_models::vehicle::{G0_M_S2, Vehicle};
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use truth_model::flight::{Motion, advance, free};
use truth_model::propulsion::Drive;

use crate::common::{GRAVITY_M_S2, bug, symmetric_bug};
use crate::{aloft, burning, fly};

#[test]
fn the_rocket_equation_holds_over_a_long_burn() {
    let vehicle = symmetric_bug();
    let thrust_n = 3000.0;
    let (start, drive) = burning(&aloft(85.5), thrust_n);
    let end = fly(&vehicle, &start, &drive, 0.0, 1e-3, 30_000);
    let (m0, m1) = (vehicle.mass.wet_mass_kg(), vehicle.mass.dry.mass_kg + end.propellant_kg);
    let burnt_kg = thrust_n / (225.0 * G0_M_S2) * 30.0;
    // The acceptance list's bound; 30,000 roundings leave about 1e-12.
    assert!((m0 - m1 - burnt_kg).abs() < 1e-9 * burnt_kg);
    let expected_m_s = 225.0 * G0_M_S2 * (m0 / m1).ln();
    assert!((end.velocity_w.z / expected_m_s - 1.0).abs() < 1e-9, "{}", end.velocity_w.z);
}

#[test]
fn sixty_seconds_of_constant_thrust_end_where_the_closed_form_says() {
    let (thrust_n, time_s) = (2000.0, 60.0);
    let mut start = aloft(85.5);
    start.attitude_wb = UnitQuaternion::from_euler_angles(0.3, -0.4, 0.5);
    start.velocity_w = Vector3::new(-15.0, -5.0, -25.0);
    let (start, drive) = burning(&start, thrust_n);
    let end = fly(&symmetric_bug(), &start, &drive, GRAVITY_M_S2, 1e-3, 60_000);
    // Twice integrated rocket equation along the held axis, and a parabola.
    let exhaust_m_s = 225.0 * G0_M_S2;
    let (m0, flow_kg_s) = (259.5, thrust_n / exhaust_m_s);
    let m1 = m0 - flow_kg_s * time_s;
    let along_m = exhaust_m_s * (time_s + m1 / flow_kg_s * (m1 / m0).ln());
    let expected_w =
        start.position_w + start.velocity_w * time_s + start.attitude_wb * (Vector3::z() * along_m)
            - Vector3::z() * (0.5 * GRAVITY_M_S2 * time_s * time_s);
    let error_m = (end.position_w - expected_w).norm();
    // The acceptance list's bound; 60,000 roundings near 1e4 m (2e-12 each) leave about 1e-8.
    assert!(error_m < 1e-6, "{error_m} m");
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
        ..Drive::default()
    };
    let at = |step_s: f64| {
        fly(&bug(), &start, &drive, GRAVITY_M_S2, step_s, (2.0 / step_s).round() as usize)
    };
    let reference = at(5e-4);
    let error = |step_s| (at(step_s).position_w - reference.position_w).norm();
    let order = (error(0.02) / error(0.01)).log2();
    // Acceptance of the plant: at least 3.8.
    assert!(order > 3.8, "observed order {order}");
}

/// A second during which a quarter of the propellant goes, without any flow that pushes.
fn lose_propellant(vehicle: &Vehicle, start: &Motion) -> Motion {
    (0..1000).fold(*start, |mut motion, _| {
        motion.propellant_kg -= 0.02;
        advance(vehicle, &Vector3::zeros(), &motion, &Drive::default(), 1e-3, free)
    })
}

#[test]
fn mass_that_goes_without_a_force_moves_and_turns_nothing() {
    let velocity_w = Vector3::new(3.0, -2.0, 1.0);
    // The centre of mass wanders sideways while the vehicle doesn't turn, then along the axis that
    // it spins about. 1e-12: the acceptance list's bound, absolute, on metres and radians a second.
    for (vehicle, rate_b) in [(bug(), Vector3::zeros()), (symmetric_bug(), Vector3::z() * 0.7)] {
        let start = Motion { velocity_w, rate_b, ..aloft(80.0) };
        let end = lose_propellant(&vehicle, &start);
        let shift_m = vehicle.mass.at(80.0).com_b - vehicle.mass.at(end.propellant_kg).com_b;
        assert!(shift_m.norm() > 0.01, "the centre of mass has moved by {shift_m} only");
        assert!((end.velocity_w - velocity_w).norm() < 1e-12, "{}", end.velocity_w);
        assert!((end.rate_b - rate_b).norm() < 1e-12, "{}", end.rate_b);
    }
}
