//! Each misuse is an error whose message names the culprit, and changes nothing.

use std::ptr;

use fmi_adapter::fmi3::Status;

use crate::harness::{Importer, Resources, collect};
use crate::integrator::{MASS_KG, RATE_1, RATE_2, X_1};

/// Value reference of `terminate_at_end`.
const TERMINATE: u32 = 2;

#[test]
fn values() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let fmu = importer.instance;
    for value in [f64::NAN, f64::INFINITY] {
        importer.refused(importer.set(RATE_2, value), "fmi3SetFloat64: rate[2] = ");
    }
    let part = "fmi3SetFloat64: mass_kg = -1: must be within 0e0 and 1e6";
    importer.refused(importer.set(MASS_KG, -1.0), part);
    importer.refused(importer.set(X_1, 1.0), "x[1] (value reference 2000) is output");
    importer.refused(importer.set(0, 1.0), "time (value reference 0) is independent");
    importer.refused(importer.set(777, 1.0), "value reference 777 is unknown");
    importer.refused(importer.set(1, 1.0), "scenario_file (value reference 1) is of type String");
    importer.refused(importer.set_scenario("x"), "scenario_file is a fixed parameter");
    importer.refused(importer.try_get(&[X_1, 4], &mut [0.0; 2]), "value reference 4 is unknown");
    importer.refused(importer.try_get(&[X_1], &mut [0.0; 2]), "nValues is 2, but x[1] need 1");
    importer.refused(importer.try_get(&[RATE_1, X_1], &mut [0.0]), "rate[1] and 1 more");
    unsafe {
        importer.refused(
            crate::fmi3SetString(fmu, &X_1, 1, &c"x".as_ptr(), 1),
            "x[1] (value reference 2000) is of type Float64, not String",
        );
        // The second value is not looked at, wherever it points to.
        let wild = [c"x".as_ptr(), ptr::without_provenance(1)];
        importer.refused(
            crate::fmi3SetString(fmu, &1, 1, wild.as_ptr(), 2),
            "nValues is 2, but scenario_file need 1",
        );
        importer.refused(
            crate::fmi3SetFloat64(fmu, &RATE_1, 1, ptr::without_provenance(8), 2),
            "nValues is 2, but rate[1] need 1",
        );
        let (refs, flags) = ([TERMINATE, TERMINATE], [0_u8, 1]);
        importer.refused(
            crate::fmi3SetBoolean(fmu, refs.as_ptr(), 2, flags.as_ptr(), 2),
            "terminate_at_end is a fixed parameter",
        );
        importer.refused(
            crate::fmi3GetInt32(fmu, &X_1, 1, &mut 0, 1),
            "fmi3GetInt32: x[1] (value reference 2000) is of type Float64, not Int32",
        );
        let pair = [RATE_1, X_1];
        importer
            .refused(crate::fmi3SetFloat64(fmu, pair.as_ptr(), 2, [9.0, 9.0].as_ptr(), 2), "x[1]");
    }
    assert_eq!(importer.get([RATE_1, RATE_2]), [0.5, 0.5], "a refused set changed an input");
    assert_eq!(importer.step(0.0, 0.001).0, Status::Ok, "a refused call broke the instance");
}

#[test]
fn not_utf8() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    let status = unsafe { crate::fmi3SetString(importer.instance, &1, 1, &c"\xff".as_ptr(), 1) };
    importer.refused(status, "scenario_file is not valid UTF-8");
}

#[test]
fn null_pointers() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let fmu = importer.instance;
    unsafe {
        let null = ptr::null_mut();
        let refs: *const u32 = &X_1;
        let refused = |status, part| importer.refused(status, part);
        refused(crate::fmi3GetFloat64(fmu, ptr::null(), 1, &mut 0.0, 1), "valueReferences");
        refused(crate::fmi3GetFloat64(fmu, refs, 1, ptr::null_mut(), 1), "values");
        refused(crate::fmi3SetFloat64(fmu, refs, 1, ptr::null(), 1), "values");
        refused(crate::fmi3GetString(fmu, &1, 1, ptr::null_mut(), 1), "values");
        refused(crate::fmi3SetString(fmu, &1, 1, &ptr::null(), 1), "values[]");
        refused(crate::fmi3GetFMUState(fmu, ptr::null_mut()), "FMUState is a null");
        refused(crate::fmi3SetFMUState(fmu, null), "FMUState is not a state");
        refused(crate::fmi3FreeFMUState(fmu, ptr::null_mut()), "FMUState is a null");
        refused(crate::fmi3SetDebugLogging(fmu, true, 1, ptr::null()), "categories");
        let (mut flag, mut time) = (false, 0.0);
        let flag: *mut bool = &mut flag;
        refused(
            crate::fmi3DoStep(fmu, 0.0, 0.1, true, flag, ptr::null_mut(), flag, &mut time),
            "terminateSimulation",
        );

        // Nobody to tell, but no crash either.
        assert_eq!(crate::fmi3Reset(null), Status::Error);
        assert_eq!(crate::fmi3GetFloat64(null, refs, 1, &mut time, 1), Status::Error);
        assert_eq!(crate::fmi3SetTime(null, 0.0), Status::Error);

        // An empty access needs no arrays, a null state needs no freeing.
        assert_eq!(crate::fmi3GetFloat64(fmu, ptr::null(), 0, ptr::null_mut(), 0), Status::Ok);
        assert_eq!(crate::fmi3GetInt8(fmu, ptr::null(), 0, ptr::null_mut(), 0), Status::Ok);
        assert_eq!(crate::fmi3FreeFMUState(fmu, &mut ptr::null_mut()), Status::Ok);
    }
}

#[test]
fn steps() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    for size_s in [0.0105e-1, 1e-10, f64::INFINITY] {
        let part = format!("fmi3DoStep: communicationStepSize: {size_s} s is not a whole");
        importer.discarded(importer.step(0.0, size_s).0, &part);
    }
    for size_s in [f64::NAN, -0.01, 0.0] {
        let part = format!("communicationStepSize is {size_s} s: it must be greater than 0");
        importer.refused(importer.step(0.0, size_s).0, &part);
    }
    for from_s in [0.01, -0.01, 0.0006, f64::NAN, f64::INFINITY] {
        let part = format!("currentCommunicationPoint is {from_s} s, but the instance is at 0 s");
        importer.refused(importer.step(from_s, 0.01).0, &part);
    }
    assert_eq!(importer.step(0.0, 0.01).4, 0.01);
}

#[test]
fn start_and_stop_time() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    let enter = |start_s, stop_s| unsafe {
        crate::fmi3EnterInitializationMode(importer.instance, true, 1e-4, start_s, true, stop_s)
    };
    importer.refused(enter(5.0, 10.0), "startTime is 5 s");
    importer.refused(enter(0.0, f64::NAN), "stopTime is NaN s");
    importer.refused(enter(0.0, 0.0), "stopTime is 0 s");
    // 0.1 + 0.2 is one ulp above 0.3, three steps of 0.1 must still fit below 0.3.
    assert_eq!(enter(0.0, 0.3), Status::Ok);
    unsafe { crate::fmi3ExitInitializationMode(importer.instance) };
    assert_eq!(importer.step(0.0, 0.1).0, Status::Ok);
    assert_eq!(importer.step(0.1, 0.2).0, Status::Ok);
    importer.refused(importer.step(0.1 + 0.2, 0.001).0, "passes the stop time");
}

#[test]
fn calls_out_of_order() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    let fmu = importer.instance;
    importer.refused(importer.step(0.0, 0.01).0, "fmi3DoStep: not allowed in state Instantiated");
    importer.refused(importer.try_get(&[X_1], &mut [0.0]), "x[1] is an output");
    unsafe {
        importer.refused(crate::fmi3ExitInitializationMode(fmu), "Instantiated");
        importer.refused(crate::fmi3Terminate(fmu), "Instantiated");
        importer.start();
        importer.refused(importer.enter(), "not allowed in state Step Mode");
        importer.refused(crate::fmi3ExitInitializationMode(fmu), "Step Mode");
        crate::fmi3Terminate(fmu);
    }
    importer.refused(importer.set(RATE_1, 1.0), "not allowed in state Terminated");
}

#[test]
fn what_is_not_declared_is_refused() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let fmu = importer.instance;
    unsafe {
        importer.refused(crate::fmi3EnterConfigurationMode(fmu), "Mode: not supported");
        importer.refused(crate::fmi3SetTime(fmu, 1.0), "fmi3SetTime: not supported");
        let (mut messages, none) = (crate::harness::Messages::new(), ptr::null());
        let log = (&raw mut messages).cast();
        let instance =
            crate::fmi3InstantiateModelExchange(none, none, none, false, false, log, Some(collect));
        assert!(instance.is_null());
        assert_eq!(messages.len(), 1);
    }
}
