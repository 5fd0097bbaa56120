//! The functions that FMI 3.0 has for itself; what it shares with 2.0 is in [`crate::c_abi`].
//!
//! SAFETY, the same for every `unsafe` below: the contract in `c_abi`.

#![expect(clippy::missing_safety_doc, reason = "one contract for all, in `c_abi`")]

use lander_models::Component;

use super::{LogMessage, sink};
use crate::c_abi::pointers::{place, utf8};
use crate::c_abi::{self, Handle, Status, Text, call};
use crate::lifecycle::Call;
use crate::logger::Logger;
use crate::variables::Variant;
use crate::{Error, Instance};

pub unsafe fn instantiate<C: Component>(
    function: &str,
    token: Text,
    resources: Text,
    logging: bool,
    event_mode: bool,
    environment: Handle,
    log: LogMessage,
) -> Handle {
    let logger = || Logger::new(sink(environment, log), logging);
    c_abi::instantiate::<C>(function, logger, || {
        if event_mode {
            return Err(Error::EventMode);
        }
        let token = unsafe { utf8("instantiationToken", token) }?;
        let resources =
            if resources.is_null() { "" } else { unsafe { utf8("resourcePath", resources) }? };
        let resources = (!resources.is_empty()).then(|| resources.into());
        Instance::new(&[Variant::Fmi3, Variant::Fmi3Arrays], token, resources, logger())
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
            (*event, *terminate, *early) = (false, stepped.report.terminate, false);
            *reached_s = stepped.time_s;
            Ok(())
        })
    }
}
