//! Runs commands one after another and says how far it is.

use std::io::{self, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Why a task ended early, and the exit code that says so.
#[derive(Debug)]
pub struct Failure {
    /// `None` when a command has already said why.
    pub reason: Option<String>,
    pub code: u8,
}

impl Failure {
    pub fn new(reason: impl Into<String>) -> Self {
        Self { reason: Some(reason.into()), code: crate::FAILED }
    }

    fn of_command(what: &str, status: ExitStatus) -> Self {
        match status.code().and_then(|code| u8::try_from(code).ok()) {
            Some(code) => Self { reason: None, code },
            None => Self::new(format!("{what} was ended: {status}")),
        }
    }
}

/// Progress over a known number of steps.
pub struct Steps {
    total: usize,
    started: Instant,
    pub finished: Vec<(String, Duration)>,
}

impl Steps {
    pub fn new(total: usize) -> Self {
        Self { total, started: Instant::now(), finished: Vec::new() }
    }

    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// Announces a step, runs it and keeps its time.
    pub fn run<T>(
        &mut self,
        name: &str,
        step: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let number = self.finished.len() + 1;
        let (total, so_far_s) = (self.total, self.elapsed().as_secs_f64());
        let to_go = total - number;
        say(
            &mut io::stderr(),
            &format!("[{number}/{total}] {name} ({so_far_s:.0} s so far, {to_go} to go)"),
        );
        let start = Instant::now();
        let result = step();
        self.finished.push((name.to_owned(), start.elapsed()));
        result
    }
}

/// Writes a line for whoever listens; nobody has to.
pub fn say(stream: &mut impl Write, line: &str) {
    let _ = writeln!(stream, "{line}");
}

/// Runs `command` with its output on stderr, so that stdout stays the landing's.
pub fn run(what: &str, command: &mut Command) -> Result<(), Failure> {
    let status = command
        .stdin(Stdio::null())
        .stdout(io::stderr())
        .status()
        .map_err(|error| cannot_start(what, &error))?;
    if status.success() { Ok(()) } else { Err(Failure::of_command(what, status)) }
}

pub fn cannot_start(what: &str, error: &io::Error) -> Failure {
    Failure::new(format!("{what} cannot be started: {error}"))
}
