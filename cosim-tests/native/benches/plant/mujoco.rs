//! MuJoCo's same lander on the same touchdowns: `touchdown_cosim.bench_mujoco`, which runs them once for
//! their errors and then times what it is told to, when it is told to.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde::Deserialize;

use crate::table::{Errors, Row};

/// The running process. Dropped early it ends with its input.
pub struct Peer {
    process: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

#[derive(Deserialize)]
pub struct Report {
    #[serde(rename = "mujoco")]
    pub version: String,
    pub reference_step_ms: f64,
    flight_us: f64,
    rows: Vec<PeerRow>,
}

#[derive(Deserialize)]
struct PeerRow {
    name: String,
    step_ms: f64,
    step_us: f64,
    to_rest_ms: f64,
    #[serde(flatten)]
    errors: Errors,
}

impl Peer {
    /// Starts it. An error says in one line why there is none.
    pub fn start(vehicle_file: &Path) -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let python = root.join(".venv/bin/python");
        if !python.exists() {
            return Err("no .venv: `cargo land` makes it".into());
        }
        let mut process = Command::new(python)
            .args(["-m", "touchdown_cosim.bench_mujoco", "--json", "--paced", "--vehicle"])
            .arg(vehicle_file)
            .env("PYTHONPATH", root.join("cosim-tests/python"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| error.to_string())?;
        let (requests, answers) =
            process.stdin.take().zip(process.stdout.take()).ok_or("no pipe")?;
        Ok(Self { process, requests, answers: BufReader::new(answers) })
    }

    /// Times one family, or `flight`, once more.
    pub fn time(mut self, name: &str) -> Result<Self, String> {
        // A process that has ended refuses the request or gives no answer; `report` says how it ended.
        let asked = writeln!(self.requests, "{name}").is_ok();
        let mut answer = String::new();
        if asked && self.answers.read_line(&mut answer).is_ok_and(|bytes| bytes > 0) {
            return Ok(self);
        }
        Err(self.report().err().unwrap_or_else(|| format!("bench_mujoco did not time `{name}`")))
    }

    pub fn report(self) -> Result<Report, String> {
        let Self { mut process, requests, answers } = self;
        drop(requests);
        let report = serde_json::from_reader(answers).map_err(|error| error.to_string());
        let status = process.wait().map_err(|error| error.to_string())?;
        if status.success() { report } else { Err(format!("bench_mujoco ended with {status}")) }
    }
}

impl Report {
    pub fn rows(&self) -> Vec<Row> {
        let contact = self.rows.iter().map(|row| Row {
            engine: "mujoco".to_owned(),
            case: row.name.clone(),
            step_ms: row.step_ms,
            step_us: row.step_us,
            to_rest_ms: Some(row.to_rest_ms),
            errors: Some(row.errors),
            ..Row::default()
        });
        std::iter::once(Row::flight("mujoco", self.flight_us)).chain(contact).collect()
    }
}
