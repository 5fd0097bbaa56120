//! One table of all engines, and their times over MuJoCo's at the same error.

use serde::{Deserialize, Serialize};

use crate::mujoco::Report;
use crate::timing::REFERENCE_REFINEMENT;
use crate::work_precision::{Bound, Point, Ratio};

/// Case of the rows without contact.
pub const FLIGHT: &str = "flight";

/// Root mean squares over a family, against the same engine's fine step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Errors {
    #[serde(rename = "place_error_m")]
    pub place_m: f64,
    #[serde(rename = "tilt_error_deg")]
    pub tilt_deg: f64,
    #[serde(rename = "stroke_error_percent")]
    pub stroke_percent: f64,
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct Row {
    pub engine: String,
    pub case: String,
    pub step_ms: f64,
    /// CPU time of a step.
    pub step_us: f64,
    /// CPU time from contact to rest, mean of the family.
    pub to_rest_ms: Option<f64>,
    #[serde(flatten)]
    pub errors: Option<Errors>,
    /// Time to rest over MuJoCo's at this row's stroke error; flight: time of a step over MuJoCo's.
    pub ratio_at_stroke: Option<Ratio>,
    /// The same at this row's error of place.
    pub ratio_at_place: Option<Ratio>,
}

impl Row {
    pub fn flight(engine: &str, step_us: f64) -> Self {
        let (engine, case) = (engine.to_owned(), FLIGHT.to_owned());
        Self { engine, case, step_ms: 1.0, step_us, ..Self::default() }
    }

    /// Time against one of the errors.
    fn point(&self, error: fn(&Errors) -> f64) -> Option<Point> {
        Some(Point { time_ms: self.to_rest_ms?, error: error(self.errors.as_ref()?) })
    }
}

/// Fills the ratios of rows that are not MuJoCo's.
pub fn compare(rows: &mut [Row], peers: &[Row]) {
    for row in rows {
        let same: Vec<&Row> = peers.iter().filter(|peer| peer.case == row.case).collect();
        if row.case == FLIGHT {
            let value = same.first().map(|peer| row.step_us / peer.step_us);
            row.ratio_at_stroke = value.map(|value| Ratio { bound: Bound::Equal, value });
            continue;
        }
        let ratio = |error: fn(&Errors) -> f64| {
            let curve: Vec<Point> = same.iter().filter_map(|peer| peer.point(error)).collect();
            Ratio::at_equal_error(row.point(error)?, &curve)
        };
        let at_stroke = ratio(|errors| errors.stroke_percent);
        let at_place = ratio(|errors| errors.place_m);
        (row.ratio_at_stroke, row.ratio_at_place) = (at_stroke, at_place);
    }
}

/// `rows` in the order of their cases.
pub fn print(rows: &[Row], peer: &Result<Report, String>) {
    println!("{:>74}", "× MuJoCo at equal");
    println!(
        "engine   step ms  µs/step   rest ms  place mm    tilt °  stroke %    stroke     place"
    );
    let mut case = "";
    for row in rows {
        if row.case != case {
            case = &row.case;
            println!("\n{case}");
        }
        println!(
            "{:<8} {:>7} {:>8.2} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
            row.engine,
            row.step_ms,
            row.step_us,
            row.to_rest_ms.map(|ms| format!("{ms:.1}")).unwrap_or_default(),
            figure(row, |errors| 1e3 * errors.place_m),
            figure(row, |errors| errors.tilt_deg),
            figure(row, |errors| errors.stroke_percent),
            ratio(row.ratio_at_stroke),
            ratio(row.ratio_at_place),
        );
    }
    legend(peer);
}

fn figure(row: &Row, error: fn(&Errors) -> f64) -> String {
    row.errors.as_ref().map(|errors| format!("{:.4}", error(errors))).unwrap_or_default()
}

fn ratio(ratio: Option<Ratio>) -> String {
    let sign = |bound| match bound {
        Bound::Equal => "",
        Bound::Less => "< ",
        Bound::More => "> ",
    };
    ratio.map(|Ratio { bound, value }| format!("{}{value:.3}", sign(bound))).unwrap_or_default()
}

fn legend(peer: &Result<Report, String>) {
    let mujoco = match peer {
        Ok(report) => {
            let Report { version, reference_step_ms, .. } = report;
            format!("MuJoCo {version}, whose reference has steps of {reference_step_ms} ms.")
        }
        Err(reason) => format!("MuJoCo was not run: {reason}."),
    };
    println!(
        "
{mujoco} Each touchdown is a family of speeds (cosim-tests/benchmark.toml).
Errors: root mean square over the family of rest place, rest tilt and peak stroke, against the same engine
with {REFERENCE_REFINEMENT} steps a tick of 1 ms. Times: CPU time of the one thread, per member the least of several runs,
taken in turns with MuJoCo's; rest ms from contact to the verdict, mean of the family.
× MuJoCo: rest ms over MuJoCo's at this row's own error, of stroke or of place, on the lower envelope of
MuJoCo's rows between its steps by a power law. > : less accurate than all its rows, compared with its
fastest; < : more accurate than all its rows, compared with its most accurate. Flight: µs/step over MuJoCo's.
A step that does not bring every member to rest has no row."
    );
}
