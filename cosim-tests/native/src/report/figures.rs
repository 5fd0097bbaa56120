//! The figures of a campaign.

use lander_models::Outcome;

use super::Figure;
use crate::csv::quoted;
use crate::map::picture::colour;
use crate::study::StudyError;
use crate::study::data::Data;
use crate::study::summary::{Correlation, Group, short};
use crate::svg::{Frame, line, picture, text};

/// Outcomes of each group of runs as bars of shares.
pub fn outcomes(groups: &[Group]) -> Figure {
    const BAR: f64 = 20.0;
    let frame = Frame {
        left: 170.0,
        top: 50.0,
        width: 560.0,
        height: (BAR + 6.0) * groups.len() as f64 + 6.0,
        x: [0.0, 100.0],
        y: [0.0, 1.0],
    };
    let (mut parts, mut csv) = (String::new(), "failures,runs,outcome,share\n".to_owned());
    let mut seen: Vec<&str> = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        let top = frame.top + 6.0 + (BAR + 6.0) * index as f64;
        let label = format!("{} ({})", group.failures, group.runs);
        parts += &text(frame.left - 8.0, top + 14.0, "end", 11, &label);
        let mut from = 0.0;
        for share in group.outcomes.iter().filter(|share| share.runs > 0) {
            let to = from + 100.0 * share.share;
            let (left, right) = (frame.px(from), frame.px(to));
            parts += &format!(
                "<rect x=\"{left:.2}\" y=\"{top}\" width=\"{:.2}\" height=\"{BAR}\" fill=\"{}\"/>\n",
                right - left,
                colour_of(&share.outcome)
            );
            csv += &format!(
                "{},{},{},{}\n",
                quoted(&group.failures),
                group.runs,
                share.outcome,
                share.share
            );
            from = to;
            if !seen.contains(&share.outcome.as_str()) {
                seen.push(&share.outcome);
            }
        }
    }
    for tick in [0.0, 25.0, 50.0, 75.0, 100.0] {
        let (x, bottom) = (frame.px(tick), frame.top + frame.height);
        parts += &line([x, bottom], [x, bottom + 4.0], "#333");
        parts += &text(x, bottom + 16.0, "middle", 10, &format!("{tick} %"));
    }
    for (index, outcome) in seen.iter().enumerate() {
        let left = 170.0 + 95.0 * index as f64;
        let fill = colour_of(outcome);
        parts +=
            &format!("<rect x=\"{left}\" y=\"14\" width=\"14\" height=\"14\" fill=\"{fill}\"/>\n");
        parts += &text(left + 19.0, 25.0, "start", 12, outcome);
    }
    Figure {
        name: "outcomes".to_owned(),
        caption: "Outcomes of the runs, in brackets how many.".to_owned(),
        svg: picture(760.0, frame.top + frame.height + 30.0, &parts),
        csv,
    }
}

pub fn colour_of(outcome: &str) -> &'static str {
    let known = Outcome::ALL.into_iter().find(|known| known.name() == outcome);
    // What a component broke off.
    known.map_or("#101010", colour)
}

/// Results that have a distribution function, with their axes' words.
const FUNCTIONS: [(&str, &str); 8] = [
    ("contact_speed_down_m_s", "speed down at contact, m/s"),
    ("contact_speed_across_m_s", "speed across at contact, m/s"),
    ("contact_tilt_deg", "tilt at contact, deg"),
    ("position_error_m", "distance from the target, m"),
    ("peak_stroke_m", "greatest stroke, m"),
    ("peak_leg_load_n", "greatest load of a leg, N"),
    ("stability_distance_m", "least stability distance, m"),
    ("slide_distance_m", "slide, m"),
];

/// Distribution functions of the results that differ between runs, if any do.
pub fn distribution_functions(data: &Data) -> Result<Option<Figure>, StudyError> {
    let (mut parts, mut csv) = (String::new(), "result,value,share\n".to_owned());
    let mut panels = 0_i32;
    for (name, words) in FUNCTIONS {
        let sorted = data.sorted(name)?;
        let [Some(first), Some(last)] = [sorted.first(), sorted.last()] else { continue };
        if first == last {
            continue;
        }
        let frame = Frame {
            left: 55.0 + 250.0 * f64::from(panels % 4),
            top: 24.0 + 205.0 * f64::from(panels / 4),
            width: 185.0,
            height: 140.0,
            x: [*first, *last],
            y: [0.0, 1.0],
        };
        panels += 1;
        let n = sorted.len();
        // As many steps as a panel shows; the ends are kept.
        let kept = (0..=400.min(n - 1)).map(|k| k * (n - 1) / 400.min(n - 1));
        let points: Vec<[f64; 2]> =
            kept.map(|index| [sorted[index], (index + 1) as f64 / n as f64]).collect();
        for [value, share] in &points {
            csv += &format!("{name},{value},{share}\n");
        }
        parts += &frame.path(&points, "stroke=\"#2b6cb0\" stroke-width=\"1.6\"");
        parts += &frame.axes("", words, "share of the runs");
    }
    Ok((panels > 0).then(|| Figure {
        name: "distributions".to_owned(),
        caption: "Distribution functions over the runs in which each was measured.".to_owned(),
        svg: picture(1020.0, 24.0 + 205.0 * f64::from((panels + 3) / 4), &parts),
        csv,
    }))
}

/// Places drawn of a campaign: more would only cover each other.
const DOTS: usize = 5000;

/// Where the runs came to rest, with ellipses of one to three standard deviations. `None` where nothing spread.
pub fn footprint(data: &Data) -> Result<Option<Figure>, StudyError> {
    let [Some(x), Some(y)] = [data.column("position_w_1")?, data.column("position_w_2")?] else {
        return Ok(None);
    };
    let places = || {
        let runs = x.iter().zip(&y).zip(data.outcomes.iter());
        let runs = runs.map(|((x, y), outcome)| ([*x, *y], outcome));
        runs.filter(|([x, y], outcome)| x.is_finite() && y.is_finite() && *outcome != "failed")
    };
    let landed = || places().filter(|(_, outcome)| *outcome == "landed").map(|(place, _)| place);
    let count = landed().count();
    let n = count as f64;
    if count < 10 {
        return Ok(None);
    }
    let mean = [0, 1].map(|i| landed().map(|p| p[i]).sum::<f64>() / n);
    let covariance = |i: usize, j: usize| {
        landed().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>() / (n - 1.0)
    };
    let (xx, xy, yy) = (covariance(0, 0), covariance(0, 1), covariance(1, 1));
    let half = 4.0 * xx.max(yy).sqrt();
    if half <= 0.0 {
        return Ok(None);
    }
    let frame = Frame {
        left: 60.0,
        top: 20.0,
        width: 380.0,
        height: 380.0,
        x: [mean[0] - half, mean[0] + half],
        y: [mean[1] - half, mean[1] + half],
    };
    let (mut parts, mut csv) = (String::new(), "x_m,y_m,outcome\n".to_owned());
    let inside = |[x, y]: [f64; 2]| (x - mean[0]).abs() < half && (y - mean[1]).abs() < half;
    let outside = places().filter(|(place, _)| !inside(*place)).count();
    for ([x, y], outcome) in places().take(DOTS) {
        csv += &format!("{x},{y},{outcome}\n");
        if inside([x, y]) {
            parts += &frame.dot([x, y], 1.8, colour_of(outcome));
        }
    }
    // Square root of the covariance, by Cholesky.
    let (a, b) = (xx.sqrt(), xy / xx.sqrt());
    let c = (yy - b * b).max(0.0).sqrt();
    for sigmas in [1.0, 2.0, 3.0] {
        let ellipse: Vec<[f64; 2]> = (0..=72)
            .map(|step| {
                let (sin, cos) = libm::sincos(f64::from(step) * std::f64::consts::TAU / 72.0);
                [mean[0] + sigmas * a * cos, mean[1] + sigmas * (b * cos + c * sin)]
            })
            .collect();
        parts += &frame.path(&ellipse, "stroke=\"#222\" stroke-width=\"0.9\"");
    }
    parts += &frame.axes("", "east of the target, m", "north of the target, m");
    let dots = match places().nth(DOTS) {
        None => String::new(),
        Some(_) => format!(" Dots and data are the first {DOTS}, ellipses and counts are of all."),
    };
    Ok(Some(Figure {
        name: "footprint".to_owned(),
        caption: format!(
            "Where the runs ended, world frame; ellipses of 1, 2 and 3 standard deviations of the {count} that \
             landed. {outside} lie outside the picture.{dots}"
        ),
        svg: picture(460.0, 440.0, &parts),
        csv,
    }))
}

/// The strongest rank correlations of a result, as bars with their bounds.
pub fn sensitivity(result: &str, correlations: &[&Correlation]) -> Figure {
    const BAR: f64 = 18.0;
    let frame = Frame {
        left: 290.0,
        top: 14.0,
        width: 380.0,
        height: (BAR + 6.0) * correlations.len() as f64 + 6.0,
        x: [-1.0, 1.0],
        y: [0.0, 1.0],
    };
    let (mut parts, mut csv) = (String::new(), "parameter,correlation,low,high\n".to_owned());
    let middle = frame.px(0.0);
    for (index, c) in correlations.iter().enumerate() {
        let top = frame.top + 6.0 + (BAR + 6.0) * index as f64;
        let [value, low, high] = [c.bounded.value, c.bounded.low, c.bounded.high];
        let end = frame.px(value);
        parts += &text(frame.left - 8.0, top + 13.0, "end", 11, &c.parameter);
        parts += &format!(
            "<rect x=\"{:.2}\" y=\"{top}\" width=\"{:.2}\" height=\"{BAR}\" fill=\"#7aa6d6\"/>\n",
            middle.min(end),
            (end - middle).abs()
        );
        parts += &line([frame.px(low), top + 9.0], [frame.px(high), top + 9.0], "#222");
        parts += &text(frame.left + frame.width + 40.0, top + 13.0, "end", 11, &short(value));
        csv += &format!("{},{value},{low},{high}\n", c.parameter);
    }
    for tick in [-1.0, -0.5, 0.0, 0.5, 1.0] {
        let (x, bottom) = (frame.px(tick), frame.top + frame.height);
        parts += &line([x, frame.top], [x, bottom], if tick == 0.0 { "#333" } else { "#ddd" });
        parts += &text(x, bottom + 14.0, "middle", 10, &tick.to_string());
    }
    Figure {
        name: format!("sensitivity-{result}"),
        caption: format!("Rank correlation of {result} with what was drawn, and its 95 % bounds."),
        svg: picture(740.0, frame.top + frame.height + 24.0, &parts),
        csv,
    }
}
