//! Files that are there whole or not at all, also for a reader on another machine.

use std::collections::hash_map::RandomState;
use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A name beside `file` that no other process has, on this machine or another.
pub fn temporary(file: &Path) -> PathBuf {
    let random = RandomState::new().build_hasher().finish();
    file.with_added_extension(format!("{random:016x}.part"))
}

/// Writes under a temporary name, then gives the file its own. On error neither is left.
pub fn write(file: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = temporary(file);
    let written = File::create(&part).and_then(|mut open| {
        open.write_all(bytes)?;
        // A full disk may say so only now.
        open.sync_all()?;
        fs::rename(&part, file)
    });
    if written.is_err() {
        // What failed first is the error to tell.
        let _ = fs::remove_file(&part);
    }
    written
}
