//! Command line of `lander`.

use std::io::{BufReader, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, Parser, Subcommand};
use cosim::landing::{Error, Landing};
use cosim::layout::Layout;
use cosim::master::Master;
use cosim::schedule::{Pair, Schedule};
use cosim::verdict::gate_passed;
use guidance_fmu::Guidance;
use lander_models::Settings;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use truth_model::TruthModel;

const OK: u8 = 0;
const GATE_NOT_PASSED: u8 = 1;
/// 128 + SIGINT, as a shell reports it.
const INTERRUPTED: u8 = 130;

const INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

/// Lands the lander, natively or from rows that another master computed.
#[derive(Parser)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Fly a scenario with both components in this process
    Run {
        /// Scenario file, or the name of one in models/scenarios
        #[arg(default_value = "landing")]
        scenario: PathBuf,
        /// Folder for the log and the results
        #[arg(long, default_value = "results/native")]
        out: PathBuf,
        #[command(flatten)]
        report: Report,
    },
    /// Record rows of little-endian f64 from standard input
    Record {
        /// Scenario file, or the name of one in models/scenarios
        #[arg(long)]
        scenario: PathBuf,
        /// Folder for the log and the results
        #[arg(long, default_value = "results")]
        out: PathBuf,
        #[command(flatten)]
        report: Report,
    },
}

#[derive(Args)]
struct Report {
    /// Print the results as one JSON object instead of the verdict
    #[arg(long)]
    json: bool,
    /// Exit with 1 unless the outcome is `landed`
    #[arg(long)]
    gate: bool,
}

impl Cli {
    pub fn execute(self) -> Result<u8, Error> {
        let schedule = Schedule::load(&INTERFACES)?;
        let layout = Layout::new(&schedule, &INTERFACES);
        match self.command {
            Command::Run { scenario, out, report } => {
                let settings = Settings { scenario_file: scenario_path(scenario) };
                let landing =
                    Landing::new(&settings.scenario_file, &out, schedule.clone(), layout)?;
                report.print(run(&schedule, &settings, landing)?)
            }
            Command::Record { scenario, out, report } => {
                let width = layout.width();
                let landing = Landing::new(&scenario_path(scenario), &out, schedule, layout)?;
                report.print(record(width, landing)?)
            }
        }
    }
}

/// A bare name means a scenario of the kit.
fn scenario_path(given: PathBuf) -> PathBuf {
    let bare = given.extension().is_none() && given.file_name() == Some(given.as_os_str());
    if bare { Path::new("models/scenarios").join(given).with_extension("toml") } else { given }
}

fn run(schedule: &Schedule, settings: &Settings, mut landing: Landing) -> Result<Landing, Error> {
    let mut master = Master::new::<TruthModel, Guidance>(schedule, settings)?;
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
    let outcome = master.run(landing.stop_time(), |row| {
        landing.row(row)?;
        Ok::<_, Error>(match interrupted.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    });
    outcome.map(|()| landing)
}

fn record(width: usize, mut landing: Landing) -> Result<Landing, Error> {
    // The master that feeds the pipe decides when to stop; the log must still be closed.
    ctrlc::set_handler(|| {})?;
    let mut input = BufReader::new(std::io::stdin().lock());
    let mut bytes = vec![0; 8 * width];
    loop {
        match input.read_exact(&mut bytes) {
            Ok(()) => {}
            Err(end) if end.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(landing),
            Err(error) => return Err(Error::Input(error)),
        }
        let (words, _) = bytes.as_chunks();
        let row: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        landing.row(&row)?;
    }
}

impl Report {
    fn print(&self, landing: Landing) -> Result<u8, Error> {
        let finished = landing.finish()?;
        print!("{}", if self.json { &finished.json } else { &finished.verdict });
        let gate_failed = self.gate && !gate_passed(&finished.results);
        Ok(match (finished.results.interrupted(), gate_failed) {
            (true, _) => INTERRUPTED,
            (false, true) => GATE_NOT_PASSED,
            (false, false) => OK,
        })
    }
}
