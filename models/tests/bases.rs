//! A vehicle file may name another that it differs from in a few numbers.

use std::fs;
use std::path::{Path, PathBuf};

use lander_models::vehicle::Vehicle;

fn vehicles() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles")
}

/// The error of a file of this text, in a folder of its own beside a copy of bug.toml.
#[track_caller]
fn error(name: &str, text: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bases").join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::copy(vehicles().join("bug.toml"), folder.join("bug.toml")).unwrap();
    let file = folder.join("own.toml");
    fs::write(&file, text).unwrap();
    Vehicle::load(&file).unwrap_err().to_string()
}

#[test]
fn bug_as_demonstrated_is_bug_but_for_its_engine() {
    let bug = Vehicle::load(&vehicles().join("bug.toml")).unwrap();
    let mut fired = Vehicle::load(&vehicles().join("bug-demonstrated.toml")).unwrap();
    assert_eq!(fired.name, "BUG as demonstrated");
    assert_eq!([fired.engine.thrust_min_n, fired.engine.thrust_max_n], [1260.0, 5630.0]);
    assert_eq!(fired.engine.dead_zone_n, 945.0);
    fired.name.clone_from(&bug.name);
    fired.engine.thrust_min_n = bug.engine.thrust_min_n;
    fired.engine.thrust_max_n = bug.engine.thrust_max_n;
    fired.engine.dead_zone_n = bug.engine.dead_zone_n;
    assert_eq!(format!("{fired:?}"), format!("{bug:?}"));
}

#[test]
fn a_base_that_is_wrong_is_named_with_its_file() {
    for (name, text, parts) in [
        ("none", "base = \"nobody.toml\"", ["nobody.toml", "cannot be read"]),
        ("number", "base = 1", ["own.toml: key `base`", "must be text"]),
        ("circle", "base = \"own.toml\"", ["own.toml: key `base`", "at most 3"]),
        (
            "key",
            "base = \"bug.toml\"\n[engine]\nthrust = 1",
            ["own.toml: key `engine.thrust`", "not known"],
        ),
        // A number is replaced as a whole: its source is not the base's.
        (
            "source",
            "base = \"bug.toml\"\n[engine]\nthrust_max = { value = 1.0e4, unit = \"N\" }",
            ["own.toml: key `engine.thrust_max`", "has no source"],
        ),
    ] {
        let error = error(name, text);
        for part in parts {
            assert!(error.contains(part), "{name}: `{error}` does not say `{part}`");
        }
    }
}
