//! Guidance under each of the ten failure modes, against the same flights without a response; and
//! not a single alarm where nothing fails.

use claims::{Bound, Claim};
use cosim::failures::{Ending, FAILURES, Failure, Flight, Wiring, campaign};
use cosim::statistics::spread::Spread;
use lander_models::Vehicle;

fn bug() -> Vehicle {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/vehicles/bug.toml");
    Vehicle::load(file.as_ref()).unwrap()
}

/// A failure's flights with a response and without.
fn flown(name: &str) -> [Vec<Ending>; 2] {
    let failure = FAILURES.iter().find(|failure| failure.name == name).unwrap();
    [true, false].map(|response| campaign(failure, response, &bug()).unwrap())
}

fn landed(endings: &[Ending]) -> usize {
    endings.iter().filter(|ending| ending.landed).count()
}

/// Claims that at least so many land, and asserts that the response makes so many more land; fewer
/// where negative.
#[track_caller]
fn lands(id: &str, claim: &str, at_least: usize, gain: i64) -> [Vec<Ending>; 2] {
    let [with_response, without_response] = flown(claim);
    let [with, without] = [&with_response, &without_response].map(|endings| landed(endings));
    let gained = with as i64 - without as i64;
    assert!(gained >= gain, "{claim}: {with} land with a response, {without} without");
    let reference = format!("landings of 12: 4 onsets, 3 draws; {without} without a response");
    Claim {
        id,
        section: "Failures in flight",
        claim,
        reference: &reference,
        unit: "",
        bound: Bound::AtLeast(at_least as f64),
        origin: "as measured, less two deviations of a binomial draw of 12",
        noise: 0.0,
    }
    .holds(with as f64);
    [with_response, without_response]
}

/// The better of two means is the response's: medians do not see the flights that end badly.
#[track_caller]
fn gentler([with, without]: &[Vec<Ending>; 2], of: fn(&Ending) -> f64) {
    let mean = |endings: &[Ending]| Spread::of(endings.iter().map(of)).mean;
    assert!(mean(with) < mean(without), "{} and {}", mean(with), mean(without));
}

#[test]
fn without_an_engine_it_falls_upright() {
    let endings = flown("engine shut-off");
    // Nothing lands: from 500 m the ground comes at 13 m/s or more.
    gentler(&endings, |ending| ending.tilt_deg);
    Claim {
        id: "failure-shutoff",
        section: "Failures in flight",
        claim: "engine shut-off: tilt at the impact, median of 12",
        reference: "12.3 deg where guidance looks for nothing",
        unit: "deg",
        bound: Bound::AtMost(6.0),
        origin: "half of it",
        noise: 0.0,
    }
    .holds(Spread::of(endings[0].iter().map(|ending| ending.tilt_deg)).p50);
}

#[test]
fn a_weak_engine_lands_where_it_shows_before_the_last_burn() {
    let endings = lands("failure-thrust", "thrust loss 70 %", 6, 4);
    gentler(&endings, |ending| ending.down_m_s);
}

#[test]
fn a_brown_out_is_ridden_through_where_height_is_left() {
    lands("failure-brownout", "brown-out 1 s", 9, -1);
}

#[test]
fn height_over_the_target_stands_in_for_the_altimeter() {
    lands("failure-altimeter", "altimeter lost", 11, 6);
}

#[test]
fn a_filter_without_its_imu_lands_more_often_on_what_the_engine_really_does() {
    let endings = lands("failure-imu", "IMU lost", 6, 1);
    gentler(&endings, |ending| ending.tilt_deg);
}

#[test]
fn a_stuck_pair_is_balanced() {
    let pitch = lands("failure-pair-pitch", "pair stuck, pitch", 11, 3);
    gentler(&pitch, |ending| ending.tilt_deg);
    let roll = lands("failure-pair-roll", "pair stuck, roll", 11, 1);
    gentler(&roll, |ending| ending.tilt_deg);
}

#[test]
fn a_leak_that_would_dry_the_tank_is_answered_by_landing_at_once() {
    lands("failure-leak", "leak 4 kg/s", 11, 1);
}

#[test]
fn a_seized_gimbal_is_held_and_balanced_by_thrusters() {
    let endings = lands("failure-gimbal", "gimbal seized", 4, 1);
    gentler(&endings, |ending| ending.tilt_deg);
}

#[test]
fn a_guidance_that_lost_its_memory_starts_anew_and_lands() {
    lands("failure-reset", "computer reset 0.5 s", 11, -1);
}

#[test]
fn slosh_and_erosion_are_no_reason_to_give_up() {
    lands("failure-slosh", "slosh 20 deg", 11, -2);
    lands("failure-erosion", "nozzle erosion", 9, -2);
}

#[test]
fn nothing_is_declared_and_nothing_changes_where_nothing_fails() {
    let (vehicle, wiring) = (bug(), Wiring::new().unwrap());
    for (sensors, seeds) in [(false, 40), (true, 10)] {
        let failure = &Failure { name: "none", tables: "", sensors };
        for seed in (1..=seeds).map(Some) {
            let [with, without] = [true, false].map(|response| {
                let flight = Flight { failure, onset_s: 0.0, response, seed };
                flight.fly(&vehicle, &wiring).unwrap()
            });
            assert!(with.declared_after_s.is_nan(), "{seed:?}: {with:?}");
            // Bit for bit: shortest decimals tell all of them.
            let bits = |ending: &Ending| serde_json::to_string(ending).unwrap();
            assert_eq!(bits(&with), bits(&without), "{seed:?}");
        }
    }
}
