//! One table of all engines, and what MuJoCo takes for the same accuracy.

use serde::Serialize;

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
    /// Time to rest over that of MuJoCo's coarsest step whose end is no farther off.
    pub ratio_to_mujoco: Option<f64>,
}

/// Fills the ratio of each row that is not MuJoCo's: contact by time to rest at equal accuracy of
/// the resting place, flight by the step.
pub fn compare(rows: &mut [Row], peers: &[Row]) {
    for row in rows {
        let same = peers.iter().filter(|peer| peer.case == row.case);
        row.ratio_to_mujoco = match (row.to_rest_ms, row.place_error_m) {
            (Some(to_rest_ms), Some(error_m)) => same
                .filter(|peer| peer.place_error_m.is_some_and(|peer_m| peer_m <= error_m))
                .filter_map(|peer| peer.to_rest_ms)
                .reduce(f64::min)
                .map(|peer_ms| to_rest_ms / peer_ms),
            _ => same.map(|peer| row.step_us / peer.step_us).next(),
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
        "Errors: against the same engine on steps 8 times as fine. Times: the least of 5 runs.\n\
         × MuJoCo: time to rest over MuJoCo's fastest at no larger error of the resting place."
    );
}
