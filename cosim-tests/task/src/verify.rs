//! `cargo verify`: the one list of checks, for developers and CI alike.

use std::process::{Command, Stdio};

use crate::importers;
use crate::land::{build, build_fmus, build_systems, in_root};
use crate::python;
use crate::steps::{Failure, Steps, run, say};
use crate::system;
use crate::validation::{self, Accept};
use crate::viewers;
use crate::workspace::Workspace;

pub fn verify(accept: Accept) -> Result<u8, Failure> {
    let workspace = Workspace::find()?;
    let mut steps = Steps::new(11);
    let result = checks(&workspace, &mut steps, accept);
    summarise(&steps, result.is_ok());
    result.map(|()| 0)
}

fn checks(workspace: &Workspace, steps: &mut Steps, accept: Accept) -> Result<(), Failure> {
    let cargo = |arguments: &str| {
        let mut command = in_root(Command::new("cargo"), workspace);
        run(&format!("cargo {arguments}"), command.args(arguments.split_whitespace()))
    };
    steps.run("format", || cargo("fmt --all --check"))?;
    steps.run("lint", || cargo("clippy --release --workspace --all-targets -- -D warnings"))?;
    steps.run("build", || build(workspace))?;
    steps.run("Rust tests", || {
        validation::start()?;
        cargo(test_command())
    })?;
    steps.run("FMUs", || build_fmus(workspace).and_then(|()| build_systems(workspace)))?;
    let python = steps.run("Python environment", || python::environment(workspace))?;
    steps.run("system packages", system::packages)?;
    steps.run("fmi-sim", || importers::fmi_sim(workspace))?;
    steps.run("Foxglove", || viewers::foxglove(workspace))?;
    steps.run("Python tests", || {
        let mut pytest = in_root(Command::new(python), workspace);
        pytest.args(["-m", "pytest", "--quiet", "cosim-tests/python/tests"]);
        run("pytest", pytest.env("PYTHONPATH", workspace.python_package()))
    })?;
    steps.run("validation", || validation::finish(workspace, accept))
}

fn test_command() -> &'static str {
    let nextest = Command::new("cargo")
        .args(["nextest", "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if nextest.is_ok_and(|status| status.success()) {
        "nextest run --release --workspace"
    } else {
        "test --release --workspace"
    }
}

/// Where the time went, and which step failed.
fn summarise(steps: &Steps, passed: bool) {
    let line = |text: &str| say(&mut std::io::stdout(), text);
    line("");
    let last = steps.finished.len().saturating_sub(1);
    for (index, (name, time)) in steps.finished.iter().enumerate() {
        let verdict = if passed || index < last { "ok" } else { "FAILED" };
        line(&format!("  {name:<20} {:>7.1} s   {verdict}", time.as_secs_f64()));
    }
    let verdict = if passed { "all checks passed" } else { "checks failed" };
    line(&format!("  {:<20} {:>7.1} s   {verdict}", "total", steps.elapsed().as_secs_f64()));
}
