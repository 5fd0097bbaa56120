use std::ffi::CStr;
use std::ptr;

use fmi_adapter::fmi3::{Events, Status};

use crate::harness::{Importer, Resources, token};
use crate::integrator::{ALL_OUTPUTS, END, EVENT, RATE_1, RATE_2, STEPS, TROUBLE, X_1, X_2};

#[test]
fn a_run_from_instantiate_to_free() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    assert_eq!(importer.set(RATE_1, 10.0), Status::Ok);

    assert_eq!(importer.enter(), Status::Ok);
    // Initial outputs are readable before the first step; the gain in landing.toml is 2.
    assert_eq!(importer.get(ALL_OUTPUTS), [2.0, -2.0, 0.0]);
    assert_eq!(importer.get([0, RATE_1, RATE_2]), [0.0, 10.0, 0.5]);

    assert_eq!(unsafe { crate::fmi3ExitInitializationMode(importer.instance) }, Status::Ok);
    assert_eq!(importer.step(0.0, 0.25), (Status::Ok, false, false, false, 0.25));
    // Exact: 2 + 2 · 10 · 0.25 and -2 + 2 · 0.5 · 0.25 have no rounding.
    assert_eq!(importer.get([0, X_1, X_2, STEPS]), [0.25, 7.0, -1.75, 1.0]);

    assert_eq!(unsafe { crate::fmi3Terminate(importer.instance) }, Status::Ok);
    assert_eq!(importer.get([X_1]), [7.0]);
    importer.refused(importer.step(0.25, 0.25).0, "fmi3DoStep: not allowed in state Terminated");

    assert_eq!(unsafe { crate::fmi3Reset(importer.instance) }, Status::Ok);
    importer.start();
    assert_eq!(importer.get([0, X_1, RATE_1]), [0.0, 2.0, 0.5]);
    assert_eq!(importer.take(), []);
}

#[test]
fn the_scenario_parameter_selects_the_file() {
    let resources = Resources::new();
    let absolute = resources.0.join("scenarios/other.toml");
    for scenario in ["scenarios/other.toml", absolute.to_str().unwrap()] {
        let importer = Importer::new(&resources);
        assert_eq!(importer.set_scenario(scenario), Status::Ok);
        importer.start();
        assert_eq!(importer.get([X_1]), [3.0]);
        assert_eq!(importer.scenario(), scenario);
    }
    // In Initialization Mode too: FMI lets an initial="exact" parameter be set there.
    let importer = Importer::new(&resources);
    assert_eq!(importer.enter(), Status::Ok);
    assert_eq!(importer.set_scenario("scenarios/other.toml"), Status::Ok);
    assert_eq!(importer.get([X_1]), [3.0]);
    importer.refused(importer.set_scenario("nowhere.toml"), "nowhere.toml");
    assert_eq!(
        (importer.get([X_1]), importer.scenario().as_str()),
        ([3.0], "scenarios/other.toml")
    );
}

#[test]
fn the_scenario_can_be_changed_by_a_parameter() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    assert_eq!(importer.set_changes("7"), Status::Ok);
    assert_eq!(importer.enter(), Status::Ok);
    assert_eq!(importer.get([X_1]), [7.0]);
    assert_eq!(importer.set_changes("8"), Status::Ok);
    assert_eq!(importer.get([X_1]), [8.0]);
    assert_eq!(importer.scenario(), "scenarios/landing.toml");
    unsafe { crate::fmi3ExitInitializationMode(importer.instance) };
    importer.refused(importer.set_changes("9"), "scenario_changes is a fixed parameter");
}

#[test]
fn start_values_can_be_read_before_initialization() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    assert_eq!(importer.get([0, RATE_1, TROUBLE]), [0.0, 0.5, 0.5]);
    assert_eq!(importer.scenario(), "scenarios/landing.toml");
    assert_eq!((importer.set(RATE_1, 7.0), importer.get([RATE_1])), (Status::Ok, [7.0]));
    let both = importer.try_get(&[RATE_1, X_2], &mut [0.0; 2]);
    importer.refused(both, "x[2] is an output: it has no value in state Instantiated");
}

#[test]
fn a_missing_scenario_is_named_and_can_be_corrected() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    assert_eq!(importer.set_scenario("scenarios/missing.toml"), Status::Ok);
    let tried = resources.0.join("scenarios/missing.toml");
    // Once: the model's own message begins with the file.
    let message = format!("fmi3EnterInitializationMode: {}: cannot be read", tried.display());
    importer.refused(importer.enter(), &message);
    assert_eq!(importer.set_scenario(""), Status::Ok);
    importer.start();
}

#[test]
fn without_a_resource_path_only_an_absolute_scenario_works() {
    let resources = Resources::new();
    let importer = Importer::with(Some(&token()), None, Events::Unheard);
    importer.refused(importer.enter(), "scenario_file");
    importer.set_scenario(resources.0.join("scenarios/other.toml").to_str().unwrap());
    importer.start();
}

#[test]
fn instantiation_is_refused_with_a_reason() {
    for (importer, reason) in [
        (Importer::with(Some(c"wrong"), None, Events::Unheard), "the token is \"wrong\""),
        (Importer::with(None, None, Events::Unheard), "instantiationToken is a null pointer"),
    ] {
        assert!(importer.instance.is_null());
        let messages = importer.take();
        assert!(messages[0].2.contains(reason), "{messages:?}");
    }
}

#[test]
fn wobbling_communication_points_stay_on_the_ticks() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let (mut time, mut drift_s) = (0.0, 0.0_f64);
    // A sum of milliseconds leaves the ticks by a nanosecond after 335 s.
    for n in 1..=400_000 {
        let next = time + 0.001;
        // The reported time is the tick's, so the wobble does not accumulate inside.
        let tick_s = f64::from(n) / 1000.0;
        assert_eq!(importer.step(time, next - time).4, tick_s);
        time = next;
        drift_s = drift_s.max((time - tick_s).abs());
    }
    assert!(drift_s > 1e-9, "the sum was expected to drift");
}

#[test]
fn events_and_the_end_reach_the_importer() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    assert_eq!(importer.set_terminate_at_end(), Status::Ok);
    importer.start();
    importer.set(TROUBLE, EVENT);
    assert_eq!(importer.step(0.0, 0.01), (Status::Ok, false, false, false, 0.01));
    assert_eq!(importer.take(), [], "debug logging is off");

    let on = |on, names: &[&CStr]| {
        let names: Vec<_> = names.iter().map(|name| name.as_ptr()).collect();
        unsafe { crate::fmi3SetDebugLogging(importer.instance, on, names.len(), names.as_ptr()) }
    };
    assert_eq!(on(true, &[c"logEvents"]), Status::Ok);
    importer.step(0.01, 0.01);
    let messages = importer.take();
    assert_eq!((messages.len(), messages[0].0), (1, Status::Ok), "{messages:?}");
    assert_eq!((&*messages[0].1, &*messages[0].2), ("logEvents", "t = 0.02 s: event"));

    assert_eq!(on(true, &[c"logStatusError"]), Status::Ok);
    importer.set(TROUBLE, END);
    assert_eq!(importer.step(0.02, 0.01), (Status::Ok, false, true, false, 0.03));
    assert_eq!(importer.take(), []);
    importer.refused(on(true, &[c"logNothing"]), "logNothing");

    assert_eq!(on(true, &[]), Status::Ok);
    assert_eq!(unsafe { crate::fmi3Reset(importer.instance) }, Status::Ok);
    importer.start();
    assert_eq!(importer.take(), [], "reset did not restore the logging of instantiation");
}

#[test]
fn unless_asked_a_run_goes_on_after_its_end() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    unsafe {
        importer.start();
        let mut value = 7;
        assert_eq!(crate::fmi3GetBoolean(importer.instance, &2, 1, &mut value, 1), Status::Ok);
        assert_eq!(value, 0);
    }
    importer.set(TROUBLE, END);
    for n in 0..3 {
        let from_s = f64::from(n) * 0.25;
        assert_eq!(importer.step(from_s, 0.25), (Status::Ok, false, false, false, from_s + 0.25));
    }
}

#[test]
fn a_number_sign_in_a_message_is_escaped() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set_scenario("scenarios/#1#.toml");
    importer.refused(importer.enter(), "scenarios/##1##.toml: cannot be read");
}

#[test]
fn ten_thousand_instances() {
    let resources = Resources::new();
    for _ in 0..10_000 {
        let importer = Importer::stepping(&resources);
        assert_eq!(importer.step(0.0, 0.001).0, Status::Ok);
        importer.get_state();
    }
    unsafe { crate::fmi3FreeInstance(ptr::null_mut()) };
}
