//! The functions that FMI 3.0 has for itself; what it shares with 2.0 is in [`crate::c_abi`].
//!
//! SAFETY, the same for every `unsafe` below: the contract in `c_abi`.

#![expect(clippy::missing_safety_doc, reason = "one contract for all, in `c_abi`")]
#![expect(clippy::too_many_arguments, reason = "as many as the C functions have")]

use lander_models::Component;

use super::{LogMessage, sink};
use crate::Instance;
use crate::c_abi::pointers::{place, utf8};
use crate::c_abi::{self, Handle, Status, Text, call};
use crate::instance::Events;
use crate::lifecycle::Call;
use crate::logger::Logger;
use crate::variables::Variant;

pub unsafe fn instantiate<C: Component>(
    function: &str,
    token: Text,
    resources: Text,
    logging: bool,
    events: Events,
    environment: Handle,
    log: LogMessage,
) -> Handle {
    let logger = || Logger::new(sink(environment, log), logging);
    c_abi::instantiate::<C>(function, logger, || {
        let token = unsafe { utf8("instantiationToken", token) }?;
        let resources =
            if resources.is_null() { "" } else { unsafe { utf8("resourcePath", resources) }? };
        let resources = (!resources.is_empty()).then(|| resources.into());
        Instance::new(&[Variant::Fmi3, Variant::Fmi3Arrays], token, resources, events, logger())
    })
}

/// Instantiation for an interface type that this FMU does not have.
pub fn refuse_instantiation(function: &str, environment: Handle, log: LogMessage) -> Handle {
    c_abi::refuse_instantiation(function, || Logger::new(sink(environment, log), false))
}

pub unsafe fn enter_initialization_mode<C: Component>(
    handle: Handle,
    function: &str,
    start_s: f64,
    stop_defined: bool,
    stop_s: f64,
) -> Status {
    let stop_s = stop_defined.then_some(stop_s);
    unsafe {
        call::<C>(handle, function, Call::EnterInitialization, |instance| {
            instance.set_experiment(start_s, stop_s)?;
            instance.enter_initialization()
        })
    }
}

pub unsafe fn do_step<C: Component>(
    handle: Handle,
    function: &str,
    from_s: f64,
    duration_s: f64,
    event: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    reached_s: *mut f64,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::Step, |instance| {
            let event = place("eventHandlingNeeded", event)?;
            let terminate = place("terminateSimulation", terminate)?;
            let early = place("earlyReturn", early)?;
            let reached_s = place("lastSuccessfulTime", reached_s)?;
            let stepped = instance.step(from_s, duration_s)?;
            (*event, *terminate) = (stepped.report.event, stepped.report.terminate);
            (*early, *reached_s) = (stepped.early, stepped.time_s);
            Ok(())
        })
    }
}

pub unsafe fn enter_event_mode<C: Component>(handle: Handle, function: &str) -> Status {
    unsafe { call::<C>(handle, function, Call::EnterEvent, Instance::<C>::enter_event_mode) }
}

pub unsafe fn enter_step_mode<C: Component>(handle: Handle, function: &str) -> Status {
    unsafe { call::<C>(handle, function, Call::InEvent, Instance::<C>::enter_step_mode) }
}

/// Nothing is left to update: an event has happened by the time it is told, and the next one is
/// not foreseen.
pub unsafe fn update_discrete_states<C: Component>(
    handle: Handle,
    function: &str,
    needs_update: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    values_changed: *mut bool,
    next_event_defined: *mut bool,
    next_event_s: *mut f64,
) -> Status {
    unsafe {
        call::<C>(handle, function, Call::InEvent, |instance| {
            let needs_update = place("discreteStatesNeedUpdate", needs_update)?;
            let terminate = place("terminateSimulation", terminate)?;
            let nominals = place("nominalsOfContinuousStatesChanged", nominals_changed)?;
            let values = place("valuesOfContinuousStatesChanged", values_changed)?;
            let next_defined = place("nextEventTimeDefined", next_event_defined)?;
            // Undefined, so not looked at, but a null pointer is a mistake all the same.
            place("nextEventTime", next_event_s)?;
            (*needs_update, *nominals, *values, *next_defined) = (false, false, false, false);
            *terminate = instance.has_ended();
            Ok(())
        })
    }
}
