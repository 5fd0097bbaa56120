//! Inputs that no landing has are refused by name, and leave a safe command.

use guidance_fmu::Guidance;
use lander_models::signals::GUIDANCE;
use lander_models::{Component, ModelError, Settings, Ticks};

/// A descent in its first burn, with its inputs.
fn burning() -> (Guidance, guidance_fmu::State, Vec<f64>) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");
    let settings = Settings { scenario_file: file.into() };
    let (guidance, mut state) = Guidance::create(&settings).unwrap();
    let mut inputs = vec![0.0; GUIDANCE.input_len()];
    let mut put = |name: &str, values: &[f64]| {
        let at = GUIDANCE.input_offset(name).unwrap();
        inputs[at..at + values.len()].copy_from_slice(values);
    };
    put("position_w", &[300.0, 100.0, 500.0]);
    put("velocity_w", &[-15.0, -5.0, -25.0]);
    put("attitude_wb", &[1.0]);
    put("mass_kg", &[259.5]);
    put("altimeter_m", &[500.0]);
    put("computer_up", &[1.0]);
    // The first burn comes after a lead of 2.5 s at most and lasts for tenths of a second at least.
    for _ in 0..300 {
        guidance.step(&mut state, &inputs, Ticks(10)).unwrap();
        if command(&guidance, &state)[0] > 0.0 {
            return (guidance, state, inputs);
        }
    }
    panic!("never lit");
}

/// Thrust, gimbal and thruster torques.
fn command(guidance: &Guidance, state: &guidance_fmu::State) -> [f64; 6] {
    let mut outputs = vec![0.0; GUIDANCE.output_len()];
    guidance.outputs(state, &mut outputs);
    *outputs.first_chunk().unwrap()
}

#[test]
fn what_is_not_finite_or_absurd_is_named_and_leaves_the_engine_off() {
    let (guidance, state, inputs) = burning();
    let absurd = [
        ("position_w", 1e7),
        ("velocity_w", -1e5),
        ("rate_b", 1e3),
        ("specific_force_b", -1e6),
        ("mass_kg", -1.0),
        ("mass_kg", 1e7),
        ("altimeter_m", -1e7),
        ("attitude_wb", 7.0),
    ];
    let not_finite = GUIDANCE.inputs.iter().flat_map(|signal| {
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|value| (signal.name, value))
    });
    for (name, value) in absurd.into_iter().chain(not_finite) {
        let (mut state, mut inputs) = (state.clone(), inputs.clone());
        assert!(command(&guidance, &state)[0] >= 800.0);
        inputs[GUIDANCE.input_offset(name).unwrap()] = value;
        let error = guidance.step(&mut state, &inputs, Ticks(10)).unwrap_err();
        assert!(error.to_string().contains(name), "{name} = {value}: {error}");
        assert_eq!(matches!(error, ModelError::NonFiniteInput { .. }), !value.is_finite());
        assert_eq!(command(&guidance, &state), [0.0; 6], "{name} = {value}");
    }
}

#[test]
fn every_state_that_passes_gives_a_command_that_the_vehicle_has() {
    let (guidance, state, inputs) = burning();
    // As far out as the guard allows, in each direction of each scalar.
    for (name, size, limit) in [
        ("position_w", 3, 1e6),
        ("velocity_w", 3, 1e4),
        ("rate_b", 3, 1e2),
        ("specific_force_b", 3, 1e5),
        ("altimeter_m", 1, 1e6),
    ] {
        for (index, sign) in (0..size).flat_map(|index| [(index, 1.0), (index, -1.0)]) {
            let (mut state, mut inputs) = (state.clone(), inputs.clone());
            inputs[GUIDANCE.input_offset(name).unwrap() + index] = sign * limit;
            // Long enough for a plan to fall due.
            for _ in 0..60 {
                guidance.step(&mut state, &inputs, Ticks(10)).unwrap();
                let [thrust_n, gimbal @ .., tx, ty, tz] = command(&guidance, &state);
                let lit = (800.0..=5200.0).contains(&thrust_n);
                assert!(thrust_n == 0.0 || lit, "{name}: {thrust_n} N");
                // The vehicle's limits: 7°, and 50, 50 and 35 N m.
                assert!(gimbal.iter().all(|angle| angle.abs() <= 7.01_f64.to_radians()), "{name}");
                assert!(tx.abs() <= 50.0 && ty.abs() <= 50.0 && tz.abs() <= 35.0, "{name}");
            }
        }
    }
}

#[test]
fn a_bus_on_which_nobody_has_spoken_leaves_the_engine_off() {
    let (guidance, state, inputs) = burning();
    let (mut silent, mut heard) = (state.clone(), state);
    guidance.step(&mut silent, &vec![0.0; GUIDANCE.input_len()], Ticks(10)).unwrap();
    assert_eq!(command(&guidance, &silent), [0.0; 6]);
    // Then it goes on as if it had always heard.
    guidance.step(&mut silent, &inputs, Ticks(10)).unwrap();
    guidance.step(&mut heard, &inputs, Ticks(10)).unwrap();
    assert!(command(&guidance, &silent)[0] >= 800.0 && command(&guidance, &heard)[0] >= 800.0);
}
