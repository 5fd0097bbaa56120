//! The C side that FMI 2.0 and 3.0 share.
//!
//! Each function only turns pointers into slices and calls [`Instance`](crate::Instance). All
//! follow one contract, which FMI lays on the importer: a handle comes from `instantiate` of the
//! same component and was not freed; one call at a time is made on it; an array has the length
//! passed with it; a string ends with NUL. A null pointer is an error, never a crash.

mod export;
mod functions;
pub(crate) mod pointers;

use std::ffi::{CString, c_char, c_void};

pub use functions::*;

use crate::logger::Category;

/// `fmi2Component`, `fmi3Instance`, a stored state, the importer's environment.
pub type Handle = *mut c_void;
/// `fmi2String`, `fmi3String`.
pub type Text = *const c_char;

/// `fmi2Status`, `fmi3Status`: the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

impl Category {
    /// The status that a message is sent with.
    pub(crate) fn status(self) -> Status {
        match self {
            Self::Error => Status::Error,
            Self::Discard => Status::Discard,
            Self::Event => Status::Ok,
        }
    }
}

/// A message as a C string. FMI reads `#1000#` as a reference to a variable; a number sign is
/// written `##`.
pub(crate) fn message_text(text: &str) -> CString {
    CString::new(text.replace('\0', "?").replace('#', "##")).unwrap_or_default()
}
