//! Each failure mode changes the physics that it names, as a closed form says. BUG high above the
//! ground, engine at 3000 N, the fault two seconds in.

mod common;

use claims::{Bound, Claim};
use common::{Setup, bug, on_plane, run};
use lander_models::Ticks;
use lander_models::scenario::*;
use lander_models::vehicle::G0_M_S2;
use nalgebra::{Vector2, Vector3};
use truth_model::faults::vacuum_thrust_coefficient;
use truth_model::{State, TruthModel};

const ONSET: Ticks = Ticks(2000);
const THRUST_N: f64 = 3000.0;
const LAG_S: f64 = 0.1;
/// Twenty lags before the onset leave exp(-20) = 2e-9 of the start transient.
const SETTLED: f64 = 3e-9;

/// Model, and its state at the onset under a command held.
fn at_onset(faults: Faults) -> (TruthModel, State) {
    at_onset_of(faults, &mut |_| {})
}

fn at_onset_of(faults: Faults, change: &mut dyn FnMut(&mut Setup)) -> (TruthModel, State) {
    let mut setup = on_plane(bug(), 85.5);
    setup.scenario.initial.position_w.z = 1e5;
    setup.scenario.faults = faults;
    change(&mut setup);
    let model = setup.model();
    let mut state = model.initial_state();
    state.command.thrust_n = THRUST_N;
    run(&model, &mut state, ONSET.seconds());
    (model, state)
}

fn thrust_n(state: &State) -> f64 {
    state.drive.thrust_n(&state.motion)
}

/// Propellant used during the next `seconds`, kg.
fn used_kg(model: &TruthModel, state: &mut State, seconds: f64) -> f64 {
    let before_kg = state.motion.propellant_kg;
    run(model, state, seconds);
    before_kg - state.motion.propellant_kg
}

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

#[test]
fn engine_shutoff_ends_thrust_by_its_tail_off_for_good() {
    let engine_shutoff = Some(Onset { onset: ONSET });
    let (model, mut state) = at_onset(Faults { engine_shutoff, ..Faults::default() });
    close(thrust_n(&state), THRUST_N, SETTLED * THRUST_N);
    // The tail-off's impulse is T tau: as much propellant.
    let used = used_kg(&model, &mut state, 0.25);
    let decayed = (-0.25 / LAG_S).exp();
    Claim {
        id: "fault-shutoff",
        section: "Faults",
        claim: "engine shut-off: thrust 0.25 s after it, relative",
        reference: "T exp(−t/τ)",
        unit: "",
        bound: Bound::AtMost(SETTLED),
        origin: "twenty lags before the onset leave exp(-20) of the start transient",
        noise: 3e-9,
    }
    .holds(thrust_n(&state) / THRUST_N - decayed);
    let impulse = THRUST_N * LAG_S * (1.0 - decayed);
    // Fourth order on h/tau = 0.01 leaves 1e-11; the start transient SETTLED.
    close(used, impulse / (225.0 * G0_M_S2), 2.0 * SETTLED);
    run(&model, &mut state, 5.0);
    assert!(thrust_n(&state) < 1e-15 * THRUST_N);
}

#[test]
fn thrust_degradation_takes_its_share_of_thrust_and_flow() {
    let thrust_degradation = Some(ThrustDegradation { onset: ONSET, fraction: 0.3 });
    let (model, mut state) = at_onset(Faults { thrust_degradation, ..Faults::default() });
    let used = used_kg(&model, &mut state, 1.0);
    Claim {
        id: "fault-degradation",
        section: "Faults",
        claim: "thrust degraded by 30 %: thrust and flow, relative",
        reference: "0.7 T and 0.7 T/(I_sp g0)",
        unit: "",
        bound: Bound::AtMost(SETTLED),
        origin: "twenty lags before the onset leave exp(-20) of the start transient",
        noise: 3e-9,
    }
    .holds_for([
        thrust_n(&state) / (0.7 * THRUST_N) - 1.0,
        used / (0.7 * THRUST_N / (225.0 * G0_M_S2)) - 1.0,
    ]);
}

#[test]
fn a_power_brownout_stops_engine_thrusters_and_gimbal_until_power_is_back() {
    let power_brownout = Some(PowerBrownout { onset: ONSET, duration: Ticks(500) });
    let (model, mut state) =
        at_onset_of(Faults { power_brownout, ..Faults::default() }, &mut |setup| {
            setup.vehicle.engine.ignition_delay = Ticks(100)
        });
    state.command.gimbal_rad = Vector2::new(0.05, 0.0);
    state.command.rcs_torque_b.z = 35.0;
    run(&model, &mut state, 0.5);
    let dark = thrust_n(&state) / THRUST_N - (-0.5 / LAG_S).exp();
    assert_eq!((state.motion.gimbal_rad, state.drive.rcs_torque_b.z), (Vector2::zeros(), 0.0));
    // Power is back: the engine needs its ignition again.
    run(&model, &mut state, 0.1);
    let igniting = thrust_n(&state) / THRUST_N - (-0.6 / LAG_S).exp();
    assert!(state.motion.gimbal_rad.x > 0.0 && state.drive.rcs_torque_b.z == 35.0);
    run(&model, &mut state, 3.0);
    Claim {
        id: "fault-brownout",
        section: "Faults",
        claim: "brown-out of 0.5 s: thrust in it, during ignition and after, relative",
        reference: "T exp(−t/τ), the ignition's delay, T",
        unit: "",
        bound: Bound::AtMost(SETTLED),
        origin: "twenty lags before the onset leave exp(-20) of the start transient",
        noise: 3e-9,
    }
    .holds_for([dark, igniting, thrust_n(&state) / THRUST_N - 1.0]);
}

#[test]
fn a_sensor_fails_from_its_onset_on_and_no_other_does() {
    let sensor_failure = Some(SensorFailure { onset: ONSET, sensor: Sensor::Altimeter });
    let faults = Faults { sensor_failure, ..Faults::default() };
    assert!(!faults.sensor_failed(Ticks(1999), Sensor::Altimeter));
    assert!(faults.sensor_failed(ONSET, Sensor::Altimeter));
    assert!(!faults.sensor_failed(ONSET, Sensor::Imu));
}

#[test]
fn a_stuck_pair_gives_its_torque_whatever_is_asked() {
    let rcs_stuck = Some(RcsStuck { onset: ONSET, axis: 2, sign: -1.0 });
    let (model, mut state) = at_onset(Faults { rcs_stuck, ..Faults::default() });
    state.command.thrust_n = 0.0;
    run(&model, &mut state, 5.0);
    let before = state.motion;
    let used = used_kg(&model, &mut state, 1.0);
    assert_eq!(state.drive.rcs_torque_b, Vector3::new(0.0, 0.0, -35.0));
    close(used, 35.0 / (1.13 * 160.0 * G0_M_S2), 1e-10); // 1000 sums near 85 kg
    let gained = state.motion.rate_b.z - before.rate_b.z;
    let inertia_kg_m2 = model.vehicle().mass.at(state.motion.propellant_kg).inertia_b[(2, 2)];
    Claim {
        id: "fault-rcs-stuck",
        section: "Faults",
        claim: "thruster pair stuck for 1 s: angular momentum gained, relative",
        reference: "τ t, 35 N m s",
        unit: "",
        bound: Bound::AtMost(2e-3),
        origin: "the tensor's products couple the axes by so much",
        noise: 1e-5,
    }
    .holds(gained * inertia_kg_m2 / -35.0 - 1.0);
    // The opposite pair, fired in full, cancels it at twice the flow.
    state.command.rcs_torque_b.z = 35.0;
    run(&model, &mut state, 1.0);
    assert_eq!(state.drive.rcs_torque_b.z, 0.0);
    close(state.drive.other_flow_kg_s, 70.0 / (1.13 * 160.0 * G0_M_S2), 1e-15);
}

#[test]
fn a_leak_takes_propellant_and_leaves_the_motion_alone() {
    let propellant_leak = Some(PropellantLeak { onset: ONSET, flow_kg_s: 0.4 });
    let (model, mut state) =
        at_onset_of(Faults { propellant_leak, ..Faults::default() }, &mut |setup| {
            setup.scenario.gravity_m_s2 = 0.0;
            setup.scenario.ignition = Ignition::Never;
            setup.scenario.initial.velocity_w = Vector3::new(3.0, -2.0, 1.0);
        });
    let before = state.motion;
    Claim {
        id: "fault-leak",
        section: "Faults",
        claim: "propellant that a leak of 0.4 kg/s loses in 10 s",
        reference: "4 kg",
        unit: "kg",
        bound: Bound::AtMost(1e-10),
        origin: "10⁴ sums near 85 kg",
        noise: 1e-10,
    }
    .holds(used_kg(&model, &mut state, 10.0) - 4.0);
    Claim {
        id: "fault-leak-motion",
        section: "Faults",
        claim: "change of velocity and rate by the same leak",
        reference: "none",
        unit: "m/s, rad/s",
        bound: Bound::AtMost(1e-12),
        origin: "acceptance list",
        noise: 1e-13,
    }
    .holds_for([(state.motion.velocity_w - before.velocity_w).norm(), state.motion.rate_b.norm()]);
    run(&model, &mut state, 300.0);
    assert_eq!(state.motion.propellant_kg, 0.0);
}

#[test]
fn a_seized_gimbal_holds_its_angles() {
    let gimbal_seizure = Some(Onset { onset: ONSET });
    let mut faults = Faults { gimbal_seizure, ..Faults::default() };
    for seizes in [true, false] {
        let (model, mut state) = at_onset(faults.clone());
        let held_rad = state.motion.gimbal_rad;
        state.command.gimbal_rad = Vector2::new(0.1, -0.1);
        run(&model, &mut state, 1.0);
        assert_eq!(state.motion.gimbal_rad == held_rad, seizes);
        faults = Faults::default();
    }
    // At an angle and in motion, too.
    let gimbal_seizure = Some(Onset { onset: Ticks(ONSET.0 + 50) });
    let (model, mut state) = at_onset(Faults { gimbal_seizure, ..Faults::default() });
    state.command.gimbal_rad = Vector2::new(0.1, -0.1);
    run(&model, &mut state, 0.05);
    let held_rad = state.motion.gimbal_rad;
    run(&model, &mut state, 1.0);
    assert!(held_rad.x > 0.01);
    Claim {
        id: "fault-gimbal",
        section: "Faults",
        claim: "gimbal that seizes while it moves: turn in the second after",
        reference: "none",
        unit: "rad",
        bound: Bound::AtMost(0.0),
        origin: "the angle is held bit for bit",
        noise: 0.0,
    }
    .holds((state.motion.gimbal_rad - held_rad).norm());
}

#[test]
fn a_computer_reset_zeroes_or_holds_the_commands_for_its_duration() {
    let mut errors = Vec::new();
    for commands in [ResetCommands::Zero, ResetCommands::Held] {
        let computer_reset = Some(ComputerReset { onset: ONSET, duration: Ticks(300), commands });
        let (model, mut state) = at_onset(Faults { computer_reset, ..Faults::default() });
        state.command.thrust_n = 5000.0;
        run(&model, &mut state, 0.3);
        let target_n = if commands == ResetCommands::Held { THRUST_N } else { 0.0 };
        let expected_n = target_n + (THRUST_N - target_n) * (-0.3 / LAG_S).exp();
        errors.push((thrust_n(&state) - expected_n) / THRUST_N);
        run(&model, &mut state, 3.0);
        errors.push(thrust_n(&state) / 5000.0 - 1.0);
    }
    Claim {
        id: "fault-reset",
        section: "Faults",
        claim: "computer reset of 0.3 s, commands zero or held: thrust at its end and after, \
            relative",
        reference: "T exp(−t/τ) or T, then the new command",
        unit: "",
        bound: Bound::AtMost(SETTLED),
        origin: "twenty lags before the onset leave exp(-20) of the start transient",
        noise: 3e-9,
    }
    .holds_for(errors);
}

#[test]
fn slosh_is_asked_for_at_one_tick() {
    let slosh = Some(Slosh { onset: ONSET, angle_rad: 0.2 });
    let faults = Faults { slosh, ..Faults::default() };
    let asked: Vec<_> = (1998..2003).map(|tick| faults.slosh_onset(Ticks(tick))).collect();
    assert_eq!(asked, [None, None, Some(0.2), None, None]);
}

#[test]
fn nozzle_erosion_lowers_thrust_and_isp_at_the_same_flow_and_turns_the_thrust() {
    let pointing_rate_rad_s = 0.1_f64.to_radians();
    let nozzle_erosion = Some(NozzleErosion { onset: ONSET, rate_s: 0.02, pointing_rate_rad_s });
    let (model, mut state) = at_onset(Faults { nozzle_erosion, ..Faults::default() });
    let used = used_kg(&model, &mut state, 10.0);
    // The last tick's factor is that of its start, 9.999 s after the onset.
    let coefficient = |ratio: f64| vacuum_thrust_coefficient(ratio, 1.2);
    let factor = coefficient(30.0 / (1.0 + 0.02 * 9.999)) / coefficient(30.0);
    assert!((0.95..0.999).contains(&factor), "a fifth more throat takes {factor}");
    Claim {
        id: "fault-erosion",
        section: "Faults",
        claim: "nozzle erosion, a fifth more throat: thrust, relative",
        reference: "C_F of the ideal nozzle, (T.72) to (T.74)",
        unit: "",
        bound: Bound::AtMost(SETTLED),
        origin: "twenty lags before the onset leave exp(-20) of the start transient",
        noise: 3e-9,
    }
    .holds(thrust_n(&state) / (THRUST_N * factor) - 1.0);
    close(used / 10.0, THRUST_N / (225.0 * G0_M_S2), SETTLED);
    let flow_kg_s = state.drive.engine_flow_kg_s(model.vehicle(), state.motion.thrust_n);
    close(thrust_n(&state) / (flow_kg_s * G0_M_S2), 225.0 * factor, 225.0 * 1e-14);
    close(state.drive.pointing_error_rad.x, pointing_rate_rad_s * 9.999, 1e-15);
}

#[test]
fn all_ten_modes_can_happen_in_one_run_and_are_counted() {
    let text = include_str!("../../models/scenarios/landing.toml");
    let seconds = |value: f64| format!("{{ value = {value:?}, unit = \"s\" }}");
    let faults = [
        ("slosh", "angle = { value = 5.0, unit = \"deg\" }".to_owned()),
        ("nozzle_erosion", "rate = { value = 0.01, unit = \"1/s\" }\npointing_rate = { value = 0.1, unit = \"deg/s\" }".to_owned()),
        ("propellant_leak", "flow = { value = 0.1, unit = \"kg/s\" }".to_owned()),
        ("thrust_degradation", "fraction = { value = 0.1, unit = \"1\" }".to_owned()),
        ("sensor_failure", "sensor = \"star_tracker\"".to_owned()),
        ("rcs_stuck", "axis = \"y\"\nsense = \"negative\"".to_owned()),
        ("power_brownout", format!("duration = {}", seconds(0.2))),
        ("computer_reset", format!("commands = \"held\"\nduration = {}", seconds(0.2))),
        ("gimbal_seizure", String::new()),
        ("engine_shutoff", String::new()),
    ];
    let mut text = text.to_owned();
    for (n, (mode, parameters)) in faults.iter().enumerate() {
        let onset = seconds(1.0 + n as f64);
        text += &format!("[faults.{mode}]\nonset = {onset}\n{parameters}\n");
    }
    let vehicle = bug();
    let scenario = Scenario::parse("all.toml".as_ref(), &text, &vehicle).unwrap();
    let model = TruthModel::new(scenario, vehicle);
    let mut state = model.initial_state();
    state.command.thrust_n = THRUST_N;
    for count in 0..10 {
        assert_eq!(model.scenario().faults.active(state.now), count);
        run(&model, &mut state, 1.0);
    }
    Claim {
        id: "fault-modes",
        section: "Faults",
        claim: "failure modes past their onset, all in one run, the motion finite",
        reference: "ten modes",
        unit: "",
        bound: Bound::AtLeast(10.0),
        origin: "acceptance list",
        noise: 0.0,
    }
    .holds(f64::from(model.scenario().faults.active(state.now) as u32));
    assert!(state.motion.is_finite());
}
