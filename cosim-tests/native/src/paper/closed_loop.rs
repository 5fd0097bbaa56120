//! Fig. 7: Monte Carlo landings, closed loop against open loop, in the paper's truth and in this kit's.

use guidance_fmu::scvx::Problem;
use lander_models::scenario::Disturbances;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::chapter::{Chapter, cell};
use super::drawing::{COLOURS, key};
use super::flights::{AS_FIRED, CLOSED_LOOP, Flights, Flown, OPEN_LOOP, PAPER};
use super::problems::{Start, plan, problem};
use super::three_dof::{self, End, Scheme};
use super::{Error, Inputs};
use crate::csv::quoted;
use crate::report::Figure;
use crate::report::figures;
use crate::statistics::quantile::{Bounded, bootstrap, quantile};
use crate::study::summary::Group;
use crate::svg::{Frame, picture};

/// The schemes as they are called, with their colours.
pub const SCHEMES: [(&str, super::flights::Scheme, &str); 4] = [
    ("open loop", OPEN_LOOP, COLOURS[5]),
    ("10 s, as the paper", PAPER, COLOURS[3]),
    ("this kit's closed loop", CLOSED_LOOP, COLOURS[1]),
    ("the same, engine as fired", AS_FIRED, COLOURS[2]),
];

/// Mean of a sample with its 95 % bootstrap bounds.
pub fn mean(values: &[f64]) -> Bounded {
    if values.is_empty() {
        return Bounded { value: f64::NAN, low: f64::NAN, high: f64::NAN };
    }
    bootstrap(values.len(), 1, |indices| {
        indices.iter().map(|index| values[*index]).sum::<f64>() / indices.len() as f64
    })
}

pub fn bounded(found: Bounded, decimals: usize) -> String {
    let [value, low, high] = [found.value, found.low, found.high].map(|v| cell(v, decimals));
    format!("{value} ({low} to {high})")
}

/// Flights in the paper's own truth, under its Table VIII; runs 1 to `runs`.
pub fn in_three_dof(nominal: &Problem, scheme: Scheme, runs: u64) -> Result<Vec<End>, Error> {
    let first = plan(nominal).map_err(|source| Error::Plan { what: "descent", source })?;
    let errors = Disturbances::MONTE_CARLO_TABLE;
    let one = |seed: u64| three_dof::fly(nominal, &first, scheme, &errors, seed);
    Ok((1..=runs).into_par_iter().map(one).collect())
}

fn of(ends: &[End], number: fn(&End) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = ends.iter().map(number).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// # Errors
/// A printed number that is missing, a nominal plan that is not found.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, flights, .. } = inputs;
    let nominal = problem(Start::Descent, &inputs.bug, printed)?;
    let period_s = printed.number("replan_period", "s")?;
    let mut chapter =
        Chapter::new("Monte Carlo, closed loop against open loop: section V-C, Fig. 7");
    let open_m = cell(printed.number("open_loop_error", "m")?, 0);
    let closed_m = format!("< {}", cell(printed.number("closed_loop_error", "m")?, 0));
    let unprinted = || "not printed".to_owned();
    let lines = [
        ("open loop, nominal start's plan", open_m, Some(Scheme::OpenLoop), None),
        ("open loop, own start's plan", unprinted(), Some(Scheme::KnownStart), Some(OPEN_LOOP)),
        ("10 s, as the paper", closed_m, Some(Scheme::Replanned(period_s)), Some(PAPER)),
        ("this kit's closed loop", unprinted(), None, Some(CLOSED_LOOP)),
        ("the same, engine as fired", unprinted(), None, Some(AS_FIRED)),
    ];
    let mut errors = Vec::new();
    for (name, printed, paper, scheme) in lines {
        let mut cells = vec![name.to_owned(), printed];
        cells.extend(match paper {
            Some(paper) => {
                let ends = in_three_dof(&nominal, paper, inputs.runs)?;
                let down = quantile(&of(&ends, |end| end.down_m_s), 0.5);
                [bounded(mean(&of(&ends, |end| end.miss_m)), 2), cell(down.value, 2)]
            }
            None => ["no such law in it", "no such law in it"].map(str::to_owned),
        });
        cells.extend(match scheme.and_then(|scheme| flights.of(scheme)) {
            Some(flown) => {
                let misses = flown.sorted("position_error_m");
                let [high, most] = [0.99, 1.0].map(|share| cell(quantile(misses, share).value, 2));
                [flown.runs().to_string(), bounded(mean(misses), 2), high, most]
            }
            None => ["not flown"; 4].map(str::to_owned),
        });
        errors.push(cells);
    }
    chapter.table(
        "landing-error",
        "Landing error: distance from the target, m. Means with 95 % bootstrap bounds.",
        &[
            "guidance",
            "printed, mean, m",
            "paper's truth (3-DoF, RK4 0.1 s), mean, m",
            "its speed down at the ground, median, m/s",
            "landings in this kit's truth",
            "mean, m",
            "99 %, m",
            "greatest, m",
        ],
        errors,
    );
    let precision_m = printed.number("landing_precision", "m")?;
    chapter.differs(format!(
        "initial state, altitude and glide slope are not printed, so 12 m and 147 m are trends: \
         the last table shows from which height the paper's truth gives them. Most of its open loop \
         is the error of the start, 10 m and 2 m/s an axis; with a plan of the run's own start \
         it is the second line. This kit's guidance always knows where it is, so its open loop \
         is that one. In either truth a vehicle that replans each 10 s comes within metres of \
         the target and reaches the ground at metres a second. The abstract's \"less than {precision_m} m\" says less than \
         the 12 m.",
    ));
    touchdown(&mut chapter, flights);
    outcomes(&mut chapter, flights);
    chapter.figure(super::trajectories::figure(inputs)?);
    heights(&mut chapter, inputs, &nominal, period_s)?;
    Ok(chapter)
}

/// What touchdown is judged by, with its quantiles.
const CONTACT: [(&str, &str, &str); 5] = [
    ("contact_speed_down_m_s", "speed down at contact, m/s", "down"),
    ("contact_speed_across_m_s", "speed across at contact, m/s", "across"),
    ("contact_tilt_deg", "tilt at contact, deg", "tilt"),
    ("contact_rate_deg_s", "rate at contact, deg/s", "rate"),
    ("position_error_m", "distance from the target, m", "miss"),
];

fn touchdown(chapter: &mut Chapter, flights: &Flights) {
    let mut rows = Vec::new();
    for (name, scheme, _) in SCHEMES {
        let Some(flown) = flights.of(scheme) else { continue };
        for (result, words, _) in CONTACT {
            let sorted = flown.sorted(result);
            let mut cells = vec![name.to_owned(), words.to_owned(), sorted.len().to_string()];
            cells.extend([0.5, 0.99].map(|share| bounded(quantile(sorted, share), 2)));
            cells.push(cell(quantile(sorted, 1.0).value, 2));
            rows.push(cells);
        }
    }
    chapter.table(
        "touchdown",
        "What the paper does not print: the state at first contact. Quantiles with 95 % \
         bootstrap bounds.",
        &["guidance", "result", "measured in", "median", "99 %", "greatest"],
        rows,
    );
    chapter.figure(distributions(flights));
}

fn outcomes(chapter: &mut Chapter, flights: &Flights) {
    let (mut rows, mut groups) = (Vec::new(), Vec::new());
    for (name, scheme, _) in SCHEMES {
        let Some(Flown { outcomes, failures, .. }) = flights.of(scheme) else { continue };
        let with = |failed: bool| {
            let runs = outcomes.iter().zip(failures.iter());
            runs.filter(move |(_, failures)| (*failures != "none") == failed)
                .map(|(outcome, _)| outcome)
        };
        let split = [
            Group::new("all", outcomes.iter()),
            Group::new("without a failure mode", with(false)),
            Group::new("with one", with(true)),
        ];
        for group in split.iter().filter(|group| group.runs > 0) {
            for share in &group.outcomes {
                let percent = [share.share, share.share_low, share.share_high].map(|p| 100.0 * p);
                let mut cells =
                    vec![name.to_owned(), group.failures.clone(), share.outcome.clone()];
                cells.push(format!("{} of {}", share.runs, group.runs));
                cells.extend(percent.map(|p| cell(p, 2)));
                rows.push(cells);
            }
        }
        let [all, ..] = split;
        groups.push(Group { failures: name.to_owned(), ..all });
    }
    chapter.table(
        "landing-outcomes",
        "How the landings ended, tip-over included, with two-sided 95 % bounds by Clopper and \
         Pearson.",
        &["guidance", "runs", "outcome", "count", "share, %", "from, %", "to, %"],
        rows,
    );
    chapter.differs(
        "the paper judges by position alone. A plan flown without feedback down to the ground \
         is off in height by metres when its engine is off by per cents, so it arrives too fast \
         or cuts off too high. Position precision is no landing: what lands is feedback down to \
         cut-off. Ten failure modes at 2.5 % in all are a couple of dozen of 1,000 runs: each \
         mode's share has bounds too wide to tell modes apart (study `failure-modes`).",
    );
    chapter.figure(figures::outcomes(&groups));
}

/// Distribution functions of the contact state, a curve a scheme.
fn distributions(flights: &Flights) -> Figure {
    let (mut parts, mut csv) = (String::new(), "guidance,result,value,share\n".to_owned());
    for (panel, (result, words, _)) in CONTACT.into_iter().enumerate() {
        let samples: Vec<_> = SCHEMES
            .into_iter()
            .filter_map(|(name, scheme, colour)| {
                Some((name, colour, flights.of(scheme)?.sorted(result)))
            })
            .filter(|(_, _, sorted)| !sorted.is_empty())
            .collect();
        // To the worst but one in a hundred of the worst scheme: the tail would hide the rest.
        let reach =
            samples.iter().map(|(_, _, sorted)| quantile(sorted, 0.99).value).fold(0.0, f64::max);
        let frame = Frame {
            left: 60.0 + 330.0 * (panel % 3) as f64,
            top: 44.0 + 250.0 * (panel / 3) as f64,
            width: 260.0,
            height: 180.0,
            x: [0.0, reach.max(1e-3)],
            y: [0.0, 1.0],
        };
        for (index, (name, colour, sorted)) in samples.iter().enumerate() {
            let n = sorted.len();
            let kept = (0..=400.min(n - 1)).map(|k| k * (n - 1) / 400.min(n - 1).max(1));
            let points: Vec<[f64; 2]> =
                kept.map(|i| [sorted[i], (i + 1) as f64 / n as f64]).collect();
            for [value, share] in &points {
                csv += &format!("{},{result},{value},{share}\n", quoted(name));
            }
            parts += &frame.path(&points, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
            if panel == 0 {
                parts += &key(
                    &Frame { left: 60.0 + 110.0 * index as f64, ..frame },
                    index,
                    name,
                    colour,
                );
            }
        }
        parts += &frame.axes("", words, "share of the runs");
    }
    Figure {
        name: "touchdown-distributions".to_owned(),
        caption: "Distribution functions of the state at first contact, cut off at the 99 % \
                  quantile of the widest."
            .to_owned(),
        svg: picture(1000.0, 545.0, &parts),
        csv,
    }
}

/// The paper's truth over the height of the start: where 147 m is.
fn heights(
    chapter: &mut Chapter,
    inputs: &Inputs,
    nominal: &Problem,
    period_s: f64,
) -> Result<(), Error> {
    let runs = (inputs.runs / 5).max(20).min(inputs.runs);
    let mut rows = Vec::new();
    for height_m in [300.0, 500.0, 900.0, 1500.0, 2500.0, 4000.0] {
        let start = Problem { r0_w: Vector3::new(300.0, 100.0, height_m), ..nominal.clone() };
        let first = plan(&start)
            .map_err(|source| Error::Plan { what: "descent from another height", source })?;
        let mut cells = vec![cell(height_m, 0), cell(first.duration_s(), 1)];
        for scheme in [Scheme::OpenLoop, Scheme::Replanned(period_s)] {
            let ends = in_three_dof(&start, scheme, runs)?;
            cells.push(bounded(mean(&of(&ends, |end| end.miss_m)), 1));
            cells.push(cell(quantile(&of(&ends, |end| end.down_m_s), 0.5).value, 1));
        }
        rows.push(cells);
    }
    chapter.table(
        "landing-error-height",
        &format!(
            "The paper's truth from other heights, {runs} runs each: which start its two \
                  numbers could be from."
        ),
        &[
            "start height, m",
            "plan's duration, s",
            "open loop, mean miss, m",
            "open loop, speed down, median, m/s",
            "plan each 10 s, mean miss, m",
            "plan each 10 s, speed down, median, m/s",
        ],
        rows,
    );
    Ok(())
}
