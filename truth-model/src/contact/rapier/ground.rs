//! The ground as Rapier sees it: a plane under each part of the vehicle, tangent to the terrain and
//! moved along with the part, and the rocks around as balls. On soft soil a pad's plane lies on a
//! plate that sinks against the soil's bearing load (T.48).

use lander_models::scenario::Soil;
use nalgebra::Vector3;
use rapier3d_f64::dynamics::{
    ImpulseJointHandle, JointAxis, MassProperties as RapierMass, MotorModel, PrismaticJointBuilder,
    RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d_f64::geometry::{
    ColliderBuilder, ColliderHandle, Group, InteractionGroups, InteractionTestMode, SharedShape,
};
use rapier3d_f64::glamx::DVec3;
use rapier3d_f64::pipeline::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::super::{Footing, Site};
use super::convert::{from_glam, to_glam};

/// Elastic stiffness of a plate, N/m: soil springs back by 0.1 mm from a crush load.
const PLATE_STIFFNESS_N_M: f64 = 1e7;
/// Rocks are there out to this distance from the vehicle, and renewed when it has gone half of it, m.
const ROCK_REACH_M: f64 = 8.0;

const ROCKS: Group = Group::GROUP_32;

/// Groups of part number `part`: it meets its own plane and all rocks.
pub fn lander_groups(part: usize) -> InteractionGroups {
    groups(Group::from_bits_truncate(1 << part), plane_group(part) | ROCKS)
}

fn plane_group(part: usize) -> Group {
    Group::from_bits_truncate(1 << (part + 16))
}

fn groups(memberships: Group, filter: Group) -> InteractionGroups {
    InteractionGroups { memberships, filter, test_mode: InteractionTestMode::And }
}

/// All parts' groups.
fn any_part() -> Group {
    Group::from_bits_truncate(0xffff)
}

/// What the vehicle may touch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Soilbed {
    /// One for each part: pads in order of the legs, hull, nozzle. On hard plane ground one for all.
    tiles: Vec<Tile>,
    rocks: Vec<ColliderHandle>,
    rocks_around_w: Vector3<f64>,
}

/// A plane under a part.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Tile {
    plane: ColliderHandle,
    plate: Option<Plate>,
}

/// Soil under a pad.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Plate {
    body: RigidBodyHandle,
    joint: ImpulseJointHandle,
    normal_w: Vector3<f64>,
    surface_w: Vector3<f64>,
    /// Depth to which the soil has yielded.
    settled_m: f64,
}

impl Soilbed {
    /// Under parts at these places; the last two are hull and nozzle.
    pub fn new(world: &mut PhysicsWorld, site: &Site, parts_w: &[Vector3<f64>]) -> Self {
        let friction = site.terrain.friction;
        let tiles = if site.ground.is_plane() && site.terrain.soil.is_none() {
            let all = groups((0..parts_w.len()).map(plane_group).collect(), any_part());
            vec![Tile::hard(world, &site.footing(&parts_w[0]), all, friction)]
        } else {
            let pads = parts_w.len() - 2;
            let earth = world.bodies.insert(RigidBodyBuilder::fixed());
            (parts_w.iter().enumerate())
                .map(|(part, part_w)| {
                    let groups = groups(plane_group(part), any_part());
                    let footing = site.footing(part_w);
                    if part < pads && site.terrain.soil.is_some() {
                        let plate_kg = site.vehicle.gear.foot_mass_kg;
                        Tile::soft(world, (&footing, part_w), groups, friction, earth, plate_kg)
                    } else {
                        Tile::hard(world, &footing, groups, friction)
                    }
                })
                .collect()
        };
        Self { tiles, rocks: Vec::new(), rocks_around_w: Vector3::repeat(f64::INFINITY) }
    }

    /// Moves the planes under parts that went on, and the rocks if the vehicle did. A pad keeps the
    /// soil that it has pressed until it is clear of the hole.
    pub fn follow(&mut self, world: &mut PhysicsWorld, site: &Site, parts_w: &[Vector3<f64>]) {
        if self.tiles.len() > 1 {
            for (tile, part_w) in self.tiles.iter_mut().zip(parts_w) {
                let footing = site.footing(part_w);
                let clear = footing.clearance_m(part_w) > site.vehicle.gear.pad_radius_m;
                if tile.plate.is_none() || clear {
                    tile.move_to(world, &footing, part_w);
                }
            }
        }
        let [.., hull_w, _] = parts_w else { return };
        if (hull_w - self.rocks_around_w).norm() < 0.5 * ROCK_REACH_M {
            return;
        }
        self.rocks_around_w = *hull_w;
        for rock in self.rocks.drain(..) {
            world.remove_collider(rock);
        }
        for rock in site.ground.rocks_near(hull_w, ROCK_REACH_M) {
            let ball = ColliderBuilder::ball(rock.radius_m)
                .translation(to_glam(&rock.centre_w))
                .friction(site.terrain.friction)
                .collision_groups(groups(ROCKS, any_part()));
            self.rocks.push(world.colliders.insert(ball));
        }
    }

    /// Sets how much the soil under each pad bears now.
    pub fn press(&self, world: &mut PhysicsWorld, soil: &Soil, bearing_radius_m: f64) {
        for plate in self.tiles.iter().filter_map(|tile| tile.plate.as_ref()) {
            plate.press(world, soil, bearing_radius_m);
        }
    }

    /// Lets the soil yield as far as it was pressed in the last step.
    pub fn settle(&mut self, world: &PhysicsWorld, soil: &Soil, bearing_radius_m: f64) {
        for plate in self.tiles.iter_mut().filter_map(|tile| tile.plate.as_mut()) {
            plate.settle(world, soil, bearing_radius_m);
        }
    }

    /// Depth of the hole under a pad, m.
    pub fn sinkage_m(&self, part: usize) -> f64 {
        let plate = self.tiles.get(part).and_then(|tile| tile.plate.as_ref());
        plate.map_or(0.0, |plate| plate.settled_m)
    }
}

impl Tile {
    fn hard(
        world: &mut PhysicsWorld,
        footing: &Footing,
        groups: InteractionGroups,
        friction: f64,
    ) -> Self {
        let plane = plane(footing, groups, friction)
            .translation(to_glam(&(footing.normal_w * footing.offset_m)));
        Self { plane: world.colliders.insert(plane), plate: None }
    }

    fn soft(
        world: &mut PhysicsWorld,
        (footing, part_w): (&Footing, &Vector3<f64>),
        groups: InteractionGroups,
        friction: f64,
        earth: RigidBodyHandle,
        plate_kg: f64,
    ) -> Self {
        let surface_w = footing.below(part_w);
        let mass = RapierMass::new(DVec3::ZERO, plate_kg, DVec3::splat(plate_kg));
        let body = world.bodies.insert(
            RigidBodyBuilder::dynamic()
                .translation(to_glam(&surface_w))
                .additional_mass_properties(mass)
                .gravity_scale(0.0)
                .can_sleep(false),
        );
        let plane = world.colliders.insert_with_parent(
            plane(footing, groups, friction),
            body,
            &mut world.bodies,
        );
        let joint = PrismaticJointBuilder::new(to_glam(&-footing.normal_w))
            .local_anchor1(to_glam(&surface_w))
            .local_anchor2(DVec3::ZERO)
            .contacts_enabled(false)
            .motor_model(MotorModel::ForceBased)
            .build();
        let joint = world.impulse_joints.insert(earth, body, joint, true);
        let normal_w = footing.normal_w;
        let plate = Plate { body, joint, normal_w, surface_w, settled_m: 0.0 };
        Self { plane, plate: Some(plate) }
    }

    /// Puts the plane where the ground is now: on soil, untouched soil.
    fn move_to(&mut self, world: &mut PhysicsWorld, footing: &Footing, part_w: &Vector3<f64>) {
        let surface_w = footing.below(part_w);
        if let Some(plane) = world.colliders.get_mut(self.plane) {
            plane.set_shape(SharedShape::halfspace(to_glam(&footing.normal_w)));
            if self.plate.is_none() {
                plane.set_translation(to_glam(&surface_w));
            }
        }
        if let Some(plate) = &mut self.plate {
            *plate = Plate { normal_w: footing.normal_w, surface_w, settled_m: 0.0, ..*plate };
            let body = &mut world.bodies[plate.body];
            body.set_translation(to_glam(&surface_w), true);
            body.set_linvel(DVec3::ZERO, true);
            if let Some(joint) = world.impulse_joints.get_mut(plate.joint, true) {
                let axis = to_glam(&-footing.normal_w);
                joint.data.set_local_axis1(axis).set_local_axis2(axis);
                joint.data.set_local_anchor1(to_glam(&surface_w));
            }
        }
    }
}

impl Plate {
    fn press(&self, world: &mut PhysicsWorld, soil: &Soil, radius_m: f64) {
        let mass_kg = world.bodies[self.body].mass();
        let critical_n_s_m = 2.0 * (PLATE_STIFFNESS_N_M * mass_kg).sqrt();
        let bearing_n = soil.pad_load_n(radius_m, self.depth_m(world));
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, true) {
            joint
                .data
                .set_motor_position(
                    JointAxis::LinX,
                    self.settled_m,
                    PLATE_STIFFNESS_N_M,
                    critical_n_s_m,
                )
                .set_motor_max_force(JointAxis::LinX, bearing_n);
        }
    }

    fn settle(&mut self, world: &PhysicsWorld, soil: &Soil, radius_m: f64) {
        let depth_m = self.depth_m(world);
        let spring_m = soil.pad_load_n(radius_m, depth_m) / PLATE_STIFFNESS_N_M;
        self.settled_m = self.settled_m.max(depth_m - spring_m);
    }

    fn depth_m(&self, world: &PhysicsWorld) -> f64 {
        let place_w = from_glam(world.bodies[self.body].translation());
        self.normal_w.dot(&(self.surface_w - place_w)).max(0.0)
    }
}

fn plane(footing: &Footing, groups: InteractionGroups, friction: f64) -> ColliderBuilder {
    ColliderBuilder::new(SharedShape::halfspace(to_glam(&footing.normal_w)))
        .density(0.0)
        .friction(friction)
        .collision_groups(groups)
}
