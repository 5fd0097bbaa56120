//! Powered flight: the rocket equation, constant thrust, order of the step, mass that only goes.

use claims::{Bound, Claim};
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
    Claim {
        id: "burnt-propellant",
        section: "Flight",
        claim: "propellant of a burn of 30 s at 3 kN, relative",
        reference: "T t/(I_sp g0)",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list",
        noise: 1e-11,
    }
    .holds((m0 - m1) / burnt_kg - 1.0);
    let expected_m_s = 225.0 * G0_M_S2 * (m0 / m1).ln();
    Claim {
        id: "rocket-equation",
        section: "Flight",
        claim: "speed gained in the same burn, relative",
        reference: "Tsiolkovsky's rocket equation",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list",
        noise: 1e-11,
    }
    .holds(end.velocity_w.z / expected_m_s - 1.0);
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
    Claim {
        id: "constant-thrust",
        section: "Flight",
        claim: "position after 60 s at constant thrust",
        reference: "rocket equation, integrated twice, and a parabola",
        unit: "m",
        bound: Bound::AtMost(1e-6),
        origin: "acceptance list",
        noise: 1e-8,
    }
    .holds(error_m);
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
    Claim {
        id: "flight-order",
        section: "Flight",
        claim: "order in which the error of position falls with the step, 20 to 10 ms",
        reference: "4: classical Runge-Kutta",
        unit: "",
        bound: Bound::AtLeast(3.8),
        origin: "acceptance list",
        noise: 0.0,
    }
    .holds(order);
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
    // it spins about.
    let (mut velocities_m_s, mut rates_rad_s) = (Vec::new(), Vec::new());
    for (vehicle, rate_b) in [(bug(), Vector3::zeros()), (symmetric_bug(), Vector3::z() * 0.7)] {
        let start = Motion { velocity_w, rate_b, ..aloft(80.0) };
        let end = lose_propellant(&vehicle, &start);
        let shift_m = vehicle.mass.at(80.0).com_b - vehicle.mass.at(end.propellant_kg).com_b;
        assert!(shift_m.norm() > 0.01, "the centre of mass has moved by {shift_m} only");
        velocities_m_s.push((end.velocity_w - velocity_w).norm());
        rates_rad_s.push((end.rate_b - rate_b).norm());
    }
    Claim {
        id: "mass-loss-velocity",
        section: "Flight",
        claim: "change of O's velocity while a quarter of the propellant goes without a force",
        reference: "none",
        unit: "m/s",
        bound: Bound::AtMost(1e-12),
        origin: "acceptance list",
        noise: 1e-13,
    }
    .holds_for(velocities_m_s);
    Claim {
        id: "mass-loss-rate",
        section: "Flight",
        claim: "change of the angular rate in the same",
        reference: "none",
        unit: "rad/s",
        bound: Bound::AtMost(1e-12),
        origin: "acceptance list",
        noise: 1e-13,
    }
    .holds_for(rates_rad_s);
}
