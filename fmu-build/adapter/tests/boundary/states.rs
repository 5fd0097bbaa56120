use std::ptr;

use fmi_adapter::fmi3::Status;

use crate::harness::{Importer, Resources};
use crate::integrator::{ALL_OUTPUTS, RATE_1, X_1};

const STEP_S: f64 = 0.013;

/// Steps `count` times from step number `first`, rates changing, and returns all output bits.
fn fly(importer: &Importer, first: u32, count: u32) -> Vec<[u64; 3]> {
    let one = |n: u32| {
        importer.set(RATE_1, f64::from(n).sin());
        assert_eq!(importer.step(f64::from(n) * STEP_S, STEP_S).0, Status::Ok);
        importer.get(ALL_OUTPUTS).map(f64::to_bits)
    };
    (first..first + count).map(one).collect()
}

#[test]
fn a_restored_instance_continues_bit_for_bit() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    fly(&importer, 0, 10);
    let state = importer.get_state();
    let blob = importer.serialize(state);
    let expected = fly(&importer, 10, 50);

    assert_eq!(importer.set_state(state), Status::Ok);
    assert_eq!(fly(&importer, 10, 50), expected, "same instance");

    let running = Importer::stepping(&resources);
    let fresh = Importer::new(&resources);
    for other in [&running, &fresh] {
        let (status, state) = other.deserialize(&blob);
        assert_eq!(status, Status::Ok, "{:?}", other.take());
        assert_eq!(other.set_state(state), Status::Ok);
        assert_eq!(other.serialize(state), blob, "the blob is not a fixed point");
        assert_eq!(fly(other, 10, 50), expected, "another instance");
    }
}

#[test]
fn the_state_holds_inputs_and_life_cycle() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set(RATE_1, 7.0);
    let instantiated = importer.get_state();
    importer.start();
    importer.set(RATE_1, 8.0);
    let stepping = importer.get_state();
    unsafe { crate::fmi3Terminate(importer.instance) };

    importer.set_state(stepping);
    assert_eq!(importer.get([RATE_1]), [8.0]);
    importer.set_state(instantiated);
    importer.refused(importer.try_get(&[X_1], &mut [0.0]), "Instantiated");
    importer.start();
    assert_eq!(importer.get([RATE_1]), [7.0]);
}

#[test]
fn a_state_survives_reset_with_its_own_scenario() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set_scenario("scenarios/other.toml");
    importer.start();
    let state = importer.get_state();
    unsafe { crate::fmi3Reset(importer.instance) };
    importer.start();
    assert_eq!(importer.get([X_1]), [2.0]);
    assert_eq!(importer.set_state(state), Status::Ok);
    assert_eq!(
        (importer.get([X_1]), importer.scenario().as_str()),
        ([3.0], "scenarios/other.toml")
    );
}

#[test]
fn handles_are_checked() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let mut state = importer.get_state();
    let kept = state;
    // A handle passed in is used again, as FMI asks.
    unsafe { crate::fmi3GetFMUState(importer.instance, &mut state) };
    assert_eq!(state, kept);

    // Another library counts on its own, so small numbers may well be its handles.
    assert!(state.addr() > 1 << 32, "{state:?}");

    let stranger = Importer::stepping(&resources);
    stranger.refused(stranger.set_state(state), "FMUState is not a state of this instance");
    unsafe {
        assert_eq!(crate::fmi3FreeFMUState(importer.instance, &mut state), Status::Ok);
        assert!(state.is_null());
        state = kept;
        importer.refused(crate::fmi3FreeFMUState(importer.instance, &mut state), "was freed");
        importer.refused(crate::fmi3GetFMUState(importer.instance, &mut state), "was freed");
    }
    importer.refused(importer.set_state(kept), "was freed");
}

#[test]
fn a_damaged_blob_is_refused_and_changes_nothing() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let blob = importer.serialize(importer.get_state());
    fly(&importer, 0, 3);
    let before = importer.get(ALL_OUTPUTS);

    for length in 0..blob.len() {
        let (status, state) = importer.deserialize(&blob[..length]);
        importer.refused(status, "serializedState");
        assert!(state.is_null());
    }
    for position in 0..blob.len() {
        let mut damaged = blob.clone();
        damaged[position] ^= 0x10;
        importer.refused(importer.deserialize(&damaged).0, "serializedState");
    }
    let mut extended = blob.clone();
    extended.push(0);
    importer.refused(importer.deserialize(&extended).0, "truncated or extended");

    assert_eq!(importer.get(ALL_OUTPUTS), before);
    fly(&importer, 3, 1);
}

#[test]
fn a_blob_brings_its_scenario_along() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set_scenario("scenarios/other.toml");
    importer.set_changes("5");
    importer.start();
    fly(&importer, 0, 10);
    let blob = importer.serialize(importer.get_state());
    let expected = fly(&importer, 10, 50);

    let fresh = Importer::new(&resources);
    let running = Importer::stepping(&resources);
    for other in [&fresh, &running] {
        let (status, state) = other.deserialize(&blob);
        assert_eq!(status, Status::Ok, "{:?}", other.take());
        assert_eq!(
            other.scenario(),
            "scenarios/landing.toml",
            "deserialising touched the running state"
        );
        assert_eq!(other.set_state(state), Status::Ok);
        assert_eq!(other.scenario(), "scenarios/other.toml");
        assert_eq!(fly(other, 10, 50), expected);
    }
}

#[test]
fn a_blob_is_restored_in_whatever_life_cycle_state_it_was_taken() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set(RATE_1, 7.0);
    let mut blobs = Vec::new();
    let mut keep = |outputs: &[f64]| {
        blobs.push((importer.serialize(importer.get_state()), outputs.to_vec()));
    };
    keep(&[]);
    importer.enter();
    keep(&importer.get(ALL_OUTPUTS));
    unsafe { crate::fmi3ExitInitializationMode(importer.instance) };
    importer.step(0.0, STEP_S);
    keep(&importer.get(ALL_OUTPUTS));
    unsafe { crate::fmi3Terminate(importer.instance) };
    keep(&importer.get(ALL_OUTPUTS));

    for (blob, outputs) in blobs {
        let fresh = Importer::new(&resources);
        let (status, state) = fresh.deserialize(&blob);
        assert_eq!(status, Status::Ok, "{:?}", fresh.take());
        assert_eq!(fresh.set_state(state), Status::Ok);
        assert_eq!(fresh.serialize(state), blob, "the blob is not a fixed point");
        assert_eq!(fresh.get([RATE_1]), [7.0]);
        if outputs.is_empty() {
            fresh.start();
        } else {
            assert_eq!(fresh.get(ALL_OUTPUTS)[..], outputs);
        }
    }
}

#[test]
fn a_state_from_before_initialization_depends_on_no_file() {
    let resources = Resources::new();
    let importer = Importer::new(&resources);
    importer.set(RATE_1, 7.0);
    let state = importer.get_state();
    let blob = importer.serialize(state);
    // Neither the parameter set since, nor the file it names, is part of the stored state.
    importer.set_scenario("scenarios/other.toml");
    assert_eq!(importer.serialize(state), blob);
    resources.write("landing", "2.5");
    assert_eq!(importer.deserialize(&blob).0, Status::Ok);
}

#[test]
fn a_blob_of_an_edited_configuration_is_refused() {
    for edited_file in ["landing", "gain"] {
        let resources = Resources::new();
        resources.write("gain", "2");
        resources.write("landing", "gain.toml");
        let importer = Importer::stepping(&resources);
        let blob = importer.serialize(importer.get_state());

        resources.write(edited_file, "2.5");
        let fresh = Importer::new(&resources);
        fresh.refused(fresh.deserialize(&blob).0, "another configuration");
        std::fs::remove_file(resources.0.join("scenarios/landing.toml")).unwrap();
        fresh.refused(fresh.deserialize(&blob).0, "scenarios/landing.toml: cannot be read");
        // The running instance still is what it was created from.
        assert_eq!(importer.deserialize(&blob).0, Status::Ok);
    }
}

#[test]
fn the_size_must_be_the_announced_one() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    let state = importer.get_state();
    let size = importer.serialize(state).len();
    let mut room = vec![0; size + 1];
    let (fmu, room) = (importer.instance, room.as_mut_ptr());
    unsafe {
        importer.refused(crate::fmi3SerializeFMUState(fmu, state, room, size - 1), "size is");
        importer.refused(crate::fmi3SerializeFMUState(fmu, state, room, size + 1), "size is");
        let null = ptr::null_mut();
        importer.refused(crate::fmi3SerializeFMUState(fmu, state, null, size), "serializedState");
    }
}
