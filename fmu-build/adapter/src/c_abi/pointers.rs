//! Importer's pointers to Rust references; a null pointer is an error that names it.

use std::ffi::CStr;
use std::slice;

use super::Text;
use crate::Error;

/// # Safety
/// `data` is null or points to `count` values that nobody writes while the slice lives.
pub unsafe fn array<'a, T>(
    what: &'static str,
    data: *const T,
    count: usize,
) -> Result<&'a [T], Error> {
    match (data.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(Error::Null { what }),
        // SAFETY: not null; the rest is the caller's promise.
        (false, _) => Ok(unsafe { slice::from_raw_parts(data, count) }),
    }
}

/// # Safety
/// `data` is null or points to `count` values that nobody else touches while the slice lives.
pub unsafe fn array_mut<'a, T>(
    what: &'static str,
    data: *mut T,
    count: usize,
) -> Result<&'a mut [T], Error> {
    match (data.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(Error::Null { what }),
        // SAFETY: not null; the rest is the caller's promise.
        (false, _) => Ok(unsafe { slice::from_raw_parts_mut(data, count) }),
    }
}

/// A place for one result: an importer may pass the same for several, so it is no reference.
pub fn place<T>(what: &'static str, target: *mut T) -> Result<*mut T, Error> {
    if target.is_null() { Err(Error::Null { what }) } else { Ok(target) }
}

/// # Safety
/// `text` is null or points to a NUL-terminated string that lives long enough.
pub unsafe fn c_string<'a>(what: &'static str, text: Text) -> Result<&'a CStr, Error> {
    if text.is_null() {
        return Err(Error::Null { what });
    }
    // SAFETY: not null; the rest is the caller's promise.
    Ok(unsafe { CStr::from_ptr(text) })
}

/// # Safety
/// As [`c_string`].
pub unsafe fn utf8<'a>(what: &'static str, text: Text) -> Result<&'a str, Error> {
    // SAFETY: the caller's promise.
    let text = unsafe { c_string(what, text) }?;
    text.to_str().map_err(|_| Error::NotUtf8 { what: what.to_owned() })
}
