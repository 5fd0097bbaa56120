//! `cargo land`: build, then land with FMPy.

use std::ffi::{OsStr, OsString};
use std::os::unix::process::CommandExt;
use std::process::Command;

use crate::python;
use crate::steps::{Failure, Steps, cannot_start, run};
use crate::workspace::Workspace;

pub fn land(arguments: &[OsString]) -> Result<u8, Failure> {
    // A failed build may have exited with 1, which here means a gate that was not passed.
    build_and_fly(arguments).map_err(|failure| Failure { code: crate::FAILED, ..failure })
}

fn build_and_fly(arguments: &[OsString]) -> Result<u8, Failure> {
    let workspace = Workspace::find()?;
    let (scenario, options) = split(arguments)?;
    let mut steps = Steps::new(4);
    steps.run("build", || build(&workspace))?;
    steps.run("FMUs", || build_fmus(&workspace))?;
    let python = steps.run("Python environment", || python::environment(&workspace))?;
    steps.run("landing", || {
        // In place of this process: Ctrl-C and the exit code are the master's own.
        let error = Command::new(python)
            .args(["-m", "touchdown_cosim"])
            .arg(workspace.scenario(scenario.unwrap_or(OsStr::new("landing"))))
            .args(options)
            .arg("--fmus")
            .arg(workspace.fmus())
            .arg("--lander")
            .arg(workspace.release("lander"))
            .env("PYTHONPATH", workspace.python_package())
            .exec();
        Err(cannot_start("FMPy", &error))
    })
}

/// One cargo invocation for all: the shells and the native master must be the same numeric
/// code, and features unify over what is built together.
pub fn build(workspace: &Workspace) -> Result<(), Failure> {
    let cargo = Command::new("cargo");
    run("cargo build", in_root(cargo, workspace).args(["build", "--release", "--workspace"]))
}

pub fn build_fmus(workspace: &Workspace) -> Result<(), Failure> {
    let mut command = in_root(Command::new(workspace.release("fmu-build")), workspace);
    command.args(["build", "--libraries"]).arg(workspace.target.join("release"));
    run("fmu-build", command.arg("--out").arg(workspace.fmus()))
}

/// The SSP files around the FMUs.
pub fn build_systems(workspace: &Workspace) -> Result<(), Failure> {
    let mut command = in_root(Command::new(workspace.release("fmu-build")), workspace);
    run("fmu-build", command.args(["ssp", "--fmus"]).arg(workspace.fmus()))
}

pub fn in_root(mut command: Command, workspace: &Workspace) -> Command {
    command.current_dir(&workspace.root);
    command
}

/// The scenario, and the options for the master.
fn split(arguments: &[OsString]) -> Result<(Option<&OsStr>, Vec<&OsStr>), Failure> {
    let (mut scenario, mut options) = (None, Vec::new());
    let mut words = arguments.iter().map(OsString::as_os_str);
    while let Some(word) = words.next() {
        let shown = word.to_string_lossy();
        match &*shown {
            "--json" | "--gate" => options.push(word),
            "--out" | "--variant" => {
                let value = words.next();
                let value = value.ok_or_else(|| Failure::new(format!("{shown} needs a value")))?;
                options.extend([word, value]);
            }
            _ if shown.starts_with('-') => {
                return Err(Failure::new(format!("{shown} is not known\n{}", crate::USAGE)));
            }
            _ if scenario.is_none() => scenario = Some(word),
            _ => return Err(Failure::new(format!("{shown}: only one scenario at a time"))),
        }
    }
    Ok((scenario, options))
}

#[cfg(test)]
mod tests {
    use std::os::unix::ffi::OsStringExt;

    use super::*;

    fn words(line: &str) -> Vec<OsString> {
        line.split_whitespace().map(OsString::from).collect()
    }

    #[test]
    fn scenario_and_options_come_in_any_order() {
        let line = words("--json hop --out there --gate");
        let (scenario, options) = split(&line).unwrap();
        assert_eq!(scenario, Some(OsStr::new("hop")));
        assert_eq!(options, ["--json", "--out", "there", "--gate"]);
    }

    #[test]
    fn a_file_name_need_not_be_unicode() {
        let name = OsString::from_vec(b"h\xf6p.toml".to_vec());
        let line = [name.clone(), "--out".into(), name.clone()];
        let (scenario, options) = split(&line).unwrap();
        assert_eq!(scenario, Some(name.as_os_str()));
        assert_eq!(options, [OsStr::new("--out"), &name]);
    }

    #[test]
    fn what_is_not_understood_is_refused() {
        for line in ["--fast", "hop landing", "--out", "--variant"] {
            assert!(split(&words(line)).is_err(), "{line} was taken");
        }
    }
}
