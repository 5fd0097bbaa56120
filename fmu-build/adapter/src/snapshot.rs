//! The changing part of an instance, and its serialised form.
//!
//! | bytes | content |
//! |---|---|
//! | 0..32 | interface hash |
//! | 32..64 | fingerprint of the configuration; zeros if there is none yet |
//! | 64..96 | SHA-256 of the payload |
//! | 96..104 | payload length, u64 little-endian |
//! | 104.. | payload: [`Snapshot`] in postcard |

use std::ffi::{CStr, CString};
use std::fmt::Debug;

use lander_models::Ticks;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::lifecycle::Lifecycle;
use crate::variables::{DEFAULT_SCENARIO, Slot};

/// SHA-256.
pub type Hash = [u8; 32];

/// All that a restart needs besides the files that `scenario_file` leads to.
#[derive(Clone, Serialize, Deserialize)]
pub struct Snapshot<S> {
    pub lifecycle: Lifecycle,
    pub parameters: Parameters,
    pub now: Ticks,
    /// No step may pass it.
    pub stop: Ticks,
    /// The last step asked for the end of the run.
    pub ended: bool,
    pub inputs: Vec<f64>,
    /// Present from Initialization Mode on.
    pub state: Option<S>,
}

/// Parameters as set.
#[derive(Clone, Serialize, Deserialize)]
pub struct Parameters {
    /// C strings because importers get pointers to them.
    pub scenario_file: CString,
    pub scenario_changes: CString,
    pub terminate_at_end: bool,
}

impl Parameters {
    /// Of the two strings.
    pub fn text(&self, slot: Slot) -> &CStr {
        if slot == Slot::Changes { &self.scenario_changes } else { &self.scenario_file }
    }

    pub fn set_text(&mut self, slot: Slot, value: &CStr) {
        let place = match slot {
            Slot::Changes => &mut self.scenario_changes,
            _ => &mut self.scenario_file,
        };
        *place = value.to_owned();
    }
}

/// Start values. Several importers take a run that asks for its end for a failure (FMI 2.0 has no
/// other way than to discard the step): it has to be asked for.
impl Default for Parameters {
    fn default() -> Self {
        let scenario_file = CString::new(DEFAULT_SCENARIO).unwrap_or_default();
        Self { scenario_file, scenario_changes: CString::default(), terminate_at_end: false }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum BlobError {
    #[error("{given} bytes, {expected} expected: truncated or extended")]
    Length { given: usize, expected: usize },
    #[error("written by another model or another version of its interface")]
    Foreign,
    #[error("written under another configuration than scenario_file \"{scenario_file}\" gives now")]
    Configuration { scenario_file: String },
    #[error("corrupt: {0}")]
    Corrupt(String),
}

const HEADER: usize = 104;

/// In place of a fingerprint before Initialization Mode, when no file has been read.
pub const NO_CONFIGURATION: Hash = [0; 32];

/// Identifies a component's whole configuration, whichever files it was read from. `Debug`
/// writes an f64 so that it reads back to the same bits.
pub fn fingerprint(component: &impl Debug) -> Hash {
    Sha256::digest(format!("{component:?}")).into()
}

impl<S: Serialize + DeserializeOwned> Snapshot<S> {
    pub fn encode(&self, interface: &Hash, fingerprint: &Hash) -> Result<Vec<u8>, BlobError> {
        let payload = postcard::to_allocvec(self).map_err(|e| BlobError::Corrupt(e.to_string()))?;
        let mut blob = Vec::with_capacity(HEADER + payload.len());
        blob.extend(interface);
        blob.extend(fingerprint);
        blob.extend(Hash::from(Sha256::digest(&payload)));
        blob.extend((payload.len() as u64).to_le_bytes());
        blob.extend(payload);
        Ok(blob)
    }

    /// The snapshot and the fingerprint that it was written with; refuses what `encode` did not
    /// write for the same `interface`.
    pub fn decode(blob: &[u8], interface: &Hash) -> Result<(Self, Hash), BlobError> {
        let given = blob.len();
        let Some((header, payload)) = blob.split_at_checked(HEADER) else {
            return Err(BlobError::Length { given, expected: HEADER });
        };
        if header[..32] != *interface {
            return Err(BlobError::Foreign);
        }
        let length = header[96..].iter().rev().fold(0_u64, |n, byte| n << 8 | u64::from(*byte));
        if length != payload.len() as u64 {
            let expected = usize::try_from(length).map_or(usize::MAX, |n| n.saturating_add(HEADER));
            return Err(BlobError::Length { given, expected });
        }
        if header[64..96] != Hash::from(Sha256::digest(payload)) {
            return Err(BlobError::Corrupt("the checksum does not match".to_owned()));
        }
        let (snapshot, rest) = postcard::take_from_bytes::<Self>(payload)
            .map_err(|error| BlobError::Corrupt(error.to_string()))?;
        if !rest.is_empty() {
            return Err(BlobError::Corrupt(format!("{} bytes too many", rest.len())));
        }
        let mut fingerprint = NO_CONFIGURATION;
        fingerprint.copy_from_slice(&header[32..64]);
        Ok((snapshot, fingerprint))
    }
}
