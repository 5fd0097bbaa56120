//! A zip archive with the same bytes each time: sorted entries, one date, one mode.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::{Error, Stamp};

/// Content by path in the archive.
pub type Entries = BTreeMap<String, Vec<u8>>;

pub fn pack(entries: &Entries, stamp: Stamp) -> Result<Vec<u8>, Error> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(stamp.zip())
        .unix_permissions(0o644);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, content) in entries {
        let failed = |source| Error::Archive { file: path.clone(), source };
        zip.start_file(path.as_str(), options).map_err(failed)?;
        zip.write_all(content).map_err(|error| failed(error.into()))?;
    }
    let failed = |source| Error::Archive { file: "central directory".to_owned(), source };
    Ok(zip.finish().map_err(failed)?.into_inner())
}
