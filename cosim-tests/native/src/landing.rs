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
use crate::verdict::Verdict;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    #[error(transparent)]
    Recorder(#[from] RecorderError),
    #[error("{}: {source}", file.display())]
    File { file: PathBuf, source: std::io::Error },
    #[error("results cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("row {row}: {source}")]
    RowTime { row: u64, source: NotWholeTicks },
    #[error("standard input: {0}")]
    Input(std::io::Error),
    #[error("row {row}: {reason}")]
    Row { row: u64, reason: UnknownOutcome },
    #[error("the run ended before its first row")]
    NoRows,
    #[error("Ctrl-C cannot be caught: {0}")]
    Interrupt(#[from] ctrlc::Error),
}

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
    last_row: Vec<f64>,
}

/// What a landing leaves behind besides its files.
pub struct Finished {
    pub results: Results,
    pub json: String,
    pub verdict: String,
}

impl Landing {
    /// Reads the scenario; writes nothing before the first row.
    pub fn new(
        scenario_file: &Path,
        out: &Path,
        schedule: Schedule,
        layout: Layout,
    ) -> Result<Self, Error> {
        let (scenario, vehicle) = Scenario::load(scenario_file)?;
        let file = |extension: &str| out.join(format!("{}.{extension}", scenario.name));
        if Path::new(&scenario.name).file_name() != Some(scenario.name.as_ref()) {
            return Err(Error::Config(ConfigError::Key {
                file: scenario_file.to_owned(),
                key: "name".to_owned(),
                reason: format!("is \"{}\", must be fit for a file name", scenario.name),
            }));
        }
        Ok(Self {
            log_file: file("mcap"),
            results_file: file("json"),
            progress: Progress::new(scenario.stop_time.seconds()),
            scenario,
            vehicle,
            schedule,
            layout,
            recorder: None,
            digest: Sha256::new(),
            rows: 0,
            last_row: Vec::new(),
        })
    }

    pub fn stop_time(&self) -> Ticks {
        self.scenario.stop_time
    }

    /// Takes the next row, `Layout::width` long.
    pub fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        let time = Ticks::from_seconds(row[0])
            .map_err(|source| Error::RowTime { row: self.rows, source })?;
        for value in row {
            self.digest.update(value.to_le_bytes());
        }
        let recorder = match &mut self.recorder {
            Some(recorder) => recorder,
            None => {
                let recorder = start_files(
                    &self.log_file,
                    &self.results_file,
                    &self.layout,
                    Scene::new(&self.scenario, &self.vehicle),
                )?;
                self.recorder.insert(recorder)
            }
        };
        recorder.row(time, row);
        self.progress.row(&self.schedule, &self.layout, row);
        self.rows += 1;
        self.last_row.clear();
        self.last_row.extend_from_slice(row);
        Ok(())
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

/// Starts the log; older results would not belong to it, so they go.
fn start_files(
    log_file: &Path,
    results_file: &Path,
    layout: &Layout,
    scene: Scene,
) -> Result<Recorder, Error> {
    let at = |file: &Path| {
        let file = file.to_owned();
        move |source| Error::File { file, source }
    };
    if let Some(folder) = log_file.parent() {
        fs::create_dir_all(folder).map_err(at(folder))?;
    }
    match fs::remove_file(results_file) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(at(results_file)(error)),
        _ => Ok(Recorder::create(log_file, layout, scene)?),
    }
}

/// A reader never sees half a file.
fn write_whole(file: &Path, text: &str) -> Result<(), Error> {
    let part = file.with_extension("json.part");
    fs::write(&part, text)
        .and_then(|()| fs::rename(&part, file))
        .map_err(|source| Error::File { file: file.to_owned(), source })
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}
