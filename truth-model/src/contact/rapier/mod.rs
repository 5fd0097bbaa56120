//! The reference contact engine. This room alone names Rapier.
//!
//! One hull body and one small footpad body per leg on a prismatic joint along its stroke axis.
//! The joint's motor is the strut: an implicit spring-damper towards the crushed length whose
//! force is capped at the crush load, which makes it flow plastically (T.10). Settings and the
//! reasons for them: README, "Rapier engine".

mod bodies;
mod convert;
mod ground;

use lander_models::mass::MassProperties;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::{TICK_S, Ticks};
use nalgebra::Vector3;
use rapier3d_f64::dynamics::{FrictionModel, JointAxis, RigidBodyHandle, SpringCoefficients};
use rapier3d_f64::geometry::ColliderHandle;
use rapier3d_f64::pipeline::PhysicsWorld;
use serde::{Deserialize, Serialize};

use super::{ContactEngine, Site, Touch};
use crate::flight::Motion;
use crate::gear::{LegState, crush_load_n, crushed_after};
use crate::propulsion::{Drive, Wrench};
use crate::slosh;
use bodies::{Foot, hull_body, hull_mass, insert_bob, insert_foot, insert_structure};
use convert::{from_glam, from_glam_rotation, to_glam};
use ground::Soilbed;

/// Stiffness of pad on ground: 2e7 N/m for a foot of 2 kg, 0.08 mm under a crush load. Rapier's
/// default (60 Hz, overdamped) adds millimetres of its own to a stroke.
const PAD_NATURAL_FREQUENCY_HZ: f64 = 500.0;
/// Slower than this neither a touch nor a stroke needs finer steps, m/s: 0.3 mm of a stroke that
/// such a speed leads to.
const GENTLE_M_S: f64 = 0.1;
/// A vehicle slower than this for so long is calm, and then stands.
const STILL_M_S: f64 = 0.02;
const CALM_TIME: Ticks = Ticks(20);
const STANDING_TIME: Ticks = Ticks(600);

/// How finely a tick is solved. Measured against the closed forms: README, "Rapier engine".
#[derive(Clone, Copy)]
struct Pace {
    steps: u32,
    /// Sub-steps of a step.
    iterations: usize,
    /// Sweeps of a sub-step over joints and contacts.
    sweeps: usize,
}

/// A pad comes down, or the structure, or a strut reaches its stop: Rapier stops it up to
/// two sub-steps early, and a strut then works for so much longer.
const TOUCHING: Pace = Pace { steps: 16, iterations: 8, sweeps: 2 };
/// A strut strokes: the semi-implicit sub-step h takes v h/2 of the stroke.
const STROKING: Pace = Pace { steps: 4, iterations: 4, sweeps: 2 };
/// Rocking, turning and sliding.
const MOVING: Pace = Pace { steps: 1, iterations: 4, sweeps: 4 };
/// Hardly moves: a sub-step of 1 ms takes 20 µm of it, and creep has no time to add up.
const CALM: Pace = Pace { steps: 1, iterations: 1, sweeps: 4 };
/// Standing: what the sweeps leave of friction would let it creep.
const STANDING: Pace = Pace { steps: 1, iterations: 2, sweeps: 16 };

/// The engine at one instant: plain data, `Clone` and serialisable.
#[derive(Serialize, Deserialize)]
pub struct RapierWorld {
    world: PhysicsWorld,
    hull: RigidBodyHandle,
    /// Hull and nozzle: what must not touch.
    structure: [ColliderHandle; 2],
    feet: Vec<Foot>,
    bobs: Vec<RigidBodyHandle>,
    ground: Soilbed,
    /// Propellant for which the hull's mass was set, and whether it sloshed.
    loaded: Option<(f64, bool)>,
    /// Pads that touched in the last step.
    standing: [bool; FOOT_SLOTS],
    /// For how long the vehicle has hardly moved.
    still: Ticks,
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
        let (feet, bobs) = (self.feet.clone(), self.bobs.clone());
        Self { world, feet, bobs, ground: self.ground.clone(), ..*self }
    }
}

impl ContactEngine for RapierWorld {
    fn take_over(site: &Site, motion: &Motion, legs: &[LegState]) -> Self {
        let vehicle = site.vehicle;
        let mut world = PhysicsWorld::default();
        tune(&mut world);
        let hull = hull_body(vehicle, &slosh::rest(vehicle, motion), motion);
        let hull = world.bodies.insert(hull);
        let structure = insert_structure(&mut world, vehicle, hull, site.terrain.friction);
        let gear = &vehicle.gear;
        let feet = (gear.legs.iter().zip(legs).enumerate())
            .map(|(part, (leg, state))| {
                let leg = (gear, leg, part);
                insert_foot(&mut world, leg, hull, state, motion, site.pad_friction())
            })
            .collect();
        let bobs = (vehicle.slosh.iter())
            .flat_map(|tanks| tanks.hinges_b.iter().map(move |hinge_b| (tanks, hinge_b)))
            .zip(slosh::bobs(vehicle, motion))
            .map(|(tank, bob)| insert_bob(&mut world, hull, tank, &bob, motion))
            .collect();
        let ground = Soilbed::new(&mut world, site, &parts_w(site, motion, legs));
        let standing = [false; FOOT_SLOTS];
        let (loaded, still) = (None, Ticks::ZERO);
        Self { world, hull, structure, feet, bobs, ground, loaded, standing, still }
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
        let burn = drive.burn(vehicle, motion);
        self.world.gravity = to_glam(&site.gravity_w);
        self.set_mass(site, motion);
        self.apply(motion, &burn.mass, [burn.driven, burn.inside(&motion.rate_b)]);
        let parts_w = parts_w(site, motion, legs);
        self.ground.follow(&mut self.world, site, &parts_w);
        let pace = self.pace(site, &parts_w, legs);
        let steps = site.refinement * pace.steps;
        let parameters = &mut self.world.integration_parameters;
        parameters.dt = TICK_S / f64::from(steps);
        parameters.num_solver_iterations = pace.iterations;
        parameters.num_internal_pgs_iterations = pace.sweeps;
        let mut touch = Touch::default();
        for _ in 0..steps {
            self.substep(site, legs);
            if !self.world.quarantine().is_empty() {
                return None;
            }
            self.read_legs(site, legs);
            for ((down, leg), standing) in touch.feet.iter_mut().zip(&*legs).zip(&mut self.standing)
            {
                *standing = leg.ground_force_w != Vector3::zeros();
                *down |= *standing;
            }
            let [hull, nozzle] = self.structure.map(|part| self.touches(part));
            touch.structure.hull |= hull;
            touch.structure.nozzle |= nozzle;
        }
        motion.actuate(drive.following(vehicle, TICK_S).after(motion.actuators()));
        motion.propellant_kg = (motion.propellant_kg - burn.flow_kg_s * TICK_S).max(0.0);
        self.read_motion(site, motion);
        Some(touch)
    }
}

impl RapierWorld {
    fn pace(&mut self, site: &Site, parts_w: &[Vector3<f64>], legs: &[LegState]) -> Pace {
        let hull = &self.world.bodies[self.hull];
        let speed_m_s =
            hull.linvel().length() + hull.angvel().length() * site.vehicle.hull.top_height_m;
        self.still = if speed_m_s < STILL_M_S { self.still + Ticks(1) } else { Ticks::ZERO };
        let (mut touching, mut stroking) = (false, false);
        for (n, foot) in self.feet.iter().enumerate() {
            let velocity_w = from_glam(self.world.bodies[foot.body].linvel());
            if self.standing[n] {
                let rate_m_s = legs[n].stroke_rate_m_s;
                let left_m = site.vehicle.gear.legs[n].strut.stroke_max_m - legs[n].stroke_m;
                stroking |= rate_m_s.abs() > GENTLE_M_S;
                touching |= rate_m_s > GENTLE_M_S && left_m < 2.0 * TICK_S * rate_m_s;
            } else {
                let footing = site.footing(&parts_w[n]);
                let gap_m = footing.clearance_m(&parts_w[n]) - site.vehicle.gear.pad_radius_m;
                let closing_m_s = -footing.normal_w.dot(&velocity_w);
                touching |= closing_m_s > GENTLE_M_S && gap_m < 2.0 * TICK_S * closing_m_s;
            }
        }
        touching |= self.structure_near(site, parts_w, speed_m_s);
        match () {
            () if touching => TOUCHING,
            () if stroking => STROKING,
            () if self.still > STANDING_TIME => STANDING,
            () if self.still > CALM_TIME => CALM,
            () => MOVING,
        }
    }

    /// Whether hull or nozzle may meet the ground within two ticks.
    fn structure_near(&self, site: &Site, parts_w: &[Vector3<f64>], speed_m_s: f64) -> bool {
        let (hull, engine) = (&site.vehicle.hull, &site.vehicle.engine);
        let axis_w = from_glam_rotation(*self.world.bodies[self.hull].rotation()) * Vector3::z();
        let [.., bottom_w, nozzle_w] = parts_w else { return false };
        let top_w = bottom_w + axis_w * (hull.top_height_m - hull.bottom_height_m);
        let rims = [
            (*bottom_w, hull.radius_m),
            (top_w, hull.radius_m),
            (*nozzle_w, engine.nozzle_exit_radius_m),
        ];
        speed_m_s > GENTLE_M_S
            && rims.iter().any(|(centre_w, radius_m)| {
                let under = site.footing(centre_w);
                let drop_m = radius_m * axis_w.cross(&under.normal_w).norm();
                under.clearance_m(centre_w) - drop_m < 2.0 * TICK_S * speed_m_s
            })
    }

    fn substep(&mut self, site: &Site, legs: &[LegState]) {
        let gear = &site.vehicle.gear;
        for ((foot, leg), state) in self.feet.iter().zip(&gear.legs).zip(legs) {
            if let Some(joint) = self.world.impulse_joints.get_mut(foot.joint, true) {
                let strut = &leg.strut;
                let (stiffness, damping) = (strut.stiffness_n_m, strut.damping_n_s_m);
                joint
                    .data
                    .set_motor_position(JointAxis::LinX, state.crushed_m, stiffness, damping)
                    .set_motor_max_force(JointAxis::LinX, crush_load_n(strut, state.stroke_m));
            }
        }
        if let Some(soil) = &site.terrain.soil {
            self.ground.press(&mut self.world, soil, gear.bearing_radius_m);
        }
        self.world.step();
        if let Some(soil) = &site.terrain.soil {
            self.ground.settle(&self.world, soil, gear.bearing_radius_m);
        }
    }

    /// Keeps the velocity of O when the centre of mass moves: Rapier's is that of the centre of mass.
    fn set_mass(&mut self, site: &Site, motion: &Motion) {
        let load = Some((motion.propellant_kg, motion.slosh.are_active()));
        if self.loaded == load {
            return;
        }
        self.loaded = load;
        let hull = &mut self.world.bodies[self.hull];
        let (properties, com_b) = hull_mass(&site.vehicle.gear, &slosh::rest(site.vehicle, motion));
        hull.set_additional_mass_properties(properties, true);
        hull.recompute_mass_properties_from_colliders(&self.world.colliders);
        hull.set_linvel(to_glam(&motion.point_velocity_w(&com_b)), true);
    }

    fn apply(&mut self, motion: &Motion, mass: &MassProperties, wrenches: [Wrench; 2]) {
        let com_w = to_glam(&motion.point_position_w(&mass.com_b));
        let hull = &mut self.world.bodies[self.hull];
        hull.reset_forces(true);
        hull.reset_torques(true);
        for Wrench { force_b, torque_b } in wrenches {
            // About the whole vehicle's centre of mass, not the hull body's.
            hull.add_force_at_point(to_glam(&(motion.attitude_wb * force_b)), com_w, true);
            hull.add_torque(to_glam(&(motion.attitude_wb * torque_b)), true);
        }
    }

    fn read_motion(&self, site: &Site, motion: &mut Motion) {
        let hull = &self.world.bodies[self.hull];
        motion.position_w = from_glam(hull.translation());
        motion.attitude_wb = from_glam_rotation(*hull.rotation());
        let rate_w = from_glam(hull.angvel());
        motion.rate_b = motion.attitude_wb.inverse() * rate_w;
        let com_to_origin_w = motion.position_w - from_glam(hull.center_of_mass());
        motion.velocity_w = from_glam(hull.linvel()) + rate_w.cross(&com_to_origin_w);
        let bobs_w = self.bobs.iter().map(|bob| {
            let bob = &self.world.bodies[*bob];
            (from_glam(bob.translation()), from_glam(bob.linvel()))
        });
        slosh::set_bobs(site.vehicle, motion, bobs_w);
    }

    fn read_legs(&self, site: &Site, legs: &mut [LegState]) {
        let gear = &site.vehicle.gear;
        let hull = &self.world.bodies[self.hull];
        let (origin_w, attitude_wb) =
            (from_glam(hull.translation()), from_glam_rotation(*hull.rotation()));
        for (n, (foot, leg)) in self.feet.iter().zip(&gear.legs).enumerate() {
            let axis_w = attitude_wb * leg.stroke_axis_b;
            let free_w = origin_w + attitude_wb * gear.pad_centre_b(leg);
            let body = &self.world.bodies[foot.body];
            let stroke_m = (from_glam(body.translation()) - free_w).dot(&axis_w);
            let step_s = self.world.integration_parameters.dt;
            let cap_n = crush_load_n(&leg.strut, legs[n].stroke_m);
            legs[n] = LegState {
                stroke_m,
                stroke_rate_m_s: (stroke_m - legs[n].stroke_m) / step_s,
                crushed_m: crushed_after(&leg.strut, cap_n, legs[n].crushed_m, stroke_m),
                load_n: self.strut_load_n(foot),
                ground_force_w: self.ground_force_w(foot.pad),
                sinkage_m: self.ground.sinkage_m(n),
            };
        }
    }

    /// Length of the last sub-step, of which Rapier keeps the impulses.
    fn substep_s(&self) -> f64 {
        let parameters = &self.world.integration_parameters;
        parameters.dt / parameters.num_solver_iterations as f64
    }

    /// Load along the stroke axis in the last sub-step, compression positive. A strut on its stop
    /// has a spike that this does not see.
    fn strut_load_n(&self, foot: &Foot) -> f64 {
        let axis = JointAxis::LinX as usize;
        self.world.impulse_joints.get(foot.joint).map_or(0.0, |joint| {
            let impulse_n_s = joint.data.motors[axis].impulse + joint.data.limits[axis].impulse;
            impulse_n_s / self.substep_s()
        })
    }

    /// Force of ground and rocks on a part in the last sub-step.
    fn ground_force_w(&self, part: ColliderHandle) -> Vector3<f64> {
        let mut impulse = Vector3::zeros();
        for pair in self.world.narrow_phase.contact_pairs_with(part) {
            // Rapier's impulses are those on the pair's first collider, along minus the normal.
            let sign = if pair.collider1 == part { 1.0 } else { -1.0 };
            for manifold in pair.manifolds() {
                let normal_w = from_glam(manifold.data.normal);
                for point in &manifold.points {
                    let sliding = from_glam(point.data.warmstart_tangent_world);
                    impulse += (sliding - normal_w * point.data.warmstart_impulse) * sign;
                }
            }
        }
        impulse / self.substep_s()
    }

    /// Whether the last step gave the part an impulse. Distance would tell one tick late: Rapier
    /// stops a part within the tick in which it would reach the ground.
    fn touches(&self, part: ColliderHandle) -> bool {
        let mut pairs = self.world.narrow_phase.contact_pairs_with(part);
        pairs.any(|pair| pair.total_impulse_magnitude() > 0.0)
    }
}

/// Where the parts are that may touch: centres of the pads, of the hull's and of the nozzle's lower
/// end.
fn parts_w(site: &Site, motion: &Motion, legs: &[LegState]) -> Vec<Vector3<f64>> {
    let (gear, hull, engine) = (&site.vehicle.gear, &site.vehicle.hull, &site.vehicle.engine);
    let pads = gear.legs.iter().zip(legs);
    let pads = pads.map(|(leg, now)| gear.pad_centre_b(leg) + leg.stroke_axis_b * now.stroke_m);
    let structure = [hull.bottom_height_m, engine.nozzle_exit_height_m].map(|z| Vector3::z() * z);
    pads.chain(structure).map(|part_b| motion.point_position_w(&part_b)).collect()
}

fn tune(world: &mut PhysicsWorld) {
    let p = &mut world.integration_parameters;
    // None leaves position errors' velocities in: tip-over speeds then err by 8 %. More add nothing.
    p.num_internal_stabilization_iterations = 2;
    p.friction_model = FrictionModel::Coulomb;
    p.contact_clustering = false;
    p.contact_recycling = false;
    p.max_ccd_substeps = 0;
    // The default clamps every body to 400 m/s without a word.
    p.normalized_max_linear_velocity = f64::MAX;
    p.static_contact_softness = SpringCoefficients::new(PAD_NATURAL_FREQUENCY_HZ, 1.0);
}
