//! `fmu-build`: packs, describes and checks FMUs. Exit code 0 success, 1 failure, 2 usage.

use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use fmu_build::check::{self, Demands, Finding, inspect};
use fmu_build::model::MODELS;
use fmu_build::package::{Sources, build};
use fmu_build::platform::{Glibc, Platform, parse_glibc};
use fmu_build::{Error, Stamp, capabilities, describe, ssp, vehicle};

#[derive(Parser)]
#[command(version, about = "Packs, describes and checks the lander FMUs (FMI 2.0 and 3.0)")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Pack the shell libraries into FMUs: each for FMI 2.0, FMI 3.0 and FMI 3.0 with arrays
    Build {
        /// Folder with the two shells' libraries, such as liblander_truth_fmu.so; once for each
        /// platform that the FMUs shall hold. By default the folder of this program
        #[arg(long, value_name = "DIR")]
        libraries: Vec<PathBuf>,
        /// Where to write the FMUs; by default `fmu` in cargo's target folder
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Workspace root, for models/ and LICENSE
        #[arg(long, value_name = "DIR", default_value = ".")]
        root: PathBuf,
    },
    /// Pack FMUs into lander.ssp (FMI 2.0) and lander-fmi3.ssp
    Ssp {
        /// Folder with the FMUs that `build` wrote; by default `fmu` in cargo's target folder
        #[arg(long, value_name = "DIR")]
        fmus: Option<PathBuf>,
        /// Where to write the SSP files; the folder of the FMUs if not given
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Workspace root, for models/
        #[arg(long, value_name = "DIR", default_value = ".")]
        root: PathBuf,
    },
    /// Begin a vehicle of one's own: a copy, and a scenario that flies it
    NewVehicle {
        /// Of the files, and of vehicle and scenario
        name: String,
        /// The vehicle to copy
        #[arg(long, value_name = "NAME", default_value = "bug")]
        from: String,
        /// Workspace root, for models/
        #[arg(long, value_name = "DIR", default_value = ".")]
        root: PathBuf,
    },
    /// Print the variables of both models
    Describe {
        #[arg(long)]
        json: bool,
        /// The capability table, docs/FMI.md
        #[arg(long, conflicts_with = "json")]
        capabilities: bool,
    },
    /// Look into finished FMUs, then run them as a sceptical user would
    Check {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// The newest glibc that a library may need, as 2.17
        #[arg(long, value_name = "VERSION", value_parser = glibc)]
        glibc: Option<Glibc>,
        /// A platform that every FMU must hold; may be given more than once
        #[arg(long, value_name = "NAME", value_parser = platform)]
        platform: Vec<Platform>,
        /// Only look, run nothing
        #[arg(long)]
        no_run: bool,
        #[arg(long)]
        json: bool,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            say(format_args!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// `false` if a check found problems.
fn run(command: Command) -> Result<bool, Error> {
    match command {
        Command::Build { libraries, out, root } => {
            let stamp = stamp()?;
            let libraries = if libraries.is_empty() { vec![target(".")?] } else { libraries };
            let sources = Sources { libraries: &libraries, root: &root, stamp };
            Ok(wrote(&build(&sources, &out.map_or_else(|| target("../fmu"), Ok)?)?))
        }
        Command::Ssp { fmus, out, root } => {
            let fmus = fmus.map_or_else(|| target("../fmu"), Ok)?;
            let out = out.unwrap_or_else(|| fmus.clone());
            Ok(wrote(&ssp::build(&fmus, &root, stamp()?, &out)?))
        }
        Command::NewVehicle { name, from, root } => {
            Ok(wrote(&vehicle::create(&root, &name, &from)?))
        }
        Command::Describe { capabilities: true, .. } => print(&capabilities::page()?),
        Command::Describe { json: true, .. } => print(&format!("{:#}\n", describe::json(&MODELS))),
        Command::Describe { .. } => print(&describe::table(&MODELS)),
        Command::Check { files, glibc, platform, no_run, json } => {
            let demands = Demands { glibc, platforms: platform };
            examine(&files, &demands, !no_run, json)
        }
    }
}

/// Prints what was found as it is found, or all of it as one JSON object.
fn examine(files: &[PathBuf], demands: &Demands, run: bool, json: bool) -> Result<bool, Error> {
    let (mut report, mut fmus) = (Vec::new(), Vec::new());
    let mut tell = |subject: &str, findings: &mut dyn Iterator<Item = Finding>| {
        let mut list = Vec::new();
        if !json {
            print(&format!("{subject}\n"))?;
        }
        for finding in findings {
            if !json {
                print(&format!("{finding}\n"))?;
            }
            list.push(finding);
        }
        report.push((subject.to_owned(), list));
        Ok::<(), Error>(())
    };
    for file in files {
        let (findings, fmu) = match inspect(file, demands) {
            Ok(inspected) => inspected,
            Err(error) => (vec![Finding::unreadable(&error)], None),
        };
        let trials = fmu.iter().filter(|_| run).flat_map(check::run);
        tell(&file.display().to_string(), &mut findings.into_iter().chain(trials))?;
        fmus.extend(fmu);
    }
    let pairs = if run { check::pairs(&fmus) } else { Vec::new() };
    if !pairs.is_empty() {
        let landings = pairs.into_iter().map(|(truth, guidance)| check::fly(truth, guidance));
        tell("coupled", &mut landings.into_iter())?;
    }
    let passed = report.iter().flat_map(|(_, list)| list).all(|finding| finding.passed);
    if json {
        print(&format!("{:#}\n", check::json(&report)))?;
    }
    Ok(passed)
}

fn glibc(text: &str) -> Result<Glibc, String> {
    parse_glibc(text).ok_or_else(|| "must be as 2.17".to_owned())
}

fn platform(text: &str) -> Result<Platform, String> {
    let found = Platform::ALL.into_iter().find(|platform| platform.name() == text);
    let known = Platform::ALL.map(Platform::name).join(", ");
    found.ok_or_else(|| format!("known are {known}"))
}

fn stamp() -> Result<Stamp, Error> {
    Stamp::parse(std::env::var("SOURCE_DATE_EPOCH").ok().as_deref())
}

/// A folder beside this program, which cargo puts where it puts the libraries.
fn target(folder: &str) -> Result<PathBuf, Error> {
    let program = std::env::current_exe()
        .map_err(|source| Error::Read { file: "this program".into(), source })?;
    Ok(program.parent().unwrap_or(&program).join(folder))
}

fn wrote(files: &[PathBuf]) -> bool {
    files.iter().for_each(|file| say(format_args!("wrote {}", file.display())));
    true
}

/// To standard error. Nobody left to read it is no failure.
fn say(message: std::fmt::Arguments) {
    let _ = writeln!(std::io::stderr(), "{message}");
}

/// To standard output. A reader that has seen enough, as in `describe | head`, is no failure.
fn print(text: &str) -> Result<bool, Error> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::Print(error)),
        _ => Ok(true),
    }
}
