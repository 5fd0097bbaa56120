//! The probability of a rare tip-over, by subset simulation over a study's parameters.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use lander_models::Outcome;
use lander_models::math::square;
use lander_models::quantity::{ConfigError, Limit, Section};
use serde::Serialize;

use super::StudyError;
use super::campaign::Campaign;
use super::data::Data;
use super::file::{Kind, Sampling, Study};
use super::row::{Columns, Row};
use super::shard::VERSION;
use super::summary::short;
use super::table::Reader;
use crate::landing::Error;
use crate::progress::Count;
use crate::statistics::binomial;
use crate::statistics::normal::share_below;
use crate::statistics::subset::{Estimate, Settings, subset_simulation};

/// The result whose fall leads to a tip-over: the least distance of the centre of mass inside the planes
/// through adjacent footpads.
pub const MARGIN: &str = "stability_distance_m";

/// Of nine seeds of `tip-over-rare`, six upper bounds lay below its 8.2e-6 with 100 samples a level, by up to a factor
/// of 50; with 500 still five, by at most 2.6: bounds leave out what the levels have in common. Fewer are no estimate.
const SAMPLES_MIN: f64 = 500.0;
/// Share of proposals below which chains hardly leave their starts: a quarter of what they mix best with
/// (`subset::ACCEPTANCE`).
const MOVED_MIN: f64 = 0.1;

/// `[rare_event]` of a study.
pub fn read(root: &Section, seed: u64) -> Result<Settings, ConfigError> {
    let s = root.optional_section("rare_event")?;
    let whole = |key: &str, low: f64, high: f64, default: f64| {
        let number = s.number_or(key, "1", Limit::Within(low, high), default)?;
        match number.fract() == 0.0 {
            true => Ok(number as usize),
            false => Err(s.error(key, format!("is {number}, must be a whole number"))),
        }
    };
    let settings = Settings {
        seed,
        samples: whole("samples", SAMPLES_MIN, 1e6, 1000.0)?,
        chain: whole("chain", 2.0, 100.0, 10.0)?,
        correlation: s.number_or("correlation", "1", Limit::Within(0.0, 0.99), 0.8)?,
        levels_max: whole("levels_max", 1.0, 20.0, 8.0)?,
    };
    if !settings.samples.is_multiple_of(settings.chain) {
        let Settings { samples, chain, .. } = settings;
        return Err(
            s.error("samples", format!("is {samples}, must be a multiple of chain, {chain}"))
        );
    }
    s.finish()?;
    Ok(settings)
}

#[derive(Clone, Debug, Serialize)]
pub struct RareEvent {
    pub study: String,
    pub study_sha256: String,
    pub version: &'static str,
    pub seed: u64,
    pub event: &'static str,
    pub margin: &'static str,
    #[serde(flatten)]
    pub estimate: Estimate,
    /// Runs of plain Monte Carlo for the same coefficient of variation, (1 - p)/(p v²).
    pub plain_runs_for_the_same: f64,
    /// What the study's plain runs say of each level, if its campaign has been run.
    pub plain: Vec<Plain>,
}

/// Plain Monte Carlo's share of margins up to a level's bound.
#[derive(Clone, Debug, Serialize)]
pub struct Plain {
    pub bound: f64,
    pub runs: usize,
    pub met: usize,
    /// Two-sided 95 % limits, Clopper and Pearson.
    pub share_low: f64,
    pub share_high: f64,
}

/// Estimates the probability of a tip-over in a study of touchdowns.
///
/// # Errors
/// A study that is no such, a run that fails, `StudyError::Interrupted`.
pub fn estimate(
    campaign: &Campaign,
    threads: usize,
    interrupted: &AtomicBool,
) -> Result<RareEvent, Error> {
    let study = campaign.study;
    check(study)?;
    let settings = study.rare_event;
    let runs_max = settings.samples * settings.levels_max;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let progress = Count::new("runs at most", runs_max);
    let streams: Vec<&str> = study.drawn().map(|parameter| parameter.key.as_str()).collect();
    let margin = |x: &[f64]| {
        if interrupted.load(Ordering::Relaxed) {
            return Err(StudyError::Interrupted);
        }
        let uniform = |stream: &str| {
            let index = streams.iter().position(|key| *key == stream);
            index.map_or(0.5, |index| share_below(x[index]))
        };
        let row = study.run_of(0, &uniform)?.finish(study.kind, campaign.columns);
        progress.one_more();
        Ok::<_, StudyError>(margin_of_row(&row, campaign.columns))
    };
    let estimate = pool.install(|| subset_simulation(streams.len(), &settings, margin));
    progress.finish();
    let estimate = estimate?;
    let Estimate { probability, deviation, .. } = estimate;
    Ok(RareEvent {
        study: study.name.clone(),
        study_sha256: study.hash.clone(),
        version: VERSION,
        seed: study.seed,
        event: Outcome::Tipped.name(),
        margin: MARGIN,
        plain_runs_for_the_same: (1.0 - probability) / (probability * square(deviation)),
        plain: plain(campaign, &estimate)?,
        estimate,
    })
}

/// A search needs a margin that is a function of the drawn parameters alone.
fn check(study: &Study) -> Result<(), ConfigError> {
    let wrong = |key: &str, reason: &str| {
        Err(ConfigError::Key {
            file: study.file.clone(),
            key: key.to_owned(),
            reason: reason.to_owned(),
        })
    };
    if study.kind != Kind::Touchdown {
        return wrong("kind", "is \"landing\", but a rare event is sought among touchdowns");
    }
    if !study.failures.modes.is_empty() {
        return wrong("failures", "cannot be part of a rare event's margin");
    }
    if study.sampling != Sampling::Independent {
        return wrong("sampling", "must be \"independent\" for a rare event");
    }
    if !study.axes.is_empty() {
        return wrong("axis", "is for designs: a rare event is sought in one");
    }
    if study.drawn().next().is_none() {
        return wrong("dispersion", "has nothing that is drawn");
    }
    Ok(())
}

fn margin_of_row(row: &Row, columns: &Columns) -> f64 {
    margin(row.outcome, columns.result(row, MARGIN))
}

/// 0 or less in a tip-over and in nothing else; a run without contact is far from one.
fn margin(outcome: &str, distance_m: f64) -> f64 {
    if outcome == Outcome::Tipped.name() {
        distance_m.min(0.0)
    } else if distance_m.is_nan() {
        f64::INFINITY
    } else {
        // A centre of mass that leaves the support in a bounce may come back.
        distance_m.max(f64::MIN_POSITIVE)
    }
}

fn plain(campaign: &Campaign, estimate: &Estimate) -> Result<Vec<Plain>, StudyError> {
    let Some(reader) = Reader::open(campaign)? else { return Ok(Vec::new()) };
    let data = Data::new(&reader)?;
    let distances = data.column(MARGIN)?.unwrap_or_default();
    let margins: Vec<f64> =
        data.outcomes.iter().zip(distances).map(|(outcome, d)| margin(outcome, d)).collect();
    let of_level = |bound: f64| {
        let met = margins.iter().filter(|margin| **margin <= bound).count();
        let [share_low, share_high] = binomial::limits(met, margins.len());
        Plain { bound, runs: margins.len(), met, share_low, share_high }
    };
    Ok(estimate.levels.iter().map(|level| of_level(level.bound)).collect())
}

impl fmt::Display for RareEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Estimate { probability, deviation, low, high, runs, levels, reached } = &self.estimate;
        let what = if *reached { "probability" } else { "not reached; probability at most about" };
        if let Some(level) = levels.iter().find(|level| level.accepted < MOVED_MIN) {
            writeln!(
                f,
                "warning: {:.0} % of the chains' proposals moved them up to {} {}: the bounds are too narrow, take \
                 more samples",
                100.0 * level.accepted,
                self.margin,
                short(level.bound),
            )?;
        }
        writeln!(
            f,
            "{}: {} {what} {probability:.3e} (95 %: {low:.2e} to {high:.2e}, coefficient of variation \
             {deviation:.2})\n  {runs} runs; plain Monte Carlo needs {:.3e} for the same: {:.3} %",
            self.study,
            self.event,
            self.plain_runs_for_the_same,
            100.0 * *runs as f64 / self.plain_runs_for_the_same,
        )?;
        writeln!(f, "  {} up to   probability  moved %   plain Monte Carlo", self.margin)?;
        for (index, level) in levels.iter().enumerate() {
            let plain = self.plain.get(index).map_or(String::new(), |plain| {
                let Plain { runs, met, share_low, share_high, .. } = plain;
                format!("{met} of {runs}: {share_low:.2e} to {share_high:.2e}")
            });
            writeln!(
                f,
                "  {:>26}   {:>11.3e}  {:>7.0}   {plain}",
                short(level.bound),
                level.probability,
                100.0 * level.accepted
            )?;
        }
        Ok(())
    }
}
