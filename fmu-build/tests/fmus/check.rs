//! What `check` finds in FMUs that it runs.

use std::path::Path;
use std::process::{Command, Output};

use crate::workshop::{FMI3, Workshop, problems_with};
use fmu_build::Stamp;
use fmu_build::check::{Demands, inspect, run};
use fmu_build::platform::Platform;

/// Names of the trials that `file` fails, and how many there are.
fn failed(file: &Path) -> (Vec<String>, usize) {
    let (_, fmu) = inspect(file, &Demands::default()).unwrap();
    let findings: Vec<_> = run(&fmu.unwrap()).collect();
    let failed = findings.iter().filter(|finding| !finding.passed);
    (failed.map(|finding| finding.check.clone()).collect(), findings.len())
}

#[test]
fn an_honest_library_passes_every_trial_in_each_variant() {
    let workshop = Workshop::new("honest");
    // The stand-in has truth's interface.
    for file in &workshop.build("out", Stamp::default()).unwrap()[..3] {
        assert_eq!(failed(file), (vec![], 13), "{}", file.display());
    }
}

#[test]
fn a_model_that_keeps_something_outside_its_state_is_found() {
    let workshop = Workshop::with("forgetful", "forgetful");
    let (failed, _) = failed(&workshop.build("out", Stamp::default()).unwrap()[FMI3]);
    for trial in ["two instances", "threads", "save and restore", "serialise", "reset"] {
        assert!(failed.iter().any(|name| name == trial), "{trial} passed: {failed:?}");
    }
    // It breaks none of the rules of calls.
    for trial in ["load", "wrong token", "fly"] {
        assert!(!failed.iter().any(|name| name == trial), "{trial} failed");
    }
}

#[test]
fn demands_on_libraries_are_checked() {
    let workshop = Workshop::new("demands");
    let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
    let path = "binaries/x86_64-linux/lander_truth.so";
    let demands = Demands { glibc: Some((2, 0)), platforms: vec![Platform::LinuxX86_64] };
    let problems = problems_with(file, &demands);
    assert!(problems[0].starts_with(&format!("{path} needs glibc 2.")), "{problems:?}");
    assert!(problems[0].ends_with(", above glibc 2.0"), "{problems:?}");
    let demands = Demands { glibc: None, platforms: Platform::ALL.to_vec() };
    let missing = ["aarch64-linux/lander_truth.so", "x86_64-windows/lander_truth.dll"];
    let missing = missing.map(|path| format!("binaries/{path} is missing"));
    assert_eq!(problems_with(file, &demands), missing);
}

fn check(arguments: &[&str], file: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fmu-build"));
    command.arg("check").args(arguments).arg(file).output().unwrap()
}

#[test]
fn the_command_says_what_it_found_and_its_exit_code_whether_all_is_well() {
    let workshop = Workshop::with("forgetful", "command");
    let file = &workshop.build("out", Stamp::default()).unwrap()[FMI3];
    let told = check(&[], file);
    assert_eq!(told.status.code(), Some(1));
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.contains("  FAIL  save and restore   "), "{text}");
    assert!(text.contains("  pass  load               FMI 3.0"), "{text}");

    let told = check(&["--json"], file);
    assert_eq!(told.status.code(), Some(1));
    let report: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(report["passed"], false);
    let checks = report["files"][0]["checks"].as_array().unwrap();
    let of = |name: &str| checks.iter().find(|check| check["check"] == name).unwrap();
    assert_eq!((&of("reset")["passed"], &of("load")["passed"]), (&false.into(), &true.into()));

    assert_eq!(check(&["--no-run"], file).status.code(), Some(0));
    assert_eq!(check(&["--no-run", "--glibc", "2.0"], file).status.code(), Some(1));
    assert_eq!(check(&["--glibc", "two"], file).status.code(), Some(2));
}
