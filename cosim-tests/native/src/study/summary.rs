//! What a study's runs come to: outcomes with their bounds.

use std::collections::BTreeMap;
use std::fmt;

use lander_models::Outcome;
use serde::Serialize;

use super::StudyError;
use super::data::Data;
use super::file::Study;
use super::shard::{BUILD, VERSION};
use crate::statistics::binomial;
use crate::statistics::quantile::{Bounded, quantile};
use crate::statistics::rank_correlation::rank_correlation;
use crate::statistics::sobol::{Design, Index};

#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub study: String,
    pub study_sha256: String,
    pub version: &'static str,
    pub build: &'static str,
    pub seed: u64,
    pub runs: usize,
    pub results: Vec<Quantiles>,
    /// Rank correlations, the strongest of each result first.
    pub sensitivity: Vec<Correlation>,
    /// Sobol' indices, if the study's runs are laid out for them.
    pub sobol: Vec<SobolIndex>,
    /// All runs first, then those without and with each failure mode, if the study has any.
    pub groups: Vec<Group>,
}

/// Runs that have a failure mode in common.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    pub failures: String,
    pub runs: usize,
    pub outcomes: Vec<Share>,
}

/// A result over the runs in which it was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Quantiles {
    pub result: String,
    pub measured: usize,
    pub quantiles: Vec<Quantile>,
}

#[derive(Clone, Debug, Serialize)]
pub struct Quantile {
    pub share: f64,
    #[serde(flatten)]
    pub bounded: Bounded,
}

/// How a result moves with a drawn parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Correlation {
    pub result: String,
    pub parameter: String,
    #[serde(flatten)]
    pub bounded: Bounded,
}

/// How much of a result's variance is a parameter's.
#[derive(Clone, Debug, Serialize)]
pub struct SobolIndex {
    pub result: String,
    pub parameter: String,
    #[serde(flatten)]
    pub index: Index,
}

/// Results that a touchdown is judged by.
pub const RESULTS: [&str; 17] = [
    "position_error_m",
    "contact_speed_down_m_s",
    "contact_speed_across_m_s",
    "contact_tilt_deg",
    "contact_rate_deg_s",
    "rest_tilt_deg",
    "least_hull_clearance_m",
    "least_nozzle_clearance_m",
    "peak_stroke_m",
    "peak_leg_load_n",
    "peak_acceleration_m_s2",
    "tip_energy_margin_j",
    "stability_distance_m",
    "slide_distance_m",
    "flight_time_s",
    "propellant_used_kg",
    LANDED,
];

/// Not a column: 1 for a run that landed, 0 for any other.
const LANDED: &str = "landed";

const SHARES: [f64; 5] = [0.01, 0.1, 0.5, 0.9, 0.99];

/// How often one outcome was met.
#[derive(Clone, Debug, Serialize)]
pub struct Share {
    pub outcome: String,
    pub runs: usize,
    pub share: f64,
    /// Two-sided 95 % limits of its probability, Clopper and Pearson.
    pub share_low: f64,
    pub share_high: f64,
}

impl Summary {
    pub fn new(study: &Study, data: &Data) -> Result<Self, StudyError> {
        let sobol = sobol_indices(study, data)?;
        // Bounds are for independent runs: of a Sobol' layout those of A and B.
        let picked = study.sobol_layout().map(|layout| data.part(layout.matrices, 0, 2));
        let runs = data.runs();
        let data = picked.as_ref().unwrap_or(data);
        let mut groups = vec![Group::new("all", data.outcomes.iter())];
        if !study.failures.modes.is_empty() {
            let mut names: Vec<&String> = data.failures.names.iter().collect();
            names.sort();
            for name in names {
                let with = data.failures.iter().zip(data.outcomes.iter());
                let with = with.filter(|(failures, _)| failures == name);
                groups.push(Group::new(name, with.map(|(_, outcome)| outcome)));
            }
        }
        let results = RESULTS.iter().map(|name| Quantiles::new(name, data));
        let results: Vec<Option<Quantiles>> = results.collect::<Result<_, _>>()?;
        Ok(Self {
            study: study.name.clone(),
            study_sha256: study.hash.clone(),
            version: VERSION,
            build: BUILD,
            seed: study.seed,
            runs,
            results: results.into_iter().flatten().collect(),
            sensitivity: correlations(study, data)?,
            sobol,
            groups,
        })
    }
}

impl Quantiles {
    /// `None` for what was never measured.
    pub fn new(result: &str, data: &Data) -> Result<Option<Self>, StudyError> {
        let sorted = data.sorted(result)?;
        let of = |share| Quantile { share, bounded: quantile(&sorted, share) };
        let quantiles = SHARES.map(of).to_vec();
        Ok((!sorted.is_empty()).then(|| Self {
            result: result.to_owned(),
            measured: sorted.len(),
            quantiles,
        }))
    }

    pub fn at(&self, share: f64) -> Option<Bounded> {
        self.quantiles.iter().find(|quantile| quantile.share == share).map(|q| q.bounded)
    }
}

/// A result by name, also `LANDED`.
fn result(data: &Data, name: &str) -> Result<Option<Vec<f64>>, StudyError> {
    if name == LANDED {
        let landed = data.outcomes.iter().map(|o| f64::from(u8::from(o == Outcome::Landed.name())));
        return Ok(Some(landed.collect()));
    }
    data.column(name)
}

fn correlations(study: &Study, data: &Data) -> Result<Vec<Correlation>, StudyError> {
    let mut all = Vec::new();
    for name in RESULTS {
        let Some(y) = result(data, name)? else { continue };
        let mut found = Vec::new();
        for parameter in study.drawn() {
            let Some(x) = data.column(&parameter.column)? else { continue };
            let (result, parameter) = (name.to_owned(), parameter.column.clone());
            let of = |bounded| Correlation { result, parameter, bounded };
            found.extend(rank_correlation(&x, &y).map(of));
        }
        found.sort_by(|a, b| b.bounded.value.abs().total_cmp(&a.bounded.value.abs()));
        all.extend(found);
    }
    Ok(all)
}

fn sobol_indices(study: &Study, data: &Data) -> Result<Vec<SobolIndex>, StudyError> {
    let Some(layout) = study.sobol_layout() else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for name in RESULTS {
        let Some(y) = result(data, name)? else { continue };
        let of_matrix = |matrix| y.iter().skip(matrix).step_by(layout.matrices).copied().collect();
        let mixed = (0..layout.inputs.len()).map(|input| of_matrix(input + 2)).collect();
        let design = Design { a: of_matrix(0), b: of_matrix(1), mixed };
        for (index, input) in design.indices(study.seed).into_iter().zip(&layout.inputs) {
            // A result that never varies has no shares of its variance.
            if index.total.value.is_finite() {
                let parameter = input.clone();
                all.push(SobolIndex { result: name.to_owned(), parameter, index });
            }
        }
    }
    Ok(all)
}

/// Outcomes' names, and that of a run that a component broke off.
pub fn outcome_names() -> impl Iterator<Item = &'static str> {
    Outcome::ALL.map(Outcome::name).into_iter().chain(["failed"])
}

impl Share {
    /// `count` of `runs` had an outcome.
    pub fn new(outcome: &str, count: usize, runs: usize) -> Self {
        let [share_low, share_high] = binomial::limits(count, runs);
        let share = count as f64 / runs as f64;
        Self { outcome: outcome.to_owned(), runs: count, share, share_low, share_high }
    }
}

impl Group {
    pub fn new<'a>(failures: &str, outcomes: impl IntoIterator<Item = &'a str>) -> Self {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for outcome in outcomes {
            *counts.entry(outcome).or_default() += 1;
        }
        let runs = counts.values().sum();
        let count = |name| counts.get(name).copied().unwrap_or(0);
        let shares = outcome_names().map(|name| Share::new(name, count(name), runs));
        // What never happened still has an upper bound worth knowing for `tipped`.
        let kept = shares.filter(|share| share.runs > 0 || share.outcome == Outcome::Tipped.name());
        Self { failures: failures.to_owned(), runs, outcomes: kept.collect() }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} runs, seed {}", self.study, self.runs, self.seed)?;
        writeln!(
            f,
            "  {:<22} {:<12} {:>8} {:>9}  95 % bounds",
            "failures", "outcome", "runs", "share %"
        )?;
        for group in &self.groups {
            for share in &group.outcomes {
                let percent = [share.share, share.share_low, share.share_high].map(|p| 100.0 * p);
                writeln!(
                    f,
                    "  {:<22} {:<12} {:>8} {:>9.3}  {:.3} to {:.3}",
                    group.failures, share.outcome, share.runs, percent[0], percent[1], percent[2]
                )?;
            }
        }
        let measured = self.results.iter().filter(|r| r.measured > 0);
        writeln!(
            f,
            "  {:<26} {:>8}  {:>10} {:>23}  {:>10} {:>23}",
            "result", "measured", "median", "95 % bounds", "99 %", "95 % bounds"
        )?;
        for r in measured {
            let cells = [0.5, 0.99].map(|share| {
                let Bounded { value, low, high } = r.at(share)?;
                Some(format!(
                    "{:>10} {:>23}",
                    short(value),
                    format!("{} to {}", short(low), short(high))
                ))
            });
            let [median, high] = cells.map(Option::unwrap_or_default);
            writeln!(f, "  {:<26} {:>8}  {median}  {high}", r.result, r.measured)?;
        }
        if !self.sensitivity.is_empty() {
            writeln!(f, "  {:<26} strongest rank correlations", "result")?;
        }
        for group in self.sensitivity.chunk_by(|a, b| a.result == b.result) {
            let words =
                group.iter().take(3).map(|c| format!("{} {:+.2}", c.parameter, c.bounded.value));
            writeln!(f, "  {:<26} {}", group[0].result, words.collect::<Vec<_>>().join(", "))?;
        }
        Ok(())
    }
}

/// A number to four digits; an infinite bound is none.
pub fn short(value: f64) -> String {
    if value.is_infinite() {
        return "none".to_owned();
    }
    let digits = 3 - libm::log10(value.abs().max(1e-3)).floor() as i32;
    format!("{value:.*}", digits.clamp(0, 4) as usize)
}
