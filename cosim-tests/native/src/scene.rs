//! What a viewer draws: the lander in its body frame, the ground in the world frame.
//! Only shapes here; the recorder knows how a log spells them.

use lander_models::scenario::Terrain;
use lander_models::{Scenario, Vehicle};
use nalgebra::{UnitQuaternion, Vector3};

/// Red, green, blue, opacity, each 0 to 1.
pub type Color = [f64; 4];

const STRUCTURE: Color = [0.78, 0.74, 0.62, 1.0];
const LEG: Color = [0.55, 0.55, 0.58, 1.0];
const NOZZLE: Color = [0.25, 0.25, 0.28, 1.0];
const PLUME: Color = [1.0, 0.72, 0.30, 0.45];
const GROUND: Color = [0.42, 0.41, 0.40, 1.0];
const GRID: Color = [0.58, 0.57, 0.55, 1.0];
const TARGET: Color = [0.95, 0.35, 0.20, 1.0];

/// Drawn radius of a footpad; its contact point is too small to see.
const PAD_RADIUS_M: f64 = 0.12;
const TARGET_RADIUS_M: f64 = 3.0;
/// Squares of the ground's grid from its middle to its edge, at most: a start far away gets a
/// coarser grid, not a bigger log.
const GRID_CELLS_MAX: f64 = 200.0;
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

/// Triples of corners.
#[derive(Clone, Debug)]
pub struct Triangles {
    pub points: Vec<Vector3<f64>>,
    pub color: Color,
}

#[derive(Clone, Debug, Default)]
pub struct Entity {
    pub frustums: Vec<Frustum>,
    pub lines: Vec<Lines>,
    pub triangles: Vec<Triangles>,
}

#[derive(Clone, Debug)]
pub struct Scene {
    /// In the body frame.
    pub lander: Entity,
    /// In the world frame.
    pub ground: Entity,
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
        Self { lander: lander(vehicle, &plume), ground: ground(scenario), plume }
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

fn ground(scenario: &Scenario) -> Entity {
    let start = scenario.initial.position_w;
    let reach_m = (1.2 * start.x.abs().max(start.y.abs())).max(20.0);
    let nominal_m: f64 = if reach_m > 100.0 { 50.0 } else { 5.0 };
    let spacing_m = nominal_m.max(reach_m / GRID_CELLS_MAX);
    let cells = (reach_m / spacing_m).ceil();
    let edge_m = cells * spacing_m;
    let at = |x: f64, y: f64| on_plane(&scenario.terrain, x, y);

    let (a, b) = (at(-edge_m, -edge_m), at(edge_m, -edge_m));
    let (c, d) = (at(edge_m, edge_m), at(-edge_m, edge_m));
    let plane = Triangles { points: vec![a, b, c, a, c, d], color: GROUND };

    // Lines a hand above the plane, so that they are not lost in it.
    let lift = Vector3::z() * 0.02;
    let mut grid = Vec::new();
    for index in 0..=(2.0 * cells) as u32 {
        let line_m = f64::from(index) * spacing_m - edge_m;
        grid.extend([at(line_m, -edge_m), at(line_m, edge_m)]);
        grid.extend([at(-edge_m, line_m), at(edge_m, line_m)]);
    }
    let target = &scenario.guidance.target_w;
    let ring = |index: u32| {
        let (sin, cos) = (f64::from(index) * std::f64::consts::TAU / 32.0).sin_cos();
        at(target.x + TARGET_RADIUS_M * cos, target.y + TARGET_RADIUS_M * sin)
    };
    let ring = (0..32).flat_map(|index| [ring(index), ring(index + 1)]).collect();
    let lines = |points: Vec<Vector3<f64>>, thickness_m, color| Lines {
        points: points.into_iter().map(|point| point + lift).collect(),
        thickness_m,
        color,
    };
    Entity {
        lines: vec![lines(grid, 0.05, GRID), lines(ring, 0.15, TARGET)],
        triangles: vec![plane],
        ..Default::default()
    }
}

/// Point of the ground above or below world (x, y).
fn on_plane(terrain: &Terrain, x_m: f64, y_m: f64) -> Vector3<f64> {
    let normal_w = terrain.normal_w();
    let z_m = -(normal_w.x * x_m + normal_w.y * y_m) / normal_w.z;
    Vector3::new(x_m, y_m, z_m)
}
