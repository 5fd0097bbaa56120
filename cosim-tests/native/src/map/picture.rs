//! A map as a picture: a panel a case, cells in the colours of their outcomes.

use lander_models::Outcome;

use super::criterion;
use super::refine::Cell;
use super::table::CaseSummary;
use super::{Atlas, Mapped};
use crate::svg::{Frame, line, picture, text};

const PANEL: [f64; 2] = [260.0, 220.0];
const MARGIN: [f64; 2] = [60.0, 78.0];
const COLUMNS: usize = 3;

/// Fill of an outcome wherever it is drawn.
pub fn colour(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Landed => "#5aa872",
        Outcome::Slid => "#c9d36b",
        Outcome::Tipped => "#cf4a55",
        Outcome::Struck => "#e8a33d",
        Outcome::Bottomed => "#8f6fb0",
        Outcome::Crashed => "#4a4a4a",
        Outcome::NoContact | Outcome::InFlight => "#c8c8c8",
    }
}

/// The whole map.
pub fn draw(atlas: &Atlas, mapped: &[Mapped], summaries: &[CaseSummary]) -> String {
    let rows = mapped.len().div_ceil(COLUMNS);
    let [width, height] = [PANEL[0] + MARGIN[0] + 12.0, PANEL[1] + MARGIN[1]];
    let columns = mapped.len().min(COLUMNS);
    let mut parts = String::new();
    for (index, (of_case, summary)) in mapped.iter().zip(summaries).enumerate() {
        let frame = Frame {
            left: MARGIN[0] + width * (index % COLUMNS) as f64,
            top: 64.0 + height * (index / COLUMNS) as f64,
            width: PANEL[0],
            height: PANEL[1],
            x: atlas.map.across_m_s,
            y: atlas.map.down_m_s,
        };
        parts += &panel(atlas, of_case, summary, &frame);
    }
    let shown =
        |outcome: &Outcome| summaries.iter().any(|s| s.outcomes.contains_key(outcome.name()));
    let mut left = 60.0;
    for outcome in Outcome::ALL.into_iter().filter(shown) {
        let fill = colour(outcome);
        parts +=
            &format!("<rect x=\"{left}\" y=\"12\" width=\"14\" height=\"14\" fill=\"{fill}\"/>\n");
        parts += &text(left + 19.0, 23.0, "start", 12, outcome.name());
        left += 90.0;
    }
    parts += &line([left, 19.0], [left + 18.0, 19.0], "black");
    parts += &text(left + 23.0, 23.0, "start", 12, "tip speed of captured pads (T.24)");
    // The words of the legend's last entry are some 200 wide.
    let legend = left + 23.0 + 200.0;
    picture((width * columns as f64 + 20.0).max(legend), 60.0 + height * rows as f64, &parts)
}

fn panel(atlas: &Atlas, of_case: &Mapped, summary: &CaseSummary, frame: &Frame) -> String {
    let mut parts = String::new();
    for cell in &of_case.refined.cells {
        parts += &fill(atlas, of_case, *cell, frame);
    }
    parts += &frame.path(&captured_limit(atlas, of_case), "stroke=\"black\" stroke-width=\"1.5\"");
    parts += &frame.axes(&summary.case, "horizontal velocity, m/s", "velocity down, m/s");
    let percent = |share: f64| 100.0 * share;
    let words = format!(
        "{} touchdowns; static angle errs on {:.1} %, T.24 on {:.1} %",
        summary.touchdowns,
        percent(summary.static_criterion.misclassified),
        percent(summary.captured_criterion.misclassified)
    );
    let middle = frame.left + frame.width / 2.0;
    parts + &text(middle, frame.top + frame.height + 43.0, "middle", 10, &words)
}

/// A cell in one colour, or each quarter in that of its corner.
fn fill(atlas: &Atlas, of_case: &Mapped, cell: Cell, frame: &Frame) -> String {
    let at = |point| atlas.velocity_m_s(point);
    let ([x0, y0], [x1, y1]) = (at(cell.at), at((cell.at.0 + cell.side, cell.at.1 + cell.side)));
    if let Some(outcome) = of_case.class(cell) {
        return frame.rectangle([x0, x1], [y0, y1], colour(outcome));
    }
    let (xm, ym) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
    let quarters =
        [([x0, xm], [y0, ym]), ([xm, x1], [y0, ym]), ([x0, xm], [ym, y1]), ([xm, x1], [ym, y1])];
    let corners = cell.corners().into_iter().zip(quarters);
    corners
        .filter_map(|(corner, (x, y))| {
            let outcome = of_case.refined.points.get(&corner)?.outcome;
            Some(frame.rectangle(x, y, colour(outcome)))
        })
        .collect()
}

/// For each velocity down, the horizontal one from which on the captured criterion calls a tip-over.
fn captured_limit(atlas: &Atlas, of_case: &Mapped) -> Vec<[f64; 2]> {
    const STEPS: u32 = 300;
    let [low, high] = atlas.map.across_m_s;
    let across = |step: u32| low + (high - low) * f64::from(step) / f64::from(STEPS);
    let [down_low, down_high] = atlas.map.down_m_s;
    let downs = (0..=20_u32).map(|n| down_low + (down_high - down_low) * f64::from(n) / 20.0);
    downs
        .filter_map(|down| {
            let tips = |step: &u32| {
                let state = of_case.case.at(&atlas.world.case, across(*step), down);
                criterion::tips(&atlas.world.vehicle, &state).captured
            };
            let first = (0..=STEPS).find(tips)?;
            Some([across(first), down])
        })
        .collect()
}
