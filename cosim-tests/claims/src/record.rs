//! A claim on disk: a text file of `key = value` lines, one claim a file. Tests of Rust and Python
//! write them, each from a process of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use crate::{Bound, Claim};

/// A claim that held, with what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub id: String,
    pub section: String,
    pub claim: String,
    pub reference: String,
    pub unit: String,
    pub bound: Bound,
    pub origin: String,
    pub noise: f64,
    pub measured: f64,
    /// The test's file from the workspace's root, and the line.
    pub test: String,
}

/// The workspace's root.
pub(crate) fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

/// Where records are kept: `validation` in cargo's target folder.
pub fn records_folder() -> PathBuf {
    let target = env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    workspace().join(target).join("validation")
}

/// Removes all records, so that none outlives its test.
///
/// # Errors
/// If the folder cannot be removed.
pub fn clear(folder: &Path) -> io::Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

impl Record {
    pub(crate) fn of(claim: &Claim, measured: f64, test: String) -> Self {
        Self {
            id: claim.id.to_owned(),
            section: claim.section.to_owned(),
            claim: claim.claim.to_owned(),
            reference: claim.reference.to_owned(),
            unit: claim.unit.to_owned(),
            bound: claim.bound,
            origin: claim.origin.to_owned(),
            noise: claim.noise,
            measured,
            test,
        }
    }

    /// Writes the record into `folder`. Two tests that claim one id leave two files.
    ///
    /// # Errors
    /// If an id has other characters than letters, digits and dashes, or the file cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<()> {
        if self.id.is_empty() || !self.id.bytes().all(|b| b == b'-' || b.is_ascii_alphanumeric()) {
            return Err(io::Error::other("an id has letters, digits and dashes only"));
        }
        fs::create_dir_all(folder)?;
        let test = self.test.replace(['/', '.', ':'], "-");
        fs::write(folder.join(format!("{}@{test}", self.id)), self.to_text())
    }

    fn to_text(&self) -> String {
        let (kind, limit) = match self.bound {
            Bound::AtMost(limit) => ("at_most", limit),
            Bound::AtLeast(limit) => ("at_least", limit),
        };
        let fields = [
            ("id", self.id.clone()),
            ("section", self.section.clone()),
            ("claim", self.claim.clone()),
            ("reference", self.reference.clone()),
            ("unit", self.unit.clone()),
            (kind, format!("{limit:e}")),
            ("origin", self.origin.clone()),
            ("noise", format!("{:e}", self.noise)),
            ("measured", format!("{:e}", self.measured)),
            ("test", self.test.clone()),
        ];
        fields.map(|(key, value)| format!("{key} = {}\n", value.replace('\n', " "))).concat()
    }

    /// Reads what `to_text` wrote. An error says what is missing.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let fields: BTreeMap<&str, &str> = text
            .lines()
            .filter_map(|line| line.split_once(" ="))
            .map(|(key, value)| (key, value.trim()))
            .collect();
        let word = |key: &str| {
            fields.get(key).map(|value| (*value).to_owned()).ok_or(format!("`{key}` is missing"))
        };
        let number =
            |key: &str| word(key)?.parse::<f64>().map_err(|error| format!("`{key}`: {error}"));
        let bound = if fields.contains_key("at_least") {
            Bound::AtLeast(number("at_least")?)
        } else {
            Bound::AtMost(number("at_most")?)
        };
        Ok(Self {
            id: word("id")?,
            section: word("section")?,
            claim: word("claim")?,
            reference: word("reference")?,
            unit: word("unit")?,
            bound,
            origin: word("origin")?,
            noise: number("noise")?,
            measured: number("measured")?,
            test: word("test")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read() {
        let record = Record {
            id: "slide".into(),
            section: "Contact".into(),
            claim: "slides = falls".into(),
            reference: "g (sin β - μ cos β)".into(),
            unit: String::new(),
            bound: Bound::AtLeast(0.1),
            origin: "two\nlines".into(),
            noise: 0.0,
            measured: -1.0 / 3.0,
            test: "a/b.rs:7".into(),
        };
        let read = Record::parse(&record.to_text()).unwrap();
        assert_eq!(read, Record { origin: "two lines".into(), ..record });
        assert!(Record::parse("id = x").unwrap_err().contains("missing"));
    }
}
