//! What tests need of the operating system, installed where it is missing (Debian).

use std::env;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::steps::{Failure, run, say};

/// How a need is seen to be met.
enum Sign {
    Program(&'static str),
    Library(&'static str),
    File(&'static str),
}

/// With the Debian packages that meet them: a browser for pages, a screen and a renderer for
/// Rerun, Foxglove's installer, Intel's threads for ecos, a C parser to build fmi-sim.
const NEEDS: [(Sign, &str); 6] = [
    (Sign::Program("chromium"), "chromium"),
    (Sign::Program("npm"), "npm"),
    (Sign::Program("xvfb-run"), "xvfb"),
    (Sign::File("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json"), "mesa-vulkan-drivers"),
    (Sign::Library("libtbb.so.12"), "libtbb12"),
    (Sign::Library("libclang-1"), "libclang-dev"),
];

/// Installs the packages that are missing, as root or with `sudo`.
pub fn packages() -> Result<(), Failure> {
    let missing: Vec<&str> =
        NEEDS.iter().filter(|(sign, _)| !sign.is_there()).map(|(_, package)| *package).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names = missing.join(" ");
    if !is_on_path("apt-get") {
        return Err(Failure::new(format!("to be installed by hand, without apt-get: {names}")));
    }
    say(&mut std::io::stderr(), &format!("installing {names}"));
    let failed = |_| Failure::new(format!("cannot be installed: apt-get install {names}"));
    apt_get("update")
        .and_then(|()| apt_get(&format!("install --yes --no-install-recommends {names}")))
        .map_err(failed)
}

impl Sign {
    fn is_there(&self) -> bool {
        match self {
            Self::Program(name) => is_on_path(name),
            Self::File(path) => Path::new(path).exists(),
            Self::Library(name) => {
                let listed =
                    Command::new("/sbin/ldconfig").arg("-p").stderr(Stdio::null()).output();
                listed.is_ok_and(|listed| String::from_utf8_lossy(&listed.stdout).contains(name))
            }
        }
    }
}

fn apt_get(arguments: &str) -> Result<(), Failure> {
    let is_root = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n");
    let mut command = Command::new(if is_root { "apt-get" } else { "sudo" });
    if !is_root {
        command.args(["--non-interactive", "apt-get"]);
    }
    command.env("DEBIAN_FRONTEND", "noninteractive").arg("--quiet=2");
    run("apt-get", command.args(arguments.split_whitespace()))
}

fn is_on_path(program: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).any(|folder| folder.join(program).is_file())
}
