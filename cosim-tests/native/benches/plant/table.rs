//! One table of all engines, and what MuJoCo takes for the same accuracy.

use serde::Serialize;

use crate::timing::REFINEMENT;

/// MuJoCo's fastest step counts whose peak stroke is no farther off.
const STROKE_ERROR_PERCENT: f64 = 1.5;

#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub engine: String,
    pub case: String,
    pub step_ms: f64,
    pub step_us: f64,
    pub to_rest_ms: Option<f64>,
    pub place_error_m: Option<f64>,
    pub tilt_error_deg: Option<f64>,
    pub stroke_error_percent: Option<f64>,
    /// Time to rest over MuJoCo's at `STROKE_ERROR_PERCENT`.
    pub ratio_to_mujoco: Option<f64>,
}

/// Fills the ratio of each row that is not MuJoCo's: contact by time to rest, flight by the step.
pub fn compare(rows: &mut [Row], peers: &[Row]) {
    for row in rows {
        let same = || peers.iter().filter(|peer| peer.case == row.case);
        let chosen = same()
            .filter(|peer| peer.stroke_error_percent.is_some_and(|off| off <= STROKE_ERROR_PERCENT))
            .filter_map(|peer| peer.to_rest_ms)
            .reduce(f64::min);
        row.ratio_to_mujoco = match (row.to_rest_ms, chosen) {
            (Some(ours_ms), Some(peer_ms)) => Some(ours_ms / peer_ms),
            _ if row.case == "flight" => same().map(|peer| row.step_us / peer.step_us).next(),
            _ => None,
        };
    }
}

pub fn print(rows: &[Row], peer: &Result<String, String>) {
    println!(
        "{:<8} {:<24} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "engine",
        "touchdown",
        "step ms",
        "µs/step",
        "rest ms",
        "place m",
        "tilt °",
        "stroke %",
        "× MuJoCo"
    );
    let figure =
        |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2e}"));
    for row in rows {
        println!(
            "{:<8} {:<24} {:>8} {:>8.2} {:>9} {:>9} {:>9} {:>9} {:>9}",
            row.engine,
            row.case,
            row.step_ms,
            row.step_us,
            row.to_rest_ms.map_or("–".to_owned(), |ms| format!("{ms:.1}")),
            figure(row.place_error_m),
            figure(row.tilt_error_deg),
            figure(row.stroke_error_percent),
            row.ratio_to_mujoco.map_or("–".to_owned(), |ratio| format!("{ratio:.2}")),
        );
    }
    match peer {
        Ok(version) => println!("\nMuJoCo {version}"),
        Err(reason) => println!("\nMuJoCo was not run: {reason}"),
    }
    println!(
        "Errors: against the same engine with {REFINEMENT} steps within each (MuJoCo: steps of 0.02 ms).\n\
         Times: the least of several runs. × MuJoCo: time to rest over MuJoCo's fastest with\n\
         a stroke error of at most {STROKE_ERROR_PERCENT} %; flight: by the step."
    );
}
