//! Makes the FMUs.

use std::fs;
use std::path::{Path, PathBuf};

use fmi_adapter::Variant;
use fmi_adapter::variables::DEFAULT_SCENARIO;
use lander_models::signals::Interface;
use lander_models::{Scenario, Ticks};

use crate::archive::{Entries, pack};
use crate::description::model_description;
use crate::documentation::page;
use crate::model::{MODELS, archive_file, library_entry, library_files};
use crate::platform::{Library, Platform};
use crate::terminals::{self, terminals};
use crate::{Error, Stamp};

/// Where things come from.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// Folders with the shells' shared libraries, one for each platform.
    pub libraries: &'a [PathBuf],
    /// Workspace root: `models/` and `LICENSE`.
    pub root: &'a Path,
    pub stamp: Stamp,
}

/// Writes the archives of each model into `out` and returns their paths. All are made before
/// the first is written, and each appears under its name only when complete.
pub fn build(sources: &Sources, out: &Path) -> Result<Vec<PathBuf>, Error> {
    let all = MODELS.into_iter().flat_map(|model| Variant::ALL.map(|variant| (model, variant)));
    let made: Vec<(PathBuf, Vec<u8>)> = all
        .map(|(model, variant)| {
            Ok((out.join(archive_file(model, variant)), archive(model, variant, sources)?))
        })
        .collect::<Result<_, Error>>()?;
    write_all(out, made)
}

/// Writes files into the folder `out` and returns their paths.
pub(crate) fn write_all(out: &Path, made: Vec<(PathBuf, Vec<u8>)>) -> Result<Vec<PathBuf>, Error> {
    fs::create_dir_all(out).map_err(Error::write(out))?;
    for (file, bytes) in &made {
        write_whole(file, bytes)?;
    }
    Ok(made.into_iter().map(|(file, _)| file).collect())
}

/// The bytes of one FMU.
pub fn archive(model: &Interface, variant: Variant, sources: &Sources) -> Result<Vec<u8>, Error> {
    let mut entries = Entries::new();
    for folder in sources.libraries {
        let (platform, library) = library(folder, model)?;
        if entries.insert(library_entry(model, variant, platform), library).is_some() {
            let platform = platform.name();
            return Err(Error::SamePlatform { folder: folder.clone(), platform });
        }
    }
    let models = sources.root.join("models");
    for (folder, extension) in [("scenarios", "toml"), ("vehicles", "toml"), ("terrain", "tif")] {
        for file in files(&models.join(folder), extension)? {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            entries.insert(format!("resources/{folder}/{name}"), read(&file)?);
        }
    }
    let stop = validate_scenarios(&models)?;
    let description = model_description(model, variant, stop, sources.stamp)?;
    entries.insert("modelDescription.xml".to_owned(), description.into_bytes());
    entries.insert("documentation/index.html".to_owned(), page(model, variant).into_bytes());
    if variant != Variant::Fmi2 {
        entries.insert(terminals::ENTRY.to_owned(), terminals(model, variant).into_bytes());
    }
    let license = sources.root.join("LICENSE");
    if license.exists() {
        // Each version names the entry point of the licences in its own way.
        let entry = if variant == Variant::Fmi2 { "license" } else { "licenses/license" };
        entries.insert(format!("documentation/{entry}.txt"), read(&license)?);
    }
    pack(&entries, sources.stamp)
}

/// The library of `model` in `folder`, and the platform that its headers name.
fn library(folder: &Path, model: &Interface) -> Result<(Platform, Vec<u8>), Error> {
    let [so, dll] = library_files(model).map(|name| folder.join(name));
    let file = if dll.exists() { dll } else { so };
    let bytes = read(&file)?;
    match Library::read(&bytes) {
        Ok(library) => Ok((library.platform, bytes)),
        Err(reason) => Err(Error::Library { file, reason }),
    }
}

/// Loads every scenario once, so that a broken one is found here and not by an importer.
/// Returns the stop time of the default one.
fn validate_scenarios(models: &Path) -> Result<Ticks, Error> {
    for file in files(&models.join("scenarios"), "toml")? {
        Scenario::load(&file)?;
    }
    default_stop(models)
}

/// Stop time of the default scenario.
pub(crate) fn default_stop(models: &Path) -> Result<Ticks, Error> {
    Ok(Scenario::load(&models.join(DEFAULT_SCENARIO))?.0.stop_time)
}

pub(crate) fn files(folder: &Path, with: &str) -> Result<Vec<PathBuf>, Error> {
    let listing = fs::read_dir(folder).map_err(Error::read(folder))?;
    let mut files = Vec::new();
    for entry in listing {
        let file = entry.map_err(Error::read(folder))?.path();
        if file.extension().is_some_and(|extension| extension == with) {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}

pub(crate) fn read(file: &Path) -> Result<Vec<u8>, Error> {
    fs::read(file).map_err(Error::read(file))
}

/// Under a temporary name first: nobody ever opens half an archive.
fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), Error> {
    let partial = file.with_added_extension("partial");
    let written = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, file));
    written.map_err(|error| {
        // The first error is the one to report.
        let _ = fs::remove_file(&partial);
        Error::write(file)(error)
    })
}
