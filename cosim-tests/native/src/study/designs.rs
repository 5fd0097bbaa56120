//! What the designs of a study come to: outcomes and margins of each, and what they differ by from the
//! baseline's over the same draws.

use std::fmt;

use lander_models::Outcome;
use rayon::prelude::*;
use serde::Serialize;

use super::StudyError;
use super::data::Data;
use super::distribution::Value;
use super::file::{Kind, Study};
use super::shard::{BUILD, VERSION};
use super::summary::{Quantiles, RESULTS, Share, outcome_names};
use crate::map::criterion;
use crate::statistics::paired::Pairs;
use crate::statistics::quantile::{Bounded, quantile};

#[derive(Clone, Debug, Serialize)]
pub struct DesignSummary {
    pub study: String,
    pub study_sha256: String,
    pub version: &'static str,
    pub build: &'static str,
    pub seed: u64,
    /// Flown at each design, with the same draws.
    pub runs_each: usize,
    pub axes: Vec<AxisSummary>,
    /// Place in `designs` of that which the others are compared with.
    pub baseline: usize,
    /// The first axis moves fastest.
    pub designs: Vec<OfDesign>,
}

#[derive(Clone, Debug, Serialize)]
pub struct AxisSummary {
    pub column: String,
    pub unit: Option<String>,
    pub values: Vec<Value>,
    pub baseline: Value,
}

#[derive(Clone, Debug, Serialize)]
pub struct OfDesign {
    /// One an axis.
    pub values: Vec<Value>,
    /// Of every outcome that any design met, and of `tipped`.
    pub outcomes: Vec<OfOutcome>,
    pub results: Vec<OfResult>,
    /// Of touchdowns.
    pub criteria: Option<Criteria>,
}

#[derive(Clone, Debug, Serialize)]
pub struct OfOutcome {
    #[serde(flatten)]
    pub share: Share,
    /// To the baseline; `None` for itself.
    pub difference: Option<Difference>,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Difference {
    #[serde(flatten)]
    pub bounded: Bounded,
    /// McNemar's exact, that the shares are the same.
    pub p_value: f64,
    /// The design first, the baseline second.
    pub pairs: Pairs,
}

#[derive(Clone, Debug, Serialize)]
pub struct OfResult {
    #[serde(flatten)]
    pub quantiles: Quantiles,
    /// Median of the differences to the baseline, draw by draw.
    pub median_difference: Option<Bounded>,
}

/// What criteria that simulate nothing call a tip-over, over the same draws.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Criteria {
    /// Slope beyond the static tip angle (T.16).
    pub static_angle: Called,
    /// Speed beyond that at which captured pads tip (T.24), an energy criterion.
    pub captured_pads: Called,
}

/// Shares of a design's runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Called {
    pub share: f64,
    /// Tipped over, but was not called so.
    pub missed: f64,
    /// Called so, but did not.
    pub false_alarms: f64,
}

impl DesignSummary {
    /// From a study's merged table.
    pub fn new(study: &Study, data: &Data) -> Result<Self, StudyError> {
        let designs = study.designs();
        let (count, baseline) = (designs.count() as usize, designs.baseline() as usize);
        let part = |design: usize| data.part(count, design, design + 1);
        let seen: Vec<&str> = outcome_names()
            .filter(|name| {
                *name == Outcome::Tipped.name() || data.outcomes.names.iter().any(|n| n == name)
            })
            .collect();
        let of_baseline = part(baseline);
        let of_design = |design: usize| {
            let own = part(design);
            let other = (design != baseline).then_some(&of_baseline);
            let results = RESULTS.iter().map(|name| of_result(name, &own, other));
            let results: Vec<Option<OfResult>> = results.collect::<Result<_, StudyError>>()?;
            Ok(OfDesign {
                values: designs.values(design as u64),
                outcomes: seen.iter().map(|name| of_outcome(name, &own, other)).collect(),
                results: results.into_iter().flatten().collect(),
                criteria: criteria(study, design, &own)?,
            })
        };
        let axis = |axis: &super::axis::Axis| AxisSummary {
            column: axis.column.clone(),
            unit: axis.unit.clone(),
            values: axis.values.clone(),
            baseline: axis.values[axis.baseline].clone(),
        };
        Ok(Self {
            study: study.name.clone(),
            study_sha256: study.hash.clone(),
            version: VERSION,
            build: BUILD,
            seed: study.seed,
            runs_each: data.runs() / count,
            axes: study.axes.iter().map(axis).collect(),
            baseline,
            designs: (0..count).map(of_design).collect::<Result<_, StudyError>>()?,
        })
    }
}

impl OfDesign {
    /// Every design has all outcomes that any met.
    pub fn outcome(&self, name: &str) -> Option<&OfOutcome> {
        self.outcomes.iter().find(|outcome| outcome.share.outcome == name)
    }

    pub fn result(&self, name: &str) -> Option<&OfResult> {
        self.results.iter().find(|result| result.quantiles.result == name)
    }
}

/// A probability of an accident to a few digits.
pub fn p_words(p_value: f64) -> String {
    if p_value < 1e-3 { format!("{p_value:.0e}") } else { format!("{p_value:.3}") }
}

fn of_outcome(name: &str, own: &Data, baseline: Option<&Data>) -> OfOutcome {
    let count = own.outcomes.iter().filter(|outcome| *outcome == name).count();
    let difference = baseline.map(|baseline| {
        let both = own.outcomes.iter().zip(baseline.outcomes.iter());
        let pairs: Pairs = both.map(|(a, b)| (a == name, b == name)).collect();
        Difference { bounded: pairs.difference(), p_value: pairs.p_value(), pairs }
    });
    OfOutcome { share: Share::new(name, count, own.runs()), difference }
}

fn of_result(
    name: &str,
    own: &Data,
    baseline: Option<&Data>,
) -> Result<Option<OfResult>, StudyError> {
    let Some(quantiles) = Quantiles::new(name, own)? else { return Ok(None) };
    let median_difference = match baseline {
        None => None,
        Some(baseline) => {
            let [own, other] =
                [own.column(name)?, baseline.column(name)?].map(Option::unwrap_or_default);
            let mut moved: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
            moved.retain(|difference| difference.is_finite());
            moved.sort_by(f64::total_cmp);
            (!moved.is_empty()).then(|| quantile(&moved, 0.5))
        }
    };
    Ok(Some(OfResult { quantiles, median_difference }))
}

/// Draws a design's touchdowns once more and asks the criteria.
fn criteria(study: &Study, design: usize, own: &Data) -> Result<Option<Criteria>, StudyError> {
    if study.kind != Kind::Touchdown {
        return Ok(None);
    }
    let (designs, runs) = (study.designs().count() as usize, own.runs());
    // Called by the static angle, and by captured pads; each with whether it tipped over.
    let one = |row: usize| {
        let world = study.run((row * designs + design) as u64)?.truth;
        let tips = criterion::tips(&world.vehicle, &world.case);
        let tipped = own.outcomes.get(row) == Outcome::Tipped.name();
        Ok([(tips.fixed, tipped), (tips.captured, tipped)])
    };
    let all: Vec<Result<_, StudyError>> = (0..runs).into_par_iter().map(one).collect();
    let all = all.into_iter().collect::<Result<Vec<_>, _>>()?;
    let called = |which: usize| {
        let pairs: Pairs = all.iter().map(|two| two[which]).collect();
        let share = |count: usize| count as f64 / runs as f64;
        Called {
            share: share(pairs.both + pairs.only_first),
            missed: share(pairs.only_second),
            false_alarms: share(pairs.only_first),
        }
    };
    Ok(Some(Criteria { static_angle: called(0), captured_pads: called(1) }))
}

impl fmt::Display for DesignSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (designs, seed) = (self.designs.len(), self.seed);
        writeln!(
            f,
            "{}: {designs} designs, {} runs each with the same draws, seed {seed}",
            self.study, self.runs_each
        )?;
        for axis in &self.axes {
            write!(f, "  {:>24}", axis.column)?;
        }
        writeln!(
            f,
            "  tipped %   95 % bounds   to the baseline, 95 % bounds       landed %  T.24 %"
        )?;
        for (number, design) in self.designs.iter().enumerate() {
            for value in &design.values {
                write!(f, "  {:>24}", value.to_string())?;
            }
            let Some(tipped) = design.outcome(Outcome::Tipped.name()) else { continue };
            let percent = |share: f64| format!("{:.1}", 100.0 * share);
            let Share { share, share_low, share_high, .. } = tipped.share;
            let bounds = format!("{} to {}", percent(share_low), percent(share_high));
            let difference = match tipped.difference {
                _ if number == self.baseline => "the baseline".to_owned(),
                None => String::new(),
                Some(Difference { bounded: Bounded { value, low, high }, p_value, .. }) => {
                    let [value, low, high] =
                        [value, low, high].map(|d| format!("{:+.1}", 100.0 * d));
                    format!("{value} ({low} to {high}), p {}", p_words(p_value))
                }
            };
            let landed = design.outcome(Outcome::Landed.name()).map_or(0.0, |o| o.share.share);
            let called = design.criteria.map_or(String::new(), |c| percent(c.captured_pads.share));
            writeln!(
                f,
                "  {:>8}  {bounds:>12}   {difference:<34}  {:>7}  {called:>6}",
                percent(share),
                percent(landed)
            )?;
        }
        Ok(())
    }
}
