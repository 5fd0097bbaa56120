//! One landing as seen from its rows: digest, log, results, verdict. Who produced the rows,
//! the native master or FMPy, makes no difference here.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use lander_models::time::NotWholeTicks;
use lander_models::{ConfigError, ModelError, Scenario, Ticks, Vehicle};
use sha2::{Digest, Sha256};

use crate::layout::Layout;
use crate::progress::Progress;
use crate::recorder::{Recorder, RecorderError};
use crate::results::{Results, UnknownOutcome};
use crate::scene::Scene;
use crate::schedule::{Schedule, ScheduleError};
use crate::study::StudyError;
use crate::touchdowns::TouchdownsError;
use crate::verdict::Verdict;
use crate::whole_file;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    #[error(transparent)]
    Touchdowns(#[from] TouchdownsError),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error(transparent)]
    Paper(#[from] crate::paper::Error),
    #[error(transparent)]
    Recorder(#[from] RecorderError),
    #[error("{}: {source}", file.display())]
    File { file: PathBuf, source: std::io::Error },
    #[error("results cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("row {row}: {source}")]
    RowTime { row: u64, source: NotWholeTicks },
    #[error("row {row} is at {time_s} s: {limit}")]
    RowOrder { row: u64, time_s: f64, limit: String },
    #[error("row {row} has {bytes} bytes, must have {expected}")]
    PartialRow { row: u64, bytes: usize, expected: usize },
    #[error("standard input: {0}")]
    Input(std::io::Error),
    #[error("standard output: {0}")]
    Output(std::io::Error),
    #[error("the master that fed the rows failed")]
    MasterFailed,
    #[error("row {row}: {reason}")]
    Row { row: u64, reason: UnknownOutcome },
    #[error("the run ended before its first row")]
    NoRows,
    #[error("threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error("Ctrl-C cannot be caught: {0}")]
    Interrupt(#[from] ctrlc::Error),
}

/// A file name holds 255 bytes; the rest is room for an extension.
const NAME_MAX_BYTES: usize = 200;

pub struct Landing {
    scenario: Scenario,
    vehicle: Vehicle,
    schedule: Schedule,
    layout: Layout,
    log_file: PathBuf,
    results_file: PathBuf,
    recorder: Option<Recorder>,
    progress: Progress,
    digest: Sha256,
    rows: u64,
    /// Of the last row.
    time: Ticks,
    last_row: Vec<f64>,
}

/// What a landing leaves behind besides its files.
pub struct Finished {
    pub results: Results,
    pub json: String,
    pub verdict: String,
}

impl Landing {
    /// Reads the scenario and removes older results of its name, which a run that fails or is
    /// killed must not leave behind as its own. Writes nothing before the first row.
    pub fn new(
        scenario_file: &Path,
        out: &Path,
        schedule: Schedule,
        layout: Layout,
    ) -> Result<Self, Error> {
        let (scenario, vehicle) = Scenario::load(scenario_file)?;
        let file = |extension: &str| out.join(format!("{}.{extension}", scenario.name));
        if !names_a_file(&scenario.name) {
            return Err(Error::Config(ConfigError::Key {
                file: scenario_file.to_owned(),
                key: "name".to_owned(),
                reason: format!(
                    "is {:?}, must be fit for a file name of at most {NAME_MAX_BYTES} bytes",
                    scenario.name
                ),
            }));
        }
        let results_file = file("json");
        remove(&results_file)?;
        Ok(Self {
            log_file: file("mcap"),
            results_file,
            progress: Progress::new(scenario.stop_time.seconds()),
            scenario,
            vehicle,
            schedule,
            layout,
            recorder: None,
            digest: Sha256::new(),
            rows: 0,
            time: Ticks::ZERO,
            last_row: Vec::new(),
        })
    }

    pub fn stop_time(&self) -> Ticks {
        self.scenario.stop_time
    }

    /// Number of rows taken so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Takes the next row, `Layout::width` long.
    pub fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        let time = self.time_of(row)?;
        for value in row {
            self.digest.update(value.to_le_bytes());
        }
        let recorder = match &mut self.recorder {
            Some(recorder) => recorder,
            None => {
                let scene = Scene::new(&self.scenario, &self.vehicle);
                self.recorder.insert(start_log(&self.log_file, &self.layout, scene)?)
            }
        };
        recorder.row(time, row);
        self.progress.row(&self.schedule, &self.layout, row);
        self.rows += 1;
        self.time = time;
        self.last_row.clear();
        self.last_row.extend_from_slice(row);
        Ok(())
    }

    /// Time of the next row, if it may follow the last one.
    fn time_of(&self, row: &[f64]) -> Result<Ticks, Error> {
        let number = self.rows;
        let time =
            Ticks::from_seconds(row[0]).map_err(|source| Error::RowTime { row: number, source })?;
        let wrong = |limit| Err(Error::RowOrder { row: number, time_s: time.seconds(), limit });
        // The run ends at the first communication point that is not before the stop time.
        let end = self.scenario.stop_time + self.schedule.communication_step;
        match number {
            0 if time != Ticks::ZERO => wrong("the first row must be at 0 s".to_owned()),
            1.. if time <= self.time => {
                wrong(format!("must be after the last, at {} s", self.time.seconds()))
            }
            _ if time >= end => wrong(format!("must be before {} s", end.seconds())),
            _ => Ok(time),
        }
    }

    /// Ends a failed run: the log is closed and reads to its end, but there are no results.
    pub fn abandon(self) {
        self.progress.finish();
        if let Some(recorder) = self.recorder {
            // What failed first is the error to tell.
            let _ = recorder.close();
        }
    }

    /// Closes the log and writes the results.
    pub fn finish(self) -> Result<Finished, Error> {
        self.progress.finish();
        self.recorder.ok_or(Error::NoRows)?.close()?;
        let results = Results::from_last_row(
            &self.scenario.name,
            &self.schedule,
            &self.layout,
            &self.last_row,
            hexadecimal(&self.digest.finalize()),
        )
        .map_err(|reason| Error::Row { row: self.rows - 1, reason })?;
        let json = results.to_json()?;
        write_whole(&self.results_file, &json)?;
        let verdict =
            Verdict { results: &results, scenario: &self.scenario, vehicle: &self.vehicle };
        let verdict = format!(
            "{verdict}  {:<16} {}, {}\n",
            "files",
            self.log_file.display(),
            self.results_file.display()
        );
        Ok(Finished { results, json, verdict })
    }
}

/// Whether a name can be that of a file or folder.
pub fn names_a_file(name: &str) -> bool {
    Path::new(name).file_name() == Some(name.as_ref())
        && name.len() <= NAME_MAX_BYTES
        && !name.contains(|c: char| c.is_control() || c == '\\')
}

fn start_log(file: &Path, layout: &Layout, scene: Scene) -> Result<Recorder, Error> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)
            .map_err(|source| Error::File { file: folder.to_owned(), source })?;
    }
    Ok(Recorder::create(file, layout, scene)?)
}

/// Removes a file, if there is one.
fn remove(file: &Path) -> Result<(), Error> {
    match fs::remove_file(file) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::File { file: file.to_owned(), source })
        }
        _ => Ok(()),
    }
}

/// A reader never sees half a file.
pub fn write_whole(file: &Path, text: &str) -> Result<(), Error> {
    whole_file::write(file, text.as_bytes())
        .map_err(|source| Error::File { file: file.to_owned(), source })
}

pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
