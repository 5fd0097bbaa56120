//! The zip archive: what is in it, and unpacked for a trial.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use fmi_adapter::Variant;
use fmi_adapter::variables::DEFAULT_SCENARIO;
use zip::ZipArchive;

use crate::{Error, terminals};

/// Content by path.
pub type Entries = BTreeMap<String, Vec<u8>>;

pub fn read(file: &Path) -> Result<Entries, Error> {
    let failed = |source| Error::Archive { file: file.display().to_string(), source };
    let mut zip = ZipArchive::new(File::open(file).map_err(Error::read(file))?).map_err(failed)?;
    let mut entries = Entries::new();
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).map_err(failed)?;
        let name = entry.name().map_err(failed)?.into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).map_err(Error::read(file))?;
        entries.insert(name, content);
    }
    Ok(entries)
}

/// Entries that could be written outside a folder that the archive is unpacked to.
pub fn path_problems(entries: &Entries) -> Vec<String> {
    let outside = |path: &&String| {
        path.contains('\\') || path.starts_with('/') || path.split('/').any(|part| part == "..")
    };
    let paths = entries.keys().filter(outside);
    paths.map(|path| format!("entry {path}: not a plain relative path")).collect()
}

/// Files that the FMU needs or that FMI expects.
pub fn missing(entries: &Entries, variant: Variant) -> Vec<String> {
    let scenario = format!("resources/{DEFAULT_SCENARIO}");
    let mut expected = vec![scenario.as_str(), "documentation/index.html"];
    if variant != Variant::Fmi2 {
        expected.push(terminals::ENTRY);
    }
    let missing = expected.into_iter().filter(|path| !entries.contains_key(*path));
    missing.map(|path| format!("{path} is missing")).collect()
}

/// Writes all entries below `folder`; their paths have no problem.
pub fn unpack(entries: &Entries, folder: &Path) -> Result<(), Error> {
    for (path, content) in entries {
        let file = folder.join(path);
        let parent = file.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(Error::write(parent))?;
        fs::write(&file, content).map_err(Error::write(&file))?;
    }
    Ok(())
}
