//! Foxglove Studio as its own packages bring it, for tests of the log.

use std::fs;
use std::process::Command;

use crate::steps::{Failure, run};
use crate::workspace::Workspace;

/// Installs below the target folder what the lock file says, unless it is there.
pub fn foxglove(workspace: &Workspace) -> Result<(), Failure> {
    let source = workspace.root.join("cosim-tests/viewers");
    let folder = workspace.target.join("viewers");
    let failed = |error: std::io::Error| Failure::new(format!("{}: {error}", folder.display()));
    let lock = fs::read(source.join("package-lock.json")).map_err(failed)?;
    // The lock file as last installed.
    let stamp = folder.join("installed.lock");
    if fs::read(&stamp).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    fs::create_dir_all(&folder).map_err(failed)?;
    for name in ["package.json", "package-lock.json"] {
        fs::copy(source.join(name), folder.join(name)).map_err(failed)?;
    }
    run(
        "npm ci",
        Command::new("npm")
            .args(["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"])
            .arg("--prefix")
            .arg(&folder),
    )?;
    fs::write(&stamp, lock).map_err(failed)
}
