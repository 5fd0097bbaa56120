//! Runs a study, shard by shard, on all cores.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::StudyError;
use super::file::Study;
use super::row::Columns;
use super::shard::{self, Shard};
use crate::landing::Error;
use crate::progress::Count;
use crate::whole_file;

/// One of `of` equal parts of a campaign, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub number: u64,
    pub of: u64,
}

impl std::str::FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = |word: &str| word.parse::<u64>().ok();
        match text.split_once('/').and_then(|(a, b)| Some((parse(a)?, parse(b)?))) {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("must be i/n with i from 1 to n, as in 3/8".to_owned()),
        }
    }
}

pub struct Campaign<'a> {
    pub study: &'a Study,
    pub columns: &'a Columns,
    /// Results of the study; its shards are in `shards` below.
    pub folder: PathBuf,
}

/// How far a campaign came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Whole,
    /// Its part is done.
    Part,
    Interrupted,
}

impl<'a> Campaign<'a> {
    pub fn new(study: &'a Study, columns: &'a Columns, out: &Path) -> Self {
        Self { study, columns, folder: out.join(&study.name) }
    }

    pub fn shards(&self) -> Vec<Shard> {
        shard::all(self.study, &self.columns.header(), &self.folder.join("shards"))
    }

    /// Runs what is not there yet of `part`, or of all. Shards that are there and whole stay.
    pub fn run(
        &self,
        part: Option<Part>,
        threads: usize,
        interrupted: &AtomicBool,
    ) -> Result<End, Error> {
        let folder = self.folder.join("shards");
        let lost = |source| StudyError::File { file: folder.clone(), source };
        fs::create_dir_all(&folder).map_err(lost)?;
        for folder in [&self.folder, &folder] {
            whole_file::remove_leftovers(folder).map_err(lost)?;
        }
        let mine = |block: &u64| part.is_none_or(|part| block % part.of == part.number - 1);
        let mut missing = Vec::new();
        for (_, shard) in (0..).zip(self.shards()).filter(|(block, _)| mine(block)) {
            if shard.read()?.is_none() {
                missing.push(shard);
            }
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let runs: u64 = missing.iter().map(|shard| shard.runs.end - shard.runs.start).sum();
        if !pool.install(|| self.check_draws(&missing, runs as usize, interrupted))? {
            return Ok(End::Interrupted);
        }
        let progress = Count::new("runs", runs as usize);
        let done = pool.install(|| {
            for shard in &missing {
                let Some(rows) = self.rows(shard, &progress, interrupted)? else {
                    return Ok(End::Interrupted);
                };
                shard.write(&rows)?;
            }
            Ok(if part.is_some() { End::Part } else { End::Whole })
        });
        progress.finish();
        done
    }

    /// Refuses the first run with a draw that its file does not take, before any is flown. Bounded distributions
    /// have been tried at their ends. Whether it was not interrupted: 20,000 draws take a second on two cores.
    fn check_draws(
        &self,
        shards: &[Shard],
        count: usize,
        interrupted: &AtomicBool,
    ) -> Result<bool, StudyError> {
        if self.study.drawn().all(|parameter| parameter.distribution.is_bounded()) {
            return Ok(true);
        }
        let progress = Count::new("draws checked", count);
        let refused = |number: u64| {
            if interrupted.load(Ordering::Relaxed) {
                return None;
            }
            progress.one_more();
            self.study.run(number).err()
        };
        let runs = shards.par_iter().flat_map(|shard| shard.runs.clone());
        let first = runs.map(refused).find_first(Option::is_some).flatten();
        progress.finish();
        first.map_or(Ok(!interrupted.load(Ordering::Relaxed)), Err)
    }

    /// The rows of a shard, unless interrupted.
    fn rows(
        &self,
        shard: &Shard,
        progress: &Count,
        interrupted: &AtomicBool,
    ) -> Result<Option<Vec<String>>, StudyError> {
        let one = |number: u64| {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let row = self.study.run(number)?.finish(self.study.kind, self.columns);
            progress.one_more();
            Ok(Some(row.to_csv()))
        };
        // In order, so that of two errors the one told does not depend on the threads.
        let rows: Vec<Result<Option<String>, StudyError>> =
            shard.runs.clone().into_par_iter().map(one).collect();
        rows.into_iter().collect()
    }
}
