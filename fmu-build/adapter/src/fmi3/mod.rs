//! FMI 3.0 Co-Simulation: C types and the functions behind the exported symbols.
//!
//! Each function only turns pointers into slices and calls [`Instance`]. All follow one
//! contract, which FMI 3.0 lays on the importer: a handle comes from `instantiate` of the same
//! component and was not freed; one call at a time is made on it; an array has the length passed
//! with it; a string ends with NUL. A null pointer is an error, never a crash.

mod boundary;
mod export;
mod pointers;

use std::ffi::{CStr, CString, c_char, c_void};

pub use boundary::*;

use crate::logger::{Category, Sink};

/// `fmi3Instance`, `fmi3FMUState`, `fmi3InstanceEnvironment`.
pub type Handle = *mut c_void;
/// `fmi3String`.
pub type Text = *const c_char;

/// `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

/// `fmi3LogMessageCallback`; null means that nobody listens.
pub type LogMessage =
    Option<unsafe extern "C" fn(environment: Handle, Status, category: Text, message: Text)>;

/// `fmi3GetVersion`.
pub const VERSION: &CStr = c"3.0";

/// Wraps the importer's callback.
fn sink(environment: Handle, log: LogMessage) -> Option<Sink> {
    let log = log?;
    Some(Box::new(move |category, message| {
        let status = match category {
            Category::Error => Status::Error,
            Category::Discard => Status::Discard,
            Category::Event => Status::Ok,
        };
        // FMI reads `#1000#` as a reference to a variable; a number sign is written `##`.
        let escaped = |text: &str| text.replace('\0', "?").replace('#', "##");
        let text = |text: &str| CString::new(escaped(text)).unwrap_or_default();
        let (category, message) = (text(category.name()), text(message));
        // SAFETY: callback and environment come from the importer as a pair; both strings live
        // through the call.
        unsafe { log(environment, status, category.as_ptr(), message.as_ptr()) }
    }))
}
