//! Restoration against differences of the exact roll-out, and what it may not do.

use lander_models::math::square;
use lander_models::random::normal;
use nalgebra::Vector3;

use super::problem::{Problem, Settings, Terminal};
use super::restore::{Freedom, MISS_MET, freedoms, restore, slope};
use super::start;
use super::structure::Grid;
use super::trajectory::{Iterate, Trajectory};
use super::{Plan, solve};
use crate::scenarios::descent;

/// A plan's flight, with durations, thrusts and directions off by about `share`, and the norm of all these changes.
fn disturbed(problem: &Problem, share: f64) -> (Grid, Trajectory, f64) {
    let plan: Plan = solve(problem, &Settings::default()).unwrap();
    let (grid, planned) = start::from_plan(problem, &Settings::default(), &plan, 0.0).unwrap();
    let mut iterate = planned.clone();
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
    let size = distance(&planned, &iterate);
    let flown = Trajectory::new(problem, &grid, iterate);
    (grid, flown, size)
}

/// Norm of the relative changes from one iterate to another.
fn distance(from: &Iterate, to: &Iterate) -> f64 {
    let steps = from.step_s.iter().zip(&to.step_s).map(|(from_s, to_s)| to_s / from_s - 1.0);
    let burns = from.w_w.iter().zip(&to.w_w).filter(|(from_w, _)| from_w.norm() > 0.0);
    let impulses = burns.map(|(from_w, to_w)| (to_w - from_w).norm() / from_w.norm());
    steps.chain(impulses).map(square).sum::<f64>().sqrt()
}

#[test]
fn slopes_are_those_of_the_exact_flight() {
    /// Central difference; its error is of second order in the change, and rounding over it is 1e-9 m/s.
    const CHANGE: f64 = 1e-5;
    const ERROR_MAX_M_S: f64 = 1e-8;
    let problem = descent();
    let (grid, flown, _) = disturbed(&problem, 0.01);
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
            assert!((slope[axis] - per_m[axis]).abs() < ERROR_MAX_M_S, "{freedom:?} r {axis}");
            assert!(
                (slope[axis + 3] - per_m_s[axis]).abs() < ERROR_MAX_M_S,
                "{freedom:?} v {axis}"
            );
        }
    }
}

#[test]
fn a_disturbed_flight_meets_its_target_again_within_its_limits() {
    for (terminal, share) in [(Terminal::Point, 1e-3), (Terminal::Anywhere, 1e-3)] {
        let problem = Problem { terminal, ..descent() };
        let (grid, flown, size) = disturbed(&problem, share);
        assert!(flown.miss_r_w.norm() > 0.1, "{} m", flown.miss_r_w.norm());
        let restored = restore(&problem, &grid, &flown).expect("small enough");
        assert!(restored.miss_r_w.norm() <= MISS_MET && restored.miss_v_w.norm() <= MISS_MET);
        let moved = distance(&flown.iterate, &restored.iterate);
        // To take the disturbance back is one way to the target; the way of least norm is no longer.
        assert!(moved <= size, "{moved} of {size}");
        // Rounding of 5,200 N.
        assert!(restored.thrust_violation_n < 1e-9, "{} N", restored.thrust_violation_n);
    }
}

#[test]
fn what_restoration_does_not_heed_it_does_not_touch() {
    let (grid, flown, _) = disturbed(&descent(), 1e-3);
    let limited = Problem { thrust_rate_max_n_s: Some(1e4), ..descent() };
    assert!(restore(&limited, &grid, &flown).is_none());
    // Half a flight away no small change meets the target.
    let (grid, far, _) = disturbed(&descent(), 0.3);
    assert!(restore(&descent(), &grid, &far).is_none());
}
