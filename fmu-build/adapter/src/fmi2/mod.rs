//! FMI 2.0 Co-Simulation: C types and the functions behind the exported symbols.

mod export;
mod functions;
mod uri;

use std::ffi::{CStr, CString, c_int};

pub use functions::*;

use crate::c_abi::{Handle, Status, Text, message_text};
use crate::logger::Sink;

/// `fmi2Boolean`: any number but 0 is true.
pub type Boolean = c_int;

/// `fmi2GetVersion`.
pub const VERSION: &CStr = c"2.0";
/// `fmi2GetTypesPlatform`.
pub const TYPES_PLATFORM: &CStr = c"default";

/// `fmi2CallbackLogger`: `message` is a format as of printf.
pub type LogMessage = Option<
    unsafe extern "C" fn(
        environment: Handle,
        instance_name: Text,
        Status,
        category: Text,
        message: Text,
        ...
    ),
>;

/// `fmi2CallbackFunctions`; memory is not taken from the importer and steps are never pending.
#[repr(C)]
pub struct Callbacks {
    pub logger: LogMessage,
    pub allocate_memory: Handle,
    pub free_memory: Handle,
    pub step_finished: Handle,
    pub environment: Handle,
}

/// `fmi2Type`.
const CO_SIMULATION: c_int = 1;

/// `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
const TERMINATED: c_int = 3;

/// Wraps the importer's callback. The message is its own format, percent signs doubled: a
/// logger that takes no further arguments, as from a scripting language, shows it too.
fn sink(name: &CStr, callbacks: Option<&Callbacks>) -> Option<Sink> {
    let (log, environment) = (callbacks?.logger?, callbacks?.environment);
    let name = CString::from(name);
    Some(Box::new(move |category, message| {
        let message = message_text(&message.replace('%', "%%"));
        let (status, category) = (category.status(), message_text(category.name()));
        // SAFETY: callback and environment come from the importer as a pair; all strings live
        // through the call; the format asks for no arguments.
        unsafe { log(environment, name.as_ptr(), status, category.as_ptr(), message.as_ptr()) }
    }))
}
