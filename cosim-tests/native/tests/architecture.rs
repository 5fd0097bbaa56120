//! The invariants of docs/ARCHITECTURE.md that can be read off the files.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Source files of Rust and Python below `folder`, with their path from the root.
fn sources(folder: &str) -> Vec<(String, String)> {
    let mut files = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && !name.starts_with('.') && name != "target" {
                folders.push(path);
            } else if name.ends_with(".rs") || name.ends_with(".py") {
                let shown = path.strip_prefix(root()).unwrap().display().to_string();
                files.push((shown, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    files.sort();
    files
}

fn all_sources() -> Vec<(String, String)> {
    ["models", "truth-model", "guidance-fmu", "fmu-build", "cosim-tests"]
        .iter()
        .flat_map(|room| sources(room))
        .collect()
}

/// Files below `rooms` whose text has `word`, this test aside.
fn naming(word: &str) -> Vec<String> {
    let here = file!().rsplit('/').next().unwrap();
    all_sources()
        .into_iter()
        .filter(|(path, text)| !path.ends_with(here) && text.contains(word))
        .map(|(path, _)| path)
        .collect()
}

#[test]
fn each_engine_is_named_in_one_place() {
    let rapier = "truth-model/src/contact/rapier/";
    assert!(naming("rapier3d_f64").iter().all(|path| path.starts_with(rapier)));
    assert_eq!(naming("clarabel::"), ["guidance-fmu/src/scvx/conic.rs"]);
    assert_eq!(naming("foxglove::"), ["cosim-tests/native/src/recorder.rs"]);
    // Its test reads the file back.
    let parquet = ["cosim-tests/native/src/study/table.rs", "cosim-tests/native/tests/campaign.rs"];
    assert_eq!(naming("parquet::"), parquet);
}

#[test]
fn truth_and_guidance_do_not_know_each_other() {
    for (room, other) in [("truth-model", "guidance-fmu"), ("guidance-fmu", "truth-model")] {
        let manifest = fs::read_to_string(root().join(room).join("Cargo.toml")).unwrap();
        assert!(!manifest.contains(other), "{room} depends on {other}");
    }
}

#[test]
fn the_models_print_nothing_and_read_no_clock() {
    for room in ["models/src", "truth-model/src", "guidance-fmu/src", "fmu-build/adapter/src"] {
        for (path, text) in sources(room) {
            for banned in ["println!", "dbg!", "std::time::", "thread::spawn", "rayon"] {
                assert!(!text.contains(banned), "{path} has {banned}");
            }
        }
    }
}

#[test]
fn unsafe_code_stays_at_the_c_boundary() {
    for (path, text) in all_sources() {
        let boundary =
            ["adapter/src/c_abi", "adapter/src/fmi2", "adapter/src/fmi3", "src/importer"];
        let allowed = boundary.iter().any(|b| path.starts_with(&format!("fmu-build/{b}/")))
            || path.contains("/tests/")
            || !path.ends_with(".rs");
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let found =
            code.into_iter().any(|line| line.contains("unsafe ") || line.contains("unsafe("));
        assert!(allowed || !found, "{path} has unsafe code");
    }
}

#[test]
fn no_file_is_longer_than_a_reader_s_patience() {
    for (path, text) in all_sources() {
        let lines = text.lines().count();
        assert!(lines <= 600, "{path} has {lines} lines");
    }
}
