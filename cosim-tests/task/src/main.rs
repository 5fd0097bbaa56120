//! Task runner: `cargo land` builds and flies, `cargo verify` checks everything.
//!
//! Standard output belongs to the result: the landing's verdict or JSON, the summary of the
//! checks. All else goes to stderr.

mod importers;
mod land;
mod python;
mod steps;
mod system;
mod validation;
mod verify;
mod viewers;
mod workspace;

use std::ffi::OsString;
use std::process::ExitCode;

use validation::Accept;

const USAGE: &str = "\
usage: cargo land [SCENARIO] [--json] [--gate] [--out DIR] [--variant NAME]
           build, then land with FMPy
       cargo verify [--accept]
           run every check

SCENARIO  a scenario file, or the name of one in models/scenarios (default: landing)
--json    print the results as one JSON object instead of the verdict
--gate    exit with 1 unless the outcome is `landed`
--out     folder for the log and the results (default: results)
--variant which FMUs: fmi3 (default), fmi3-arrays or fmi2
--accept  write docs/VALIDATION.md as the tests measured it, instead of comparing";

/// Bad arguments, or a step that could not be started.
const FAILED: u8 = 2;

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let result = match arguments.split_first() {
        Some((_, rest)) if rest.iter().any(|word| word == "--help" || word == "-h") => {
            steps::say(&mut std::io::stdout(), USAGE);
            Ok(0)
        }
        Some((task, rest)) if task == "land" => land::land(rest),
        Some((task, [])) if task == "verify" => verify::verify(Accept::No),
        Some((task, [word])) if task == "verify" && word == "--accept" => {
            verify::verify(Accept::Yes)
        }
        _ => Err(steps::Failure::new(USAGE)),
    };
    match result {
        Ok(code) => code.into(),
        Err(failure) => {
            if let Some(reason) = failure.reason {
                steps::say(&mut std::io::stderr(), &format!("error: {reason}"));
            }
            failure.code.into()
        }
    }
}
