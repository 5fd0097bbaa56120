//! What a sceptical user does with an FMU before trusting it: looks into the archive, then runs it.

mod archive;
mod binaries;
mod description;
mod drive;
mod landing;
mod trials;

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use fmi_adapter::{Variant, token};
use lander_models::signals::Interface;
use serde_json::{Value, json};
use tempfile::TempDir;

pub use binaries::Demands;
pub use landing::{fly, pairs};

use crate::Error;
use crate::model::library_entry;
use crate::platform::Platform;

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub check: String,
    pub passed: bool,
    /// What was found, or what is wrong.
    pub note: String,
}

impl Finding {
    fn of(check: &str, outcome: Result<String, String>) -> Self {
        let passed = outcome.is_ok();
        let (Ok(note) | Err(note)) = outcome;
        Self { check: check.to_owned(), passed, note }
    }

    fn of_problems(check: &str, problems: Vec<String>, otherwise: String) -> Vec<Self> {
        if problems.is_empty() {
            return vec![Self::of(check, Ok(otherwise))];
        }
        problems.into_iter().map(|problem| Self::of(check, Err(problem))).collect()
    }

    /// Of a file that is no archive.
    pub fn unreadable(error: &Error) -> Self {
        Self::of("archive", Err(error.to_string()))
    }

    fn json(&self) -> Value {
        json!({ "check": self.check, "passed": self.passed, "note": self.note })
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let verdict = if self.passed { "pass" } else { "FAIL" };
        write!(f, "  {verdict}  {:<18} {}", self.check, self.note)
    }
}

/// An FMU that has been looked into and unpacked, ready to run here.
pub struct Unpacked {
    pub model: &'static Interface,
    pub variant: Variant,
    library: PathBuf,
    folder: TempDir,
}

impl Unpacked {
    fn token(&self) -> String {
        token(self.model, self.variant)
    }

    fn resources(&self) -> PathBuf {
        self.folder.path().join("resources")
    }

    fn is_fmi2(&self) -> bool {
        self.variant == Variant::Fmi2
    }
}

/// All findings by file, and whether every check passed.
pub fn json(report: &[(String, Vec<Finding>)]) -> Value {
    let findings = |list: &[Finding]| list.iter().map(Finding::json).collect::<Vec<_>>();
    let subjects: Vec<Value> = report
        .iter()
        .map(|(name, list)| json!({ "file": name, "checks": findings(list) }))
        .collect();
    let passed = report.iter().flat_map(|(_, list)| list).all(|finding| finding.passed);
    json!({ "passed": passed, "files": subjects })
}

/// Looks into `file` without running it. With the findings comes the FMU itself, if it is one for
/// this platform; an error is that the file cannot be read as an archive.
pub fn inspect(file: &Path, demands: &Demands) -> Result<(Vec<Finding>, Option<Unpacked>), Error> {
    let entries = archive::read(file)?;
    let mut findings = Vec::new();
    let outside = archive::path_problems(&entries);
    let is_tame = outside.is_empty();
    let note = format!("{} files", entries.len());
    findings.extend(Finding::of_problems("archive", outside, note));
    let text = entries.get("modelDescription.xml").map(|bytes| String::from_utf8_lossy(bytes));
    let read = text.ok_or_else(|| "modelDescription.xml is missing".to_owned());
    let ((model, variant), problems) = match read.and_then(|text| description::read(&text)) {
        Ok(read) => read,
        Err(problem) => {
            findings.push(Finding::of("description", Err(problem)));
            return Ok((findings, None));
        }
    };
    let note = format!("{} {}, as the signal table has it", model.model, variant.name());
    findings.extend(Finding::of_problems("description", problems, note));
    let note = "scenario, documentation, terminals".to_owned();
    findings.extend(Finding::of_problems("files", archive::missing(&entries, variant), note));
    let (libraries, problems) = binaries::read(model, variant, &entries, demands);
    findings.extend(Finding::of_problems("libraries", problems, binaries::summary(&libraries)));
    let here = Platform::here().filter(|here| libraries.contains_key(here));
    let Some(here) = here.filter(|_| is_tame) else { return Ok((findings, None)) };
    let folder =
        TempDir::with_prefix("fmu-check-").map_err(Error::write(Path::new("temporary")))?;
    archive::unpack(&entries, folder.path())?;
    let library = folder.path().join(library_entry(model, variant, here));
    Ok((findings, Some(Unpacked { model, variant, library, folder })))
}

/// Runs the FMU in this process, one trial after another.
pub fn run(fmu: &Unpacked) -> impl Iterator<Item = Finding> {
    trials::TRIALS.iter().map(|(name, trial)| Finding::of(name, trial(fmu)))
}
