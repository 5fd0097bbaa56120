//! MuJoCo's same lander on the same touchdowns, timed by its Python peer.
//!
//! Called as `python -m touchdown_cosim.bench_mujoco CASES.csv --json`: the table has the columns of
//! `lander touchdowns`, one case a row. Expected on stdout is one JSON object:
//! `{"version": "3.3.0", "flight_us": 5.8, "rows": [ROW, …]}` with a row for each case and step size,
//! `{"case": 0, "step_ms": 1.0, "step_us": 13.0, "to_rest_ms": 40.0, "place_error_m": 1e-3,
//! "tilt_error_deg": 1e-2, "stroke_error_percent": 0.5}`: times of MuJoCo alone, the least of
//! several runs, and errors against its own fine step.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde::Deserialize;

use crate::cases;

#[derive(Deserialize)]
pub struct Peer {
    pub version: String,
    pub flight_us: f64,
    pub rows: Vec<PeerRow>,
}

#[derive(Deserialize)]
pub struct PeerRow {
    pub case: usize,
    pub step_ms: f64,
    pub step_us: f64,
    pub to_rest_ms: f64,
    pub place_error_m: f64,
    pub tilt_error_deg: f64,
    pub stroke_error_percent: f64,
}

/// Runs the peer. An error says in one line why there is none.
pub fn run() -> Result<Peer, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let python = root.join(".venv/bin/python");
    if !python.exists() {
        return Err("no .venv: `cargo land` makes it".into());
    }
    let table = std::env::temp_dir().join(format!("plant-cases-{}.csv", std::process::id()));
    fs::write(&table, cases::csv()).map_err(|error| error.to_string())?;
    let output = Command::new(python)
        .args(["-m", "touchdown_cosim.bench_mujoco"])
        .arg(&table)
        .arg("--json")
        .env("PYTHONPATH", root.join("cosim-tests/python"))
        .output()
        .map_err(|error| error.to_string());
    // What is left in the temporary folder does no harm.
    let _ = fs::remove_file(&table);
    let output = output?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(said.lines().last().unwrap_or("it failed and said nothing").to_owned());
    }
    let peer: Peer = serde_json::from_slice(&output.stdout).map_err(|error| error.to_string())?;
    match peer.rows.iter().find(|row| row.case >= cases::CASES.len()) {
        Some(row) => Err(format!("it timed a case {} that nobody asked for", row.case)),
        None => Ok(peer),
    }
}
