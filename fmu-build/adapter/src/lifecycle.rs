//! The states of an instance, and which call is allowed in which.

use serde::{Deserialize, Serialize};

/// Values are bits, so that a set of states is a mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Lifecycle {
    Instantiated = 1,
    /// "Initialization Mode": the component exists, outputs can be read.
    Initialization = 2,
    /// "Step Mode".
    Stepping = 4,
    Terminated = 8,
    /// After a panic or a failed step the component's state can't be trusted.
    Failed = 16,
    /// "Event Mode", of importers that asked for it.
    Event = 32,
}

impl Lifecycle {
    /// Name for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "Instantiated",
            Self::Initialization => "Initialization Mode",
            Self::Stepping => "Step Mode",
            Self::Terminated => "Terminated",
            Self::Failed => "Failed",
            Self::Event => "Event Mode",
        }
    }
}

/// A kind of call, whatever the FMI version names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    SetDebugLogging,
    EnterInitialization,
    ExitInitialization,
    Get,
    Set,
    Step,
    EnterEvent,
    /// Update of discrete states, and the way back to steps.
    InEvent,
    /// FMI 2.0: what came of the last step.
    GetStatus,
    Terminate,
    Reset,
    GetState,
    SetState,
    /// Free, serialise and deserialise touch stored states only, not the running one.
    StoredState,
    Unsupported,
}

const INSTANTIATED: u8 = Lifecycle::Instantiated as u8;
const INITIALIZATION: u8 = Lifecycle::Initialization as u8;
const STEPPING: u8 = Lifecycle::Stepping as u8;
const TERMINATED: u8 = Lifecycle::Terminated as u8;
const EVENT: u8 = Lifecycle::Event as u8;
const HEALTHY: u8 = INSTANTIATED | INITIALIZATION | STEPPING | EVENT | TERMINATED;
const ANY: u8 = HEALTHY | Lifecycle::Failed as u8;

impl Call {
    /// THE table (FMI 3.0.2, sections 2.3 and 4.2).
    const fn mask(self) -> u8 {
        match self {
            Self::SetDebugLogging => ANY,
            Self::EnterInitialization => INSTANTIATED,
            Self::ExitInitialization => INITIALIZATION,
            // Before Initialization Mode start values only: see `get_floats`.
            Self::Get => HEALTHY,
            Self::Set => INSTANTIATED | INITIALIZATION | STEPPING | EVENT,
            Self::Step | Self::EnterEvent => STEPPING,
            Self::InEvent => EVENT,
            Self::GetStatus => STEPPING | TERMINATED,
            Self::Terminate => STEPPING | EVENT,
            Self::Reset => ANY,
            Self::GetState => HEALTHY,
            Self::SetState => ANY,
            Self::StoredState => ANY,
            Self::Unsupported => ANY,
        }
    }

    pub fn allowed_in(self, state: Lifecycle) -> bool {
        self.mask() & state as u8 != 0
    }
}
