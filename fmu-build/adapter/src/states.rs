//! Stored states. The importer holds handles, the instance holds the states: a stale or foreign
//! handle is an error, and what was not freed goes with the instance.

use std::sync::atomic::{AtomicUsize, Ordering};

use lander_models::Component;

use crate::error::Error;
use crate::instance::{Instance, StoredState};
use crate::lifecycle::Lifecycle;
use crate::snapshot::{BlobError, Snapshot};

/// Opaque, never 0, unique in the process so that another instance does not know it.
pub type StateHandle = usize;

static NEXT: AtomicUsize = AtomicUsize::new(1);

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
        Ok(stored.snapshot.encode(&self.origin(stored.config.as_ref()))?)
    }

    /// Stores the state in `blob`. The running state is untouched until `set_state`.
    ///
    /// The files are not in the blob: this instance must name the same scenario, and reads it
    /// if it has not done so yet.
    pub fn deserialize_state(
        &mut self,
        blob: &[u8],
        reuse: Option<StateHandle>,
    ) -> Result<StateHandle, Error> {
        let snapshot = Snapshot::decode(blob, &self.origin(self.config.as_ref()))?;
        let created = snapshot.lifecycle != Lifecycle::Instantiated;
        if snapshot.inputs.len() != C::INTERFACE.input_len() || snapshot.state.is_some() != created
        {
            return Err(BlobError::Corrupt("its parts do not fit together".to_owned()).into());
        }
        let config = match (&snapshot.state, &self.config) {
            (None, _) => None,
            (Some(_), Some(config)) => Some(config.clone()),
            (Some(_), None) => Some(self.load()?.0.into()),
        };
        self.store(reuse, StoredState { config, snapshot })
    }

    fn store(
        &mut self,
        reuse: Option<StateHandle>,
        state: StoredState<C>,
    ) -> Result<StateHandle, Error> {
        let handle = match reuse {
            Some(known) if self.stored.contains_key(&known) => known,
            Some(_) => return Err(Error::UnknownState),
            // Relaxed: only uniqueness matters.
            None => NEXT.fetch_add(1, Ordering::Relaxed),
        };
        self.stored.insert(handle, state);
        Ok(handle)
    }
}
