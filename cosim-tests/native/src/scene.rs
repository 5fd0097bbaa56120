//! What a viewer draws: the lander in its body frame, the ground in the world frame.
//! Only shapes here; the recorder knows how a log spells them.

use lander_models::{Scenario, Vehicle};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::terrain::Ground;

use crate::relief::{Patch, Relief};

/// Red, green, blue, opacity, each 0 to 1.
pub type Color = [f64; 4];

const STRUCTURE: Color = [0.78, 0.74, 0.62, 1.0];
const LEG: Color = [0.55, 0.55, 0.58, 1.0];
const NOZZLE: Color = [0.25, 0.25, 0.28, 1.0];
const PLUME: Color = [1.0, 0.72, 0.30, 0.45];
const GROUND: Color = [0.42, 0.41, 0.40, 1.0];
const GRID: Color = [0.58, 0.57, 0.55, 1.0];
const ROCK: Color = [0.36, 0.35, 0.34, 1.0];
const TARGET: Color = [0.95, 0.35, 0.20, 1.0];

/// Drawn radius of a footpad; its contact point is too small to see.
const PAD_RADIUS_M: f64 = 0.12;
const TARGET_RADIUS_M: f64 = 3.0;
const LIFT_M: f64 = 0.01;
/// Plume length at full thrust, for the eye only.
const PLUME_LENGTH_M: f64 = 4.0;

/// A frustum, z along its axis.
#[derive(Clone, Debug)]
pub struct Frustum {
    pub center: Vector3<f64>,
    pub attitude: UnitQuaternion<f64>,
    pub length_m: f64,
    pub bottom_radius_m: f64,
    pub top_radius_m: f64,
    pub color: Color,
}

/// Pairs of end points.
#[derive(Clone, Debug)]
pub struct Lines {
    pub points: Vec<Vector3<f64>>,
    pub thickness_m: f64,
    pub color: Color,
}

/// Triples of corners, as places in `points`.
#[derive(Clone, Debug)]
pub struct Triangles {
    pub points: Vec<Vector3<f64>>,
    pub corners: Vec<u32>,
    pub color: Color,
}

#[derive(Clone, Debug)]
pub struct Sphere {
    pub center: Vector3<f64>,
    pub radius_m: f64,
    pub color: Color,
}

#[derive(Clone, Debug, Default)]
pub struct Entity {
    pub frustums: Vec<Frustum>,
    pub lines: Vec<Lines>,
    pub triangles: Vec<Triangles>,
    pub spheres: Vec<Sphere>,
}

#[derive(Clone, Debug)]
pub struct Scene {
    /// In the body frame.
    pub lander: Entity,
    /// In the world frame.
    pub ground: Entity,
    /// Points of the ground, world frame, for viewers without entities.
    pub ground_points_w: Vec<Vector3<f64>>,
    plume: Plume,
}

#[derive(Clone, Debug)]
struct Plume {
    pivot_b: Vector3<f64>,
    exit_offset_m: f64,
    exit_radius_m: f64,
    thrust_max_n: f64,
}

impl Scene {
    pub fn new(scenario: &Scenario, vehicle: &Vehicle) -> Self {
        let engine = &vehicle.engine;
        let plume = Plume {
            pivot_b: engine.pivot_b,
            exit_offset_m: engine.pivot_b.z - engine.nozzle_exit_height_m,
            exit_radius_m: engine.nozzle_exit_radius_m,
            thrust_max_n: engine.thrust_max_n,
        };
        let terrain = Ground::new(&scenario.terrain);
        let (start_w, target_w) = (&scenario.initial.position_w, &scenario.guidance.target_w);
        let relief = Relief::about(&terrain, target_w, start_w);
        let patches = [&relief.around, &relief.site];
        Self {
            lander: lander(vehicle, &plume),
            ground: ground(&terrain, &relief, target_w),
            ground_points_w: patches.into_iter().flat_map(Patch::points_w).collect(),
            plume,
        }
    }

    /// Plume in the body frame; empty with the engine off. The gimbal turns the thrust line
    /// about body x, then about body y.
    pub fn plume(&self, thrust_n: f64, gimbal_rad: [f64; 2]) -> Entity {
        if thrust_n <= 0.0 {
            return Entity::default();
        }
        let plume = &self.plume;
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), gimbal_rad[1])
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), gimbal_rad[0]);
        let length_m = PLUME_LENGTH_M * thrust_n / plume.thrust_max_n;
        let down_m = plume.exit_offset_m + 0.5 * length_m;
        let flame = Frustum {
            center: plume.pivot_b - attitude * Vector3::z() * down_m,
            attitude,
            length_m,
            bottom_radius_m: 2.5 * plume.exit_radius_m,
            top_radius_m: plume.exit_radius_m,
            color: PLUME,
        };
        Entity { frustums: vec![flame], ..Default::default() }
    }
}

fn lander(vehicle: &Vehicle, plume: &Plume) -> Entity {
    let hull = &vehicle.hull;
    let upright = |bottom_m: f64, top_m: f64, bottom_radius_m, top_radius_m, color| Frustum {
        center: Vector3::new(0.0, 0.0, 0.5 * (bottom_m + top_m)),
        attitude: UnitQuaternion::identity(),
        length_m: top_m - bottom_m,
        bottom_radius_m,
        top_radius_m,
        color,
    };
    let mut frustums = vec![
        upright(hull.bottom_height_m, hull.top_height_m, hull.radius_m, hull.radius_m, STRUCTURE),
        upright(
            plume.pivot_b.z - plume.exit_offset_m,
            plume.pivot_b.z,
            plume.exit_radius_m,
            0.4 * plume.exit_radius_m,
            NOZZLE,
        ),
    ];
    let mut legs = Vec::new();
    for foot in vehicle.gear.feet_b() {
        let rim = Vector3::new(foot.x, foot.y, 0.0).normalize() * hull.radius_m;
        let middle_m = 0.5 * (hull.bottom_height_m + hull.top_height_m);
        for height_m in [hull.bottom_height_m, middle_m] {
            legs.extend([rim + Vector3::z() * height_m, foot]);
        }
        let pad = upright(foot.z, foot.z + 0.04, PAD_RADIUS_M, PAD_RADIUS_M, LEG);
        frustums.push(Frustum { center: foot + Vector3::z() * 0.02, ..pad });
    }
    let legs = Lines { points: legs, thickness_m: 0.05, color: LEG };
    Entity { frustums, lines: vec![legs], ..Default::default() }
}

fn ground(terrain: &Ground, relief: &Relief, target_w: &Vector3<f64>) -> Entity {
    // The site lies a little above its surroundings, which are too coarse to show it, and lines a
    // hand above the site, so that they are not lost in it.
    let raised = |lift_m: f64| move |point_w: Vector3<f64>| point_w + Vector3::z() * lift_m;
    let mesh = |patch: &Patch, lift_m| Triangles {
        points: patch.points_w().map(raised(lift_m)).collect(),
        corners: patch.triangles().collect(),
        color: GROUND,
    };
    let grid = |patch: &Patch, thickness_m| Lines {
        points: patch.lines().map(raised(2.0 * LIFT_M)).collect(),
        thickness_m,
        color: GRID,
    };
    let ring = |index: u32| {
        let (sin, cos) = libm::sincos(f64::from(index) * std::f64::consts::TAU / 32.0);
        let [x_m, y_m] = [target_w.x + TARGET_RADIUS_M * cos, target_w.y + TARGET_RADIUS_M * sin];
        Vector3::new(x_m, y_m, terrain.height_m(x_m, y_m) + 2.0 * LIFT_M)
    };
    let ring = (0..32).flat_map(|index| [ring(index), ring(index + 1)]).collect();
    let rock = |[x, y, z, radius_m]: &[f64; 4]| Sphere {
        center: Vector3::new(*x, *y, *z),
        radius_m: *radius_m,
        color: ROCK,
    };
    Entity {
        lines: vec![
            grid(&relief.around, 0.1),
            grid(&relief.site, 0.01),
            Lines { points: ring, thickness_m: 0.15, color: TARGET },
        ],
        triangles: vec![mesh(&relief.around, 0.0), mesh(&relief.site, LIFT_M)],
        spheres: relief.rocks.iter().map(rock).collect(),
        ..Default::default()
    }
}
