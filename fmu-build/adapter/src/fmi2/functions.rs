//! The functions that FMI 2.0 has for itself; what it shares with 3.0 is in [`crate::c_abi`].
//!
//! SAFETY, the same for every `unsafe` below: the contract in `c_abi`.

#![expect(clippy::missing_safety_doc, reason = "one contract for all, in `c_abi`")]

use std::ffi::{CStr, c_int};

use lander_models::Component;

use super::{Boolean, CO_SIMULATION, Callbacks, LAST_SUCCESSFUL_TIME, TERMINATED, sink, uri};
use crate::c_abi::pointers::{place, utf8};
use crate::c_abi::{self, Handle, Status, Text, call};
use crate::instance::Events;
use crate::lifecycle::Call;
use crate::logger::Logger;
use crate::variables::Variant;
use crate::{Error, Instance};

pub unsafe fn instantiate<C: Component>(
    function: &str,
    name: Text,
    kind: c_int,
    token: Text,
    resources: Text,
    callbacks: *const Callbacks,
    logging: Boolean,
) -> Handle {
    let name = if name.is_null() { c"" } else { unsafe { CStr::from_ptr(name) } };
    let callbacks = unsafe { callbacks.as_ref() };
    let logger = || Logger::new(sink(name, callbacks), logging != 0);
    c_abi::instantiate::<C>(function, logger, || {
        if kind != CO_SIMULATION {
            return Err(Error::Unsupported);
        }
        let token = unsafe { utf8("fmuGUID", token) }?;
        let resources = if resources.is_null() {
            ""
        } else {
            unsafe { utf8("fmuResourceLocation", resources) }?
        };
        let resources = (!resources.is_empty()).then(|| uri::path(resources));
        Instance::new(&[Variant::Fmi2], token, resources, Events::Unheard, logger())
    })
}

pub unsafe fn setup_experiment<C: Component>(
    handle: Handle,
    function: &str,
    start_s: f64,
    stop_defined: Boolean,
    stop_s: f64,
) -> Status {
    let stop_s = (stop_defined != 0).then_some(stop_s);
    unsafe {
        call::<C>(handle, function, Call::EnterInitialization, |instance| {
            instance.set_experiment(start_s, stop_s)
        })
    }
}

pub unsafe fn enter_initialization_mode<C: Component>(handle: Handle, function: &str) -> Status {
    let body = Instance::<C>::enter_initialization;
    unsafe { call::<C>(handle, function, Call::EnterInitialization, body) }
}

/// FMI 2.0 has no other way to say that the run has ended: the step is complete, the status is
/// Discard, and `fmi2GetBooleanStatus` has the reason.
pub unsafe fn do_step<C: Component>(
    handle: Handle,
    function: &str,
    from_s: f64,
    duration_s: f64,
) -> Status {
    let mut ended = false;
    let status = unsafe {
        call::<C>(handle, function, Call::Step, |instance| {
            ended = instance.step(from_s, duration_s)?.report.terminate;
            Ok(())
        })
    };
    if ended { Status::Discard } else { status }
}

/// Time up to which the last step came.
pub unsafe fn get_real_status<C: Component>(
    handle: Handle,
    function: &str,
    kind: c_int,
    value: *mut f64,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::GetStatus, |instance| {
            let value = place("value", value)?;
            if kind != LAST_SUCCESSFUL_TIME {
                return Err(Error::StatusKind(kind));
            }
            *value = instance.now_s();
            Ok(())
        })
    }
}

/// Whether the run has reached its end.
pub unsafe fn get_boolean_status<C: Component>(
    handle: Handle,
    function: &str,
    kind: c_int,
    value: *mut Boolean,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::GetStatus, |instance| {
            let value = place("value", value)?;
            if kind != TERMINATED {
                return Err(Error::StatusKind(kind));
            }
            *value = Boolean::from(instance.has_ended());
            Ok(())
        })
    }
}

/// The other kinds tell of pending steps, and no step of this FMU is ever pending.
pub unsafe fn refuse_status<C: Component>(handle: Handle, function: &str, kind: c_int) -> Status {
    unsafe { call::<C>(handle, function, Call::GetStatus, |_| Err(Error::StatusKind(kind))) }
}
