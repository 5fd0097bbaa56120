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

/// Creates a file under its temporary name. It is no leftover as long as it is open.
pub fn create(part: &Path) -> io::Result<File> {
    let open = File::create(part)?;
    // Where a file system knows no locks nothing is taken for a leftover either.
    let _ = open.lock();
    Ok(open)
}

/// Removes what processes that were killed left in a folder under temporary names. What one is still writing stays,
/// also that of another machine if the file system's locks reach there.
pub fn remove_leftovers(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let file = entry?.path();
        if file.extension().is_some_and(|extension| extension == "part")
            && File::open(&file).is_ok_and(|open| open.try_lock().is_ok())
        {
            fs::remove_file(&file)?;
        }
    }
    Ok(())
}

/// Writes under a temporary name, then gives the file its own. On error neither is left.
pub fn write(file: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = temporary(file);
    let written = create(&part).and_then(|mut open| {
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
