//! `lander`: the native landing, and the recorder behind the FMPy master.

mod cli;

use std::process::ExitCode;

use clap::Parser;

/// Bad input, or a run that failed.
const FAILED: u8 = 2;

fn main() -> ExitCode {
    match cli::Cli::parse().execute() {
        Ok(code) => code.into(),
        Err(error) => {
            eprintln!("error: {error}");
            FAILED.into()
        }
    }
}
