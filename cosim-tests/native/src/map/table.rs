//! A map's cells as a table, and what they come to.

use crate::csv::{number, quoted};
use std::collections::BTreeMap;

use lander_models::Outcome;
use lander_models::math::square;
use serde::Serialize;

use super::refine::Cell;
use super::{Atlas, Mapped, Touchdown};

/// Parts of a case's plane, weighed by area in m²/s².
#[derive(Clone, Debug, Serialize)]
pub struct CaseSummary {
    pub case: String,
    pub touchdowns: usize,
    pub cells: usize,
    /// Share of the plane of each outcome.
    pub outcomes: BTreeMap<&'static str, f64>,
    pub static_criterion: Confusion,
    pub captured_criterion: Confusion,
}

/// A criterion against the touchdowns, in shares of the plane.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Confusion {
    pub misclassified: f64,
    /// Called stable, but it tips over.
    pub missed: f64,
    /// Called a tip-over, but it does not.
    pub false_alarms: f64,
}

impl Mapped<'_> {
    fn corners(&self, cell: Cell) -> impl Iterator<Item = &Touchdown> {
        cell.corners().into_iter().filter_map(|corner| self.refined.points.get(&corner))
    }

    /// The outcome at all corners, if it is one.
    pub fn class(&self, cell: Cell) -> Option<Outcome> {
        let mut outcomes = self.corners(cell).map(|touchdown| touchdown.outcome);
        let first = outcomes.next()?;
        outcomes.all(|outcome| outcome == first).then_some(first)
    }

    /// Each cell as the mean of its corners.
    pub fn summary(&self) -> CaseSummary {
        let cells = &self.refined.cells;
        let area = |cell: &Cell| square(f64::from(cell.side));
        let whole: f64 = cells.iter().map(area).sum();
        let share = |is: &dyn Fn(&Touchdown) -> bool| {
            let of_cell = |cell: &Cell| {
                let met = self.corners(*cell).filter(|touchdown| is(touchdown)).count();
                area(cell) * met as f64 / 4.0
            };
            cells.iter().map(of_cell).sum::<f64>() / whole
        };
        let confusion = |calls: fn(&Touchdown) -> bool| {
            let tips = |t: &Touchdown| t.outcome == Outcome::Tipped;
            let missed = share(&|t| tips(t) && !calls(t));
            let false_alarms = share(&|t| calls(t) && !tips(t));
            Confusion { misclassified: missed + false_alarms, missed, false_alarms }
        };
        let outcomes = Outcome::ALL.into_iter().map(|outcome| {
            (outcome.name(), share(&|touchdown: &Touchdown| touchdown.outcome == outcome))
        });
        CaseSummary {
            case: self.case.name.clone(),
            touchdowns: self.refined.points.len(),
            cells: cells.len(),
            outcomes: outcomes.filter(|(_, share)| *share > 0.0).collect(),
            static_criterion: confusion(|touchdown| touchdown.criteria.fixed),
            captured_criterion: confusion(|touchdown| touchdown.criteria.captured),
        }
    }
}

const HEADER: &str = "case,across_low_m_s,across_high_m_s,down_low_m_s,down_high_m_s,class,\
                      tip_energy_margin_j,stability_distance_m,peak_stroke_m,clearance_m";

/// All cells of all cases as CSV: the class of all corners, or `mixed`; of the margins the worst corner's.
pub fn cells_csv(atlas: &Atlas, mapped: &[Mapped]) -> String {
    let mut text = HEADER.to_owned() + "\n";
    for of_case in mapped {
        for cell in &of_case.refined.cells {
            let [low, high] = [cell.at, (cell.at.0 + cell.side, cell.at.1 + cell.side)]
                .map(|point| atlas.velocity_m_s(point));
            let least = |of: fn(&Touchdown) -> f64| {
                number(of_case.corners(*cell).map(of).fold(f64::NAN, f64::min))
            };
            let stroke = of_case.corners(*cell).map(|t| t.peak_stroke_m).fold(f64::NAN, f64::max);
            let cells = [
                quoted(&of_case.case.name),
                low[0].to_string(),
                high[0].to_string(),
                low[1].to_string(),
                high[1].to_string(),
                of_case.class(*cell).map_or("mixed", Outcome::name).to_owned(),
                least(|t| t.tip_energy_margin_j),
                least(|t| t.stability_distance_m),
                number(stroke),
                least(|t| t.clearance_m),
            ];
            text += &(cells.join(",") + "\n");
        }
    }
    text
}

/// All touchdowns of all cases as CSV.
pub fn points_csv(mapped: &[Mapped]) -> String {
    let mut text = "case,across_m_s,down_m_s,outcome,tip_energy_margin_j,stability_distance_m,\
                    peak_stroke_m,clearance_m,tips_after_s,static_tips,captured_tips\n"
        .to_owned();
    for of_case in mapped {
        for t in of_case.refined.points.values() {
            let cells = [
                quoted(&of_case.case.name),
                t.across_m_s.to_string(),
                t.down_m_s.to_string(),
                t.outcome.name().to_owned(),
                number(t.tip_energy_margin_j),
                number(t.stability_distance_m),
                number(t.peak_stroke_m),
                number(t.clearance_m),
                number(t.tips_after_s),
                u8::from(t.criteria.fixed).to_string(),
                u8::from(t.criteria.captured).to_string(),
            ];
            text += &(cells.join(",") + "\n");
        }
    }
    text
}
