//! The benchmark's comparison at equal error, on curves that are known.

#[path = "../benches/plant/work_precision.rs"]
mod work_precision;

use work_precision::{Bound, Point, Ratio};

fn points(times_and_errors: &[(f64, f64)]) -> Vec<Point> {
    times_and_errors.iter().map(|&(time_ms, error)| Point { time_ms, error }).collect()
}

fn at(time_ms: f64, error: f64, curve: &[(f64, f64)]) -> Ratio {
    Ratio::at_equal_error(Point { time_ms, error }, &points(curve)).expect("a curve")
}

/// An order of convergence of two: time 1/√error.
const SECOND_ORDER: [(f64, f64); 3] = [(1.0, 1.0), (2.0, 0.25), (4.0, 0.0625)];

#[test]
fn a_power_law_is_interpolated_exactly() {
    for error in [1.0, 0.7, 0.25, 0.2, 0.0625] {
        let ratio = at(3.0, error, &SECOND_ORDER);
        assert_eq!(ratio.bound, Bound::Equal);
        // Rounding of two logarithms and a power.
        assert!((ratio.value / (3.0 * error.sqrt()) - 1.0).abs() < 1e-14, "{error}: {ratio:?}");
    }
}

#[test]
fn beyond_the_curve_is_a_bound() {
    // Less accurate than its coarsest step: it would take less than 1 ms.
    assert_eq!(at(3.0, 2.0, &SECOND_ORDER), Ratio { bound: Bound::More, value: 3.0 });
    // More accurate than its finest: it would take more than 4 ms.
    assert_eq!(at(3.0, 0.01, &SECOND_ORDER), Ratio { bound: Bound::Less, value: 0.75 });
    assert_eq!(Ratio::at_equal_error(Point { time_ms: 3.0, error: 1.0 }, &[]), None);
}

#[test]
fn a_step_that_a_faster_one_beats_counts_for_nothing() {
    let with_outlier = [SECOND_ORDER[2], SECOND_ORDER[0], (3.0, 0.5), SECOND_ORDER[1], (8.0, 0.07)];
    for error in [0.9, 0.4, 0.1, 0.0625] {
        assert_eq!(at(1.0, error, &with_outlier), at(1.0, error, &SECOND_ORDER));
    }
    // Its finest step being the outlier, nothing is known beyond the best.
    assert_eq!(at(1.0, 0.06, &with_outlier).bound, Bound::Less);
}
