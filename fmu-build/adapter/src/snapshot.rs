//! The changing part of an instance, and its serialised form.
//!
//! | bytes | content |
//! |---|---|
//! | 0..32 | interface token |
//! | 32..64 | scenario fingerprint |
//! | 64..96 | SHA-256 of the payload |
//! | 96..104 | payload length, u64 little-endian |
//! | 104.. | payload: [`Snapshot`] in postcard |

use std::ffi::CString;

use lander_models::Ticks;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::lifecycle::Lifecycle;

/// All that a restart needs besides the files that the scenario names.
#[derive(Clone, Serialize, Deserialize)]
pub struct Snapshot<S> {
    pub lifecycle: Lifecycle,
    /// The parameter as set; kept as a C string because importers get a pointer to it.
    pub scenario_file: CString,
    pub now: Ticks,
    /// No step may pass it.
    pub stop: Ticks,
    pub inputs: Vec<f64>,
    /// Present from Initialization Mode on.
    pub state: Option<S>,
}

#[derive(Debug, thiserror::Error)]
pub enum BlobError {
    #[error("{given} bytes, {expected} expected: truncated or extended")]
    Length { given: usize, expected: usize },
    #[error("written by another model or another version of its interface")]
    Foreign,
    #[error("written under another scenario: set scenario_file to that one first")]
    Scenario,
    #[error("corrupt: {0}")]
    Corrupt(String),
}

const HEADER: usize = 104;

/// What a blob must match to be accepted.
#[derive(Clone, Copy)]
pub struct Origin {
    pub token: [u8; 32],
    pub fingerprint: [u8; 32],
}

/// Identifies a scenario: the parameter as set, and the content of the file it means.
///
/// Catches a scenario edited between save and restore. A file that can't be read counts as
/// empty: `Component::create` is what reports that.
pub fn fingerprint(parameter: &[u8], content: &[u8]) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update((parameter.len() as u64).to_le_bytes());
    hash.update(parameter);
    hash.update(content);
    hash.finalize().into()
}

impl<S: Serialize + DeserializeOwned> Snapshot<S> {
    pub fn encode(&self, origin: &Origin) -> Result<Vec<u8>, BlobError> {
        let payload = postcard::to_allocvec(self).map_err(|e| BlobError::Corrupt(e.to_string()))?;
        let mut blob = Vec::with_capacity(HEADER + payload.len());
        blob.extend(origin.token);
        blob.extend(origin.fingerprint);
        blob.extend(<[u8; 32]>::from(Sha256::digest(&payload)));
        blob.extend((payload.len() as u64).to_le_bytes());
        blob.extend(payload);
        Ok(blob)
    }

    /// Refuses what `encode` did not write for the same `origin`.
    pub fn decode(blob: &[u8], origin: &Origin) -> Result<Self, BlobError> {
        let given = blob.len();
        let Some((header, payload)) = blob.split_at_checked(HEADER) else {
            return Err(BlobError::Length { given, expected: HEADER });
        };
        if header[..32] != origin.token {
            return Err(BlobError::Foreign);
        }
        let length = header[96..].iter().rev().fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
        if length != payload.len() as u64 {
            let expected = usize::try_from(length).map_or(usize::MAX, |n| n.saturating_add(HEADER));
            return Err(BlobError::Length { given, expected });
        }
        if header[64..96] != <[u8; 32]>::from(Sha256::digest(payload)) {
            return Err(BlobError::Corrupt("the checksum does not match".to_owned()));
        }
        if header[32..64] != origin.fingerprint {
            return Err(BlobError::Scenario);
        }
        let (snapshot, rest) = postcard::take_from_bytes::<Self>(payload)
            .map_err(|error| BlobError::Corrupt(error.to_string()))?;
        if !rest.is_empty() {
            return Err(BlobError::Corrupt(format!("{} bytes too many", rest.len())));
        }
        Ok(snapshot)
    }
}
