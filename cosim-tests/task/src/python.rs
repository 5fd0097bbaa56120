//! The Python environment `.venv`, exactly as the lock files say.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::steps::{Failure, run};
use crate::workspace::Workspace;

/// Installs what differs from the lock files and returns the interpreter.
pub fn environment(workspace: &Workspace) -> Result<PathBuf, Failure> {
    let folder = workspace.root.join(".venv");
    let python = folder.join("bin/python");
    let locks = ["bootstrap.lock", "requirements.lock"];
    let locks = locks.map(|name| workspace.python_package().join(name));
    let wanted = contents(&locks)?;
    // The lock files as last installed.
    let stamp = folder.join("installed.lock");
    if python.exists() && fs::read(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    if !python.exists() {
        let mut create = Command::new(base_interpreter()?);
        run("python -m venv", create.args(["-m", "venv", "--clear"]).arg(&folder))?;
    }
    let [bootstrap, requirements] = &locks;
    run(
        "pip install uv",
        Command::new(&python)
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
            .args(["--require-hashes", "--requirement"])
            .arg(bootstrap),
    )?;
    run(
        "uv pip sync",
        Command::new(folder.join("bin/uv"))
            .args(["pip", "sync", "--quiet", "--require-hashes", "--python"])
            .args([&python, bootstrap, requirements])
            .env("UV_PYTHON_DOWNLOADS", "never"),
    )?;
    fs::write(&stamp, wanted).map_err(|error| cannot_use(&stamp, &error))?;
    Ok(python)
}

/// The first Python on the path that is new enough (`tomllib` came with 3.11).
fn base_interpreter() -> Result<&'static str, Failure> {
    let new_enough = |name: &&str| {
        Command::new(name)
            .args(["-c", "import sys; sys.exit(sys.version_info < (3, 11))"])
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    };
    ["python3", "python3.11"].into_iter().find(new_enough).ok_or_else(|| {
        Failure::new("Python 3.11 or newer is needed, as `python3` or `python3.11` on the path")
    })
}

fn contents(files: &[PathBuf]) -> Result<Vec<u8>, Failure> {
    let mut all = Vec::new();
    for file in files {
        all.extend(fs::read(file).map_err(|error| cannot_use(file, &error))?);
    }
    Ok(all)
}

fn cannot_use(file: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("{}: {error}", file.display()))
}
