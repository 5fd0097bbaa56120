//! FMI 3.0 Co-Simulation: C types and the functions behind the exported symbols.

mod export;
mod functions;

use std::ffi::CStr;

pub use functions::*;

use crate::c_abi::message_text;
pub use crate::c_abi::{Handle, Status, Text};
pub use crate::instance::Events;
use crate::logger::Sink;

/// `fmi3LogMessageCallback`; null means that nobody listens.
pub type LogMessage =
    Option<unsafe extern "C" fn(environment: Handle, Status, category: Text, message: Text)>;

/// `fmi3GetVersion`.
pub const VERSION: &CStr = c"3.0";

/// Wraps the importer's callback.
fn sink(environment: Handle, log: LogMessage) -> Option<Sink> {
    let log = log?;
    Some(Box::new(move |category, message| {
        let (name, message) = (message_text(category.name()), message_text(message));
        // SAFETY: callback and environment come from the importer as a pair; both strings live
        // through the call.
        unsafe { log(environment, category.status(), name.as_ptr(), message.as_ptr()) }
    }))
}
