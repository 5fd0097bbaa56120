//! FMUs of the real tables and resources around stand-in libraries, in a folder of their own.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use fmu_build::check::{Demands, inspect};
use fmu_build::model::{MODELS, library_files};
use fmu_build::package::{Sources, build};
use fmu_build::{Error, Stamp};

/// A folder with `libraries/`, gone when dropped.
pub struct Workshop(pub PathBuf);

/// Place of the truth model's FMI 3.0 archive in what `build` returns.
pub const FMI3: usize = 1;

impl Workshop {
    pub fn new(name: &str) -> Self {
        Self::with("honest", name)
    }

    /// Both libraries are the example of this name.
    pub fn with(example: &str, name: &str) -> Self {
        let folder = format!("fmu-build-test-{}-{name}", std::process::id());
        let workshop = Self(std::env::temp_dir().join(folder));
        fs::create_dir_all(workshop.0.join("libraries")).unwrap();
        for model in MODELS {
            let library = workshop.0.join("libraries").join(&library_files(model)[0]);
            fs::copy(stand_in(example), library).unwrap();
        }
        workshop
    }

    pub fn build(&self, out: &str, stamp: Stamp) -> Result<Vec<PathBuf>, Error> {
        let libraries = &[self.0.join("libraries")];
        build(&Sources { libraries, root: root(), stamp }, &self.0.join(out))
    }

    pub fn build_from(&self, libraries: &[PathBuf], out: &str) -> Result<Vec<PathBuf>, Error> {
        let stamp = Stamp::default();
        build(&Sources { libraries, root: root(), stamp }, &self.0.join(out))
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        // Left-overs in the temporary folder don't make a test wrong.
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Where cargo puts the example of this name, beside this package's program.
fn stand_in(example: &str) -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_fmu-build"));
    program.with_file_name("examples").join(format!("lib{example}.so"))
}

/// What a look into `file` finds wrong.
pub fn problems(file: &Path) -> Vec<String> {
    problems_with(file, &Demands::default())
}

pub fn problems_with(file: &Path, demands: &Demands) -> Vec<String> {
    let (findings, _) = inspect(file, demands).unwrap();
    findings.into_iter().filter(|finding| !finding.passed).map(|finding| finding.note).collect()
}

pub fn read_entry(file: &Path, entry: &str) -> String {
    String::from_utf8(read_bytes(file, entry)).unwrap()
}

pub fn read_bytes(file: &Path, entry: &str) -> Vec<u8> {
    let mut zip = zip::ZipArchive::new(fs::File::open(file).unwrap()).unwrap();
    let mut bytes = Vec::new();
    zip.by_name(entry).unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

/// Replaces `from` by `to` in the model description of `file`.
pub fn tamper(file: &Path, from: &str, to: &str) {
    let mut source = zip::ZipArchive::new(fs::File::open(file).unwrap()).unwrap();
    let mut target = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for index in 0..source.len() {
        let entry = source.by_index_raw(index).unwrap();
        if entry.name().unwrap() != "modelDescription.xml" {
            target.raw_copy_file(entry).unwrap();
        }
    }
    let text = read_entry(file, "modelDescription.xml");
    assert!(text.contains(from), "nothing to tamper with");
    target.start_file("modelDescription.xml", zip::write::SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(&mut target, text.replacen(from, to, 1).as_bytes()).unwrap();
    fs::write(file, target.finish().unwrap().into_inner()).unwrap();
}
