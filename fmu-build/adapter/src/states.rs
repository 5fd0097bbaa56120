//! Stored states. The importer holds handles, the instance holds the states: a stale or foreign
//! handle is an error, and what was not freed goes with the instance.

use std::sync::atomic::{AtomicUsize, Ordering};

use lander_models::Component;

use crate::error::Error;
use crate::instance::{Instance, StoredState};
use crate::lifecycle::Lifecycle;
use crate::snapshot::{BlobError, Snapshot};

/// Opaque, never 0, unique in the process so that no other instance of any FMU knows it.
pub type StateHandle = usize;

/// Each library has a counter of its own. Where it starts follows from the counter's address,
/// spread over all bits (Fibonacci hashing), so that no two libraries count in the same range.
fn new_handle() -> StateHandle {
    static TAKEN: AtomicUsize = AtomicUsize::new(0);
    let start = (&raw const TAKEN).addr().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 1;
    // Relaxed: only uniqueness matters.
    start + 1 + TAKEN.fetch_add(1, Ordering::Relaxed)
}

impl<C: Component> Instance<C> {
    /// Stores the current state, under `reuse` if that is a handle of this instance.
    pub fn get_state(&mut self, reuse: Option<StateHandle>) -> Result<StateHandle, Error> {
        let state = StoredState { config: self.config.clone(), snapshot: self.live.clone() };
        self.store(reuse, state)
    }

    pub fn set_state(&mut self, handle: StateHandle) -> Result<(), Error> {
        let stored = self.stored.get(&handle).ok_or(Error::UnknownState)?;
        self.live = stored.snapshot.clone();
        self.config = stored.config.clone();
        self.refresh_outputs();
        Ok(())
    }

    pub fn free_state(&mut self, handle: StateHandle) -> Result<(), Error> {
        self.stored.remove(&handle).map(|_| ()).ok_or(Error::UnknownState)
    }

    /// Layout: see [`crate::snapshot`].
    pub fn serialize_state(&self, handle: StateHandle) -> Result<Vec<u8>, Error> {
        let stored = self.stored.get(&handle).ok_or(Error::UnknownState)?;
        Ok(stored.snapshot.encode(&self.interface, &stored.fingerprint())?)
    }

    /// Stores the state in `blob`. The running state is untouched until `set_state`.
    ///
    /// The configuration is not in the blob, its fingerprint and the scenario's name are. This
    /// instance's own configuration is used if it is the same; otherwise the scenario is read.
    pub fn deserialize_state(
        &mut self,
        blob: &[u8],
        reuse: Option<StateHandle>,
    ) -> Result<StateHandle, Error> {
        let (snapshot, fingerprint) = Snapshot::decode(blob, &self.interface)?;
        let created = snapshot.lifecycle != Lifecycle::Instantiated;
        if snapshot.inputs.len() != C::INTERFACE.input_len() || snapshot.state.is_some() != created
        {
            return Err(BlobError::Corrupt("its parts do not fit together".to_owned()).into());
        }
        let config = match &self.config {
            _ if !created => None,
            Some(own) if own.fingerprint == fingerprint => Some(own.clone()),
            _ => Some(self.load(&snapshot.parameters)?.0),
        };
        let state = StoredState { config, snapshot };
        if state.fingerprint() != fingerprint {
            let scenario_file =
                state.snapshot.parameters.scenario_file.to_string_lossy().into_owned();
            return Err(BlobError::Configuration { scenario_file }.into());
        }
        self.store(reuse, state)
    }

    fn store(
        &mut self,
        reuse: Option<StateHandle>,
        state: StoredState<C>,
    ) -> Result<StateHandle, Error> {
        let handle = match reuse {
            Some(known) if self.stored.contains_key(&known) => known,
            Some(_) => return Err(Error::UnknownState),
            None => new_handle(),
        };
        self.stored.insert(handle, state);
        Ok(handle)
    }
}
