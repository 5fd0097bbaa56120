//! The drawing stays small whatever the scenario.

use std::path::Path;

use cosim::scene::Scene;
use lander_models::Scenario;

fn grid_points(start_m: f64) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut scenario, vehicle) =
        Scenario::load(&root.join("models/scenarios/landing.toml")).unwrap();
    scenario.initial.position_w.x = start_m;
    Scene::new(&scenario, &vehicle).ground.lines.iter().map(|lines| lines.points.len()).sum()
}

#[test]
fn a_start_far_away_gets_a_coarser_grid_and_not_a_bigger_log() {
    // 300 m out: squares of 50 m to 400 m, so 17 lines each way with 2 ends each, and the ring
    // of 32 lines around the target.
    assert_eq!(grid_points(300.0), 2 * 17 * 2 + 2 * 32);
    // Across the whole Moon: 200 squares on either side, one more for rounding.
    for start_m in [1e5, 3e8, 1e300] {
        assert!(grid_points(start_m) <= 2 * 403 * 2 + 2 * 32, "{start_m} m");
    }
}
