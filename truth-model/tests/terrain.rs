//! The relief: a meshed plane is the plane, the surface is smooth, and the nearest point is the
//! nearest.

mod common;

use claims::{Bound, Claim};
use common::relief::{cratered, level, meshed, place};
use common::{bug, on_plane};
use lander_models::scenario::{Scenario, Terrain};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::TruthModel;
use truth_model::terrain::{Cylinder, Ground};

const SLOPE_RAD: f64 = 0.2;
const DOWNHILL_RAD: f64 = 0.7;

/// A slope, and the same slope as a grid with 0.1 m between its nodes.
fn slope_and_mesh() -> (Terrain, Terrain) {
    let slope = Terrain { slope_rad: SLOPE_RAD, downhill_rad: DOWNHILL_RAD, ..level() };
    let (sin, cos) = DOWNHILL_RAD.sin_cos();
    let fall = SLOPE_RAD.tan();
    (slope, meshed(0.1, 12.0, |x_m, y_m| 1000.0 - fall * (cos * x_m + sin * y_m)))
}

/// Elevations near 1000 m have their last bit at 1.1e-13 m, which one cell's slope takes over
/// 0.1 m; sums of sixteen such nodes may lose ten times that.
const MESH_M: f64 = 2e-12;
const MESH_NORMAL: f64 = 2e-11;

#[test]
fn a_finely_meshed_plane_is_the_plane() {
    let (slope, mesh) = slope_and_mesh();
    let (plane, mesh) = (Ground::new(&slope), Ground::new(&mesh));
    assert!(plane.is_plane() && !mesh.is_plane());
    let (mut clearances_m, mut normals) = (Vec::new(), Vec::new());
    for index in 0..2000 {
        let point_w = place(index, Vector3::new(8.0, 8.0, 4.0));
        let (a, b) = (plane.nearest(&point_w), mesh.nearest(&point_w));
        clearances_m.push(a.clearance_m - b.clearance_m);
        normals.push((a.normal_w - b.normal_w).norm());
        let height_m = plane.height_m(point_w.x, point_w.y);
        clearances_m.push(height_m - mesh.height_m(point_w.x, point_w.y));
        let top_w = point_w + place(index + 5000, Vector3::repeat(2.0));
        let part = Cylinder { bottom_w: point_w, top_w, radius_m: 0.7 };
        let [on_plane_m, on_mesh_m] =
            [&plane, &mesh].map(|ground| ground.cylinder_clearance_m(&part));
        clearances_m.push(on_plane_m - on_mesh_m);
    }
    Claim {
        id: "mesh-clearance",
        section: "Terrain",
        claim: "height and clearances of points and cylinders over a finely meshed slope",
        reference: "the plane itself",
        unit: "m",
        bound: Bound::AtMost(MESH_M),
        origin: "last bit of an elevation of 1000 m, 1.1e-13 m, in sums of sixteen",
        noise: MESH_M,
    }
    .holds_for(clearances_m);
    Claim {
        id: "mesh-normal",
        section: "Terrain",
        claim: "normal of the same",
        reference: "the plane's",
        unit: "",
        bound: Bound::AtMost(MESH_NORMAL),
        origin: "the same over a cell of 0.1 m",
        noise: MESH_NORMAL,
    }
    .holds_for(normals);
}

#[test]
fn the_vehicle_stands_as_high_over_the_mesh_as_over_the_plane() {
    let (slope, mesh) = slope_and_mesh();
    let mut setup = on_plane(bug(), 20.0);
    for index in 0..200 {
        setup.scenario.initial.position_w =
            place(index, Vector3::new(4.0, 4.0, 0.5)) + Vector3::z() * 2.0;
        let angles = place(index + 5000, Vector3::repeat(0.5));
        setup.scenario.initial.attitude_wb =
            UnitQuaternion::from_euler_angles(angles.x, angles.y, angles.z);
        let [plane, mesh] = [&slope, &mesh].map(|terrain| {
            setup.scenario.terrain = terrain.clone();
            let model = setup.model();
            let state = model.initial_state();
            let feet: Vec<_> = model.foot_clearances_m(&state).collect();
            (model.lowest_m(&state), feet)
        });
        assert!((plane.0 - mesh.0).abs() < MESH_M, "{plane:?} {mesh:?}");
        for (a, b) in plane.1.iter().zip(&mesh.1) {
            assert!((a - b).abs() < MESH_M, "{plane:?} {mesh:?}");
        }
    }
}

#[test]
fn cubic_convolution_reproduces_every_quadratic() {
    // Keys (1981): third order with -1/2, so that quadratics are exact, here to rounding.
    let quadratic = |x: f64, y: f64| 0.3 * x - 0.2 * y + 0.05 * x * x - 0.03 * x * y + 0.02 * y * y;
    let ground = Ground::new(&meshed(0.5, 6.0, quadratic));
    for index in 0..500 {
        let at = place(index, Vector3::new(5.0, 5.0, 0.0));
        let height_m = quadratic(at.x, at.y);
        assert!((ground.height_m(at.x, at.y) - height_m).abs() < 1e-13);
        let normal_w = ground.nearest(&Vector3::new(at.x, at.y, height_m)).normal_w;
        let by_x = 0.3 + 0.1 * at.x - 0.03 * at.y;
        let by_y = -0.2 - 0.03 * at.x + 0.04 * at.y;
        assert!((normal_w - Vector3::new(-by_x, -by_y, 1.0).normalize()).norm() < 1e-12);
    }
}

/// Gradient of the relief at a place, from the normal there.
fn gradient(ground: &Ground, x_m: f64, y_m: f64) -> [f64; 2] {
    let on_ground = Vector3::new(x_m, y_m, ground.height_m(x_m, y_m));
    let normal_w = ground.nearest(&on_ground).normal_w;
    [-normal_w.x / normal_w.z, -normal_w.y / normal_w.z]
}

fn rough() -> Terrain {
    let waves = |x: f64, y: f64| 40.0 + 0.3 * (1.3 * x).sin() + 0.2 * (0.9 * y + x).cos();
    Terrain { slope_rad: 0.1, ..meshed(0.5, 20.0, waves) }
}

#[test]
fn heights_and_normals_agree_and_neither_jumps() {
    for terrain in [cratered(), rough()] {
        let ground = Ground::new(&terrain);
        let step_m = 1e-4;
        let mut before: Option<[f64; 2]> = None;
        // A path that runs through rims, flanks, cells and the grid's edge at all angles.
        for index in 0..400_000 {
            let along_m = f64::from(index) * step_m;
            let (x_m, y_m) = (along_m - 15.0, 0.37 * along_m - 4.0);
            let now = gradient(&ground, x_m, y_m);
            if index % 50 == 0 {
                let h_m = |dx: f64, dy: f64| ground.height_m(x_m + dx, y_m + dy);
                let central = [
                    (h_m(step_m, 0.0) - h_m(-step_m, 0.0)) / (2.0 * step_m),
                    (h_m(0.0, step_m) - h_m(0.0, -step_m)) / (2.0 * step_m),
                ];
                for axis in 0..2 {
                    // Across a jump in curvature of 2/m a central difference errs by a quarter of
                    // jump times step.
                    assert!((now[axis] - central[axis]).abs() < 1e-4, "{x_m} {now:?} {central:?}");
                }
            }
            if let Some(last) = before.replace(now) {
                let turn = (now[0] - last[0]).hypot(now[1] - last[1]);
                // No curvature beyond 3/m here, so a step of 0.1 mm turns the gradient by less.
                assert!(turn < 3.0 * 1.07 * step_m, "{x_m}: {last:?} to {now:?}");
            }
        }
    }
}

#[test]
fn the_nearest_point_is_what_a_search_finds() {
    let mut errors_m = Vec::new();
    for terrain in [cratered(), rough()] {
        let ground = Ground::new(&terrain);
        for index in 0..300 {
            let mut point_w = place(index, Vector3::new(18.0, 18.0, 0.0));
            // Within the least radius of curvature above; the feet's distance and more.
            let gap_m = 0.3 * f64::from(index as u32 % 10) / 9.0 - 0.05;
            point_w.z = ground.height_m(point_w.x, point_w.y) + gap_m;
            let found = ground.nearest(&point_w);
            // Ever finer squares about the best place so far.
            let (mut best_m, mut centre, mut half_m) = (f64::INFINITY, point_w.xy(), gap_m.abs());
            for _ in 0..12 {
                let about = centre;
                for node in 0..21 * 21 {
                    let offset = |k: i32| f64::from(k - 10) / 10.0 * half_m;
                    let at = about + nalgebra::Vector2::new(offset(node % 21), offset(node / 21));
                    let foot_w = Vector3::new(at.x, at.y, ground.height_m(at.x, at.y));
                    let distance_m = (point_w - foot_w).norm();
                    if distance_m < best_m {
                        (best_m, centre) = (distance_m, at);
                    }
                }
                half_m *= 0.25;
            }
            errors_m.push(found.clearance_m.abs() - best_m);
            assert!(found.clearance_m * gap_m >= 0.0);
        }
    }
    Claim {
        id: "nearest-point",
        section: "Terrain",
        claim: "distance to the nearest point of craters and of a rough map",
        reference: "exhaustive search",
        unit: "m",
        bound: Bound::AtMost(1e-8),
        origin: "the search's last squares are 1e-9 m wide",
        noise: 1e-9,
    }
    .holds_for(errors_m);
}

#[test]
fn a_crater_has_the_depth_and_rim_that_were_asked_for() {
    let mut terrain = cratered();
    let craters = terrain.craters.as_mut().unwrap();
    // About one crater, and alone in its disc: 20 m wide in 100 m.
    (craters.diameter_min_m, craters.diameter_max_m) = (20.0, 21.0);
    craters.density_at_1m_m2 = 0.05;
    craters.freshness_min = 1.0;
    let ground = Ground::new(&terrain);
    let all = ground.craters();
    let alone = |a: &&truth_model::terrain::Crater| {
        let others = all.iter().filter(|b| b.centre_m != a.centre_m);
        others.map(|b| (a.centre_m - b.centre_m).norm()).all(|d| d > 32.0)
    };
    let crater = all.iter().find(alone).unwrap();
    let height_m =
        |rho: f64| ground.height_m(crater.centre_m.x + rho * crater.radius_m, crater.centre_m.y);
    let depth_m = 0.12 * 2.0 * crater.radius_m;
    // Rounding of heights of a metre.
    assert!((height_m(1.0) - 0.18 * depth_m).abs() < 1e-12);
    assert!((height_m(1.0) - height_m(0.0) - depth_m).abs() < 1e-12);
    assert!(height_m(0.98) < height_m(1.0) && height_m(1.02) < height_m(1.0));
    assert_eq!(height_m(1.5), 0.0);
}

#[test]
fn a_map_s_origin_lies_at_world_zero_unless_the_datum_says_otherwise() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/hills.toml");
    let (mut scenario, vehicle) = Scenario::load(file.as_ref()).unwrap();
    let model = TruthModel::new(scenario.clone(), vehicle);
    assert_eq!(model.ground().height_m(0.0, 0.0), 0.0);
    let node_m = model.ground().height_m(10.0, 10.0);
    scenario.terrain.heightmap.as_mut().unwrap().datum_m = Some(-1200.0);
    // Line 23, column 24 of the map: -1195.25 m.
    let ground = Ground::new(&scenario.terrain);
    assert_eq!(ground.height_m(10.0, 10.0), 4.75);
    assert!((node_m - 4.75 + ground.height_m(0.0, 0.0)).abs() < 1e-12);
}

#[test]
fn a_model_prints_short_whatever_its_terrain() {
    let mut setup = on_plane(bug(), 20.0);
    for terrain in [cratered(), rough()] {
        setup.scenario.terrain = terrain;
        let print = format!("{:?}", setup.model().ground());
        assert!(print.len() < 300, "{print}");
    }
}
