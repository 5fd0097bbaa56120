//! The functions behind exported symbols of both versions. `function` is the symbol's name.
//!
//! SAFETY, the same for every `unsafe` below: the contract in the parent module.

#![expect(clippy::missing_safety_doc, reason = "one contract for all, in the parent module")]

use std::ptr;

use lander_models::Component;

use super::pointers::{array, array_mut, c_string, place, utf8};
use super::{Handle, Status, Text};
use crate::instance::Answer;
use crate::lifecycle::Call;
use crate::logger::Logger;
use crate::variables::Slot;
use crate::{Error, Instance, guard};

/// Runs `body` on the instance that `handle` points to.
pub unsafe fn call<C: Component>(
    handle: Handle,
    function: &str,
    kind: Call,
    body: impl FnOnce(&mut Instance<C>) -> Result<(), Error>,
) -> Status {
    let instance = unsafe { handle.cast::<Instance<C>>().as_mut() };
    // A null handle has no logger to tell.
    let answer = instance.map_or(Answer::Error, |instance| instance.run(function, kind, body));
    match answer {
        Answer::Done => Status::Ok,
        Answer::Discard => Status::Discard,
        Answer::Error => Status::Error,
    }
}

/// What `make` makes, as a handle; null and a message if it fails.
pub fn instantiate<C: Component>(
    function: &str,
    logger: impl Fn() -> Logger,
    make: impl FnOnce() -> Result<Instance<C>, Error>,
) -> Handle {
    match guard::catch(make).unwrap_or_else(|message| Err(Error::Panic(message))) {
        Ok(instance) => Box::into_raw(Box::new(instance)).cast(),
        Err(error) => {
            // There is nobody else to tell of a panic.
            let _ = guard::catch(|| logger().error(&format!("{function}: {error}")));
            ptr::null_mut()
        }
    }
}

pub unsafe fn free_instance<C: Component>(handle: Handle, function: &str) {
    if handle.is_null() {
        return;
    }
    let mut instance = unsafe { Box::from_raw(handle.cast::<Instance<C>>()) };
    let logger = std::mem::take(&mut instance.logger);
    if let Err(message) = guard::catch(|| drop(instance)) {
        logger.error(&format!("{function}: {}", Error::Panic(message)));
    }
}

pub unsafe fn set_debug_logging<C: Component>(
    handle: Handle,
    function: &str,
    on: bool,
    count: usize,
    categories: *const Text,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::SetDebugLogging, |instance| {
            let categories = array("categories", categories, count)?;
            let names = categories.iter().map(|text| utf8("categories[]", *text));
            instance.logger.select(on, &names.collect::<Result<Vec<_>, _>>()?)
        })
    }
}

pub unsafe fn exit_initialization_mode<C: Component>(handle: Handle, function: &str) -> Status {
    let body = Instance::<C>::exit_initialization;
    unsafe { call::<C>(handle, function, Call::ExitInitialization, body) }
}

pub unsafe fn terminate<C: Component>(handle: Handle, function: &str) -> Status {
    unsafe { call::<C>(handle, function, Call::Terminate, Instance::<C>::terminate) }
}

pub unsafe fn reset<C: Component>(handle: Handle, function: &str) -> Status {
    unsafe { call::<C>(handle, function, Call::Reset, Instance::<C>::reset) }
}

pub unsafe fn get_reals<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Get, |instance| {
            let slots = slots(instance, references, count, instance.real_type(), value_count)?;
            instance.get_floats(&slots, array_mut("values", values, value_count)?)
        })
    }
}

pub unsafe fn set_reals<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Set, |instance| {
            let slots = slots(instance, references, count, instance.real_type(), value_count)?;
            instance.set_floats(&slots, array("values", values, value_count)?)
        })
    }
}

pub unsafe fn get_strings<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *mut Text,
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Get, |instance| {
            let slots = slots(instance, references, count, "String", value_count)?;
            let values = array_mut("values", values, value_count)?;
            for (value, text) in values.iter_mut().zip(instance.get_strings(&slots)) {
                *value = text.as_ptr();
            }
            Ok(())
        })
    }
}

pub unsafe fn set_strings<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *const Text,
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Set, |instance| {
            let slots = slots(instance, references, count, "String", value_count)?;
            let values = array("values", values, value_count)?;
            let texts = values.iter().map(|text| c_string("values[]", *text));
            instance.set_strings(&slots, &texts.collect::<Result<Vec<_>, _>>()?)
        })
    }
}

/// Each version has its own Boolean.
pub unsafe fn get_booleans<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *mut impl From<bool>,
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Get, |instance| {
            let slots = slots(instance, references, count, "Boolean", value_count)?;
            let values = array_mut("values", values, value_count)?;
            for (value, found) in values.iter_mut().zip(instance.get_booleans(&slots)) {
                *value = found.into();
            }
            Ok(())
        })
    }
}

/// Read as numbers, 0 for false: a C `bool` of another value would be no valid Rust one.
pub unsafe fn set_booleans<C: Component>(
    handle: Handle,
    function: &str,
    references: *const u32,
    count: usize,
    values: *const (impl Copy + Into<i32>),
    value_count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Set, |instance| {
            let slots = slots(instance, references, count, "Boolean", value_count)?;
            let values = array("values", values, value_count)?;
            let values = values.iter().map(|value| (*value).into() != 0);
            instance.set_booleans(&slots, &values.collect::<Vec<_>>())
        })
    }
}

/// Get or set of a type that no variable has: an error that names the first variable.
pub unsafe fn refuse_type<C: Component>(
    handle: Handle,
    function: &str,
    data_type: &'static str,
    references: *const u32,
    count: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Unsupported, |instance| {
            slots(instance, references, count, data_type, count).map(|_| ())
        })
    }
}

unsafe fn slots<C: Component>(
    instance: &Instance<C>,
    references: *const u32,
    count: usize,
    data_type: &'static str,
    value_count: usize,
) -> Result<Vec<Slot>, Error> {
    let references = unsafe { array("valueReferences", references, count) }?;
    instance.slots(references, data_type, value_count)
}

pub unsafe fn get_fmu_state<C: Component>(
    handle: Handle,
    function: &str,
    state: *mut Handle,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::GetState, |instance| {
            let state = place("FMUState", state)?;
            let kept = instance.get_state(known(*state))?;
            *state = ptr::without_provenance_mut(kept);
            Ok(())
        })
    }
}

pub unsafe fn set_fmu_state<C: Component>(handle: Handle, function: &str, state: Handle) -> Status {
    unsafe {
        call::<C>(handle, function, Call::SetState, |instance| instance.set_state(state.addr()))
    }
}

/// A null state is ignored, as FMI asks.
pub unsafe fn free_fmu_state<C: Component>(
    handle: Handle,
    function: &str,
    state: *mut Handle,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::StoredState, |instance| {
            let state = place("FMUState", state)?;
            known(*state).map_or(Ok(()), |kept| instance.free_state(kept))?;
            *state = ptr::null_mut();
            Ok(())
        })
    }
}

pub unsafe fn serialized_fmu_state_size<C: Component>(
    handle: Handle,
    function: &str,
    state: Handle,
    size: *mut usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::StoredState, |instance| {
            let size = place("size", size)?;
            *size = instance.serialize_state(state.addr())?.len();
            Ok(())
        })
    }
}

pub unsafe fn serialize_fmu_state<C: Component>(
    handle: Handle,
    function: &str,
    state: Handle,
    bytes: *mut u8,
    size: usize,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::StoredState, |instance| {
            let blob = instance.serialize_state(state.addr())?;
            if size != blob.len() {
                return Err(Error::BlobSize { given: size, expected: blob.len() });
            }
            array_mut("serializedState", bytes, size)?.copy_from_slice(&blob);
            Ok(())
        })
    }
}

pub unsafe fn deserialize_fmu_state<C: Component>(
    handle: Handle,
    function: &str,
    bytes: *const u8,
    size: usize,
    state: *mut Handle,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::StoredState, |instance| {
            let blob = array("serializedState", bytes, size)?;
            let state = place("FMUState", state)?;
            *state = ptr::without_provenance_mut(instance.deserialize_state(blob, known(*state))?);
            Ok(())
        })
    }
}

/// Instantiation for an interface type that this FMU does not have.
pub fn refuse_instantiation(function: &str, logger: impl Fn() -> Logger) -> Handle {
    // There is nobody else to tell of a panic.
    let _ = guard::catch(|| logger().error(&format!("{function}: {}", Error::Unsupported)));
    ptr::null_mut()
}

/// A function that no declared capability allows.
pub unsafe fn unsupported<C: Component>(handle: Handle, function: &str) -> Status {
    unsafe { call::<C>(handle, function, Call::Unsupported, |_| Err(Error::Unsupported)) }
}

fn known(state: Handle) -> Option<usize> {
    (!state.is_null()).then(|| state.addr())
}
