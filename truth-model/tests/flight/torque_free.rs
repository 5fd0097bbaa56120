//! Torque-free motion: what is conserved, and attitude against the classical solutions.

use claims::{Bound, Claim};
use nalgebra::{Rotation3, Vector3};
use truth_model::flight::Motion;
use truth_model::propulsion::Drive;

use lander_models::vehicle::Vehicle;
use nalgebra::UnitQuaternion;

use crate::common::{bug, symmetric_bug};
use crate::{aloft, fly};

const TIME_S: f64 = 60.0;

fn coast(vehicle: &Vehicle, start: &Motion) -> Motion {
    fly(vehicle, start, &Drive::default(), 0.0, 1e-3, (TIME_S * 1e3) as usize)
}

/// Angular momentum about the centre of mass, world frame.
fn spin_w(vehicle: &Vehicle, motion: &Motion) -> Vector3<f64> {
    let inertia_b = vehicle.mass.at(motion.propellant_kg).inertia_b;
    motion.attitude_wb * (inertia_b * motion.rate_b)
}

#[test]
fn tumbling_keeps_energy_momentum_and_the_path_of_the_centre_of_mass() {
    // Products of inertia as well: no axis is principal.
    let mut vehicle = bug();
    vehicle.mass.dry.products_kg_m2 = Vector3::new(4.0, -7.0, 3.0);
    let mut start = aloft(40.0);
    start.rate_b = Vector3::new(0.4, -0.9, 0.3);
    let end = coast(&vehicle, &start);
    let mass = vehicle.mass.at(40.0);
    let energy = |m: &Motion| 0.5 * m.rate_b.dot(&(mass.inertia_b * m.rate_b));
    Claim {
        id: "torque-free-energy",
        section: "Flight",
        claim: "relative change of energy in 60 s of tumbling, no axis principal",
        reference: "conservation of energy",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list",
        noise: 1e-12,
    }
    .holds(energy(&end) / energy(&start) - 1.0);
    let (spin_0_w, spin_1_w) = (spin_w(&vehicle, &start), spin_w(&vehicle, &end));
    Claim {
        id: "torque-free-momentum",
        section: "Flight",
        claim: "relative change of angular momentum in the same",
        reference: "conservation of angular momentum",
        unit: "",
        bound: Bound::AtMost(1e-9),
        origin: "acceptance list",
        noise: 1e-12,
    }
    .holds((spin_1_w - spin_0_w).norm() / spin_0_w.norm());
    let com_w = |m: &Motion| m.point_position_w(&mass.com_b);
    let drift_w = com_w(&end) - com_w(&start) - start.point_velocity_w(&mass.com_b) * TIME_S;
    Claim {
        id: "torque-free-path",
        section: "Flight",
        claim: "drift of the centre of mass off its straight line in the same",
        reference: "Newton's first law",
        unit: "m",
        bound: Bound::AtMost(1e-8),
        origin: "60,000 roundings near 1e4 m (2e-12 m each) that add at random",
        noise: 1e-9,
    }
    .holds(drift_w.norm());
}

/// Angle between two attitudes, degrees.
fn apart_deg(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    (a.inverse() * b).angle().to_degrees()
}

#[test]
fn an_axisymmetric_body_precesses_as_the_closed_form_says() {
    let mut vehicle = symmetric_bug();
    vehicle.mass.dry.inertia_kg_m2.x = vehicle.mass.dry.inertia_kg_m2.y;
    vehicle.mass.propellant.gyration_radius_b.x = vehicle.mass.propellant.gyration_radius_b.y;
    let mut start = aloft(40.0);
    start.attitude_wb = UnitQuaternion::from_euler_angles(0.3, -0.4, 0.5);
    start.rate_b = Vector3::new(0.4, -0.9, 0.7);
    let end = coast(&vehicle, &start);
    // Precession about the angular momentum at H/J_t, and a spin about the axis with the rest.
    let inertia_b = vehicle.mass.at(40.0).inertia_b;
    let (across, along) = (inertia_b.m11, inertia_b.m33);
    let precession_w = spin_w(&vehicle, &start) * (TIME_S / across);
    let spin_b = Vector3::z() * (start.rate_b.z * (1.0 - along / across) * TIME_S);
    let expected = UnitQuaternion::from_scaled_axis(precession_w)
        * start.attitude_wb
        * UnitQuaternion::from_scaled_axis(spin_b);
    let error_deg = apart_deg(&end.attitude_wb, &expected);
    Claim {
        id: "torque-free-precession",
        section: "Flight",
        claim: "attitude of an axisymmetric body after 60 s without torque",
        reference: "precession and spin in closed form",
        unit: "°",
        bound: Bound::AtMost(1e-6),
        origin: "acceptance list",
        noise: 1e-9,
    }
    .holds(error_deg);
}

/// Jacobi's sn, cn and dn for parameter `m` by descending Landen transformation (Abramowitz and
/// Stegun 16.4).
fn jacobi(u: f64, m: f64) -> [f64; 3] {
    let (mut a, mut g, mut steps) = (1.0_f64, (1.0 - m).sqrt(), Vec::new());
    let mut c = m.sqrt();
    while c > 1e-16 {
        (a, g, c) = (0.5 * (a + g), (a * g).sqrt(), 0.5 * (a - g));
        steps.push((a, c));
    }
    let mut phi = f64::from(1_u32 << steps.len()) * a * u;
    for (a, c) in steps.iter().rev() {
        phi = 0.5 * (phi + (c / a * phi.sin()).asin());
    }
    let (sn, cn) = phi.sin_cos();
    [sn, cn, (1.0 - m * sn * sn).sqrt()]
}

/// Rates of a body with principal moments J₁ < J₂ < J₃ and `2 T J₂ < H²` that starts with ω₂ = 0
/// (Landau and Lifshitz, Mechanics, § 37).
fn euler_poinsot(j: [f64; 3], start: [f64; 2], time_s: f64) -> Vector3<f64> {
    let [j1, j2, j3] = j;
    let [w1, w3] = start;
    let twice_energy = j1 * w1 * w1 + j3 * w3 * w3;
    let spin_2 = (j1 * w1).powi(2) + (j3 * w3).powi(2);
    let excess = spin_2 - twice_energy * j1;
    let lack = twice_energy * j3 - spin_2;
    let pace = ((j3 - j2) * excess / (j1 * j2 * j3)).sqrt();
    let m = (j2 - j1) * lack / ((j3 - j2) * excess);
    let [sn, cn, dn] = jacobi(pace * time_s, m);
    let w2 = (lack / (j2 * (j3 - j2))).sqrt();
    Vector3::new(w1 * cn, w2 * sn, w3 * dn)
}

#[test]
fn an_asymmetric_body_tumbles_as_jacobi_s_functions_say() {
    let mut vehicle = symmetric_bug();
    // Moments rise from x to z, so that the closed form's axes are the body's.
    vehicle.mass.dry.inertia_kg_m2 = Vector3::new(70.0, 110.0, 150.0);
    let (w1, w3) = (0.5, 0.8);
    let mut start = aloft(0.0);
    start.rate_b = Vector3::new(w1, 0.0, w3);
    let j = [70.0, 110.0, 150.0];
    // World z along the angular momentum H: the body's axes see it at polar angles that the rates
    // give, and it turns about it at H (J₁ω₁² + J₂ω₂²)/((J₁ω₁)² + (J₂ω₂)²).
    let spin = (j[0] * w1).hypot(j[2] * w3);
    let attitude = |rate_b: &Vector3<f64>, azimuth: f64| {
        let h_b = rate_b.component_mul(&Vector3::from(j)) / spin;
        let (polar, own) = (h_b.z.acos(), h_b.x.atan2(h_b.y));
        UnitQuaternion::from_rotation_matrix(
            &(Rotation3::from_axis_angle(&Vector3::z_axis(), azimuth)
                * Rotation3::from_axis_angle(&Vector3::x_axis(), polar)
                * Rotation3::from_axis_angle(&Vector3::z_axis(), own)),
        )
    };
    start.attitude_wb = attitude(&start.rate_b, 0.0);
    let end = coast(&vehicle, &start);

    let azimuth_rate = |time_s: f64| {
        let w = euler_poinsot(j, [w1, w3], time_s);
        let (x, y) = (j[0] * w.x, j[1] * w.y);
        spin * (x * w.x + y * w.y) / (x * x + y * y)
    };
    // Simpson's rule; halving this step changes the result by less than 1e-12 rad.
    let step_s = 5e-3;
    let azimuth: f64 = (0..(TIME_S / step_s) as usize)
        .map(|n| n as f64 * step_s)
        .map(|t| {
            let inner = azimuth_rate(t + 0.5 * step_s);
            step_s / 6.0 * (azimuth_rate(t) + 4.0 * inner + azimuth_rate(t + step_s))
        })
        .sum();
    let rate_b = euler_poinsot(j, [w1, w3], TIME_S);
    Claim {
        id: "torque-free-rate",
        section: "Flight",
        claim: "rate of an asymmetric body after 60 s without torque",
        reference: "Jacobi's elliptic functions (Landau and Lifshitz, § 37)",
        unit: "rad/s",
        bound: Bound::AtMost(1e-8),
        origin: "acceptance list: its 1e-6°, as rad/s",
        noise: 1e-11,
    }
    .holds((end.rate_b - rate_b).norm());
    let error_deg = apart_deg(&end.attitude_wb, &attitude(&rate_b, azimuth));
    Claim {
        id: "torque-free-attitude",
        section: "Flight",
        claim: "attitude of the same body",
        reference: "Jacobi's elliptic functions, azimuth by quadrature",
        unit: "°",
        bound: Bound::AtMost(1e-6),
        origin: "acceptance list",
        noise: 1e-9,
    }
    .holds(error_deg);
}
