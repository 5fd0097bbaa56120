//! What rows depend on besides the study's files: the sources of the models and of what flies them, and
//! the dependencies' versions.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Below the workspace. Statistics, reports and command line are left out: they change no row.
pub const SOURCES: [&str; 17] = [
    "Cargo.lock",
    "models/src",
    "truth-model/src",
    "guidance-fmu/src",
    "cosim-tests/schedule.toml",
    "cosim-tests/native/src/flight.rs",
    "cosim-tests/native/src/layout.rs",
    "cosim-tests/native/src/master.rs",
    "cosim-tests/native/src/schedule.rs",
    "cosim-tests/native/src/study/axis.rs",
    "cosim-tests/native/src/study/distribution.rs",
    "cosim-tests/native/src/study/failures.rs",
    "cosim-tests/native/src/study/file.rs",
    "cosim-tests/native/src/study/parameter.rs",
    "cosim-tests/native/src/study/row.rs",
    "cosim-tests/native/src/study/run.rs",
    "cosim-tests/native/src/touchdowns.rs",
];

/// The first 16 hexadecimal digits of SHA-256 over names and contents.
pub fn fingerprint(workspace: &Path) -> io::Result<String> {
    let mut digest = Sha256::new();
    for source in SOURCES {
        for file in files(&workspace.join(source))? {
            // The same on every machine: names below the workspace, with one kind of slash and of line end.
            let name = file.strip_prefix(workspace).unwrap_or(&file).to_string_lossy().into_owned();
            let text = fs::read_to_string(&file)?.replace("\r\n", "\n");
            for part in [name.replace('\\', "/"), text] {
                digest.update((part.len() as u64).to_le_bytes());
                digest.update(part);
            }
        }
    }
    Ok(digest.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect())
}

/// A file, or all below a folder, in order.
fn files(path: &Path) -> io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut entries: Vec<PathBuf> =
        fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    entries.sort();
    let below = entries.iter().map(|entry| files(entry)).collect::<io::Result<Vec<_>>>()?;
    Ok(below.concat())
}
