//! A shard: the rows of a block of runs in a file of their own. It is there whole or not at all, so a
//! campaign that is killed, anywhere, goes on from the shards it finds.

use std::fs;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::StudyError;
use super::file::Study;
use crate::landing::hexadecimal;
use crate::whole_file;

/// Of the rows: they may differ from one version of the software to the next.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Of the sources that rows depend on (`build_fingerprint.rs`): they may differ from one build to the next.
pub const BUILD: &str = env!("SOURCES_FINGERPRINT");

/// What rows come from: files of the same origin may stand in one table.
pub fn origin(study_sha256: &str, version: &str, build: &str) -> String {
    format!("study {study_sha256} version {version} build {build}")
}

#[derive(Clone, Debug)]
pub struct Shard {
    pub runs: Range<u64>,
    pub file: PathBuf,
    /// Of all shards of the study.
    origin: String,
    /// The line with the names of the columns.
    header: String,
}

/// The shards of all runs of a study, in order.
pub fn all(study: &Study, header: &str, folder: &Path) -> Vec<Shard> {
    let origin = study.origin();
    (0..study.runs.div_ceil(study.shard_runs))
        .map(|block| {
            let first = block * study.shard_runs;
            let runs = first..(first + study.shard_runs).min(study.runs);
            let file = folder.join(format!("{:09}-{:09}.csv", runs.start, runs.end - 1));
            Shard { runs, file, origin: origin.clone(), header: header.to_owned() }
        })
        .collect()
}

impl Shard {
    /// The rows, a line each, if the file is there and whole.
    ///
    /// # Errors
    /// A file of another study, version or build: that is no leftover to be written over.
    pub fn read(&self) -> Result<Option<Vec<String>>, StudyError> {
        let text = match fs::read_to_string(&self.file) {
            Ok(text) => text,
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::InvalidData) => {
                return Ok(None);
            }
            Err(source) => return Err(StudyError::File { file: self.file.clone(), source }),
        };
        let (first, rest) = text.split_once('\n').unwrap_or((&text, ""));
        let Some((origin, digest)) = first.split_once(" rows ") else { return Ok(None) };
        let Some(found) = origin.strip_prefix("# ") else { return Ok(None) };
        if found != self.origin {
            let (found, expected) = (found.to_owned(), self.origin.clone());
            return Err(StudyError::Foreign { file: self.file.clone(), found, expected });
        }
        let whole =
            rest.strip_prefix(self.header.as_str()).and_then(|rows| rows.strip_prefix('\n'));
        let Some(rows) = whole.filter(|_| digest == sha256(rest)) else { return Ok(None) };
        Ok(Some(rows.lines().map(str::to_owned).collect()))
    }

    /// Writes the rows under a temporary name, then gives the file its own.
    pub fn write(&self, rows: &[String]) -> Result<(), StudyError> {
        let mut body = self.header.clone() + "\n";
        for row in rows {
            body += row;
            body.push('\n');
        }
        let text = format!("# {} rows {}\n{body}", self.origin, sha256(&body));
        whole_file::write(&self.file, text.as_bytes())
            .map_err(|source| StudyError::File { file: self.file.clone(), source })
    }
}

fn sha256(text: &str) -> String {
    hexadecimal(&Sha256::digest(text))
}
