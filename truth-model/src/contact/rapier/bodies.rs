//! The vehicle as bodies: a hull, a foot per leg on a prismatic joint, a bob per tank.

use lander_models::frames::{Attitude, steiner};
use lander_models::mass::MassProperties;
use lander_models::vehicle::{Gear, Lateral, Leg, Slosh, Vehicle};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, Vector3};
use rapier3d_f64::dynamics::{
    CoefficientCombineRule, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis,
    MassProperties as RapierMass, MotorModel, RigidBody, RigidBodyBuilder, RigidBodyHandle,
    SphericalJointBuilder,
};
use rapier3d_f64::geometry::{ColliderBuilder, ColliderHandle, SharedShape};
use rapier3d_f64::glamx::DVec3;
use rapier3d_f64::pipeline::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::convert::{pose, rotation_to_glam, to_glam};
use super::ground::lander_groups;
use crate::flight::Motion;
use crate::gear::LegState;
use crate::slosh::Bob;

/// Radius of gyration of a foot body, m: the footpad with its lower strut.
const FOOT_GYRATION_M: f64 = 0.1;
/// The same for a bob: near a point, and far from the zero that a solver can't divide by.
const BOB_GYRATION_M: f64 = 0.01;
/// The strut may extend this far beyond its free length before the joint stops it, m. The stop
/// stays away from the resting point: a joint held by its limit alone creeps.
const EXTENSION_STOP_M: f64 = 0.02;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Foot {
    pub body: RigidBodyHandle,
    pub pad: ColliderHandle,
    pub joint: ImpulseJointHandle,
}

/// Hull body = vehicle less feet, so that together they have the vehicle's properties.
pub fn hull_mass(gear: &Gear, mass: &MassProperties) -> (RapierMass, Vector3<f64>) {
    let foot_kg = gear.foot_mass_kg;
    let centres_b = || gear.legs.iter().map(|leg| gear.pad_centre_b(leg));
    let hull_kg = mass.mass_kg - foot_kg * gear.legs.len() as f64;
    let first_moment_b = mass.com_b * mass.mass_kg - centres_b().sum::<Vector3<f64>>() * foot_kg;
    let com_b = first_moment_b / hull_kg;
    let mut inertia_b = mass.inertia_b - steiner(&(com_b - mass.com_b)) * hull_kg;
    for centre_b in centres_b() {
        inertia_b -= steiner(&(centre_b - mass.com_b)) * foot_kg
            + Matrix3::identity() * (foot_kg * FOOT_GYRATION_M * FOOT_GYRATION_M);
    }
    let (moments, axes_b) = principal(inertia_b);
    let frame = rotation_to_glam(&axes_b);
    let properties = RapierMass::with_principal_inertia_frame(
        to_glam(&com_b),
        hull_kg,
        to_glam(&moments),
        frame,
    );
    (properties, com_b)
}

/// Principal moments and the frame of their axes. Rapier's own decomposition takes the host's `acos`
/// and `cos`, whose last bit is not the same everywhere.
fn principal(inertia_b: Matrix3<f64>) -> (Vector3<f64>, Attitude) {
    let SymmetricEigen { eigenvalues, eigenvectors } = inertia_b.symmetric_eigen();
    // Eigenvectors have no sign: the one that makes a rotation of them.
    let axes_b = eigenvectors * eigenvectors.determinant().signum();
    // A moment below zero is rounding, and Rapier takes zero for "does not turn".
    let moments = eigenvalues.map(|moment| moment.max(0.0));
    (moments, Attitude::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes_b)))
}

/// `mass` is that of the vehicle less bobs.
pub fn hull_body(vehicle: &Vehicle, mass: &MassProperties, motion: &Motion) -> RigidBody {
    let (properties, com_b) = hull_mass(&vehicle.gear, mass);
    body_at(&motion.position_w, motion)
        .linvel(to_glam(&motion.point_velocity_w(&com_b)))
        .additional_mass_properties(properties)
        .gyroscopic_forces_enabled(true)
        .build()
}

/// A body that turns with the vehicle.
fn body_at(position_w: &Vector3<f64>, motion: &Motion) -> RigidBodyBuilder {
    RigidBodyBuilder::dynamic()
        .pose(pose(position_w, &motion.attitude_wb))
        .angvel(to_glam(&(motion.attitude_wb * motion.rate_b)))
        .can_sleep(false)
        .allow_fast_rotation(true)
}

/// Hull and nozzle: what must not touch.
pub fn insert_structure(
    world: &mut PhysicsWorld,
    vehicle: &Vehicle,
    hull: RigidBodyHandle,
    friction: f64,
) -> [ColliderHandle; 2] {
    let (shape, engine) = (&vehicle.hull, &vehicle.engine);
    let cylinder = |radius_m: f64, bottom_m: f64, top_m: f64| {
        // Rapier's cylinder stands along y.
        let upright = Attitude::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        let centre_b = Vector3::z() * (0.5 * (bottom_m + top_m));
        let shape = SharedShape::cylinder(0.5 * (top_m - bottom_m), radius_m);
        // Within a compound at the body's origin: a collider off it makes Rapier add up inertias, which
        // ends in its own decomposition.
        ColliderBuilder::compound(vec![(pose(&centre_b, &upright), shape)])
            .density(0.0)
            .friction(friction)
            .build()
    };
    let body = cylinder(shape.radius_m, shape.bottom_height_m, shape.top_height_m);
    let nozzle = cylinder(
        engine.nozzle_exit_radius_m,
        engine.nozzle_exit_height_m,
        engine.pivot_b.z.max(engine.nozzle_exit_height_m + 0.01),
    );
    let mut part = vehicle.gear.legs.len();
    [body, nozzle].map(|mut shape| {
        shape.set_collision_groups(lander_groups(part));
        part += 1;
        world.colliders.insert_with_parent(shape, hull, &mut world.bodies)
    })
}

/// Foot of leg number `part`, its strut at the crushed length.
pub fn insert_foot(
    world: &mut PhysicsWorld,
    (gear, leg, part): (&Gear, &Leg, usize),
    hull: RigidBodyHandle,
    state: &LegState,
    motion: &Motion,
    friction: f64,
) -> Foot {
    let free_b = gear.pad_centre_b(leg);
    let centre_b = free_b + leg.stroke_axis_b * state.crushed_m;
    let inertia = DVec3::splat(gear.foot_mass_kg * FOOT_GYRATION_M * FOOT_GYRATION_M);
    let body = world.bodies.insert(
        body_at(&motion.point_position_w(&centre_b), motion)
            .linvel(to_glam(&motion.point_velocity_w(&centre_b)))
            .additional_mass_properties(RapierMass::new(DVec3::ZERO, gear.foot_mass_kg, inertia))
            .build(),
    );
    let pad = world.colliders.insert_with_parent(
        ColliderBuilder::ball(gear.pad_radius_m)
            .density(0.0)
            .friction(friction)
            .friction_combine_rule(CoefficientCombineRule::Max)
            .collision_groups(lander_groups(part))
            .build(),
        body,
        &mut world.bodies,
    );
    let locked = match gear.lateral {
        Some(_) => JointAxesMask::ANG_AXES,
        None => JointAxesMask::LOCKED_PRISMATIC_AXES,
    };
    let axis = to_glam(&leg.stroke_axis_b);
    let mut joint = GenericJointBuilder::new(locked)
        .local_axis1(axis)
        .local_axis2(axis)
        .local_anchor1(to_glam(&free_b))
        .local_anchor2(DVec3::ZERO)
        .contacts_enabled(false)
        .limits(JointAxis::LinX, [-EXTENSION_STOP_M, leg.strut.stroke_max_m])
        .motor_model(JointAxis::LinX, MotorModel::ForceBased);
    if let Some(Lateral { stiffness_n_m, damping_n_s_m }) = gear.lateral {
        for across in [JointAxis::LinY, JointAxis::LinZ] {
            joint = joint.motor_model(across, MotorModel::ForceBased).motor_position(
                across,
                0.0,
                stiffness_n_m,
                damping_n_s_m,
            );
        }
    }
    let joint = joint.build();
    Foot { body, pad, joint: world.impulse_joints.insert(hull, body, joint, true) }
}

/// A bob on a ball joint at its hinge: a rod without mass.
pub fn insert_bob(
    world: &mut PhysicsWorld,
    hull: RigidBodyHandle,
    (tanks, hinge_b): (&Slosh, &Vector3<f64>),
    bob: &Bob,
    motion: &Motion,
) -> RigidBodyHandle {
    let inertia = DVec3::splat(bob.mass_kg * BOB_GYRATION_M * BOB_GYRATION_M);
    let hinge_w = motion.point_position_w(hinge_b);
    // Rod and bob are one body that turns about the hinge as the rod does.
    let rod_w = bob.position_w - hinge_w;
    let swing_w = bob.velocity_w - motion.point_velocity_w(hinge_b);
    let rate_w = rod_w.cross(&swing_w) / (tanks.length_m * tanks.length_m);
    let body = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .translation(to_glam(&bob.position_w))
            .linvel(to_glam(&bob.velocity_w))
            .angvel(to_glam(&rate_w))
            .additional_mass_properties(RapierMass::new(DVec3::ZERO, bob.mass_kg, inertia))
            .can_sleep(false)
            .build(),
    );
    let joint = SphericalJointBuilder::new()
        .local_anchor1(to_glam(hinge_b))
        .local_anchor2(to_glam(&-rod_w))
        .contacts_enabled(false)
        .build();
    world.impulse_joints.insert(hull, body, joint, true);
    body
}
