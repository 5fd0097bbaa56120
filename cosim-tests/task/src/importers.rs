//! Importers that Python packages don't bring: built from crates.io, apart from the kit's own build.

use std::fs;
use std::process::Command;

use crate::steps::{Failure, run};
use crate::workspace::Workspace;

const FMI_SIM: &str = "0.7.0";

/// Installs fmi-sim below the target folder. Unoptimised, because the time of a landing is that of
/// our own libraries, and with co-simulation alone.
pub fn fmi_sim(workspace: &Workspace) -> Result<(), Failure> {
    let root = workspace.target.join("importers");
    // What cargo has installed there.
    let installed = fs::read_to_string(root.join(".crates.toml")).unwrap_or_default();
    if installed.contains(&format!("\"fmi-sim {FMI_SIM} ")) {
        return Ok(());
    }
    let build = root.join("build");
    run(
        "cargo install fmi-sim",
        Command::new("cargo")
            .args(["install", "fmi-sim", "--quiet", "--debug", "--locked", "--force", "--version"])
            .args([FMI_SIM, "--no-default-features", "--features", "fmi2,fmi3,cs", "--root"])
            .arg(&root)
            .arg("--target-dir")
            .arg(&build)
            .env("CARGO_PROFILE_DEV_DEBUG", "false"),
    )?;
    // Some hundred megabytes that only a next version would use.
    fs::remove_dir_all(&build)
        .map_err(|error| Failure::new(format!("{}: {error}", build.display())))
}
