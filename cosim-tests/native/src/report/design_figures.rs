//! The figures of a design study: heat maps over two axes, curves with their bounds over one.

use super::Figure;
use super::figures::colour_of;
use crate::csv::{number, quoted};
use crate::statistics::quantile::Bounded;
use crate::study::axis::Axis;
use crate::study::designs::{DesignSummary, OfDesign};
use crate::study::distribution::Value;
use crate::study::{Kind, Study};
use crate::svg::{Frame, line, picture, text};

/// Results that a report shows, with the quantile that is judged and its words.
pub const SHOWN: [(&str, (f64, &str)); 10] = [
    ("stability_distance_m", (0.01, "stability distance, 1 %, m")),
    ("peak_stroke_m", (0.99, "greatest stroke, 99 %, m")),
    ("peak_acceleration_m_s2", (0.99, "peak acceleration, 99 %, m/s2")),
    ("peak_leg_load_n", (0.99, "load of a leg, 99 %, N")),
    ("least_nozzle_clearance_m", (0.01, "nozzle clearance, 1 %, m")),
    ("slide_distance_m", (0.99, "slide, 99 %, m")),
    ("contact_speed_down_m_s", (0.99, "speed down at contact, 99 %, m/s")),
    ("contact_speed_across_m_s", (0.99, "speed across at contact, 99 %, m/s")),
    ("position_error_m", (0.99, "distance from the target, 99 %, m")),
    ("propellant_used_kg", (0.5, "propellant used, median, kg")),
];

/// A number of a design and its bounds; `None` where it has none.
type Number<'a> = &'a dyn Fn(&OfDesign) -> Option<Bounded>;

/// What a number is.
#[derive(Clone, Copy, PartialEq)]
enum Scale {
    Share,
    /// A difference of shares, whose sign counts: 0 is white, and what its bounds do not tell from 0 is grey.
    Points,
    Quantity,
}

impl Scale {
    fn words(self, value: f64) -> String {
        match self {
            Self::Share => format!("{:.1}", 100.0 * value),
            Self::Points => format!("{:+.1}", 100.0 * value),
            Self::Quantity => three_digits(value),
        }
    }

    /// From a number to what an axis has.
    fn factor(self) -> f64 {
        if self == Self::Quantity { 1.0 } else { 100.0 }
    }
}

fn three_digits(value: f64) -> String {
    let digits = 2 - libm::log10(value.abs().max(1e-3)).floor() as i32;
    format!("{value:.*}", digits.clamp(0, 3) as usize)
}

/// A number over the designs, drawn as a panel of a heat map or as a curve.
struct Layer<'a> {
    title: &'a str,
    colour: &'static str,
    number: Number<'a>,
    scale: Scale,
}

const INDIGO: &str = "#2b6cb0";

fn share(name: &str) -> impl Fn(&OfDesign) -> Option<Bounded> {
    move |design| {
        let share = &design.outcome(name)?.share;
        Some(Bounded { value: share.share, low: share.share_low, high: share.share_high })
    }
}

/// Tip-over with its difference to the baseline and what the criteria call it; then every other outcome.
pub fn outcomes(study: &Study, summary: &DesignSummary) -> Vec<Figure> {
    let tipped = share("tipped");
    let difference = |design: &OfDesign| Some(design.outcome("tipped")?.difference?.bounded);
    let exact = |share: f64| Bounded { value: share, low: f64::NAN, high: f64::NAN };
    let captured = |design: &OfDesign| Some(exact(design.criteria?.captured_pads.share));
    let fixed = |design: &OfDesign| Some(exact(design.criteria?.static_angle.share));
    let red = colour_of("tipped");
    let layer = |title, colour, number, scale| Layer { title, colour, number, scale };
    let mut layers = vec![
        layer("tipped over, %", red, &tipped as Number, Scale::Share),
        layer("against the baseline, percentage points", red, &difference, Scale::Points),
    ];
    let judged = summary.designs.iter().any(|design| design.criteria.is_some());
    if judged {
        layers.push(layer("called by T.24, held pads, %", "#7a4b94", &captured, Scale::Share));
        layers.push(layer("called by the static angle, %", "#444444", &fixed, Scale::Share));
    }
    let baseline = match study.axes.len() {
        2 => "(framed) over the same draws, where grey is not told from none",
        _ => "(dashed) over the same draws",
    };
    let criteria = match judged {
        true => ", and the share of the draws that each criterion calls a tip-over",
        false => "",
    };
    let caption = format!(
        "Probability of a tip-over with 95 % bounds, and the difference to the baseline {baseline}{criteria}."
    );
    let mut figures = vec![figure(study, summary, "tip-over", &caption, &layers)];
    let names: Vec<&str> = summary.designs.first().map_or(Vec::new(), |design| {
        design.outcomes.iter().map(|outcome| outcome.share.outcome.as_str()).collect()
    });
    let others: Vec<_> = names.into_iter().filter(|name| *name != "tipped").collect();
    let numbers: Vec<_> =
        others.iter().map(|name| (format!("{name}, %"), colour_of(name), share(name))).collect();
    let layers: Vec<Layer> = (numbers.iter())
        .map(|(title, colour, number)| layer(title, colour, number, Scale::Share))
        .collect();
    figures.push(figure(
        study,
        summary,
        "other-outcomes",
        "Probability of every other outcome that was met, with 95 % bounds.",
        &layers,
    ));
    figures
}

/// Quantiles of what was measured.
pub fn results(study: &Study, summary: &DesignSummary) -> Vec<Figure> {
    let of = |name: &'static str, quantile: f64| {
        move |design: &OfDesign| design.result(name)?.quantiles.at(quantile)
    };
    let shown: Vec<_> = SHOWN
        .into_iter()
        .filter(|(name, _)| *name != "position_error_m" || study.kind == Kind::Landing)
        .filter(|(name, (quantile, _))| {
            let values = summary.designs.iter().map(|d| d.result(name)?.quantiles.at(*quantile));
            let values: Option<Vec<f64>> = values.map(|b| Some(b?.value)).collect();
            // What no design moves tells nothing.
            values.is_some_and(|values| values.iter().any(|value| *value != values[0]))
        })
        .map(|(name, (quantile, words))| (words, of(name, quantile)))
        .collect();
    let layers: Vec<Layer> = shown
        .iter()
        .map(|(title, number)| Layer { title, colour: INDIGO, number, scale: Scale::Quantity })
        .collect();
    if layers.is_empty() {
        return Vec::new();
    }
    let caption = "Quantiles of what was measured, with 95 % bootstrap bounds.";
    vec![figure(study, summary, "margins", caption, &layers)]
}

fn figure(
    study: &Study,
    summary: &DesignSummary,
    name: &str,
    caption: &str,
    layers: &[Layer],
) -> Figure {
    let svg = match study.axes.as_slice() {
        [x, y] => heat_maps(x, y, summary, layers),
        [x] => curves(x, summary, layers),
        _ => String::new(),
    };
    let axes: Vec<&str> = study.axes.iter().map(|axis| axis.column.as_str()).collect();
    let mut csv = format!("{},number,value,low,high\n", axes.join(","));
    for design in &summary.designs {
        let values: Vec<String> = design.values.iter().map(Value::to_string).collect();
        for layer in layers {
            let Some(b) = (layer.number)(design) else { continue };
            let unit = layer.scale.factor();
            let numbers = [b.value, b.low, b.high].map(|n| number(unit * n));
            let (values, title) = (values.join(","), quoted(layer.title));
            csv += &format!("{values},{title},{}\n", numbers.join(","));
        }
    }
    Figure { name: name.to_owned(), caption: caption.to_owned(), svg, csv }
}

/// Shares up to this have no more than its part of the depth.
const PALE_SHARE: f64 = 0.1;
const MARGIN: [f64; 2] = [86.0, 74.0];
const ROW: f64 = 44.0;

/// A panel a layer, two in a row while their cells have room for their words.
fn heat_maps(x: &Axis, y: &Axis, summary: &DesignSummary, layers: &[Layer]) -> String {
    let (columns, rows) = (x.values.len(), y.values.len());
    let abreast = if columns <= 6 && layers.len() > 1 { 2 } else { 1 };
    let width = if abreast == 2 { 400.0 } else { 900.0_f64.min(120.0 * columns as f64) };
    let height = ROW * rows as f64;
    let mut parts = String::new();
    for (index, layer) in layers.iter().enumerate() {
        let frame = Frame {
            left: MARGIN[0] + (width + MARGIN[0] + 16.0) * (index % abreast) as f64,
            top: 30.0 + (height + MARGIN[1]) * (index / abreast) as f64,
            width,
            height,
            x: [0.0, columns as f64],
            y: [0.0, rows as f64],
        };
        parts += &heat_map(x, y, summary, layer, &frame);
    }
    let whole = [
        (width + MARGIN[0] + 16.0) * abreast as f64 + 10.0,
        30.0 + (height + MARGIN[1]) * layers.len().div_ceil(abreast) as f64,
    ];
    picture(whole[0], whole[1], &parts)
}

fn heat_map(x: &Axis, y: &Axis, summary: &DesignSummary, layer: &Layer, frame: &Frame) -> String {
    let columns = x.values.len();
    let numbers: Vec<Option<Bounded>> = summary.designs.iter().map(layer.number).collect();
    let values = || numbers.iter().flatten().map(|number| number.value);
    let signed = layer.scale == Scale::Points;
    let magnitude = |value: f64| if signed { value.abs() } else { value };
    // What is rare everywhere stays pale.
    let floor = if layer.scale == Scale::Share { PALE_SHARE } else { f64::MIN };
    let most = values().map(magnitude).fold(floor, f64::max);
    let least = match layer.scale {
        Scale::Quantity => values().fold(f64::MAX, f64::min),
        _ => 0.0,
    };
    let room = frame.width / columns as f64 > 58.0;
    let mut parts = String::new();
    for (design, number) in numbers.iter().enumerate() {
        let (column, row) = ((design % columns) as f64, (design / columns) as f64);
        let centre = frame.px(column + 0.5);
        let top = frame.py(row + 1.0);
        let framed = design == summary.baseline;
        let Some(Bounded { value, low, high }) = *number else {
            if framed {
                parts += &text(centre, top + 26.0, "middle", 11, "baseline");
                parts += &cell_frame(frame, column, row);
            }
            continue;
        };
        let depth = if most > least { (magnitude(value) - least) / (most - least) } else { 0.0 };
        let told = !signed || low > 0.0 || high < 0.0;
        let colour = match (told, signed && value < 0.0) {
            (false, _) => "#9a9a9a",
            (true, true) => colour_of("landed"),
            (true, false) => layer.colour,
        };
        let depth = if told { depth } else { 0.35 };
        parts += &frame.rectangle(
            [column, column + 1.0],
            [row, row + 1.0],
            &tint(colour, 0.75 * depth.clamp(0.0, 1.0)),
        );
        let bounds = low.is_finite() && room;
        let middle = if bounds { top + 19.0 } else { top + 26.0 };
        parts += &text(centre, middle, "middle", 13, &layer.scale.words(value));
        if bounds {
            let words = format!("{} to {}", layer.scale.words(low), layer.scale.words(high));
            parts += &text(centre, top + 35.0, "middle", 9, &words);
        }
        if framed {
            parts += &cell_frame(frame, column, row);
        }
    }
    parts += &border(frame, layer.title, &x.label(), &y.label());
    for (place, value) in x.values.iter().enumerate() {
        let at = frame.px(place as f64 + 0.5);
        parts += &text(at, frame.top + frame.height + 15.0, "middle", 10, &value.to_string());
    }
    for (place, value) in y.values.iter().enumerate() {
        let at = frame.py(place as f64 + 0.5) + 3.5;
        parts += &text(frame.left - 6.0, at, "end", 10, &value.to_string());
    }
    parts
}

/// The baseline's.
fn cell_frame(frame: &Frame, column: f64, row: f64) -> String {
    let (left, top) = (frame.px(column) + 1.5, frame.py(row + 1.0) + 1.5);
    let width = frame.px(column + 1.0) - frame.px(column) - 3.0;
    format!(
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#111\" \
         stroke-width=\"2.2\"/>\n",
        ROW - 3.0
    )
}

/// Border and words of a panel whose ticks are values.
fn border(frame: &Frame, title: &str, x_label: &str, y_label: &str) -> String {
    // No ticks: none lies between two equal ends.
    Frame { x: [0.0, 0.0], y: [0.0, 0.0], ..*frame }.axes_beside(title, x_label, y_label, 62.0)
}

/// White at 0, the colour at 1.
fn tint(colour: &str, depth: f64) -> String {
    let channel = |at: usize| {
        let full = u8::from_str_radix(&colour[at..at + 2], 16).map_or(128.0, f64::from);
        (255.0 + (full - 255.0) * depth).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(1), channel(3), channel(5))
}

/// A panel a layer with its curve and the band of its bounds.
fn curves(x: &Axis, summary: &DesignSummary, layers: &[Layer]) -> String {
    const PANEL: [f64; 2] = [400.0, 230.0];
    let at: Vec<f64> = (x.values.iter().enumerate())
        .map(|(place, value)| match value {
            Value::Number(number) => *number,
            Value::Text(_) => place as f64,
        })
        .collect();
    let ends = at.iter().fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(*v), b.max(*v)]);
    let pad = 0.06 * (ends[1] - ends[0]);
    let mut parts = String::new();
    for (index, layer) in layers.iter().enumerate() {
        // The baseline does not differ from itself.
        let none =
            (layer.scale == Scale::Points).then_some(Bounded { value: 0.0, low: 0.0, high: 0.0 });
        let numbers: Vec<(f64, Bounded)> = (at.iter().zip(&summary.designs))
            .filter_map(|(at, design)| Some((*at, (layer.number)(design).or(none)?)))
            .collect();
        let scale = layer.scale.factor();
        let shown = numbers.iter().flat_map(|(_, b)| [b.value, b.low, b.high]);
        let range = shown
            .filter(|value| value.is_finite())
            .fold([0.0_f64, 0.0_f64], |[a, b], value| [a.min(scale * value), b.max(scale * value)]);
        let frame = Frame {
            left: 66.0 + (PANEL[0] + 86.0) * (index % 2) as f64,
            top: 30.0 + (PANEL[1] + 66.0) * (index / 2) as f64,
            width: PANEL[0],
            height: PANEL[1],
            x: [ends[0] - pad, ends[1] + pad],
            y: [1.05 * range[0], if range[1] > range[0] { 1.05 * range[1] } else { 1.0 }],
        };
        let edge =
            |of: fn(&Bounded) -> f64| numbers.iter().map(move |(at, b)| (*at, scale * of(b)));
        let banded = numbers.iter().all(|(_, b)| b.low.is_finite() && b.high.is_finite());
        if banded {
            let there = edge(|b| b.low).map(|(at, value)| pixel(&frame, at, value));
            let back: Vec<String> =
                edge(|b| b.high).map(|(at, value)| pixel(&frame, at, value)).collect();
            let outline: Vec<String> = there.chain(back.into_iter().rev()).collect();
            parts += &format!(
                "<polygon points=\"{}\" fill=\"{}\" stroke=\"none\"/>\n",
                outline.join(" "),
                tint(layer.colour, 0.28)
            );
        }
        let points: Vec<[f64; 2]> = edge(|b| b.value).map(|(at, value)| [at, value]).collect();
        if layer.scale == Scale::Points {
            parts += &line(
                [frame.left, frame.py(0.0)],
                [frame.left + frame.width, frame.py(0.0)],
                "#888",
            );
        }
        parts += &frame.path(&points, &format!("stroke=\"{}\" stroke-width=\"1.8\"", layer.colour));
        for point in &points {
            parts += &frame.dot(*point, 3.0, layer.colour);
        }
        let base = frame.px(at[x.baseline]);
        parts += &format!(
            "<line x1=\"{base:.1}\" y1=\"{:.1}\" x2=\"{base:.1}\" y2=\"{:.1}\" stroke=\"#111\" stroke-dasharray=\"3 3\"/>\n",
            frame.top,
            frame.top + frame.height
        );
        let numeric = x.unit.is_some();
        let ticks = if numeric { frame.x } else { [0.0, 0.0] };
        parts += &Frame { x: ticks, ..frame }.axes_beside(layer.title, &x.label(), "", 36.0);
        if !numeric {
            for (at, value) in at.iter().zip(&x.values) {
                let below = frame.top + frame.height + 15.0;
                parts += &text(frame.px(*at), below, "middle", 10, &value.to_string());
            }
        }
    }
    let rows = layers.len().div_ceil(2) as f64;
    let columns = layers.len().min(2) as f64;
    picture(66.0 + (PANEL[0] + 86.0) * columns - 60.0, 30.0 + (PANEL[1] + 66.0) * rows, &parts)
}

fn pixel(frame: &Frame, x: f64, y: f64) -> String {
    format!("{:.2},{:.2}", frame.px(x), frame.py(y))
}
