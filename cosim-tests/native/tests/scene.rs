//! The drawing stays small whatever the scenario, and shows the ground that the truth lands on.

use std::path::Path;

use cosim::scene::Scene;
use lander_models::{Scenario, Vehicle};
use truth_model::terrain::Ground;

fn load(name: &str) -> (Scenario, Vehicle) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Scenario::load(&root.join(format!("models/scenarios/{name}.toml"))).unwrap()
}

#[test]
fn a_start_far_away_gets_coarser_squares_and_not_a_bigger_log() {
    let points = |start_m: f64| -> usize {
        let (mut scenario, vehicle) = load("landing");
        scenario.initial.position_w.x = start_m;
        Scene::new(&scenario, &vehicle).ground.lines.iter().map(|lines| lines.points.len()).sum()
    };
    // Across the whole Moon, and beyond.
    assert_eq!([1e5, 3e8, 1e300].map(points), [points(300.0); 3]);
}

#[test]
fn the_relief_is_drawn_where_it_is_and_rocks_lie_on_it() {
    let (scenario, vehicle) = load("crater-field");
    let scene = Scene::new(&scenario, &vehicle);
    let ground = Ground::new(&scenario.terrain);
    let heights: Vec<f64> = scene.ground_points_w.iter().map(|point_w| point_w.z).collect();
    let (least, most) = heights.iter().fold((0.0_f64, 0.0_f64), |(a, b), z| (a.min(*z), b.max(*z)));
    assert!(most - least > 0.1, "craters leave {} m of relief", most - least);
    for point_w in &scene.ground_points_w {
        // Rounded to a millimetre.
        assert!((point_w.z - ground.height_m(point_w.x, point_w.y)).abs() <= 5.1e-4);
    }
    assert!(!scene.ground.spheres.is_empty());
    for rock in &scene.ground.spheres {
        let height_m = rock.center.z - ground.height_m(rock.center.x, rock.center.y);
        assert!(height_m.abs() <= rock.radius_m, "a rock {height_m} m above the ground");
    }
    for triangles in &scene.ground.triangles {
        let corners = triangles.points.len() as u32;
        assert!(triangles.corners.iter().all(|corner| *corner < corners));
    }
}
