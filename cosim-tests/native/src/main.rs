//! `lander`: the native landing, and the recorder behind the FMPy master.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod cli;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use cosim::landing::Error;
use cosim::study::StudyError;

/// Bad input, or a run that failed.
const FAILED: u8 = 2;

fn main() -> ExitCode {
    match cli::Cli::parse().execute() {
        Ok(code) => code.into(),
        // Whoever feeds the rows says itself why it failed.
        Err(Error::MasterFailed) => FAILED.into(),
        Err(error) => {
            // With stderr closed there is nobody to tell, and the exit code still says it.
            let interrupted = matches!(error, Error::Study(StudyError::Interrupted));
            let (what, code) =
                if interrupted { ("", cli::INTERRUPTED) } else { ("error: ", FAILED) };
            let _ = writeln!(std::io::stderr(), "{what}{error}");
            code.into()
        }
    }
}
