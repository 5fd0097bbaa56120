//! Where things are.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::steps::Failure;

pub struct Workspace {
    pub root: PathBuf,
    /// Cargo's target folder, which also holds the FMUs.
    pub target: PathBuf,
}

impl Workspace {
    /// The workspace around the current folder.
    pub fn find() -> Result<Self, Failure> {
        let here = env::current_dir().map_err(|error| Failure::new(error.to_string()))?;
        let root = here
            .ancestors()
            .find(|folder| folder.join("cosim-tests/schedule.toml").exists())
            .ok_or_else(|| Failure::new("not inside the lander workspace"))?;
        let target = env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
        Ok(Self { root: root.to_owned(), target: root.join(target) })
    }

    pub fn release(&self, program: &str) -> PathBuf {
        self.target.join("release").join(program)
    }

    pub fn fmus(&self) -> PathBuf {
        self.target.join("fmu")
    }

    pub fn python_package(&self) -> PathBuf {
        self.root.join("cosim-tests/python")
    }

    /// A bare name that is no file means a scenario of the kit.
    pub fn scenario(&self, given: &OsStr) -> PathBuf {
        let path = Path::new(given);
        let bare = path.extension().is_none() && path.file_name() == Some(given);
        if bare && !path.is_file() {
            self.root.join("models/scenarios").join(given).with_extension("toml")
        } else {
            path.to_owned()
        }
    }
}
