//! Engine, thrusters and disturbances against closed forms, on BUG high above the ground.

mod common;

use claims::{Bound, Claim};
use common::{Setup, bug, on_plane, run};
use lander_models::scenario::Disturbances;
use lander_models::vehicle::{Curve, DeadZone, G0_M_S2};
use lander_models::{Ticks, Vehicle};
use nalgebra::{Vector2, Vector3};
use truth_model::{State, TruthModel};

fn aloft(vehicle: Vehicle) -> Setup {
    let mut setup = on_plane(vehicle, 85.5);
    setup.scenario.initial.position_w.z = 1e4;
    setup
}

fn commanded(model: &TruthModel, thrust_n: f64) -> State {
    let mut state = model.initial_state();
    state.command.thrust_n = thrust_n;
    state
}

fn thrust_n(state: &State) -> f64 {
    state.drive.thrust_n(&state.motion)
}

/// Flow of everything together over the next tick, kg/s.
fn flow_kg_s(model: &TruthModel, state: &mut State) -> f64 {
    let before_kg = state.motion.propellant_kg;
    run(model, state, 1e-3);
    (before_kg - state.motion.propellant_kg) / 1e-3
}

/// Differences of 85 kg over a tick: 1.4e-14 kg each, over a flow of 4e-4 kg a tick.
const FLOW_ROUNDING: f64 = 1e-9;
/// Exponentials of a thousand ticks multiplied up, relative.
const LAG_ROUNDING: f64 = 1e-11;

#[test]
fn start_and_tail_off_follow_their_delay_and_lags() {
    let mut setup = aloft(bug());
    let engine = &mut setup.vehicle.engine;
    engine.ignition_delay = Ticks(50);
    (engine.ignition_lag_s, engine.thrust_lag_s, engine.tail_off_lag_s) = (0.2, 0.1, 0.04);
    let model = setup.model();
    let mut state = commanded(&model, 2000.0);
    // The start is over at the first tick at or above 0.9 of the 800 N floor.
    let started_s = 0.05 + (0.2 * -(1.0 - 720.0 / 2000.0_f64).ln() * 1e3).ceil() / 1e3;
    let rise = |t: f64, lag_s: f64| (-t / lag_s).exp();
    let left_n = 2000.0 * rise(started_s - 0.05, 0.2);
    let mut errors = Vec::new();
    for tick in 1..=1000_u64 {
        run(&model, &mut state, 1e-3);
        let t = Ticks(tick).seconds();
        let expected_n = if t <= 0.05 {
            0.0
        } else if t <= started_s {
            2000.0 * (1.0 - rise(t - 0.05, 0.2))
        } else {
            2000.0 - left_n * rise(t - started_s, 0.1)
        };
        errors.push((thrust_n(&state) - expected_n) / 2000.0);
    }
    state.command.thrust_n = 0.0;
    let full_n = thrust_n(&state);
    run(&model, &mut state, 0.1);
    let expected_n = full_n * (-0.1_f64 / 0.04).exp();
    errors.push(thrust_n(&state) / expected_n - 1.0);
    Claim {
        id: "engine-transients",
        section: "Engine and disturbances",
        claim: "ignition delay, start, running and tail-off: thrust in every tick of 1.1 s, \
            relative",
        reference: "exponentials of their lags",
        unit: "",
        bound: Bound::AtMost(LAG_ROUNDING),
        origin: "a thousand ticks' exponentials multiplied up",
        noise: 1e-12,
    }
    .holds_for(errors);
    // A restart waits again, and what is left goes on decaying meanwhile.
    state.command.thrust_n = 2000.0;
    run(&model, &mut state, 0.05);
    let expected_n = full_n * (-0.15_f64 / 0.04).exp();
    assert!((thrust_n(&state) / expected_n - 1.0).abs() < LAG_ROUNDING);
    run(&model, &mut state, 0.001);
    assert!(thrust_n(&state) > expected_n);
}

#[test]
fn thrust_settles_where_the_throttle_table_says() {
    let mut setup = aloft(bug());
    setup.vehicle.engine.throttle =
        Curve::new(vec![[800.0, 900.0], [2800.0, 2500.0], [5200.0, 5000.0]]);
    let model = setup.model();
    for (command_n, expected_n) in [(599.0, 0.0), (700.0, 900.0), (1800.0, 1700.0), (6e3, 5000.0)] {
        let mut state = commanded(&model, command_n);
        run(&model, &mut state, 4.0);
        // 40 lags: exp(-40) is 4e-18.
        assert!((thrust_n(&state) - expected_n).abs() < 1e-9, "{command_n} N");
    }
}

#[test]
fn specific_impulse_is_constant_or_follows_thrust() {
    let mut setup = aloft(bug());
    for by_throttle in [None, Curve::new(vec![[0.2, 210.0], [1.0, 240.0]])] {
        setup.vehicle.engine.isp_by_throttle = by_throttle.clone();
        let model = setup.model();
        for (command_n, table_s) in [(1040.0, 210.0), (3120.0, 225.0), (5200.0, 240.0)] {
            let mut state = commanded(&model, command_n);
            run(&model, &mut state, 4.0);
            let isp_s = if by_throttle.is_some() { table_s } else { 225.0 };
            let expected = command_n / (isp_s * G0_M_S2);
            let flow = flow_kg_s(&model, &mut state);
            assert!((flow / expected - 1.0).abs() < FLOW_ROUNDING, "{command_n} N: {flow} kg/s");
        }
    }
}

#[test]
fn in_the_dead_zone_combustion_is_off_or_flickers_by_the_seed() {
    let mut setup = aloft(bug());
    let history = |setup: &Setup| -> Vec<f64> {
        let model = setup.model();
        let mut state = commanded(&model, 300.0);
        (0..60_000)
            .map(|_| {
                run(&model, &mut state, 1e-3);
                thrust_n(&state)
            })
            .collect()
    };
    assert!(history(&setup).iter().all(|thrust_n| *thrust_n == 0.0));
    setup.vehicle.engine.dead_zone = DeadZone::Unstable;
    let unstable = history(&setup);
    let mean_n = unstable.iter().sum::<f64>() / unstable.len() as f64;
    // Lit for 300/600 of the time at 300 N. 1,200 independent stretches of deviation 150 N: five
    // standard errors.
    assert!((mean_n - 150.0).abs() < 5.0 * 150.0 / 1200.0_f64.sqrt(), "mean {mean_n} N");
    assert!(unstable.iter().any(|n| *n > 250.0) && unstable[1000..].iter().any(|n| *n < 50.0));
    assert_eq!(unstable, history(&setup));
    setup.scenario.seed += 1;
    assert_ne!(unstable, history(&setup));
}

#[test]
fn known_errors_scale_thrust_and_flow_and_turn_the_thrust_line() {
    let mut setup = aloft(bug());
    let offset = &mut setup.scenario.disturbances.offset;
    (offset.thrust, offset.specific_impulse) = (-0.03, 0.02);
    offset.pointing_rad = [1_f64.to_radians(), 0.0];
    let model = setup.model();
    let mut state = commanded(&model, 3000.0);
    run(&model, &mut state, 4.0);
    assert!((thrust_n(&state) - 2910.0).abs() < 1e-9); // exp(-40) of a lag
    let expected = 2910.0 / (225.0 * 1.02 * G0_M_S2);
    assert!((flow_kg_s(&model, &mut state) / expected - 1.0).abs() < FLOW_ROUNDING);
    let wrench = state.drive.burn(model.vehicle(), &state.motion).driven;
    let angle_rad = (-wrench.force_b.y).atan2(wrench.force_b.z);
    assert!((angle_rad - 1_f64.to_radians()).abs() < 1e-15); // one rounding
    // The encoder doesn't see it.
    assert_eq!(state.motion.gimbal_rad, Vector2::zeros());
}

#[test]
fn mass_gravity_and_start_differ_from_what_the_files_say_by_the_errors() {
    let mut setup = aloft(bug());
    (setup.scenario.disturbances.offset.mass, setup.scenario.disturbances.offset.gravity) =
        (0.01, -0.005);
    let model = setup.model();
    let wet = |vehicle: &Vehicle| vehicle.mass.at(85.5).mass_kg;
    assert!((wet(model.vehicle()) / wet(&setup.vehicle) - 1.01).abs() < 1e-15);
    let mut state = model.initial_state();
    run(&model, &mut state, 2.0);
    let expected_m_s = -2.0 * 1.625 * 0.995;
    // 2,000 roundings of numbers near 3.
    assert!((state.motion.velocity_w.z - expected_m_s).abs() < 1e-12);
    setup.scenario.disturbances = Disturbances::MONTE_CARLO_TABLE;
    let start = setup.model().initial_state().motion;
    let moved_m = start.position_w - setup.scenario.initial.position_w;
    assert!(moved_m.norm() > 1.0 && moved_m.norm() < 60.0 && start.velocity_w.norm() > 0.1);
}

/// Standard deviation of `value` over 2,000 seeds, off `sigma` by so many standard errors.
fn deviation_off(
    preset: Disturbances,
    sigma: f64,
    value: impl Fn(&State, &TruthModel) -> f64,
) -> f64 {
    let mut setup = aloft(bug());
    setup.scenario.disturbances = preset;
    let runs = 2000_u64;
    let squares: f64 = (0..runs)
        .map(|seed| {
            setup.scenario.seed = seed;
            let model = setup.model();
            let mut state = commanded(&model, 3000.0);
            run(&model, &mut state, 1e-3);
            value(&state, &model).powi(2)
        })
        .sum();
    let deviation = (squares / runs as f64).sqrt();
    // Standard error of a deviation: sigma/sqrt(2 n).
    (deviation - sigma) / (sigma / (2.0 * runs as f64).sqrt())
}

#[test]
fn the_presets_spread_as_the_paper_s_tables_say() {
    let (runs, engine) = (Disturbances::MONTE_CARLO_TABLE, Disturbances::ENGINE_TABLE);
    let thrust = |state: &State, _: &TruthModel| state.drive.thrust_factor - 1.0;
    let pointing = |state: &State, _: &TruthModel| state.drive.pointing_error_rad.x.to_degrees();
    let off = [
        deviation_off(runs, 0.03_f64.hypot(0.01), thrust),
        deviation_off(runs, 1.0_f64.hypot(0.5), pointing),
        deviation_off(runs, 0.02, |state, _| state.drive.isp_factor - 1.0),
        deviation_off(runs, 0.005, |_, model| model.scenario().gravity_m_s2 / 1.625 - 1.0),
        deviation_off(runs, 0.01, |_, model| model.vehicle().mass.at(85.5).mass_kg / 259.5 - 1.0),
        deviation_off(runs, 10.0, |_, model| model.scenario().initial.position_w.x),
        deviation_off(runs, 2.0, |_, model| model.scenario().initial.velocity_w.y),
        deviation_off(runs, 0.05, |state, model| {
            state.drive.disturbance_b.x / model.vehicle().mass.at(85.5).mass_kg
        }),
        deviation_off(engine, 0.017, thrust),
        deviation_off(engine, 0.5, pointing),
    ];
    Claim {
        id: "disturbance-spread",
        section: "Engine and disturbances",
        claim: "ten deviations of both presets over 2,000 seeds, in standard errors",
        reference: "the paper's Tables VI and VIII",
        unit: "",
        bound: Bound::AtMost(5.0),
        origin: "five standard errors: one seed in a million",
        noise: 0.0,
    }
    .holds_for(off);
}

#[test]
fn noise_goes_on_bit_for_bit_from_a_stored_state() {
    let mut setup = aloft(bug());
    setup.scenario.disturbances = Disturbances::MONTE_CARLO_TABLE;
    let model = setup.model();
    let mut state = commanded(&model, 3000.0);
    state.command.rcs_torque_b = Vector3::new(7.0, -3.0, 1.0);
    run(&model, &mut state, 0.777);
    let bytes = postcard::to_allocvec(&state).unwrap();
    let mut restored: State = postcard::from_bytes(&bytes).unwrap();
    run(&model, &mut state, 1.0);
    run(&setup.model(), &mut restored, 1.0);
    assert_eq!(state.motion, restored.motion);
    assert_eq!(state.propulsion, restored.propulsion);
}

#[test]
fn pulsed_thrusters_turn_the_vehicle_as_ideal_ones_to_within_a_pulse() {
    let mut setup = aloft(common::symmetric_bug());
    let inertia_kg_m2 = setup.vehicle.mass.at(85.5).inertia_b[(2, 2)];
    let spin = |setup: &Setup| {
        let model = setup.model();
        let mut state = model.initial_state();
        state.command.rcs_torque_b.z = 5.0;
        run(&model, &mut state, 10.0);
        (state.motion.rate_b.z, 85.5 - state.motion.propellant_kg)
    };
    let (pulsed_rad_s, pulsed_kg) = spin(&setup);
    setup.vehicle.rcs.min_pulse = None;
    let (ideal_rad_s, ideal_kg) = spin(&setup);
    Claim {
        id: "rcs-pulses",
        section: "Engine and disturbances",
        claim: "impulse of 10 s of thruster pulses, less that of ideal thrusters",
        reference: "what was asked for, 50 N m s",
        unit: "N m s",
        bound: Bound::AtMost(0.7 + 1e-6),
        origin: "one pulse is owed at most: 35 N m for 20 ms",
        noise: 0.0,
    }
    .holds((pulsed_rad_s - ideal_rad_s) * inertia_kg_m2);
    assert!(pulsed_rad_s != ideal_rad_s);
    // (T.7): what is used follows what is fired, impulse over L I_sp g0.
    let per_impulse = 1.0 / (1.13 * 160.0 * G0_M_S2);
    // 10^4 roundings of 85 kg, 7e-15 kg each.
    assert!((ideal_kg - 5.0 * 10.0 * per_impulse).abs() < 1e-10);
    // The tensor falls by what was burnt, 0.04 % at most.
    let pulsed_impulse = pulsed_rad_s * inertia_kg_m2;
    assert!((pulsed_kg / (pulsed_impulse * per_impulse) - 1.0).abs() < 4e-4);
}
