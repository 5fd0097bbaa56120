//! Restoration against differences of the exact roll-out, and what it may not do.

use lander_models::random::normal;
use nalgebra::Vector3;

use super::problem::{PathLimits, Problem, Settings, Terminal};
use super::restore::{Freedom, freedoms, restore, slope};
use super::start;
use super::structure::Grid;
use super::trajectory::{Iterate, Trajectory};
use super::{Plan, solve};

fn descent() -> Problem {
    Problem {
        r0_w: Vector3::new(300.0, 100.0, 500.0),
        v0_w: Vector3::new(-15.0, -5.0, -25.0),
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        terminal: Terminal::Point,
        mass_kg: 259.5,
        dry_mass_kg: 174.0,
        gravity_m_s2: 1.625,
        isp_s: 225.0,
        thrust_min_n: 800.0,
        thrust_max_n: 5200.0,
        thrust_rate_max_n_s: None,
        propulsion: Default::default(),
        engine: Default::default(),
        tilt_max_rad: 29_f64.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    }
}

/// A plan's flight, with durations, thrusts and directions off by about `share`.
fn disturbed(problem: &Problem, share: f64) -> (Grid, Trajectory) {
    let plan: Plan = solve(problem, &Settings::default()).unwrap();
    let (grid, mut iterate) = start::from_plan(problem, &Settings::default(), &plan, 0.0).unwrap();
    let mut draw = (0..).map(|index| share * normal(7, "disturbed", index));
    for step_s in &mut iterate.step_s {
        *step_s *= 1.0 + draw.next().unwrap();
    }
    for w_w in &mut iterate.w_w {
        // A little less thrust, so that some of it is free.
        *w_w *= 1.0 - draw.next().unwrap().abs();
        *w_w += Vector3::from_fn(|_, _| draw.next().unwrap()) * w_w.norm();
    }
    let iterate = Iterate::lossless(iterate.step_s, iterate.w_w);
    let flown = Trajectory::new(problem, &grid, iterate);
    (grid, flown)
}

#[test]
fn slopes_are_those_of_the_exact_flight() {
    /// Central difference; its error is of second order in the change, and rounding over it is 1e-9.
    const CHANGE: f64 = 1e-5;
    let problem = descent();
    let (grid, flown) = disturbed(&problem, 0.01);
    let freedoms = freedoms(&problem, &grid, &flown);
    assert!(freedoms.iter().any(|f| matches!(f, Freedom::Throttle { .. })));
    for freedom in &freedoms {
        let end = |change: f64| {
            let mut iterate = flown.iterate.clone();
            freedom.apply(&grid, &mut iterate, change);
            Trajectory::new(&problem, &grid, iterate)
        };
        let (less, more) = (end(-CHANGE), end(CHANGE));
        let slope = slope(&problem, &grid, &flown, freedom);
        let per_m = (more.miss_r_w - less.miss_r_w) / (2.0 * CHANGE * flown.nodes[grid.len()].t_s);
        let per_m_s = (more.miss_v_w - less.miss_v_w) / (2.0 * CHANGE);
        for axis in 0..3 {
            assert!((slope[axis] - per_m[axis]).abs() < 1e-6, "{freedom:?} r {axis}");
            assert!((slope[axis + 3] - per_m_s[axis]).abs() < 1e-6, "{freedom:?} v {axis}");
        }
    }
}

#[test]
fn a_disturbed_flight_meets_its_target_again_within_its_limits() {
    for (terminal, share) in [(Terminal::Point, 1e-3), (Terminal::Anywhere, 1e-3)] {
        let problem = Problem { terminal, ..descent() };
        let (grid, flown) = disturbed(&problem, share);
        assert!(flown.miss_r_w.norm() > 0.1, "{} m", flown.miss_r_w.norm());
        let restored = restore(&problem, &grid, &flown).expect("small enough");
        // Three Newton steps from 0.1 % leave less than rounding in 20 s of flight.
        assert!(restored.miss_r_w.norm() < 1e-6 && restored.miss_v_w.norm() < 1e-6);
        // Nothing moved by more than the disturbance that it makes up for.
        for (old, new) in flown.iterate.w_w.iter().zip(&restored.iterate.w_w) {
            assert!((new - old).norm() <= 20.0 * share * old.norm(), "{old} {new}");
        }
        assert!(restored.thrust_violation_n < 1e-6, "{} N", restored.thrust_violation_n);
    }
}

#[test]
fn what_restoration_does_not_heed_it_does_not_touch() {
    let (grid, flown) = disturbed(&descent(), 1e-3);
    let limited = Problem { thrust_rate_max_n_s: Some(1e4), ..descent() };
    assert!(restore(&limited, &grid, &flown).is_none());
    // Half a flight away no small change meets the target.
    let (grid, far) = disturbed(&descent(), 0.3);
    assert!(restore(&descent(), &grid, &far).is_none());
}
