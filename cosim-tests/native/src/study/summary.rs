//! What a study's runs come to: outcomes with their bounds.

use std::collections::BTreeMap;
use std::fmt;

use lander_models::Outcome;
use serde::Serialize;

use super::StudyError;
use super::campaign::Campaign;
use super::data::Data;
use super::shard::VERSION;
use crate::binomial;

#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub study: String,
    pub study_sha256: String,
    pub version: &'static str,
    pub seed: u64,
    pub runs: usize,
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
    pub fn of(campaign: &Campaign) -> Result<Self, StudyError> {
        let data = Data::read(campaign)?;
        Ok(Self::new(campaign, &data))
    }

    pub fn new(campaign: &Campaign, data: &Data) -> Self {
        let study = campaign.study;
        let mut groups = vec![Group::new("all", data.outcomes.iter())];
        let mut by_failure: BTreeMap<&str, Vec<&String>> = BTreeMap::new();
        for (failures, outcome) in data.failures.iter().zip(&data.outcomes) {
            by_failure.entry(failures).or_default().push(outcome);
        }
        if !study.failures.modes.is_empty() {
            groups.extend(by_failure.into_iter().map(|(name, runs)| Group::new(name, runs)));
        }
        Self {
            study: study.name.clone(),
            study_sha256: study.hash.clone(),
            version: VERSION,
            seed: study.seed,
            runs: data.outcomes.len(),
            groups,
        }
    }
}

impl Group {
    fn new<'a>(failures: &str, outcomes: impl IntoIterator<Item = &'a String>) -> Self {
        let outcomes: Vec<&String> = outcomes.into_iter().collect();
        let runs = outcomes.len();
        let names = Outcome::ALL.map(Outcome::name).into_iter().chain(["failed"]);
        let shares = names.map(|name| {
            let count = outcomes.iter().filter(|outcome| outcome.as_str() == name).count();
            let [share_low, share_high] = binomial::limits(count, runs);
            let share = count as f64 / runs as f64;
            Share { outcome: name.to_owned(), runs: count, share, share_low, share_high }
        });
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
        Ok(())
    }
}
