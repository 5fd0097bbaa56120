//! Event Mode and early return of FMI 3.0.

use std::ptr;

use fmi_adapter::fmi3::{Events, Status};

use crate::harness::{Importer, Resources};
use crate::integrator::{END, EVENT, RATE_1, TROUBLE, X_1};

/// (status, terminate) of fmi3UpdateDiscreteStates, whose other answers are always false.
fn update(importer: &Importer) -> (Status, bool) {
    let (mut needs, mut end, mut nominals, mut values) = (true, true, true, true);
    let (mut next, mut next_s) = (true, 0.0);
    let status = unsafe {
        crate::fmi3UpdateDiscreteStates(
            importer.instance,
            &mut needs,
            &mut end,
            &mut nominals,
            &mut values,
            &mut next,
            &mut next_s,
        )
    };
    assert!(status != Status::Ok || [needs, nominals, values, next] == [false; 4]);
    (status, end)
}

fn enter_step_mode(importer: &Importer) -> Status {
    unsafe { crate::fmi3EnterStepMode(importer.instance) }
}

/// In Step Mode, by way of the Event Mode that follows initialisation.
fn stepping(resources: &Resources, events: Events) -> Importer {
    let importer = Importer::hearing(resources, events);
    assert_eq!(importer.set_terminate_at_end(), Status::Ok);
    importer.start();
    importer.refused(importer.step(0.0, 0.01).0, "not allowed in state Event Mode");
    assert_eq!(update(&importer), (Status::Ok, false));
    assert_eq!(enter_step_mode(&importer), Status::Ok);
    importer
}

#[test]
fn a_step_returns_early_at_an_event_and_goes_on_from_there() {
    let resources = Resources::new();
    let importer = stepping(&resources, Events::ReturnEarly);
    importer.set(TROUBLE, EVENT);
    assert_eq!(importer.step(0.0, 0.01), (Status::Ok, true, false, true, 0.003));
    // x starts at 2, and grows by 2 · 0.5 a second.
    assert_eq!(importer.get([0, X_1]), [0.003, 2.0 + 2.0 * 0.5 * 0.003]);

    assert_eq!(unsafe { crate::fmi3EnterEventMode(importer.instance) }, Status::Ok);
    importer.refused(importer.step(0.003, 0.007).0, "not allowed in state Event Mode");
    assert_eq!(importer.set(TROUBLE, 0.0), Status::Ok);
    assert_eq!(importer.get([0, TROUBLE]), [0.003, 0.0]);
    assert_eq!(update(&importer), (Status::Ok, false));
    assert_eq!(enter_step_mode(&importer), Status::Ok);
    assert_eq!(importer.step(0.003, 0.007), (Status::Ok, false, false, false, 0.01));
}

#[test]
fn without_early_return_the_event_is_told_at_the_end_of_the_step() {
    let resources = Resources::new();
    let importer = stepping(&resources, Events::AtStepEnd);
    importer.set(TROUBLE, EVENT);
    assert_eq!(importer.step(0.0, 0.01), (Status::Ok, true, false, false, 0.01));
    importer.set(TROUBLE, END);
    assert_eq!(importer.step(0.01, 0.01), (Status::Ok, false, true, false, 0.02));
    assert_eq!(unsafe { crate::fmi3EnterEventMode(importer.instance) }, Status::Ok);
    assert_eq!(update(&importer), (Status::Ok, true));
    assert_eq!(unsafe { crate::fmi3Terminate(importer.instance) }, Status::Ok);
}

#[test]
fn event_mode_has_to_be_asked_for() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let fmu = importer.instance;
    importer.refused(unsafe { crate::fmi3EnterEventMode(fmu) }, "eventModeUsed was false");
    importer.refused(update(&importer).0, "not allowed in state Step Mode");
    importer.refused(enter_step_mode(&importer), "not allowed in state Step Mode");

    let importer = stepping(&resources, Events::AtStepEnd);
    assert_eq!(unsafe { crate::fmi3EnterEventMode(importer.instance) }, Status::Ok);
    let null = ptr::null_mut();
    let status = unsafe {
        crate::fmi3UpdateDiscreteStates(
            importer.instance,
            null,
            null,
            null,
            null,
            null,
            null.cast(),
        )
    };
    importer.refused(status, "discreteStatesNeedUpdate is a null pointer");
}

#[test]
fn a_state_taken_in_event_mode_leads_back_to_it() {
    let resources = Resources::new();
    let importer = stepping(&resources, Events::ReturnEarly);
    importer.set(RATE_1, 4.0);
    unsafe { crate::fmi3EnterEventMode(importer.instance) };
    let state = importer.get_state();
    enter_step_mode(&importer);
    importer.step(0.0, 0.01);
    assert_eq!(importer.set_state(state), Status::Ok);
    assert_eq!(importer.get([0, RATE_1]), [0.0, 4.0]);
    assert_eq!(enter_step_mode(&importer), Status::Ok);
}
