//! Studies: many runs of a scenario with parameters drawn from distributions.
//!
//! A study file says what is run and what is drawn; `Draw` makes one run of it, `campaign` runs
//! them all into shards, and `table` merges those.

pub mod axis;
pub mod campaign;
pub mod data;
pub mod designs;
pub mod distribution;
pub mod effect;
pub mod failures;
pub mod file;
pub mod parameter;
pub mod rare;
pub mod row;
pub mod run;
pub mod shard;
pub mod summary;
pub mod table;

use std::path::PathBuf;

use lander_models::ConfigError;

pub use file::{Kind, Study};

#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("{}: {place}: {what}: {reason}", file.display())]
    Draw { file: PathBuf, place: String, what: String, reason: String },
    #[error("{}: has {runs} runs, the first is 0: there is no run {run}", file.display())]
    NoSuchRun { file: PathBuf, run: u64, runs: u64 },
    #[error("{}: {source}", file.display())]
    File { file: PathBuf, source: std::io::Error },
    #[error(
        "{}: is of another study, version or build ({found}), not of this ({expected}): \
         remove its folder or choose another with --out",
        file.display()
    )]
    Foreign { file: PathBuf, found: String, expected: String },
    #[error("{}: runs {first} to {last} have no shard yet", folder.display())]
    Missing { folder: PathBuf, first: u64, last: u64 },
    #[error("interrupted: nothing of it is kept")]
    Interrupted,
    #[error("{}: cannot be written: {reason}", file.display())]
    Parquet { file: PathBuf, reason: String },
}
