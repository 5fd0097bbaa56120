//! What can go wrong while packing, naming the file.

use std::path::{Path, PathBuf};

use lander_models::ConfigError;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("{}: cannot be read: {source}", file.display())]
    Read { file: PathBuf, source: std::io::Error },
    #[error("{}: cannot be written: {source}", file.display())]
    Write { file: PathBuf, source: std::io::Error },
    #[error("standard output: cannot be written: {0}")]
    Print(std::io::Error),
    #[error("{file}: zip archive: {source}")]
    Archive { file: String, source: zip::result::ZipError },
    #[error("{}: {reason}", file.display())]
    Library { file: PathBuf, reason: String },
    #[error("{}: another folder has a library for {platform} too", folder.display())]
    SamePlatform { folder: PathBuf, platform: &'static str },
    #[error("a scenario that would be packed is not valid: {0}")]
    Scenario(#[from] ConfigError),
    #[error("signal {signal}: unit \"{unit}\" has no known base-unit exponents")]
    Unit { signal: &'static str, unit: &'static str },
    #[error("vehicle name \"{0}\": must be of a-z, 0-9 and hyphens")]
    VehicleName(String),
    #[error("{}: exists already", file.display())]
    Exists { file: PathBuf },
    #[error("SOURCE_DATE_EPOCH is \"{0}\": it must be whole seconds from 1980 to 2107")]
    Epoch(String),
}

impl Error {
    /// For `map_err` on reading `file`.
    pub(crate) fn read(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_owned();
        |source| Self::Read { file, source }
    }

    /// For `map_err` on writing `file`.
    pub(crate) fn write(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_owned();
        |source| Self::Write { file, source }
    }
}
