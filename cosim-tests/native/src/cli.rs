//! Command line of `lander`.

mod campaign;
mod map;
mod paper;
mod rare;

use std::io::{BufReader, ErrorKind, Read, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, Parser, Subcommand};
use cosim::landing::{Error, Landing, write_whole};
use cosim::layout::Layout;
use cosim::master::Master;
use cosim::replay::Film;
use cosim::schedule::{Pair, Schedule};
use cosim::touchdowns::{self, Cases, Engine};
use cosim::verdict::{Verdict, gate_passed};
use guidance_fmu::Guidance;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use lander_models::{Scenario, Settings, Ticks, Vehicle};
use truth_model::TruthModel;
use truth_model::terrain::Ground;

const OK: u8 = 0;
const GATE_NOT_PASSED: u8 = 1;
/// 128 + SIGINT, as a shell reports it.
pub const INTERRUPTED: u8 = 130;

/// The kit's files, in the folder of its workspace.
const SCENARIOS: &str = "models/scenarios";
const VEHICLES: &str = "models/vehicles";

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
    /// Record rows of little-endian f64 from standard input; one at NaN s says that their
    /// master failed
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
    /// Fly a scenario natively and write it as an HTML page to be watched
    Replay {
        /// Scenario file, or the name of one in models/scenarios
        #[arg(default_value = "landing")]
        scenario: PathBuf,
        /// Folder for the page, beside the log and the results
        #[arg(long, default_value = "results/native")]
        out: PathBuf,
    },
    /// Run touchdowns from a file of contact states, engine off, each to its verdict
    Touchdowns(Touchdowns),
    /// Run a study: many landings or touchdowns with parameters drawn from distributions
    Campaign(campaign::Campaign),
    /// Run a study at every design of its axes, with the same draws, and compare them
    Design(campaign::Campaign),
    /// Map which velocities at contact a lander survives
    Map(map::Map),
    /// Estimate the probability of a rare tip-over among a study's touchdowns, by subset simulation
    Rare(rare::Rare),
    /// Reproduce the paper's tables and figures, as printed beside what this kit finds
    Paper(paper::Paper),
}

#[derive(Args)]
struct Touchdowns {
    /// CSV file, a case a row (its columns: cosim-tests/README.md)
    #[arg(long)]
    cases: PathBuf,
    /// Vehicle file, or the name of one in models/vehicles
    #[arg(long, default_value = "bug")]
    vehicle: PathBuf,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: Engine,
    /// Simulated time after which a case ends undecided, s
    #[arg(long, default_value = "30", value_parser = stop_time)]
    stop_time: Ticks,
    /// Number of threads; 0 takes all cores. The results don't depend on it
    #[arg(long, default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// CSV file for the results, instead of standard output
    #[arg(long)]
    out: Option<PathBuf>,
    /// Print counts and rows as one JSON object
    #[arg(long)]
    json: bool,
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
                let mut landing =
                    Landing::new(&settings.scenario_file, &out, schedule.clone(), layout)?;
                let flown = run(&schedule, &settings, &mut landing, |_| ());
                report.conclude(landing, flown)
            }
            Command::Replay { scenario, out } => {
                replay(&schedule, layout, scenario_path(scenario), &out)
            }
            Command::Record { scenario, out, report } => {
                let width = layout.width();
                let mut landing = Landing::new(&scenario_path(scenario), &out, schedule, layout)?;
                let flown = record(width, &mut landing);
                report.conclude(landing, flown)
            }
            Command::Touchdowns(touchdowns) => touchdowns.run(),
            Command::Campaign(campaign) => campaign.execute(),
            Command::Design(campaign) => campaign.execute_designs(),
            Command::Map(map) => map.execute(),
            Command::Rare(rare) => rare.execute(),
            Command::Paper(paper) => paper.execute(),
        }
    }
}

/// More would only wait for each other.
const THREADS_MAX: usize = 1024;

fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads) if threads <= THREADS_MAX => Ok(threads),
        _ => Err(format!("must be a whole number up to {THREADS_MAX}")),
    }
}

/// Set by the first Ctrl-C.
fn interruption() -> Result<Arc<AtomicBool>, Error> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
    Ok(interrupted)
}

/// A whole number of ticks, at least one.
fn stop_time(text: &str) -> Result<Ticks, String> {
    let seconds: f64 = text.parse().map_err(|_| "must be a number".to_owned())?;
    match Ticks::from_seconds(seconds) {
        Ok(ticks) if ticks > Ticks::ZERO => Ok(ticks),
        Ok(_) => Err("must be greater than 0".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

impl Touchdowns {
    fn run(&self) -> Result<u8, Error> {
        let vehicle = Vehicle::load(&kit_file(self.vehicle.clone(), VEHICLES))?;
        let cases = Cases::read(&self.cases, &vehicle)?;
        let rows = cases.run(&vehicle, self.engine, self.stop_time, self.threads)?;
        let csv = touchdowns::to_csv(&rows);
        if let Some(file) = &self.out {
            write_whole(file, &csv)?;
        }
        if self.json {
            print(&(serde_json::to_string_pretty(&touchdowns::to_json(&rows))? + "\n"))?;
        } else if self.out.is_some() {
            let counts = touchdowns::count(&rows);
            let words: Vec<_> = counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
            print(&format!("{} touchdowns: {}\n", rows.len(), words.join(", ")))?;
        } else {
            print(&csv)?;
        }
        Ok(OK)
    }
}

fn scenario_path(given: PathBuf) -> PathBuf {
    kit_file(given, SCENARIOS)
}

/// A bare name that is no file means a file of the kit around the current folder.
fn kit_file(given: PathBuf, folder: &str) -> PathBuf {
    let bare = given.extension().is_none() && given.file_name() == Some(given.as_os_str());
    if !bare || given.is_file() {
        return given;
    }
    kit_folder(folder).join(given).with_extension("toml")
}

/// A folder of the kit around the current folder.
fn kit_folder(folder: &str) -> PathBuf {
    let here = std::env::current_dir().unwrap_or_default();
    let kit = here.ancestors().map(|above| above.join(folder)).find(|folder| folder.is_dir());
    kit.unwrap_or_else(|| folder.into())
}

/// Every row goes to the landing and to `watch`.
fn run(
    schedule: &Schedule,
    settings: &Settings,
    landing: &mut Landing,
    mut watch: impl FnMut(&[f64]),
) -> Result<(), Error> {
    let mut master = Master::new::<TruthModel, Guidance>(schedule, settings)?;
    let interrupted = interruption()?;
    master.run(landing.stop_time(), |row| {
        landing.row(row)?;
        watch(row);
        Ok(match interrupted.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })
    })
}

fn replay(
    schedule: &Schedule,
    layout: Layout,
    scenario_file: PathBuf,
    out: &Path,
) -> Result<u8, Error> {
    let (scenario, vehicle) = Scenario::load(&scenario_file)?;
    let mut film = Film::new(layout.clone());
    let mut landing = Landing::new(&scenario_file, out, schedule.clone(), layout)?;
    let settings = Settings { scenario_file };
    if let Err(error) = run(schedule, &settings, &mut landing, |row| film.row(row)) {
        landing.abandon();
        return Err(error);
    }
    let results = landing.finish()?.results;
    let verdict = Verdict { results: &results, scenario: &scenario, vehicle: &vehicle };
    let ground = Ground::new(&scenario.terrain);
    let verdict = verdict.to_string();
    let page = film.page(&scenario, &vehicle, &ground, (results.outcome.name(), &verdict))?;
    let file = out.join(format!("{}.html", scenario.name));
    write_whole(&file, &page.ok_or(Error::NoRows)?)?;
    print(&format!("{}\n", file.display()))?;
    Ok(if results.interrupted() { INTERRUPTED } else { OK })
}

fn record(width: usize, landing: &mut Landing) -> Result<(), Error> {
    // The master that feeds the pipe decides when to stop; the log must still be closed.
    ctrlc::set_handler(|| {})?;
    let mut input = BufReader::new(std::io::stdin().lock());
    let expected = 8 * width;
    let mut bytes = Vec::with_capacity(expected);
    loop {
        bytes.clear();
        input.by_ref().take(expected as u64).read_to_end(&mut bytes).map_err(Error::Input)?;
        if bytes.is_empty() {
            return Ok(());
        }
        if bytes.len() < expected {
            let row = landing.rows();
            return Err(Error::PartialRow { row, bytes: bytes.len(), expected });
        }
        let (words, _) = bytes.as_chunks();
        let row: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        if row[0].is_nan() {
            return Err(Error::MasterFailed);
        }
        landing.row(&row)?;
    }
}

impl Report {
    /// Ends a landing as its flight went.
    fn conclude(&self, landing: Landing, flown: Result<(), Error>) -> Result<u8, Error> {
        if let Err(error) = flown {
            landing.abandon();
            return Err(error);
        }
        let finished = landing.finish()?;
        print(if self.json { &finished.json } else { &finished.verdict })?;
        let gate_failed = self.gate && !gate_passed(&finished.results);
        Ok(match (finished.results.interrupted(), gate_failed) {
            (true, _) => INTERRUPTED,
            (false, true) => GATE_NOT_PASSED,
            (false, false) => OK,
        })
    }
}

/// Writes to standard output. A reader that has seen enough may close it.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::Output(error)),
        _ => Ok(()),
    }
}
