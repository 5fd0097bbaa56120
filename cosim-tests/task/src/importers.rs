//! What the importers of the Python tests need of the system.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::steps::{Failure, run};

/// Shared libraries that no Python package brings, and the Debian packages that have them: ecos
/// needs Intel's threads.
const LIBRARIES: [(&str, &str); 1] = [("libtbb.so.12", "libtbb12")];

/// Installs the packages that are missing, as root or with `sudo`.
pub fn install() -> Result<(), Failure> {
    let listed = Command::new("/sbin/ldconfig").arg("-p").stderr(Stdio::null()).output();
    let listed = listed.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let present = listed.unwrap_or_default();
    for (library, package) in LIBRARIES {
        if present.contains(library) {
            continue;
        }
        if !Path::new("/usr/bin/apt-get").exists() {
            return Err(Failure::new(format!("{library} is needed: install {package}")));
        }
        let missing = |_| Failure::new(format!("{library} is needed: apt-get install {package}"));
        apt("update").and_then(|()| apt(&format!("install --yes {package}"))).map_err(missing)?;
    }
    Ok(())
}

fn apt(arguments: &str) -> Result<(), Failure> {
    let root = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n");
    let mut command = Command::new(if root { "apt-get" } else { "sudo" });
    if !root {
        command.args(["--non-interactive", "apt-get"]);
    }
    run("apt-get", command.arg("--quiet=2").args(arguments.split_whitespace()))
}
