use nalgebra::UnitQuaternion;

use super::*;
use crate::random::uniform;

const LIMITS: TouchdownLimits = TouchdownLimits { crash_speed_m_s: 5.0, slide_limit_m: 1.0 };
const UPRIGHT: TipState = TipState { margin_j: 100.0, distance_m: 1.3 };
const OVER: TipState = TipState { margin_j: -1.0, distance_m: -0.1 };
const HULL: Structure<bool> = Structure { hull: true, nozzle: false };
const NOZZLE: Structure<bool> = Structure { hull: false, nozzle: true };

fn impact(speed_m_s: f64) -> Option<Impact> {
    Some(Impact {
        time: Ticks::ZERO,
        com_velocity_w: Vector3::new(0.0, 0.0, -speed_m_s),
        attitude_wb: Attitude::identity(),
        rate_rad_s: 0.0,
        footprint_w: Vector3::zeros(),
    })
}

/// The first so many carry load.
fn feet(count: usize) -> [bool; FOOT_SLOTS] {
    std::array::from_fn(|n| n < count)
}

/// Standing still on four feet.
fn standing() -> Sight {
    Sight {
        now: Ticks::ZERO,
        impact: None,
        foot_impacts: [None; FOOT_SLOTS],
        tip: UPRIGHT,
        feet_down: feet(4),
        structure_down: Structure::default(),
        clearance_m: Structure { hull: 0.7, nozzle: 0.4 },
        bottomed: false,
        stroke_m: 0.01,
        load_n: 70.0,
        acceleration_m_s2: 1.6,
        angular_acceleration_rad_s2: 0.0,
        speed_m_s: 0.0,
        rate_rad_s: 0.0,
        attitude_wb: Attitude::identity(),
        footprint_w: Vector3::zeros(),
    }
}

/// A touchdown at 1 m/s, then what `sights` say, one a tick from tick 1.
fn seen(sights: impl IntoIterator<Item = Sight>) -> Touchdown {
    let mut touchdown = Touchdown::default();
    let touch = Sight { impact: impact(1.0), speed_m_s: 1.0, ..standing() };
    for (n, sight) in std::iter::once(touch).chain(sights).enumerate() {
        touchdown.look(&LIMITS, &Sight { now: Ticks(n as u64), ..sight });
    }
    touchdown
}

/// A touchdown, one tick of `event`, then two seconds of `after` up to the stop time.
fn verdict(event: Sight, after: Sight) -> Touchdown {
    let mut touchdown = seen(std::iter::once(event).chain(std::iter::repeat_n(after, 2000)));
    touchdown.end();
    touchdown
}

#[test]
fn every_outcome_has_its_history() {
    let moving = || Sight { speed_m_s: 0.1, ..standing() };
    let away = Sight { footprint_w: Vector3::new(0.8, 0.8, 0.0), ..standing() };
    let cases = [
        (standing(), standing(), Outcome::Landed),
        (moving(), moving(), Outcome::Slid),
        (standing(), away, Outcome::Slid),
        (Sight { tip: OVER, ..moving() }, standing(), Outcome::Landed),
        (standing(), Sight { tip: OVER, ..standing() }, Outcome::Tipped),
        (Sight { tip: OVER, structure_down: HULL, ..moving() }, standing(), Outcome::Tipped),
        (Sight { structure_down: HULL, ..moving() }, standing(), Outcome::Struck),
        (Sight { structure_down: NOZZLE, ..moving() }, standing(), Outcome::Struck),
        (Sight { structure_down: HULL, bottomed: true, ..moving() }, moving(), Outcome::Struck),
        (Sight { bottomed: true, ..moving() }, standing(), Outcome::Bottomed),
        (Sight { bottomed: true, ..moving() }, moving(), Outcome::Bottomed),
        (Sight { impact: impact(18.0), ..moving() }, standing(), Outcome::Crashed),
        (moving(), Sight { feet_down: feet(0), ..moving() }, Outcome::NoContact),
        // Lying on its hull after the stop time is no lack of contact.
        (moving(), Sight { feet_down: feet(0), structure_down: HULL, ..moving() }, Outcome::Struck),
        // Two feet are an axis to teeter about.
        (standing(), Sight { feet_down: feet(2), ..standing() }, Outcome::Slid),
    ];
    for (n, (event, after, outcome)) in cases.into_iter().enumerate() {
        assert_eq!(verdict(event, after).outcome, outcome, "case {n}");
    }
}

#[test]
fn which_part_struck_is_remembered() {
    let touchdown = verdict(Sight { structure_down: NOZZLE, ..standing() }, standing());
    assert_eq!((touchdown.struck, touchdown.bottomed), (NOZZLE, false));
    let touchdown = verdict(Sight { bottomed: true, ..standing() }, standing());
    assert_eq!((touchdown.struck, touchdown.bottomed), (Structure::default(), true));
}

#[test]
fn extremes_since_contact_are_kept_and_the_first_touch_of_a_foot_counts() {
    let foot = |tick, normal_m_s| FootImpact { time: Ticks(tick), normal_m_s, tangential_m_s: 0.0 };
    let mut foot_impacts = [None; FOOT_SLOTS];
    foot_impacts[2] = Some(foot(1, 1.5));
    let low = Sight {
        foot_impacts,
        tip: TipState { margin_j: 20.0, distance_m: 0.4 },
        clearance_m: Structure { hull: 0.6, nozzle: 0.1 },
        acceleration_m_s2: 33.0,
        angular_acceleration_rad_s2: 7.0,
        ..standing()
    };
    foot_impacts[2] = Some(foot(2, 0.3));
    let touchdown = verdict(low, Sight { foot_impacts, ..standing() });
    assert_eq!((touchdown.margin_j, touchdown.distance_m), (Some(20.0), Some(0.4)));
    assert_eq!(touchdown.clearance_m, Some(Structure { hull: 0.6, nozzle: 0.1 }));
    assert_eq!(touchdown.peak_acceleration_m_s2, 33.0);
    assert_eq!(touchdown.peak_angular_acceleration_rad_s2, 7.0);
    assert_eq!(touchdown.feet, [None, None, Some(foot(1, 1.5)), None, None, None]);
}

#[test]
fn a_vehicle_that_never_flew_can_tip_over_but_not_land() {
    let mut touchdown = Touchdown::default();
    for n in 0..2000 {
        touchdown.look(&LIMITS, &Sight { now: Ticks(n), ..standing() });
    }
    assert!(!touchdown.decided() && touchdown.peak_load_n == 0.0);
    for n in 2000..3000 {
        touchdown.look(&LIMITS, &Sight { now: Ticks(n), tip: OVER, ..standing() });
    }
    assert_eq!((touchdown.outcome, touchdown.tip_time()), (Outcome::Tipped, Some(Ticks(2000))));
}

#[test]
fn in_the_air_only_a_vehicle_that_goes_head_down_has_tipped() {
    let bounce = |degrees: f64| {
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
        let mut touchdown = seen([Sight { tip: OVER, speed_m_s: 1.0, ..standing() }]);
        for n in 2..2000 {
            touchdown.look_in_flight(Ticks(n), false, &attitude);
        }
        // Down again, still outside for a moment.
        for n in 2000..2100 {
            touchdown.look(&LIMITS, &Sight { now: Ticks(n), tip: OVER, ..standing() });
        }
        touchdown
    };
    let leaning = bounce(60.0);
    assert_eq!((leaning.outcome, leaning.unsupported_since), (Outcome::InFlight, Some(Ticks(1))));
    let mut somersault = bounce(100.0);
    assert_eq!((somersault.outcome, somersault.tip_time()), (Outcome::Tipped, Some(Ticks(1))));
    somersault.look_in_flight(Ticks(2100), true, &Attitude::identity());
    assert_eq!(somersault.outcome, Outcome::Tipped);
    // Flight before first contact is no bounce.
    let mut flying = Touchdown::default();
    let upside_down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 3.0);
    flying.look_in_flight(Ticks(1), false, &upside_down);
    // Nor is an approach that has not touched yet.
    let near = Sight { tip: OVER, attitude_wb: upside_down, feet_down: feet(0), ..standing() };
    flying.look(&LIMITS, &near);
    assert!(!flying.decided());
    flying.look(&LIMITS, &Sight { impact: impact(1.0), ..near });
    assert_eq!(flying.outcome, Outcome::Tipped);
}

/// Sights, one a tick, of a slide that starts from rest with this acceleration.
fn slide(acceleration_m_s2: f64) -> impl Iterator<Item = Sight> {
    (1..=2000).map(move |n| {
        let t = f64::from(n) * 1e-3;
        let slid_m = 0.5 * acceleration_m_s2 * t * t;
        let footprint_w = Vector3::new(slid_m, 0.0, 0.0);
        Sight { footprint_w, speed_m_s: acceleration_m_s2 * t, ..standing() }
    })
}

#[test]
fn rest_takes_half_a_second_and_lets_small_vibrations_pass() {
    let rest = seen(std::iter::repeat_n(standing(), 499));
    assert!(!rest.decided());
    assert_eq!(seen(std::iter::repeat_n(standing(), 501)).outcome, Outcome::Landed);
    // 20 Hz at 1 mm/s moves by 8 µm.
    let shaking = (1..=501).map(|n| {
        let phase = f64::from(n) * 1e-3 * 20.0 * std::f64::consts::TAU;
        let footprint_w = Vector3::new(8e-6 * phase.sin(), 0.0, 0.0);
        Sight { footprint_w, speed_m_s: 1e-3 * phase.cos().abs(), ..standing() }
    });
    assert_eq!(seen(shaking).outcome, Outcome::Landed);
}

#[test]
fn a_slow_slide_is_not_rest() {
    // Friction 0.0006 short of the slope's tangent on the Moon; it is below 5 mm/s for 5 s.
    assert!(!seen(slide(1e-3)).decided());
    // A steady crawl at 1 mm/s.
    let crawl = (1..=2000).map(|n| {
        let footprint_w = Vector3::new(f64::from(n) * 1e-6, 0.0, 0.0);
        Sight { footprint_w, speed_m_s: 1e-3, ..standing() }
    });
    assert!(!seen(crawl).decided());
    // What a contact engine creeps, 10 µm a minute, is rest.
    let creep = (1..=501).map(|n| {
        let footprint_w = Vector3::new(f64::from(n) * 1e-8 / 60.0, 0.0, 0.0);
        Sight { footprint_w, ..standing() }
    });
    assert_eq!(seen(creep).outcome, Outcome::Landed);
}

#[test]
fn a_vehicle_that_teeters_is_not_at_rest() {
    // At the turning point of a swing 5 mrad, or 1 cm, short of an edge, with BUG's time constant:
    // half a second below 1 mrad/s. Were a third foot to brush the ground, it would look at rest.
    let swing = |start_rad: f64| {
        (-250..=250).map(move |n| {
            let tilt_rad = start_rad * (f64::from(n) * 1e-3 / 1.2).cosh();
            let rate_rad_s = start_rad / 1.2 * (f64::from(n) * 1e-3 / 1.2).sinh().abs();
            let attitude_wb = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), tilt_rad);
            Sight { attitude_wb, rate_rad_s, ..standing() }
        })
    };
    assert!(swing(0.005).all(|sight| sight.rate_rad_s < 1e-3));
    assert!(!seen(swing(0.005)).decided());
    // On an edge there is no energy left to hold it, however still it is.
    let balanced = Sight { tip: TipState { margin_j: 0.0, distance_m: 0.0 }, ..standing() };
    assert!(!seen(std::iter::repeat_n(balanced, 2000)).decided());
}

#[test]
fn a_vehicle_that_leans_on_its_hull_is_at_rest_and_struck() {
    let leaning = Sight { feet_down: feet(2), structure_down: HULL, ..standing() };
    assert_eq!(seen(std::iter::repeat_n(leaning, 501)).outcome, Outcome::Struck);
}

/// A sight with everything that matters drawn at random, mostly calm.
fn random_sight(now: u64, draw: &mut impl FnMut() -> f64) -> Sight {
    let flag = |chance: f64, draw: &mut dyn FnMut() -> f64| draw() < chance;
    let tip = if flag(0.01, draw) { OVER } else { UPRIGHT };
    Sight {
        now: Ticks(now),
        impact: if flag(0.01, draw) { impact(5.2 * draw()) } else { None },
        tip,
        feet_down: if flag(0.002, draw) { feet(0) } else { feet(4) },
        structure_down: Structure { hull: flag(1e-3, draw), nozzle: flag(1e-3, draw) },
        bottomed: flag(1e-3, draw),
        speed_m_s: 5.02e-3 * draw(),
        footprint_w: Vector3::new(1e-5 * draw(), 0.0, 0.0),
        load_n: draw(),
        ..standing()
    }
}

#[test]
fn a_verdict_falls_at_most_once_and_nothing_moves_it() {
    let mut outcomes = std::collections::BTreeSet::new();
    for run in 0..100 {
        let mut index = 20_000 * run;
        let mut draw = || {
            index += 1;
            uniform(2026, "verdict", index)
        };
        let mut touchdown = Touchdown::default();
        let mut decided = None;
        for now in 0..1500 {
            touchdown.look(&LIMITS, &random_sight(now, &mut draw));
            if now == 1400 {
                touchdown.end();
            }
            let all = postcard::to_allocvec(&touchdown).unwrap();
            match &decided {
                Some(at_decision) => assert_eq!(&all, at_decision, "run {run}, tick {now}"),
                None => decided = touchdown.decided().then_some(all),
            }
        }
        assert!(decided.is_some(), "run {run} never ended");
        outcomes.insert(touchdown.outcome.name());
    }
    // The draws reach most of the alphabet, or this would show little.
    assert!(outcomes.len() >= 5, "{outcomes:?}");
}
