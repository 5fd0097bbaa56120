//! Slosh: in every tank a bob on a rigid rod without mass, hinged to the vehicle and free to swing
//! all round (T.52 to T.57 in the README).

use lander_models::Vehicle;
use lander_models::mass::MassProperties;
use lander_models::vehicle::{MAX_TANKS, Slosh};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::flight::{Accelerations, Motion};
use crate::propulsion::Wrench;

// The rods' tensions solve a system with one row per tank.
const _: () = assert!(MAX_TANKS == 3);

/// One pendulum, seen from the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pendulum {
    /// Unit vector from hinge to bob.
    pub direction_b: Vector3<f64>,
    /// Its rate in body axes, 1/s.
    pub swing_b: Vector3<f64>,
}

/// The pendulums of all tanks; none where propellant doesn't slosh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pendulums {
    count: usize,
    each: [Pendulum; MAX_TANKS],
}

/// A bob as a point mass, world frame.
#[derive(Clone, Copy, Debug)]
pub struct Bob {
    pub mass_kg: f64,
    pub position_w: Vector3<f64>,
    pub velocity_w: Vector3<f64>,
}

impl Pendulums {
    /// Bobs at rest, straight down the body's axis.
    pub fn hanging(tanks: &Slosh) -> Self {
        let down = Pendulum { direction_b: -Vector3::z(), swing_b: Vector3::zeros() };
        Self { count: tanks.hinges_b.len(), each: [down; MAX_TANKS] }
    }

    pub fn are_active(&self) -> bool {
        self.count > 0
    }

    pub fn as_slice(&self) -> &[Pendulum] {
        &self.each[..self.count]
    }

    /// Swings all bobs out to `angle_rad` from the body's axis, towards `azimuth_rad` about body z,
    /// moving on outwards at `rate_rad_s`: what a disturbance leaves behind.
    pub fn excite(&mut self, angle_rad: f64, rate_rad_s: f64, azimuth_rad: f64) {
        let out_b = Vector3::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0);
        let (sin, cos) = libm::sincos(angle_rad);
        for pendulum in &mut self.each[..self.count] {
            pendulum.direction_b = out_b * sin - Vector3::z() * cos;
            pendulum.swing_b = (out_b * cos + Vector3::z() * sin) * rate_rad_s;
        }
    }

    /// Largest angle of a bob from where it hangs, rad; 0 without slosh.
    pub fn angle_rad(&self) -> f64 {
        let angle = |p: &Pendulum| libm::atan2(p.direction_b.xy().norm(), -p.direction_b.z);
        self.as_slice().iter().map(angle).fold(0.0, f64::max)
    }

    pub(crate) fn is_finite(&self) -> bool {
        let finite = |v: &Vector3<f64>| v.iter().all(|value| value.is_finite());
        self.as_slice().iter().all(|p| finite(&p.direction_b) && finite(&p.swing_b))
    }

    /// `self + rate · factor`, element by element. Whatever has no pendulums adds nothing.
    pub(crate) fn plus(&self, rate: &Self, factor: f64) -> Self {
        let mut sum = *self;
        for (pendulum, rate) in sum.each.iter_mut().zip(rate.as_slice()) {
            pendulum.direction_b += rate.direction_b * factor;
            pendulum.swing_b += rate.swing_b * factor;
        }
        sum
    }

    pub(crate) fn times(mut self, factor: f64) -> Self {
        for pendulum in &mut self.each[..self.count] {
            pendulum.direction_b *= factor;
            pendulum.swing_b *= factor;
        }
        self
    }

    /// Takes off what an integrator's step has left along the rods.
    pub(crate) fn normalise(&mut self) {
        for pendulum in &mut self.each[..self.count] {
            pendulum.direction_b.normalize_mut();
            let along = pendulum.swing_b.dot(&pendulum.direction_b);
            pendulum.swing_b -= pendulum.direction_b * along;
        }
    }
}

/// The bobs, with what they weigh at this fill. None without slosh.
pub fn bobs<'a>(vehicle: &'a Vehicle, motion: &'a Motion) -> impl Iterator<Item = Bob> + 'a {
    vehicle.slosh.iter().flat_map(move |tanks| {
        let mass_kg = tanks.bob_kg(motion.propellant_kg);
        tanks.hinges_b.iter().zip(motion.slosh.as_slice()).map(move |(hinge_b, pendulum)| {
            let bob_b = hinge_b + pendulum.direction_b * tanks.length_m;
            let swing_w = motion.attitude_wb * (pendulum.swing_b * tanks.length_m);
            Bob {
                mass_kg,
                position_w: motion.point_position_w(&bob_b),
                velocity_w: motion.point_velocity_w(&bob_b) + swing_w,
            }
        })
    })
}

/// The vehicle less its bobs (T.52); the whole vehicle without slosh.
pub fn rest(vehicle: &Vehicle, motion: &Motion) -> MassProperties {
    let mass = vehicle.mass.at(motion.propellant_kg);
    match &vehicle.slosh {
        Some(tanks) if motion.slosh.are_active() => tanks.rest(&mass, motion.propellant_kg),
        _ => mass,
    }
}

/// Takes the bobs' positions and velocities, world frame, over into `motion`, whose own position,
/// velocity, attitude and rate are already those of the same instant. Parts along a rod are lost.
pub fn set_bobs(
    vehicle: &Vehicle,
    motion: &mut Motion,
    bobs_w: impl IntoIterator<Item = (Vector3<f64>, Vector3<f64>)>,
) {
    let Some(tanks) = &vehicle.slosh else { return };
    let mut slosh = motion.slosh;
    let places = tanks.hinges_b.iter().zip(&mut slosh.each[..slosh.count]);
    for ((hinge_b, pendulum), (position_w, velocity_w)) in places.zip(bobs_w) {
        let to_body = motion.attitude_wb.inverse();
        let bob_b = to_body * (position_w - motion.position_w);
        let swing_w = velocity_w - motion.point_velocity_w(&bob_b);
        pendulum.direction_b = (bob_b - hinge_b) / tanks.length_m;
        pendulum.swing_b = to_body * swing_w / tanks.length_m;
    }
    slosh.normalise();
    motion.slosh = slosh;
}

/// Accelerations of body and bobs under `wrench` about the vehicle's centre of mass, which is that
/// with hanging bobs (T.53 to T.57). All in body axes and less gravity, which acts on all alike.
pub(crate) fn accelerations(
    tanks: &Slosh,
    vehicle: &MassProperties,
    motion: &Motion,
    wrench: &Wrench,
) -> Accelerations<Pendulums> {
    let (rate_b, length_m) = (&motion.rate_b, tanks.length_m);
    let propellant_kg = motion.propellant_kg.max(0.0);
    let rest = tanks.rest(vehicle, propellant_kg);
    let (bob_kg, drag_1_s) = (tanks.bob_kg(propellant_kg), tanks.drag_1_s());
    // A vehicle file is refused if the rest of the vehicle has no positive inertia.
    let inverse_inertia_b = rest.inertia_b.try_inverse().unwrap_or_default();
    let pendulums = motion.slosh.as_slice();
    // Bobs from the rest's centre of mass.
    let mut arms_b = [Vector3::zeros(); MAX_TANKS];
    for ((arm_b, pendulum), hinge_b) in arms_b.iter_mut().zip(pendulums).zip(&tanks.hinges_b) {
        *arm_b = hinge_b + pendulum.direction_b * length_m - rest.com_b;
    }

    // The rest by itself, with the drag of the bobs.
    let mut force_b = wrench.force_b;
    let mut torque_b = wrench.torque_b + (vehicle.com_b - rest.com_b).cross(&force_b)
        - rate_b.cross(&(rest.inertia_b * rate_b));
    for (pendulum, arm_b) in pendulums.iter().zip(&arms_b) {
        let drag_b = pendulum.swing_b * (bob_kg * drag_1_s * length_m);
        force_b += drag_b;
        torque_b += arm_b.cross(&drag_b);
    }
    let mut com_b = force_b / rest.mass_kg;
    let mut turn_b = inverse_inertia_b * torque_b;

    // (T.54) Acceleration of the place where a bob is, seen by the bob.
    let place_b = |com_b: &Vector3<f64>, turn_b: &Vector3<f64>, n: usize| {
        com_b
            + turn_b.cross(&arms_b[n])
            + rate_b.cross(&rate_b.cross(&arms_b[n]))
            + rate_b.cross(&pendulums[n].swing_b) * (2.0 * length_m)
    };
    // (T.55) Tensions per bob mass. Rows without a tank stay those of the identity.
    let mut matrix = Matrix3::identity();
    let mut right = Vector3::zeros();
    let mut levers_b = [Vector3::zeros(); MAX_TANKS];
    for (n, pendulum) in pendulums.iter().enumerate() {
        levers_b[n] = inverse_inertia_b * arms_b[n].cross(&pendulum.direction_b);
        right[n] = pendulum.swing_b.norm_squared() * length_m
            - pendulum.direction_b.dot(&place_b(&com_b, &turn_b, n));
    }
    for (i, one) in pendulums.iter().enumerate() {
        let lever_b = arms_b[i].cross(&one.direction_b);
        for (j, other) in pendulums.iter().enumerate() {
            let straight = one.direction_b.dot(&other.direction_b) / rest.mass_kg;
            matrix[(i, j)] += bob_kg * (straight + lever_b.dot(&levers_b[j]));
        }
    }
    // The identity plus a product of positive semi-definite matrices is invertible.
    let tensions = matrix.try_inverse().unwrap_or_default() * right;
    for (n, pendulum) in pendulums.iter().enumerate() {
        let tension_n = tensions[n] * bob_kg;
        com_b += pendulum.direction_b * (tension_n / rest.mass_kg);
        turn_b += levers_b[n] * tension_n;
    }

    // (T.56) What tension and drag do to a bob, less what its place does.
    let mut swings = motion.slosh;
    for (n, pendulum) in pendulums.iter().enumerate() {
        let pull_b = pendulum.direction_b * tensions[n] + pendulum.swing_b * (drag_1_s * length_m);
        swings.each[n] = Pendulum {
            direction_b: pendulum.swing_b,
            swing_b: -(pull_b + place_b(&com_b, &turn_b, n)) / length_m,
        };
    }
    let origin_b = com_b - turn_b.cross(&rest.com_b) - rate_b.cross(&rate_b.cross(&rest.com_b));
    Accelerations { origin_b, turn_b, swings }
}
