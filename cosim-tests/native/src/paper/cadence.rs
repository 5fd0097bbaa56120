//! Replanning cadence from 10 s to 0.5 s: landing error, contact and outcome.

use super::chapter::{Chapter, cell};
use super::closed_loop::{bounded, in_three_dof, mean};
use super::drawing::{COLOURS, key};
use super::flights::{CADENCE_S, Flights, Flown, Scheme};
use super::problems::{Start, problem};
use super::{Error, Inputs, three_dof};
use crate::csv::{number, quoted};
use crate::report::Figure;
use crate::statistics::binomial;
use crate::statistics::quantile::quantile;
use crate::svg::{Frame, picture, styled_line};

const MODES: [(bool, &str, &str); 2] =
    [(false, "plans alone", COLOURS[4]), (true, "with feedback, terminal law", COLOURS[1])];

/// Share with its bounds, per cent.
fn share(flown: &Flown, outcome: &str) -> [f64; 3] {
    let (count, runs) = (flown.count(outcome), flown.runs());
    let [low, high] = binomial::limits(count, runs);
    [count as f64 / runs as f64, low, high].map(|p| 100.0 * p)
}

/// # Errors
/// A printed number that is missing, a nominal plan that is not found.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let flights = &inputs.flights;
    let nominal = problem(Start::Descent, &inputs.bug, &inputs.printed)?;
    let printed_s = inputs.printed.number("replan_period", "s")?;
    let printed_m = inputs.printed.number("closed_loop_error", "m")?;
    let runs = (inputs.runs / 5).max(20).min(inputs.runs);
    let mut rows = Vec::new();
    for (feedback, mode, _) in MODES {
        for replan_s in CADENCE_S {
            let Some(flown) = flights.of(Scheme::of(replan_s, feedback)) else { continue };
            let as_printed = !feedback && replan_s == printed_s;
            let paper = if feedback {
                "no such law in it".to_owned()
            } else {
                let ends = in_three_dof(&nominal, three_dof::Scheme::Replanned(replan_s), runs)?;
                let misses: Vec<f64> = ends.iter().map(|end| end.miss_m).collect();
                bounded(mean(&misses), 2)
            };
            let mut cells = vec![cell(replan_s, 1), mode.to_owned()];
            cells.push(if as_printed {
                format!("< {printed_m}")
            } else {
                "not printed".to_owned()
            });
            cells.extend([
                paper,
                flown.runs().to_string(),
                bounded(mean(flown.sorted("position_error_m")), 2),
            ]);
            for (result, share) in [
                ("contact_speed_down_m_s", 0.5),
                ("contact_speed_down_m_s", 0.99),
                ("contact_speed_across_m_s", 0.99),
                ("contact_tilt_deg", 0.99),
                ("contact_rate_deg_s", 0.99),
            ] {
                cells.push(cell(quantile(flown.sorted(result), share).value, 2));
            }
            for outcome in ["landed", "tipped"] {
                let [value, low, high] = share(flown, outcome).map(|p| cell(p, 1));
                cells.push(format!("{value} ({low} to {high})"));
            }
            rows.push(cells);
        }
    }
    let mut chapter = Chapter::new("Replanning cadence, 10 s to 0.5 s");
    chapter.table(
        "cadence",
        "Landings over the time between two plans, under Table VIII and the failure modes. In \
         brackets 95 % bounds.",
        &[
            "plan each, s",
            "between plans",
            "printed miss, m",
            "paper's truth, mean miss, m",
            "landings",
            "mean miss, m",
            "down, median, m/s",
            "down, 99 %",
            "across, 99 %",
            "tilt, 99 %, deg",
            "rate, 99 %, deg/s",
            "landed, %",
            "tipped, %",
        ],
        rows,
    );
    chapter.differs(
        "the paper prints one cadence and no touchdown velocity. Without feedback, planning \
         more often brings miss and speed down, but some still reach the ground at metres a \
         second at every cadence: the last burn is planned to end at the ground exactly, and \
         what its engine is off by has no later plan to mend it. A terminal law takes the speed \
         off whatever the cadence; then what a plan's ten seconds of coast drift sideways, no \
         law takes off in time, and it lands from 2 s down.",
    );
    chapter.figure(curves(flights));
    Ok(chapter)
}

fn curves(flights: &Flights) -> Figure {
    let panel = |index: usize, high: f64| Frame {
        left: 60.0 + 330.0 * index as f64,
        top: 44.0,
        width: 260.0,
        height: 220.0,
        x: [0.0, 10.5],
        y: [0.0, high],
    };
    let (mut parts, mut csv) = (
        String::new(),
        "between_plans,replan_s,mean_miss_m,low_m,high_m,\
                                         down_p99_m_s,down_low,down_high,landed_percent,\
                                         landed_low,landed_high\n"
            .to_owned(),
    );
    let mut curves = Vec::new();
    for (feedback, mode, colour) in MODES {
        let mut points: [Vec<[f64; 4]>; 3] = Default::default();
        for replan_s in CADENCE_S {
            let Some(flown) = flights.of(Scheme::of(replan_s, feedback)) else { continue };
            let (miss, down) = (
                mean(flown.sorted("position_error_m")),
                quantile(flown.sorted("contact_speed_down_m_s"), 0.99),
            );
            let [value, low, high] = share(flown, "landed");
            let three = [
                [miss.value, miss.low, miss.high],
                [down.value, down.low, down.high],
                [value, low, high],
            ];
            let numbers: Vec<String> = three.iter().flatten().map(|n| number(*n)).collect();
            csv += &format!("{},{replan_s},{}\n", quoted(mode), numbers.join(","));
            for (curve, [value, low, high]) in points.iter_mut().zip(three) {
                curve.push([replan_s, value, low, high]);
            }
        }
        curves.push((mode, colour, points));
    }
    for (index, words) in
        ["mean miss, m", "speed down at contact, 99 %, m/s", "landed, %"].into_iter().enumerate()
    {
        let points = curves.iter().flat_map(|(_, _, points)| &points[index]);
        let tops = points.flat_map(|point| [point[1], point[3]]).filter(|top| top.is_finite());
        let high = if index == 2 { 100.0 } else { 1.05 * tops.fold(1e-3, f64::max) };
        let frame = panel(index, high);
        for (number, (mode, colour, points)) in curves.iter().enumerate() {
            let middle: Vec<[f64; 2]> =
                points[index].iter().map(|point| [point[0], point[1]]).collect();
            parts += &frame.path(&middle, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
            for [replan_s, value, low, high] in &points[index] {
                parts += &frame.dot([*replan_s, *value], 3.0, colour);
                let x = frame.px(*replan_s);
                // A bound that the flights are too few for lies beyond the frame.
                let ends = [*low, *high].map(|bound| bound.clamp(frame.y[0], frame.y[1]));
                parts += &styled_line(
                    [x, frame.py(ends[0])],
                    [x, frame.py(ends[1])],
                    &format!("stroke=\"{colour}\""),
                );
            }
            if index == 0 {
                parts += &key(&frame, number, mode, colour);
            }
        }
        parts += &frame.axes("", "time between two plans, s", words);
    }
    Figure {
        name: "cadence".to_owned(),
        caption: "Landing error, contact speed and share landed over the replanning period, \
                  with 95 % bounds."
            .to_owned(),
        svg: picture(1000.0, 315.0, &parts),
        csv,
    }
}
