//! The page of a rare event.

use super::{Figure, Page};
use crate::study::Study;
use crate::study::rare::RareEvent;
use crate::study::summary::short;
use crate::svg::{Frame, picture};

pub fn page(study: &Study, found: &RareEvent) -> Page {
    let mut page = Page::new(&format!("Rare event in study {}", study.name));
    let e = &found.estimate;
    page.paragraph(&format!(
        "Probability that a touchdown of the study ends {}: {:.2e}, 95 % bounds {:.1e} to {:.1e} (coefficient of \
         variation {:.2}), from {} runs. Plain Monte Carlo would need {:.1e} for the same.",
        found.event,
        e.probability,
        e.low,
        e.high,
        e.deviation,
        e.runs,
        found.plain_runs_for_the_same
    ));
    if !e.reached {
        page.paragraph("The last level did not reach the event: the figure is an upper estimate.");
    }
    page.figure(levels(found));
    let rows: Vec<_> = e
        .levels
        .iter()
        .enumerate()
        .map(|(index, level)| {
            let plain = found.plain.get(index).map_or(String::new(), |p| {
                format!("{} of {}: {:.1e} to {:.1e}", p.met, p.runs, p.share_low, p.share_high)
            });
            let moved = format!("{:.0} %", 100.0 * level.accepted);
            vec![short(level.bound), format!("{:.2e}", level.probability), moved, plain]
        })
        .collect();
    let header = [
        &format!("{} up to", found.margin),
        "probability",
        "chains moved",
        "plain runs, 95 % bounds",
    ];
    page.table("", &header, &rows);
    page.paragraph(
        "Subset simulation: each level is a tenth of the last, reached by Markov chains that start from its worst tenth. \
         The event itself is a margin of 0.",
    );
    page.heading("Again");
    page.code(&format!("lander rare {}.toml", study.name));
    page.study_file(study);
    page
}

/// Probability over the margin, subset simulation beside plain runs.
fn levels(found: &RareEvent) -> Figure {
    let levels = &found.estimate.levels;
    let exponent = |p: f64| libm::log10(p.max(1e-12));
    let last = levels.last().map_or(1.0, |level| level.probability);
    let widest = levels.first().map_or(1.0, |level| level.bound).max(0.01);
    let frame = Frame {
        left: 60.0,
        top: 24.0,
        width: 420.0,
        height: 260.0,
        x: [-0.05 * widest, 1.1 * widest],
        y: [exponent(last).floor() - 0.3, 0.0],
    };
    let points: Vec<[f64; 2]> =
        levels.iter().map(|level| [level.bound, exponent(level.probability)]).collect();
    let mut parts = frame.path(&points, "stroke=\"#2b6cb0\" stroke-width=\"1.6\"");
    let mut csv = "margin,probability,plain_low,plain_high\n".to_owned();
    for (index, (level, point)) in levels.iter().zip(&points).enumerate() {
        parts += &frame.dot(*point, 3.0, "#2b6cb0");
        let mut bounds = [String::new(), String::new()];
        // No plain run that far has no lower bound to draw.
        if let Some(plain) = found.plain.get(index).filter(|plain| plain.met > 0) {
            let ends =
                [plain.share_low, plain.share_high].map(|share| [level.bound, exponent(share)]);
            parts += &frame.path(&ends, "stroke=\"#cf4a55\" stroke-width=\"5\" opacity=\"0.5\"");
            bounds = [plain.share_low, plain.share_high].map(|share| share.to_string());
        }
        csv += &format!("{},{},{},{}\n", level.bound, level.probability, bounds[0], bounds[1]);
    }
    parts += &frame.axes("", &format!("{} up to", found.margin), "log10 of the probability");
    Figure {
        name: "levels".to_owned(),
        caption: "Probability of a margin up to each level's bound; red: 95 % bounds of plain Monte Carlo, where its runs \
                  got so far."
            .to_owned(),
        svg: picture(500.0, 330.0, &parts),
        csv,
    }
}
