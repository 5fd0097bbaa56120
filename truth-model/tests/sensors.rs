//! Sensors against their specifications: exact where they should be, as wrong as the vehicle file
//! says where they should not. Statistical bounds are five standard errors of the estimate, for a
//! fixed seed: they hold or fail for good.

mod common;

use claims::{Bound, Claim};
use common::{Setup, on_plane, symmetric_bug};
use lander_models::component::Component;
use lander_models::frames::tilt_rad;
use lander_models::scenario::{DropOut, Navigation};
use lander_models::signals::{SENSOR_SLOTS, TRUTH};
use lander_models::time::Ticks;
use lander_models::vehicle::{Sensors, TriadSpec};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::sensors::Readings;
use truth_model::{State, TruthModel};

/// BUG, 100 m above ground, at rest where nothing pulls: true readings are constant.
fn afloat(navigation: Navigation) -> Setup {
    let mut setup = on_plane(symmetric_bug(), 40.0);
    setup.scenario.gravity_m_s2 = 0.0;
    setup.scenario.initial.position_w = Vector3::new(20.0, -10.0, 100.0);
    setup.scenario.sensing.navigation = navigation;
    setup
}

fn sensors(setup: &mut Setup) -> &mut Sensors {
    setup.vehicle.sensors.as_mut().unwrap()
}

fn advance(model: &TruthModel, state: &mut State, ticks: u64) {
    for _ in 0..ticks {
        model.tick(state).unwrap();
    }
}

/// Readings after every `period` ticks, `count` times.
fn series(model: &TruthModel, period: u64, count: usize) -> Vec<Readings> {
    let mut state = model.initial_state();
    let sample = |_| {
        advance(model, &mut state, period);
        model.readings(&state)
    };
    (0..count).map(sample).collect()
}

/// First readings of as many runs with different seeds.
fn ensemble(setup: &Setup, ticks: u64, count: u64) -> Vec<Readings> {
    let first = |seed| {
        let mut setup = setup.clone();
        setup.scenario.seed = seed;
        let model = setup.model();
        let mut state = model.initial_state();
        advance(&model, &mut state, ticks);
        model.readings(&state)
    };
    (0..count).map(first).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
}

/// Normal draws have this deviation: the variance of n of them has a relative standard error of
/// sqrt(2/(n - 1)).
#[track_caller]
fn assert_sigma(values: &[f64], sigma: f64, what: &str) {
    let ratio = variance(values) / (sigma * sigma);
    let bound = 5.0 * (2.0 / (values.len() - 1) as f64).sqrt();
    assert!((ratio - 1.0).abs() < bound, "{what}: variance is {ratio} of its specification");
}

#[track_caller]
fn assert_mean(values: &[f64], expected: f64, sigma: f64, what: &str) {
    let bound = 5.0 * sigma / (values.len() as f64).sqrt();
    let mean = mean(values);
    assert!((mean - expected).abs() < bound, "{what}: mean {mean}, expected {expected}");
}

fn components(values: impl Iterator<Item = Vector3<f64>>) -> [Vec<f64>; 3] {
    let all: Vec<_> = values.collect();
    [0, 1, 2].map(|axis| all.iter().map(|v| v[axis]).collect())
}

fn tumbling_on_a_slope() -> Setup {
    let mut setup = on_plane(symmetric_bug(), 40.0);
    setup.scenario.terrain.slope_rad = 0.2;
    setup.scenario.terrain.downhill_rad = 0.7;
    setup.scenario.initial.position_w = Vector3::new(30.0, -60.0, 400.0);
    setup.scenario.initial.velocity_w = Vector3::new(-3.0, 8.0, -20.0);
    setup.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1);
    setup.scenario.initial.rate_b = Vector3::new(0.02, -0.05, 0.1);
    setup
}

#[test]
fn perfect_navigation_tells_the_truth_of_the_instant() {
    let setup = tumbling_on_a_slope();
    let model = setup.model();
    let mut state = model.initial_state();
    for ticks in [0, 7, 500, 3] {
        advance(&model, &mut state, ticks);
        let (motion, readings) = (state.motion, model.readings(&state));
        let mounts = setup.vehicle.sensors.as_ref().unwrap();
        let (x, y) = (motion.position_w.x, motion.position_w.y);
        let height_m = motion.position_w.z - model.ground().height_m(x, y);
        assert_eq!(readings.altimeter.value.height_m, height_m);
        let velocity_w = motion.point_velocity_w(&mounts.velocimeter.mount_b);
        assert_eq!(readings.velocimeter.value, motion.attitude_wb.inverse() * velocity_w);
        assert_eq!(readings.star_tracker.value, motion.attitude_wb);
        assert_eq!(readings.landmark.value, motion.position_w);
        // Slant range to a plane: distance over the cosine of incidence.
        let normal_w = setup.scenario.terrain.normal_w();
        let from_w = motion.point_position_w(&mounts.altimeter.mount_b);
        let beam_w = motion.attitude_wb * -Vector3::z();
        let range_m = -normal_w.dot(&from_w) / normal_w.dot(&beam_w);
        // Roundings of 1e-13 m at some 500 m, through a secant.
        assert!((readings.altimeter.value.range_m - range_m).abs() < 1e-11);
        let imu_has_sampled = state.now.0 >= 10;
        assert_eq!(readings.valid().to_array(), [imu_has_sampled, true, true, true, true, true]);
    }
}

#[test]
fn imu_off_the_axis_of_a_spin_feels_the_centripetal_force() {
    let mut setup = afloat(Navigation::Perfect);
    let (rate_rad_s, lever_m) = (1.5, 0.4);
    setup.scenario.initial.rate_b = Vector3::z() * rate_rad_s;
    sensors(&mut setup).imu.mount_b = Vector3::new(0.0, lever_m, 1.1);
    let imu = series(&setup.model(), 10, 5).pop().unwrap().imu.value;
    // The mean over 10 ms is the chord of the velocity's turn: sin(x)/x of ω² r, x = ω 5 ms.
    let x: f64 = rate_rad_s * 0.005;
    let force = rate_rad_s.powi(2) * lever_m * x.sin() / x;
    Claim {
        id: "imu-lever",
        section: "Sensors",
        claim: "specific force of an IMU 0.4 m off the axis of a spin",
        reference: "ω² r sin(ωT/2)/(ωT/2)",
        unit: "m/s²",
        bound: Bound::AtMost(1e-12),
        origin: "differences of 1 m/s over 10 ms: 1e-14, some tens of roundings",
        noise: 1e-12,
    }
    .holds((imu.specific_force_b - Vector3::new(0.0, -force, 0.0)).norm());
    assert!((imu.rate_b - Vector3::z() * rate_rad_s).norm() < 1e-12);
}

#[test]
fn imu_in_free_fall_feels_nothing_and_on_its_feet_the_weight() {
    let mut falling = afloat(Navigation::Perfect);
    falling.scenario.gravity_m_s2 = common::GRAVITY_M_S2;
    let imu = series(&falling.model(), 10, 100).pop().unwrap().imu.value;
    // Speeds near 2 m/s: roundings of 1e-16 m/s over 10 ms, ten of them.
    assert!(imu.specific_force_b.norm() < 1e-12);
    let standing = on_plane(symmetric_bug(), 0.0).model();
    let imu = series(&standing, 10, 500).pop().unwrap().imu.value;
    // The gear has settled to below 1 µm/s after 5 s: 1e-6 m/s over 10 ms.
    assert!((imu.specific_force_b - Vector3::z() * common::GRAVITY_M_S2).norm() < 1e-4);
}

#[test]
fn strapdown_integration_of_the_imu_is_exact() {
    let model = tumbling_on_a_slope().model();
    let mount_b = model.vehicle().sensors.as_ref().unwrap().imu.mount_b;
    let gravity_w = Vector3::z() * -common::GRAVITY_M_S2;
    let mut state = model.initial_state();
    let mut attitude_wb = state.motion.attitude_wb;
    let mut velocity_w = state.motion.point_velocity_w(&mount_b);
    // Thrust on a deflected gimbal and thrusters: it spins up.
    let inputs = [2000.0, 0.02, -0.01, 5.0, -3.0, 2.0];
    for _ in 0..500 {
        model.step(&mut state, &inputs, Ticks(10)).unwrap();
        let imu = model.readings(&state).imu.value;
        let half = UnitQuaternion::from_scaled_axis(imu.rate_b * 0.005);
        velocity_w += (attitude_wb * half) * imu.specific_force_b * 0.01 + gravity_w * 0.01;
        attitude_wb = attitude_wb * half * half;
    }
    assert!(state.motion.rate_b.norm() > 0.3, "it should have spun up");
    Claim {
        id: "strapdown-velocity",
        section: "Sensors",
        claim: "velocity integrated from the perfect IMU over 5 s of tumbling under thrust",
        reference: "the vehicle's own",
        unit: "m/s",
        bound: Bound::AtMost(1e-11),
        origin: "500 roundings of 1e-14 m/s",
        noise: 1e-12,
    }
    .holds((velocity_w - state.motion.point_velocity_w(&mount_b)).norm());
    let left_b = (attitude_wb.inverse() * state.motion.attitude_wb).scaled_axis();
    Claim {
        id: "strapdown-attitude",
        section: "Sensors",
        claim: "attitude of the same",
        reference: "the vehicle's own",
        unit: "rad",
        bound: Bound::AtMost(1e-12),
        origin: "500 roundings of 1e-16 in the quaternion, with room",
        noise: 1e-13,
    }
    .holds(left_b.norm());
}

#[test]
fn altimeter_noise_and_turn_on_errors_have_their_deviations() {
    let setup = afloat(Navigation::Sensors);
    let spec = setup.vehicle.sensors.clone().unwrap().altimeter;
    let range_m = 100.0 + spec.mount_b.z;
    let noise_m = spec.noise_m.hypot(spec.noise_relative * range_m);
    let within: Vec<f64> = series(&setup.model(), spec.period.0, 4000)
        .iter()
        .map(|r| r.altimeter.value.range_m)
        .collect();
    assert_sigma(&within, noise_m, "noise within a run");
    let across: Vec<f64> =
        ensemble(&setup, 0, 2000).iter().map(|r| r.altimeter.value.range_m - range_m).collect();
    let total_m = noise_m.hypot(spec.bias_m).hypot(spec.scale * range_m);
    assert_sigma(&across, total_m, "all errors across runs");
    assert_mean(&across, 0.0, total_m, "all errors across runs");
}

#[test]
fn altimeter_height_has_the_range_s_error_projected_on_the_vertical() {
    let mut setup = afloat(Navigation::Sensors);
    setup.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(0.4, 0.2, 0.0);
    let tilted = setup.scenario.initial.attitude_wb;
    setup.scenario.sensing.navigation = Navigation::Perfect;
    let exact = ensemble(&setup, 0, 1)[0].altimeter.value;
    setup.scenario.sensing.navigation = Navigation::Sensors;
    let measured = ensemble(&setup, 0, 1)[0].altimeter.value;
    let (height_m, range_m) =
        (measured.height_m - exact.height_m, measured.range_m - exact.range_m);
    assert!(range_m.abs() > 1e-3, "an error is expected");
    // Roundings of 1e-14 m at 100 m.
    assert!((height_m - range_m * tilt_rad(&tilted).cos()).abs() < 1e-12);
}

#[test]
fn velocimeter_noise_grows_with_speed_and_biases_differ_by_axis() {
    let mut setup = afloat(Navigation::Sensors);
    // 5 % of noise, so that 1 s of motion leaves the ground in range and the share visible.
    sensors(&mut setup).velocimeter.noise_relative = 0.05;
    let spec = setup.vehicle.sensors.clone().unwrap().velocimeter;
    let velocity_w = Vector3::new(0.0, 0.5, -2.0);
    setup.scenario.initial.velocity_w = velocity_w;
    let across = ensemble(&setup, 0, 2000);
    let errors = components(across.iter().map(|r| r.velocimeter.value - velocity_w));
    for (axis, errors) in errors.iter().enumerate() {
        let speed = velocity_w[axis];
        let noise = spec.noise_m_s.hypot(spec.noise_relative * speed);
        let total = noise.hypot(spec.bias_m_s).hypot(spec.scale * speed);
        assert_sigma(errors, total, "velocimeter");
        assert_mean(errors, 0.0, total, "velocimeter");
    }
}

#[test]
fn star_tracker_errs_more_about_its_boresight_than_across() {
    let mut setup = afloat(Navigation::Sensors);
    sensors(&mut setup).star_tracker.period = Ticks(20);
    let spec = setup.vehicle.sensors.clone().unwrap().star_tracker;
    let within = series(&setup.model(), spec.period.0, 2000);
    let turns: Vec<_> = within.iter().map(|r| r.star_tracker.value.scaled_axis()).collect();
    let along = |axis_b: Vector3<f64>| turns.iter().map(|t| t.dot(&axis_b)).collect::<Vec<_>>();
    let boresight_b = *spec.boresight_b;
    let across_b = boresight_b.cross(&Vector3::y()).normalize();
    assert_sigma(&along(boresight_b), spec.noise_about_rad, "about the boresight");
    assert_sigma(&along(across_b), spec.noise_across_rad, "across the boresight");
    assert_sigma(&along(boresight_b.cross(&across_b)), spec.noise_across_rad, "across");
    // Misalignment across runs: per axis, with the noise of one sample on top.
    let across = ensemble(&setup, 0, 1000);
    let y: Vec<f64> = across.iter().map(|r| r.star_tracker.value.scaled_axis().y).collect();
    assert_sigma(&y, spec.misalignment_rad.hypot(spec.noise_across_rad), "misalignment");
}

#[test]
fn landmark_fixes_scatter_about_a_map_that_is_off() {
    let mut setup = afloat(Navigation::Sensors);
    let mut spec = setup.vehicle.sensors.clone().unwrap().landmark.unwrap();
    spec.period = Ticks(20);
    sensors(&mut setup).landmark = Some(spec.clone());
    let within = series(&setup.model(), spec.period.0, 500);
    let across = ensemble(&setup, 0, 1000);
    let truth_w = setup.scenario.initial.position_w;
    let within = components(within.iter().map(|r| r.landmark.value));
    let across = components(across.iter().map(|r| r.landmark.value - truth_w));
    for axis in 0..3 {
        assert_sigma(&within[axis], spec.noise_w[axis], "within a run");
        assert_sigma(&across[axis], spec.noise_w[axis].hypot(spec.bias_w[axis]), "across runs");
    }
}

/// One triad alone in the gyro: its other errors are zero.
fn gyro(spec: TriadSpec) -> Setup {
    let mut setup = afloat(Navigation::Sensors);
    sensors(&mut setup).imu.gyro = spec;
    setup
}

#[test]
fn angle_random_walk_falls_as_white_noise_in_the_allan_deviation() {
    let random_walk = 4e-5;
    let setup = gyro(TriadSpec { random_walk, bias: 1e-4, ..TriadSpec::default() });
    let readings = series(&setup.model(), 10, 40_000);
    let rates: Vec<f64> = readings.iter().map(|r| r.imu.value.rate_b.x).collect();
    let mut off = Vec::new();
    for cluster in [1, 10, 100] {
        let means: Vec<f64> = rates.chunks_exact(cluster).map(mean).collect();
        // Allan variance: half the mean square of successive differences; N²/τ for white noise
        // (IEEE Std 952).
        let allan = means.windows(2).map(|w| 0.5 * (w[1] - w[0]).powi(2)).sum::<f64>()
            / (means.len() - 1) as f64;
        let expected = random_walk * random_walk / (0.01 * cluster as f64);
        // Relative standard error of this estimator for white noise: sqrt(3/(n - 1)).
        off.push((allan / expected - 1.0) / (3.0 / (means.len() - 1) as f64).sqrt());
    }
    Claim {
        id: "gyro-allan",
        section: "Sensors",
        claim: "Allan variance of the gyro over 0.01, 0.1 and 1 s, in standard errors",
        reference: "N²/τ of white noise (IEEE Std 952)",
        unit: "",
        bound: Bound::AtMost(5.0),
        origin: "five standard errors: one seed in a million",
        noise: 0.0,
    }
    .holds_for(off);
    // Integrated, the walk's deviation grows with the root of time: 1 s windows, bias removed.
    let bias = mean(&rates);
    let walks: Vec<f64> =
        rates.chunks_exact(100).map(|w| w.iter().map(|x| (x - bias) * 0.01).sum()).collect();
    assert_sigma(&walks, random_walk, "angle after 1 s");
}

#[test]
fn bias_instability_is_a_stationary_gauss_markov_process() {
    let (drift, drift_time_s) = (1e-5, 0.2);
    let setup = gyro(TriadSpec { drift, drift_time_s, ..TriadSpec::default() });
    let rates: Vec<f64> =
        series(&setup.model(), 10, 40_000).iter().map(|r| r.imu.value.rate_b.y).collect();
    let correlation = |lag: usize| {
        let products: Vec<f64> = rates.windows(lag + 1).map(|w| w[0] * w[lag]).collect();
        mean(&products) / (drift * drift)
    };
    // 400 s hold 400/(2 · 0.2) independent stretches: a correlation errs by at most sqrt(2/1000).
    let error = (2.0_f64 / 1000.0).sqrt();
    let off = [0, 10, 20, 100].map(|lag| {
        let expected = (-0.01 * lag as f64 / drift_time_s).exp();
        (correlation(lag) - expected) / error
    });
    Claim {
        id: "gyro-drift",
        section: "Sensors",
        claim: "autocorrelation of the gyro's drift at 0 to 1 s, in standard errors",
        reference: "exp(−t/τ) of a Gauss-Markov process",
        unit: "",
        bound: Bound::AtMost(5.0),
        origin: "five standard errors of 1,000 independent stretches",
        noise: 0.0,
    }
    .holds_for(off);
    // Stationary from the first sample on.
    let first = ensemble(&setup, 10, 1000);
    let first: Vec<f64> = first.iter().map(|r| r.imu.value.rate_b.z).collect();
    assert_sigma(&first, drift, "first sample across runs");
}

#[test]
fn imu_biases_and_scale_factors_are_drawn_once_a_run() {
    let mut setup = gyro(TriadSpec { bias: 2e-5, ..TriadSpec::default() });
    sensors(&mut setup).imu.accelerometer =
        TriadSpec { scale: 1e-3, drift_time_s: 1.0, ..TriadSpec::default() };
    setup.scenario.initial.rate_b = Vector3::z();
    sensors(&mut setup).imu.mount_b = Vector3::x();
    let model = setup.model();
    let runs = series(&model, 10, 3);
    // A bias alone: the same at every sample, to the rounding of a rate of 1 rad/s.
    assert!((runs[0].imu.value.rate_b - runs[2].imu.value.rate_b).norm() < 1e-12);
    let across = ensemble(&setup, 10, 1000);
    let bias: Vec<f64> = across.iter().map(|r| r.imu.value.rate_b.x).collect();
    assert_sigma(&bias, 2e-5, "gyro bias");
    // 1 m/s² towards the axis.
    let scale: Vec<f64> = across.iter().map(|r| r.imu.value.specific_force_b.x + 1.0).collect();
    assert_sigma(&scale, 1e-3, "accelerometer scale factor");
}

#[test]
fn samples_are_held_between_their_times() {
    let setup = afloat(Navigation::Sensors);
    let every_tick = series(&setup.model(), 1, 120);
    for (before, after) in every_tick.iter().zip(&every_tick[1..]) {
        let new = after.altimeter.samples != before.altimeter.samples;
        assert_eq!(new, after.altimeter.value != before.altimeter.value);
    }
    // At 0, 50 and 100 ms; the IMU every 10 ms, first at 10 ms.
    let last = every_tick.last().unwrap().samples();
    assert_eq!((last.altimeter, last.imu, last.star_tracker), (3, 12, 1));
}

#[test]
fn a_drop_out_holds_the_reading_and_clears_its_flag() {
    let mut setup = afloat(Navigation::Sensors);
    setup.scenario.sensing.sensors.altimeter.drop_outs =
        vec![DropOut { onset: Ticks(200), end: Ticks(400) }];
    let whole = series(&afloat(Navigation::Sensors).model(), 50, 12);
    let broken = series(&setup.model(), 50, 12);
    for n in 0..12 {
        let lost = (200..400).contains(&(50 * (n + 1)));
        assert_eq!(broken[n].altimeter.valid, !lost, "sample {n}");
        // Held from 150 ms on; else the readings are those of a run without a drop-out.
        let source = if lost { 2 } else { n };
        assert_eq!(broken[n].altimeter.value, whole[source].altimeter.value);
        assert_eq!(broken[n].velocimeter, whole[n].velocimeter, "another sensor has changed");
    }
}

#[test]
fn random_drop_outs_come_as_often_as_asked() {
    let mut setup = afloat(Navigation::Sensors);
    setup.scenario.sensing.sensors.velocimeter.drop_out_probability = 0.2;
    let count = 4000;
    let readings = series(&setup.model(), 50, count);
    let lost = readings.iter().filter(|r| !r.velocimeter.valid).count() as f64;
    // Binomial.
    let sigma = (count as f64 * 0.2 * 0.8).sqrt();
    assert!((lost - 0.2 * count as f64).abs() < 5.0 * sigma, "{lost} of {count} lost");
    assert!(readings.iter().all(|r| r.altimeter.valid));
}

#[test]
fn limits_take_a_sensor_out() {
    let mut setup = afloat(Navigation::Sensors);
    setup.scenario.initial.position_w.z = 30.0;
    setup.scenario.initial.rate_b = Vector3::new(0.0, 0.0, 0.03);
    let fit = sensors(&mut setup);
    fit.altimeter.range_m = 0.5..=25.0;
    fit.velocimeter.range_m = 40.0..=100.0;
    let now = ensemble(&setup, 10, 1).pop().unwrap();
    assert_eq!(now.valid().to_array(), [true, false, false, false, true, false]);
    // What was true at the start stands in for a reading that never came.
    assert_eq!(now.altimeter.value.height_m, 30.0);
    // Looking at the sky there is no return, in range or not.
    sensors(&mut setup).altimeter.range_m = 0.0..=1e3;
    setup.scenario.initial.attitude_wb = UnitQuaternion::from_euler_angles(2.5, 0.0, 0.0);
    for navigation in [Navigation::Perfect, Navigation::Sensors] {
        setup.scenario.sensing.navigation = navigation;
        let now = ensemble(&setup, 0, 1).pop().unwrap();
        assert_eq!((now.altimeter.valid, now.altimeter.value.range_m), (false, 0.0));
    }
}

#[test]
fn errors_can_be_switched_off_one_by_one() {
    let mut setup = afloat(Navigation::Sensors);
    let noisy = series(&setup.model(), 50, 5);
    setup.scenario.sensing.sensors.altimeter.errors = false;
    let quiet = series(&setup.model(), 50, 5);
    for (noisy, quiet) in noisy.iter().zip(&quiet) {
        assert_eq!(quiet.altimeter.value.height_m, 100.0);
        assert_ne!(noisy.altimeter.value.height_m, 100.0);
        // Streams are independent: no other sensor's draws move.
        assert_eq!(noisy.imu, quiet.imu);
        assert_eq!(noisy.velocimeter, quiet.velocimeter);
        assert_eq!(noisy.landmark, quiet.landmark);
    }
}

#[test]
fn equal_seeds_give_equal_readings_and_streams_are_uncorrelated() {
    let mut setup = afloat(Navigation::Sensors);
    let (first, again) = (series(&setup.model(), 50, 2000), series(&setup.model(), 50, 2000));
    assert_eq!(first, again);
    setup.scenario.seed = 1;
    let other = series(&setup.model(), 50, 2000);
    let altimeter =
        |all: &[Readings]| all.iter().map(|r| r.altimeter.value.range_m).collect::<Vec<_>>();
    let velocimeter: Vec<f64> = first.iter().map(|r| r.velocimeter.value.z).collect();
    for partner in [altimeter(&other), velocimeter] {
        let (a, b) = (altimeter(&first), partner);
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        let products: Vec<f64> =
            a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b)).collect();
        let correlation = mean(&products) / (variance(&a) * variance(&b)).sqrt();
        // Of independent series: 1/sqrt(n).
        assert!(correlation.abs() < 5.0 / 2000_f64.sqrt(), "correlation {correlation}");
    }
}

/// Steps with held commands until `end`.
fn step_to(model: &TruthModel, state: &mut State, step: u64, end: u64) {
    while state.now.0 < end {
        model.step(state, &[1500.0, 0.01, 0.0, 0.0, 2.0, 0.0], Ticks(step)).unwrap();
    }
}

#[test]
fn readings_depend_on_no_communication_step_and_survive_a_restart() {
    let mut setup = tumbling_on_a_slope();
    setup.scenario.sensing.navigation = Navigation::Sensors;
    let model = setup.model();
    let readings = [1, 10, 70].map(|step| {
        let mut state = model.initial_state();
        step_to(&model, &mut state, step, 700);
        model.readings(&state)
    });
    assert_eq!(readings[0], readings[1]);
    assert_eq!(readings[0], readings[2]);
    let mut state = model.initial_state();
    step_to(&model, &mut state, 10, 330);
    let stored = postcard::to_allocvec(&state).unwrap();
    let mut restored: State = postcard::from_bytes(&stored).unwrap();
    step_to(&model, &mut restored, 10, 700);
    assert_eq!(model.readings(&restored), readings[0]);
}

/// BUG dropped from 5 cm: time of the first true contact and of the first told one, per leg 0.
fn contact_times(change: impl Fn(&mut Sensors)) -> (Option<u64>, Option<u64>) {
    let mut setup = on_plane(symmetric_bug(), 0.0);
    setup.scenario.initial.position_w.z = 0.05;
    setup.scenario.sensing.navigation = Navigation::Sensors;
    sensors(&mut setup).leg_probes.miss_probability = 0.0;
    change(sensors(&mut setup));
    let model = setup.model();
    let mut state = model.initial_state();
    let (mut real, mut told) = (None, None);
    for tick in 1..=1000 {
        model.tick(&mut state).unwrap();
        real = real.or(state.feet_down[0].then_some(tick));
        told = told.or(model.readings(&state).leg_probes.value[0].then_some(tick));
    }
    (real, told)
}

#[test]
fn leg_probes_tell_contacts_late_early_or_never() {
    let (real, told) = contact_times(|fit| fit.leg_probes.delay = Ticks::ZERO);
    assert!(real.is_some());
    assert_eq!(real, told);
    let (real, told) = contact_times(|fit| fit.leg_probes.delay = Ticks(3));
    assert!(told >= real.map(|tick| tick + 3), "told at {told:?}, real at {real:?}");
    let (_, told) = contact_times(|fit| fit.leg_probes.miss_probability = 1.0);
    assert_eq!(told, None);
    // A wand of 3 cm touches after a fall of 2 cm: sqrt(2 · 0.02/g), to the tick.
    let (real, told) = contact_times(|fit| {
        fit.leg_probes.delay = Ticks::ZERO;
        fit.leg_probes.length_m = 0.03;
    });
    let fall_s = (2.0 * 0.02 / common::GRAVITY_M_S2).sqrt();
    assert_eq!(told, Some((fall_s * 1e3).ceil() as u64));
    assert!(told < real);
}

#[test]
fn outputs_carry_the_readings() {
    let mut setup = afloat(Navigation::Sensors);
    setup.scenario.seed = 3;
    let model = setup.model();
    let mut state = model.initial_state();
    advance(&model, &mut state, 610);
    let mut outputs = vec![0.0; TRUTH.output_len()];
    model.outputs(&state, &mut outputs);
    let at = |name: &str| &outputs[TRUTH.output_offset(name).unwrap()..];
    let readings = model.readings(&state);
    assert_eq!(at("altimeter_m")[0], readings.altimeter.value.height_m);
    assert_eq!(at("altimeter_range_m")[0], readings.altimeter.value.range_m);
    assert_eq!(at("imu_rate_b")[..3], *readings.imu.value.rate_b.as_slice());
    assert_eq!(at("star_tracker_attitude_wb")[0], readings.star_tracker.value.w);
    assert_eq!(at("sensor_valid")[..SENSOR_SLOTS], [1.0; SENSOR_SLOTS]);
    assert_eq!(at("sensor_samples")[..SENSOR_SLOTS], [61.0, 13.0, 13.0, 2.0, 611.0, 1.0]);
    // Guidance's state inputs stay the truth until a filter takes over.
    assert_eq!(at("position_w")[..3], *state.motion.position_w.as_slice());
}
