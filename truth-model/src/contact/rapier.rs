//! The reference contact engine, and the only file that names Rapier.
//!
//! One hull body and one small footpad body per leg on a prismatic joint along its stroke axis.
//! The joint's motor is the strut: an implicit spring-damper towards the crushed length whose
//! force is capped at the crush load, which makes it flow plastically (T.10). Settings and the
//! reasons for them: README, "Contact engine".

use lander_models::frames::{Attitude, steiner};
use lander_models::mass::MassProperties;
use lander_models::time::TICK_S;
use lander_models::vehicle::{Gear, Leg, Vehicle};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use rapier3d_f64::dynamics::{
    CoefficientCombineRule, FrictionModel, ImpulseJointHandle, JointAxis,
    MassProperties as RapierMass, MotorModel, PrismaticJointBuilder, RigidBody, RigidBodyBuilder,
    RigidBodyHandle, SpringCoefficients,
};
use rapier3d_f64::geometry::{
    ColliderBuilder, ColliderHandle, Group, InteractionGroups, SharedShape,
};
use rapier3d_f64::glamx::{DMat3, DQuat, DVec3};
use rapier3d_f64::math::Pose;
use rapier3d_f64::pipeline::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::{ContactEngine, Site, Touch};
use crate::flight::Motion;
use crate::gear::{LegState, crush_load_n, crushed_after};
use crate::propulsion::{Drive, Wrench};

/// Stiffness of pad on ground: 2e7 N/m for a foot of 2 kg, 0.08 mm under a crush load. Rapier's
/// default (60 Hz, overdamped) adds millimetres of its own to a stroke.
const PAD_NATURAL_FREQUENCY_HZ: f64 = 500.0;
/// Sub-steps of one tick; one alone misses tip-over speeds by 3 %.
const SOLVER_ITERATIONS: usize = 4;
/// Friction of a captured pad: the lateral hold never gives way, the pad may still lift.
const CAPTURED_FRICTION: f64 = 1e3;
/// Radius of gyration of a foot body, m: the footpad with its lower strut.
const FOOT_GYRATION_M: f64 = 0.1;
/// The strut may extend this far beyond its free length before the joint stops it, m. The stop
/// stays away from the resting point: a joint held by its limit alone creeps.
const EXTENSION_STOP_M: f64 = 0.02;

/// The ground plane as contact sees it.
const GROUND: InteractionGroups = groups(Group::GROUP_1, Group::GROUP_2);
const LANDER: InteractionGroups = groups(Group::GROUP_2, Group::GROUP_1);

const fn groups(member: Group, filter: Group) -> InteractionGroups {
    InteractionGroups {
        memberships: member,
        filter,
        test_mode: rapier3d_f64::geometry::InteractionTestMode::And,
    }
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Foot {
    body: RigidBodyHandle,
    pad: ColliderHandle,
    joint: ImpulseJointHandle,
}

/// The contact engine at one instant: plain data, `Clone` and serialisable.
#[derive(Serialize, Deserialize)]
pub struct RapierWorld {
    world: PhysicsWorld,
    hull: RigidBodyHandle,
    /// Hull and nozzle: what must not touch.
    structure: [ColliderHandle; 2],
    ground: ColliderHandle,
    feet: Vec<Foot>,
}

impl Clone for RapierWorld {
    fn clone(&self) -> Self {
        // The pipelines are scratch space and start empty, as they do after deserialisation.
        let world = PhysicsWorld {
            gravity: self.world.gravity,
            integration_parameters: self.world.integration_parameters,
            islands: self.world.islands.clone(),
            broad_phase: self.world.broad_phase.clone(),
            narrow_phase: self.world.narrow_phase.clone(),
            bodies: self.world.bodies.clone(),
            colliders: self.world.colliders.clone(),
            impulse_joints: self.world.impulse_joints.clone(),
            multibody_joints: self.world.multibody_joints.clone(),
            ..PhysicsWorld::default()
        };
        Self { world, feet: self.feet.clone(), ..*self }
    }
}

impl ContactEngine for RapierWorld {
    fn take_over(site: &Site, motion: &Motion, legs: &[LegState]) -> Self {
        let Site { vehicle, terrain, .. } = *site;
        let mut world = PhysicsWorld::default();
        tune(&mut world);
        let pad_friction = if terrain.pads_captured { CAPTURED_FRICTION } else { terrain.friction };
        let ground = world.colliders.insert(
            ColliderBuilder::new(SharedShape::halfspace(to_glam(&terrain.normal_w())))
                .friction(terrain.friction)
                .collision_groups(GROUND)
                .build(),
        );
        let mass = vehicle.mass.at(motion.propellant_kg);
        let hull = world.bodies.insert(hull_body(vehicle, &mass, motion));
        let structure = insert_structure(&mut world, vehicle, hull, terrain.friction);
        let feet = (vehicle.gear.legs.iter().zip(legs))
            .map(|(leg, state)| {
                insert_foot(&mut world, &vehicle.gear, hull, leg, state, motion, pad_friction)
            })
            .collect();
        Self { world, hull, structure, ground, feet }
    }

    /// Propulsion and mass go on while Rapier owns the motion. A body that has become non-finite
    /// Rapier freezes and goes on as if nothing had happened.
    fn step(
        &mut self,
        site: &Site,
        motion: &mut Motion,
        legs: &mut [LegState],
        drive: &Drive,
    ) -> Option<Touch> {
        let vehicle = site.vehicle;
        let mass = vehicle.mass.at(motion.propellant_kg);
        self.world.gravity = to_glam(&site.gravity_w);
        self.set_mass(&vehicle.gear, motion, &mass);
        self.apply(motion, &mass, &drive.wrench(vehicle, motion, &mass.com_b));
        for ((foot, leg), state) in self.feet.iter().zip(&vehicle.gear.legs).zip(legs.iter()) {
            if let Some(joint) = self.world.impulse_joints.get_mut(foot.joint, true) {
                let strut = &leg.strut;
                joint
                    .data
                    .set_motor_position(
                        JointAxis::LinX,
                        state.crushed_m,
                        strut.stiffness_n_m,
                        strut.damping_n_s_m,
                    )
                    .set_motor_max_force(JointAxis::LinX, crush_load_n(strut, state.stroke_m));
            }
        }
        self.world.step();
        let flow_kg_s = drive.flow_kg_s(vehicle, motion);
        (motion.thrust_n, motion.gimbal_rad) = drive.actuators_after(vehicle, motion, TICK_S);
        motion.propellant_kg = (motion.propellant_kg - flow_kg_s * TICK_S).max(0.0);
        if !self.world.quarantine().is_empty() {
            return None;
        }
        self.read_motion(motion);
        self.read_legs(&vehicle.gear, motion, legs);
        Some(Touch {
            feet: self.feet.iter().map(|foot| self.touches(foot.pad)).collect(),
            structure: self.structure.iter().any(|part| self.touches(*part)),
        })
    }
}

impl RapierWorld {
    /// Keeps the velocity of O when the centre of mass moves: Rapier's is that of the centre of mass.
    fn set_mass(&mut self, gear: &Gear, motion: &Motion, mass: &MassProperties) {
        let hull = &mut self.world.bodies[self.hull];
        let (properties, com_b) = hull_mass(gear, mass);
        hull.set_additional_mass_properties(properties, true);
        hull.recompute_mass_properties_from_colliders(&self.world.colliders);
        hull.set_linvel(to_glam(&motion.point_velocity_w(&com_b)), true);
    }

    fn apply(&mut self, motion: &Motion, mass: &MassProperties, wrench: &Wrench) {
        let com_w = to_glam(&motion.point_position_w(&mass.com_b));
        let hull = &mut self.world.bodies[self.hull];
        hull.reset_forces(true);
        hull.reset_torques(true);
        // The wrench is about the whole vehicle's centre of mass, not the hull body's.
        hull.add_force_at_point(to_glam(&(motion.attitude_wb * wrench.force_b)), com_w, true);
        hull.add_torque(to_glam(&(motion.attitude_wb * wrench.torque_b)), true);
    }

    fn read_motion(&self, motion: &mut Motion) {
        let hull = &self.world.bodies[self.hull];
        motion.position_w = from_glam(hull.translation());
        motion.attitude_wb = from_glam_rotation(*hull.rotation());
        let rate_w = from_glam(hull.angvel());
        motion.rate_b = motion.attitude_wb.inverse() * rate_w;
        let com_to_origin_w = motion.position_w - from_glam(hull.center_of_mass());
        motion.velocity_w = from_glam(hull.linvel()) + rate_w.cross(&com_to_origin_w);
    }

    fn read_legs(&self, gear: &Gear, motion: &Motion, legs: &mut [LegState]) {
        for ((foot, leg), state) in self.feet.iter().zip(&gear.legs).zip(legs) {
            let axis_w = motion.attitude_wb * leg.stroke_axis_b;
            let free_w = motion.point_position_w(&gear.pad_centre_b(leg));
            let pad_w = from_glam(self.world.bodies[foot.body].translation());
            let cap_n = crush_load_n(&leg.strut, state.stroke_m);
            state.stroke_m = (pad_w - free_w).dot(&axis_w);
            state.load_n = self.strut_load_n(foot);
            state.crushed_m = crushed_after(&leg.strut, cap_n, state.crushed_m, state.stroke_m);
        }
    }

    /// Axial load from the joint's impulses of the tick's last sub-step, compression positive.
    /// A strut on its stop has a spike within the tick that this does not see.
    fn strut_load_n(&self, foot: &Foot) -> f64 {
        let substep_s = TICK_S / SOLVER_ITERATIONS as f64;
        let axis = JointAxis::LinX as usize;
        self.world.impulse_joints.get(foot.joint).map_or(0.0, |joint| {
            (joint.data.motors[axis].impulse + joint.data.limits[axis].impulse) / substep_s
        })
    }

    /// Whether the last step gave the part an impulse. Distance would tell one tick late: Rapier
    /// stops a part within the tick in which it would reach the ground.
    fn touches(&self, part: ColliderHandle) -> bool {
        self.world
            .contact_pair(part, self.ground)
            .is_some_and(|pair| pair.total_impulse_magnitude() > 0.0)
    }
}

fn tune(world: &mut PhysicsWorld) {
    let p = &mut world.integration_parameters;
    p.dt = TICK_S;
    p.num_solver_iterations = SOLVER_ITERATIONS;
    p.num_internal_pgs_iterations = 4;
    p.num_internal_stabilization_iterations = 4;
    p.friction_model = FrictionModel::Coulomb;
    p.contact_clustering = false;
    p.contact_recycling = false;
    p.max_ccd_substeps = 0;
    // The default clamps every body to 400 m/s without a word.
    p.normalized_max_linear_velocity = f64::MAX;
    p.static_contact_softness = SpringCoefficients::new(PAD_NATURAL_FREQUENCY_HZ, 1.0);
}

/// Hull body = vehicle less feet, so that together they have the vehicle's properties.
fn hull_mass(gear: &Gear, mass: &MassProperties) -> (RapierMass, Vector3<f64>) {
    let foot_kg = gear.foot_mass_kg;
    let centres: Vec<_> = gear.legs.iter().map(|leg| gear.pad_centre_b(leg)).collect();
    let hull_kg = mass.mass_kg - foot_kg * centres.len() as f64;
    let first_moment_b = mass.com_b * mass.mass_kg - centres.iter().sum::<Vector3<f64>>() * foot_kg;
    let com_b = first_moment_b / hull_kg;
    let mut inertia_b = mass.inertia_b - steiner(&(com_b - mass.com_b)) * hull_kg;
    for centre_b in &centres {
        inertia_b -= steiner(&(centre_b - mass.com_b)) * foot_kg
            + Matrix3::identity() * (foot_kg * FOOT_GYRATION_M * FOOT_GYRATION_M);
    }
    let columns = inertia_b.as_slice().try_into().unwrap_or([0.0; 9]);
    let properties =
        RapierMass::with_inertia_matrix(to_glam(&com_b), hull_kg, DMat3::from_cols_array(&columns));
    (properties, com_b)
}

fn hull_body(vehicle: &Vehicle, mass: &MassProperties, motion: &Motion) -> RigidBody {
    let (properties, com_b) = hull_mass(&vehicle.gear, mass);
    RigidBodyBuilder::dynamic()
        .pose(pose(&motion.position_w, &motion.attitude_wb))
        .linvel(to_glam(&motion.point_velocity_w(&com_b)))
        .angvel(to_glam(&(motion.attitude_wb * motion.rate_b)))
        .additional_mass_properties(properties)
        .can_sleep(false)
        .allow_fast_rotation(true)
        .gyroscopic_forces_enabled(true)
        .build()
}

fn insert_structure(
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
        ColliderBuilder::cylinder(0.5 * (top_m - bottom_m), radius_m)
            .position(pose(&centre_b, &upright))
            .density(0.0)
            .friction(friction)
            .collision_groups(LANDER)
            .build()
    };
    let body = cylinder(shape.radius_m, shape.bottom_height_m, shape.top_height_m);
    let nozzle = cylinder(
        engine.nozzle_exit_radius_m,
        engine.nozzle_exit_height_m,
        engine.pivot_b.z.max(engine.nozzle_exit_height_m + 0.01),
    );
    [body, nozzle].map(|part| world.colliders.insert_with_parent(part, hull, &mut world.bodies))
}

fn insert_foot(
    world: &mut PhysicsWorld,
    gear: &Gear,
    hull: RigidBodyHandle,
    leg: &Leg,
    state: &LegState,
    motion: &Motion,
    friction: f64,
) -> Foot {
    let free_b = gear.pad_centre_b(leg);
    let centre_b = free_b + leg.stroke_axis_b * state.crushed_m;
    let inertia = DVec3::splat(gear.foot_mass_kg * FOOT_GYRATION_M * FOOT_GYRATION_M);
    let body = world.bodies.insert(
        RigidBodyBuilder::dynamic()
            .pose(pose(&motion.point_position_w(&centre_b), &motion.attitude_wb))
            .linvel(to_glam(&motion.point_velocity_w(&centre_b)))
            .angvel(to_glam(&(motion.attitude_wb * motion.rate_b)))
            .additional_mass_properties(RapierMass::new(DVec3::ZERO, gear.foot_mass_kg, inertia))
            .can_sleep(false)
            .allow_fast_rotation(true)
            .build(),
    );
    let pad = world.colliders.insert_with_parent(
        ColliderBuilder::ball(gear.pad_radius_m)
            .density(0.0)
            .friction(friction)
            .friction_combine_rule(CoefficientCombineRule::Max)
            .collision_groups(LANDER)
            .build(),
        body,
        &mut world.bodies,
    );
    let joint = PrismaticJointBuilder::new(to_glam(&leg.stroke_axis_b))
        .local_anchor1(to_glam(&free_b))
        .local_anchor2(DVec3::ZERO)
        .contacts_enabled(false)
        .limits([-EXTENSION_STOP_M, leg.strut.stroke_max_m])
        .motor_model(MotorModel::ForceBased)
        .build();
    Foot { body, pad, joint: world.impulse_joints.insert(hull, body, joint, true) }
}

fn pose(position: &Vector3<f64>, rotation: &Attitude) -> Pose {
    let q = rotation.quaternion();
    Pose::from_parts(to_glam(position), DQuat::from_xyzw(q.i, q.j, q.k, q.w))
}

fn to_glam(v: &Vector3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn from_glam(v: DVec3) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

fn from_glam_rotation(q: DQuat) -> Attitude {
    UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z))
}
