//! Slant range from a point to the ground along a beam (T.79).

use nalgebra::Vector3;

/// Steepest ground that the march is sure to stop at, rise per run: 63 degrees.
const GRADE_MAX: f64 = 2.0;
/// Gap above the ground at which the march ends and the secant finishes, m.
const NEAR_M: f64 = 1e-3;
/// A beam that grazes the ground for longer counts as one without return.
const STEPS_MAX: usize = 1000;
/// No return from beyond, m.
const FAR_M: f64 = 1e5;

/// Range at which the beam from `origin_w` along the unit vector `direction_w` meets the ground,
/// whose height above a place (x, y) is given, m; `None` without a return. Exact on planes;
/// elsewhere within the secant's error over the last millimetre. An origin below ground is at
/// range 0.
///
/// Marches by steps that no ground flatter than `GRADE_MAX` can be missed with, so the first hit
/// is found. Steeper ground (the flank of a rock) may be entered by one step: then the hit lies
/// within that step, and is bisected.
pub fn range_m(
    height_m: impl Fn(f64, f64) -> f64,
    origin_w: &Vector3<f64>,
    direction_w: &Vector3<f64>,
) -> Option<f64> {
    let gap_m = |along_m: f64| {
        let at_w = origin_w + direction_w * along_m;
        at_w.z - height_m(at_w.x, at_w.y)
    };
    // Fastest that the gap can close, m/m.
    let closing = GRADE_MAX * direction_w.xy().norm() - direction_w.z;
    if closing <= 0.0 {
        return None;
    }
    let (mut along_m, mut gap) = (0.0, gap_m(0.0));
    if gap <= 0.0 {
        return Some(0.0);
    }
    for _ in 0..STEPS_MAX {
        let next_m = along_m + gap / closing;
        if next_m > FAR_M {
            return None;
        }
        let next_gap = gap_m(next_m);
        if next_gap < -NEAR_M {
            return Some(bisect(gap_m, along_m, next_m));
        }
        if next_gap < NEAR_M {
            return Some(next_m + next_gap * (next_m - along_m) / (gap - next_gap));
        }
        (along_m, gap) = (next_m, next_gap);
    }
    None
}

/// Between a point above and one below ground, to 1 µm.
fn bisect(gap_m: impl Fn(f64) -> f64, mut above_m: f64, mut below_m: f64) -> f64 {
    while below_m - above_m > 1e-6 {
        let middle_m = 0.5 * (above_m + below_m);
        if gap_m(middle_m) > 0.0 {
            above_m = middle_m;
        } else {
            below_m = middle_m;
        }
    }
    below_m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn down(x: f64, y: f64) -> Vector3<f64> {
        Vector3::new(x, y, -1.0).normalize()
    }

    #[test]
    fn a_plane_is_met_where_the_closed_form_says() {
        for (slope_x, slope_y) in [(0.0, 0.0), (0.2, -0.1), (-1.0, 0.0), (0.0, 0.99)] {
            let normal_w = Vector3::new(-slope_x, -slope_y, 1.0).normalize();
            for direction_w in [down(0.0, 0.0), down(0.5, 0.3), down(-0.4, 0.2), down(0.9, 0.0)] {
                let origin_w = Vector3::new(30.0, -20.0, 700.0);
                let range_m =
                    range_m(|x, y| slope_x * x + slope_y * y, &origin_w, &direction_w).unwrap();
                let exact_m = -normal_w.dot(&origin_w) / normal_w.dot(&direction_w);
                // Heights near 1e3 m have roundings of 1e-13 m; the secant over the last step of
                // 1 mm magnifies them at most by the shallowest incidence, some 10.
                assert!((range_m - exact_m).abs() < 1e-11, "{range_m} against {exact_m}");
            }
        }
    }

    #[test]
    fn curved_ground_is_met_first_where_the_beam_enters_it() {
        // A ring wall of radius 50 m around a bowl: the beam passes the near wall and meets the
        // far one, on the parabola z = r²/100.
        let bowl = |x: f64, y: f64| (x * x + y * y) / 100.0;
        let (origin_w, direction_w) = (Vector3::new(-40.0, 0.0, 40.0), down(1.5, 0.0));
        let range_m = range_m(bowl, &origin_w, &direction_w).unwrap();
        // x = -40 + 1.5 s, z = 40 - s on the parabola: 2.25 s² - 20 s - 2400 = 0.
        let fallen_m = (20.0 + (400.0_f64 + 4.0 * 2.25 * 2400.0).sqrt()) / 4.5;
        // Secant over less than 1 mm of a curvature of 1/50 m: 1e-8 m.
        assert!((range_m - fallen_m * 1.5_f64.hypot(1.0)).abs() < 1e-7, "{range_m}");
    }

    #[test]
    fn the_flank_of_a_block_is_found_although_it_is_a_cliff() {
        let block = |x: f64, _: f64| if (10.0..12.0).contains(&x) { 3.0 } else { 0.0 };
        // Level with the block's middle half way: enters its flank at x = 10.
        let direction_w = down(2.0, 0.0);
        let range_m = range_m(block, &Vector3::new(0.0, 0.0, 6.5), &direction_w).unwrap();
        // Bisected to 1 µm.
        assert!((range_m - 10.0 / direction_w.x).abs() < 2e-6, "{range_m}");
    }

    #[test]
    fn no_return_from_the_sky_and_none_from_below_ground() {
        let plane = |_: f64, _: f64| 0.0;
        let origin_w = Vector3::new(0.0, 0.0, 5.0);
        assert_eq!(range_m(plane, &origin_w, &Vector3::z()), None);
        assert_eq!(range_m(plane, &origin_w, &Vector3::new(0.9, 0.0, 0.1).normalize()), None);
        assert_eq!(range_m(plane, &-origin_w, &-Vector3::z()), Some(0.0));
    }
}
