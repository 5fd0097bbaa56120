//! The navigation filter over the truth's sensors: as wrong as it says, through drop-outs and
//! failures, and good enough to land on.

mod flight;

use claims::{Bound, Claim};
use flight::{CORE, Flight, STEP, drawn, landing};
use guidance_fmu::navigation::nominal::{ATTITUDE, POSITION, VELOCITY};
use lander_models::Ticks;
use lander_models::scenario::{DropOut, Sensor, SensorFailure};
use lander_models::signals::{ALTIMETER_RANGE_M, GUIDANCE, SENSOR_SAMPLES, SENSOR_VALID};
use nalgebra::{Matrix3, Vector3};

const RUNS: u64 = 40;
/// The default landing touches down after some 25 s.
const FLIGHT_S: u64 = 24;

/// Quantile of χ² over its degrees of freedom at a normal deviate (Wilson and Hilferty 1931).
fn chi_square_ratio(freedom: f64, deviate: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    (1.0 - spread + deviate * spread.sqrt()).powi(3)
}

/// Normal deviates of two-sided 95 %.
const TWO_SIDED: f64 = 1.96;

/// Half-widths of the two-sided 95 % interval of a mean NEES or NIS over its expectation, in
/// units of which a ratio's distance from 1 is told.
fn deviates(ratio: f64, freedom: f64) -> f64 {
    let bound = chi_square_ratio(freedom, TWO_SIDED.copysign(ratio - 1.0));
    (ratio - 1.0).abs() / (bound - 1.0).abs()
}

#[test]
fn errors_and_innovations_are_as_large_as_the_filter_says() {
    let mut nees = [0.0; FLIGHT_S as usize + 1];
    let mut nis = [[0.0; 2]; 6];
    for seed in 1..=RUNS {
        let mut flight = Flight::new(drawn(seed));
        for step in 0..=FLIGHT_S * 100 {
            for (sums, update) in nis.iter_mut().zip(flight.observe().to_array()) {
                if let Some(update) = update {
                    *sums = [sums[0] + update.nis, sums[1] + 1.0];
                }
            }
            if step % 100 == 0 {
                nees[step as usize / 100] += flight.nees() / (RUNS as f64 * CORE as f64);
            }
            flight.fly();
        }
    }
    println!("NEES over its expectation, each second: {nees:.3?}");
    let within = |ratio: &&f64| deviates(**ratio, (RUNS * CORE as u64) as f64) <= 1.0;
    let share = nees.iter().filter(within).count() as f64 / nees.len() as f64;
    Claim {
        id: "navigation-nees",
        section: "Navigation",
        claim: "instants at which the mean NEES of 40 flights lies within its 95 % interval",
        reference: "χ² of 40 · 15 degrees of freedom",
        unit: "%",
        bound: Bound::AtLeast(90.0),
        origin: "95 % of the instants on average; successive ones depend on each other",
        noise: 0.0,
    }
    .holds(100.0 * share);
    // Innovations are white, so all samples of all flights count.
    let sensors = [("altimeter", 1, 1.0), ("velocimeter", 2, 3.0), ("star tracker", 3, 3.0)];
    for (name, slot, size) in sensors.into_iter().chain([("landmark", 5, 3.0)]) {
        let [sum, count] = nis[slot];
        let ratio = sum / (count * size);
        println!("NIS of the {name} over its expectation: {ratio:.4} in {count} samples");
        Claim {
            id: &format!("navigation-nis-{}", name.replace(' ', "-")),
            section: "Navigation",
            claim: &format!("distance of the {name}'s mean NIS from its expectation"),
            reference: "χ² of all samples of 40 flights",
            unit: "95 % half-widths",
            bound: Bound::AtMost(1.0),
            origin: "the two-sided 95 % interval",
            noise: 0.0,
        }
        .holds(deviates(ratio, count * size));
    }
}

#[test]
fn the_covariance_stays_symmetric_and_positive_definite_for_a_minute() {
    let mut flight = Flight::new(landing());
    for step in 0..=6000 {
        flight.observe();
        let covariance = flight.estimator.filter.covariance;
        assert_eq!(covariance, covariance.transpose(), "after {step} steps");
        assert!(covariance.cholesky().is_some(), "after {step} steps");
        flight.fly();
    }
    assert!(!flight.airborne(), "flight, contact and rest were all seen");
}

/// No altimeter and no star tracker from 10 s to 15 s.
fn interrupted(seed: u64) -> Flight {
    let (mut scenario, vehicle) = drawn(seed);
    let gap = DropOut { onset: Ticks(10_000), end: Ticks(15_000) };
    scenario.sensing.sensors.altimeter.drop_outs = vec![gap];
    scenario.sensing.sensors.star_tracker.drop_outs = vec![gap];
    Flight::new((scenario, vehicle))
}

#[test]
fn a_drop_out_is_flown_through_and_told_by_the_covariance() {
    let instants = [9_900, 14_900, 20_000];
    let mut nees = [0.0; 3];
    for seed in 1..=RUNS {
        let mut flight = interrupted(seed);
        let mut attitude = [0.0; 3];
        for step in 0..=2000 {
            let updates = flight.observe();
            let now = flight.state.now.0;
            let lost = (10_000..15_000).contains(&now);
            assert!(!(lost && (updates.altimeter.is_some() || updates.star_tracker.is_some())));
            if let Some(n) = instants.iter().position(|instant| *instant == now) {
                nees[n] += flight.nees() / (RUNS as f64 * CORE as f64);
                attitude[n] = flight.estimator.filter.sigma3(ATTITUDE).norm();
            }
            assert_eq!(now, 10 * step);
            flight.fly();
        }
        let [before, at_end, after] = attitude;
        assert!(at_end > before && after < at_end, "seed {seed}: {attitude:?} rad");
    }
    println!("NEES over its expectation before, at the end of and after a drop-out: {nees:.3?}");
    Claim {
        id: "navigation-drop-out",
        section: "Navigation",
        claim: "mean NEES before, at the end of and after 5 s without altimeter and star tracker",
        reference: "χ² of 40 · 15 degrees of freedom",
        unit: "95 % half-widths",
        bound: Bound::AtMost(1.0),
        origin: "the two-sided 95 % interval",
        noise: 0.0,
    }
    .holds_for(nees.map(|ratio| deviates(ratio, (RUNS * CORE as u64) as f64)));
}

#[test]
fn a_stuck_reading_that_calls_itself_valid_is_refused() {
    let mut flight = Flight::new(landing());
    let at = |name: &str| GUIDANCE.input_offset(name).unwrap();
    let altimeter = 1;
    let (mut stuck_m, mut refused, mut seen) = (0.0, 0, 0);
    for step in 0..2000_u32 {
        let inputs = flight.inputs();
        if step == 1000 {
            stuck_m = inputs[at(ALTIMETER_RANGE_M.name)];
        }
        if step > 1000 {
            inputs[at(ALTIMETER_RANGE_M.name)] = stuck_m;
            assert_eq!(inputs[at(SENSOR_VALID.name) + altimeter], 1.0);
            assert!(inputs[at(SENSOR_SAMPLES.name) + altimeter] > 0.0);
        }
        let update = flight.observe_as_told().altimeter;
        // Within 0.2 s of its fall at some 20 m/s the vehicle has left the reading by ten of its
        // deviations, 0.3 m.
        if let Some(update) = update.filter(|_| step > 1020) {
            seen += 1;
            refused += usize::from(!update.taken);
        }
        flight.fly();
    }
    assert_eq!((seen, refused), (195, 195));
    flight.observe_as_told();
    let solution = flight.navigator.solution(&flight.estimator, flight.state.now);
    assert!(solution.rejected.altimeter >= 195.0);
    let origin_w = flight.state.motion.position_w;
    let height_m = origin_w.z - flight.truth.ground().height_m(origin_w.x, origin_w.y);
    let off = (solution.height_m - height_m) / solution.sigma.height_m;
    println!("height off by {off:.2} deviations of {:.2} m", solution.sigma.height_m);
    assert!(off.abs() < 3.9, "not misled: one in ten thousand is farther off");
}

/// What a flight on the filter came to.
#[derive(Debug, Default)]
struct Landed {
    outcome: f64,
    miss_m: f64,
    down_m_s: f64,
    across_m_s: f64,
    tilt_deg: f64,
    /// Horizontal error of the estimate just before contact.
    lost_m: f64,
    /// Squared error of the velocity estimate then, in units of its covariance.
    velocity_nees: f64,
    velocity_error_m_s: f64,
}

fn land(mut flight: Flight) -> Landed {
    let mut landed = Landed::default();
    for _ in 0..6000 {
        if flight.state.touchdown.decided() {
            break;
        }
        flight.observe();
        if flight.airborne() {
            let error = flight.error();
            let velocity: Vector3<f64> = error.fixed_rows::<3>(VELOCITY).into();
            let covariance: Matrix3<f64> =
                flight.covariance().fixed_view::<3, 3>(VELOCITY, VELOCITY).into();
            landed.lost_m = error.fixed_rows::<2>(POSITION).norm();
            landed.velocity_error_m_s = velocity.norm();
            landed.velocity_nees = velocity.dot(&covariance.cholesky().unwrap().solve(&velocity));
        }
        flight.fly();
    }
    let output = |name| flight.output(name);
    Landed {
        outcome: output("outcome"),
        miss_m: output("position_error_m"),
        down_m_s: output("contact_speed_down_m_s"),
        across_m_s: output("contact_speed_across_m_s"),
        tilt_deg: output("contact_tilt_deg"),
        ..landed
    }
}

#[test]
fn at_contact_the_estimate_is_what_a_soft_landing_needs() {
    let landings: Vec<Landed> = (1..=20)
        .map(|seed| {
            let (mut scenario, vehicle) = landing();
            scenario.seed = seed;
            let landed = land(Flight::closed((scenario, vehicle)));
            println!("{seed}: {landed:.3?}");
            landed
        })
        .collect();
    assert!(landings.iter().all(|landed| landed.outcome == 1.0));
    let claim = |id, claim, unit, limit, origin| Claim {
        id,
        section: "Navigation",
        claim,
        reference: "the truth, 20 landings flown on the filter",
        unit,
        bound: Bound::AtMost(limit),
        origin,
        noise: 0.0,
    };
    let listed = "the default landing's own limit";
    claim("navigation-landing-down", "worst downward contact speed", "m/s", 2.0, listed)
        .holds_for(landings.iter().map(|landed| landed.down_m_s));
    claim("navigation-landing-across", "worst horizontal contact speed", "m/s", 0.5, listed)
        .holds_for(landings.iter().map(|landed| landed.across_m_s));
    claim(
        "navigation-landing-miss",
        "worst miss beyond the horizontal error of the filter",
        "m",
        2.0,
        "the largest miss that the same flight may have on perfect navigation",
    )
    .holds_for(landings.iter().map(|landed| landed.miss_m - landed.lost_m));
    claim(
        "navigation-velocity-at-contact",
        "worst velocity error of the filter just before contact",
        "m/s",
        0.1,
        "a quarter of the 0.4 m/s across that a contact may have",
    )
    .holds_for(landings.iter().map(|landed| landed.velocity_error_m_s));
    let mean_m = landings.iter().map(|landed| landed.miss_m).sum::<f64>() / landings.len() as f64;
    println!("mean miss {mean_m:.2} m: the map's offset of 5 m an axis has a mean of 6.27 m");
    // χ² quantile of 3 degrees of freedom at 0.9999.
    assert!(landings.iter().all(|landed| landed.velocity_nees < 21.108));
}

#[test]
fn a_failed_sensor_is_done_without() {
    for sensor in [Sensor::Altimeter, Sensor::Velocimeter, Sensor::StarTracker] {
        let (mut scenario, vehicle) = landing();
        scenario.faults.sensor_failure = Some(SensorFailure { onset: Ticks(10_000), sensor });
        let mut flight = Flight::closed((scenario, vehicle));
        while flight.state.now < Ticks(10_000) + STEP {
            flight.observe();
            flight.fly();
        }
        let held = |flight: &mut Flight| {
            let updates = flight.observe();
            [updates.altimeter, updates.velocimeter, updates.star_tracker]
                [sensor as usize - Sensor::Altimeter as usize]
        };
        assert_eq!(held(&mut flight), None, "{sensor:?} goes unheard");
        let speed_sigma = flight.estimator.filter.sigma3(VELOCITY).norm();
        assert!(speed_sigma < 0.1, "{speed_sigma} m/s");
        let landed = land(flight);
        println!(
            "{sensor:?} lost at 10 s: outcome {}, {:.2} m/s down, {:.2} m/s across, {:.2} deg",
            landed.outcome, landed.down_m_s, landed.across_m_s, landed.tilt_deg
        );
        assert_eq!(landed.outcome, 1.0, "{sensor:?}");
    }
}
