//! MuJoCo's same lander on the same touchdowns, timed by `touchdown_cosim.bench_mujoco`: times of
//! MuJoCo alone, the least of several runs, and errors against its own fine step.

use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Stdio};

use cosim::touchdowns::COLUMNS;
use serde::Deserialize;

use crate::cases::CASES;

#[derive(Deserialize)]
pub struct Peer {
    #[serde(rename = "mujoco")]
    pub version: String,
    pub flight_us: f64,
    pub rows: Vec<PeerRow>,
}

#[derive(Deserialize)]
pub struct PeerRow {
    pub name: String,
    pub step_ms: f64,
    case: HashMap<String, f64>,
    /// `None`: so long a step does not come to rest.
    #[serde(flatten)]
    pub end: Option<PeerEnd>,
}

#[derive(Deserialize)]
pub struct PeerEnd {
    pub steps: u32,
    pub step_us_min: f64,
    pub position_error_m: f64,
    pub tilt_error_deg: f64,
    pub peak_stroke_error: f64,
}

/// Runs the peer. An error says in one line why there is none.
pub fn run(vehicle_file: &Path) -> Result<Peer, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let python = root.join(".venv/bin/python");
    if !python.exists() {
        return Err("no .venv: `cargo land` makes it".into());
    }
    let output = Command::new(python)
        .args(["-m", "touchdown_cosim.bench_mujoco", "--json", "--integrators", "Euler"])
        .arg("--vehicle")
        .arg(vehicle_file)
        .env("PYTHONPATH", root.join("cosim-tests/python"))
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(format!("bench_mujoco ended with {}", output.status));
    }
    let peer: Peer = serde_json::from_slice(&output.stdout).map_err(|error| error.to_string())?;
    match peer.rows.iter().find(|row| !is_ours(row)) {
        Some(row) => Err(format!("its touchdown `{}` is not the one here", row.name)),
        None => Ok(peer),
    }
}

fn is_ours(row: &PeerRow) -> bool {
    CASES.iter().filter(|case| case.name == row.name).any(|case| {
        let mut columns = COLUMNS.iter().zip(case.values);
        columns.all(|((name, _), value)| row.case.get(*name) == Some(&value))
    })
}
