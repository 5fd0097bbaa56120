//! Programs of the operating system that tests use, installed where they are missing (Debian).

use std::env;
use std::process::Command;

use crate::steps::{Failure, run, say};

/// A program and the Debian package that brings it.
const PROGRAMS: [(&str, &str); 1] = [("chromium", "chromium")];

/// Installs what is missing, as root or with `sudo`.
pub fn programs() -> Result<(), Failure> {
    let missing: Vec<&str> = PROGRAMS
        .iter()
        .filter(|(program, _)| !is_on_path(program))
        .map(|(_, package)| *package)
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    say(&mut std::io::stderr(), &format!("installing {}", missing.join(", ")));
    if !is_on_path("apt-get") {
        let reason = format!("{} must be installed: there is no apt-get", missing.join(", "));
        return Err(Failure::new(reason));
    }
    run("apt-get update", apt_get().args(["--quiet=2", "update"]))?;
    let install = ["--quiet=2", "install", "--yes", "--no-install-recommends"];
    run("apt-get install", apt_get().args(install).args(missing))
}

fn apt_get() -> Command {
    // Root needs no sudo, and where there is none only root gets here.
    let mut command = if is_on_path("sudo") {
        let mut sudo = Command::new("sudo");
        sudo.args(["--preserve-env=DEBIAN_FRONTEND", "apt-get"]);
        sudo
    } else {
        Command::new("apt-get")
    };
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command
}

fn is_on_path(program: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).any(|folder| folder.join(program).is_file())
}
