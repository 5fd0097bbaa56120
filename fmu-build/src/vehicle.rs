//! `new-vehicle`: a vehicle of one's own begins as a copy that flies.

use std::path::{Path, PathBuf};

use lander_models::Scenario;

use crate::Error;
use crate::package::{read, write_all};

/// Copies vehicle `from` and the default scenario under the name `name`, and loads both.
///
/// # Errors
/// A file of that name exists, `from` does not, or the name is none for a file.
pub fn create(root: &Path, name: &str, from: &str) -> Result<Vec<PathBuf>, Error> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || !name.chars().all(plain) {
        return Err(Error::VehicleName(name.to_owned()));
    }
    let models = root.join("models");
    let vehicle = PathBuf::from(format!("vehicles/{name}.toml"));
    let scenario = PathBuf::from(format!("scenarios/{name}.toml"));
    for file in [&vehicle, &scenario].map(|file| models.join(file)) {
        if file.exists() {
            return Err(Error::Exists { file });
        }
    }
    let made = [
        (vehicle, named(&models.join(format!("vehicles/{from}.toml")), name)?),
        (scenario.clone(), scenario_of(&models.join("scenarios/landing.toml"), name)?),
    ];
    let made = made.map(|(file, text)| (models.join(file), text.into_bytes())).to_vec();
    let written = write_all(&models, made)?;
    Scenario::load(&models.join(scenario))?;
    Ok(written)
}

/// The file with its `name` replaced.
fn named(file: &Path, name: &str) -> Result<String, Error> {
    let text = String::from_utf8_lossy(&read(file)?).into_owned();
    let line = |line: &str| {
        if line.starts_with("name = ") {
            format!("name = \"{name}\"\n")
        } else {
            format!("{line}\n")
        }
    };
    Ok(text.lines().map(line).collect())
}

fn scenario_of(file: &Path, name: &str) -> Result<String, Error> {
    let line = |line: &str| {
        if line.starts_with("vehicle = ") {
            format!("vehicle = \"../vehicles/{name}.toml\"\n")
        } else {
            format!("{line}\n")
        }
    };
    Ok(named(file, name)?.lines().map(line).collect())
}
