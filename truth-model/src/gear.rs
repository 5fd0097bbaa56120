//! The crushable strut (T.10 to T.12): elastic up to the crush load of the stage that the stroke
//! has reached, then plastic flow; what is crushed stays crushed.

use lander_models::vehicle::Strut;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// One leg. Strokes are those of the pad along its stroke axis, from the free length, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LegState {
    pub stroke_m: f64,
    /// Its rate, compression positive.
    pub stroke_rate_m_s: f64,
    /// Plastic part: the length that the strut springs back to.
    pub crushed_m: f64,
    /// Load along the stroke axis, compression positive.
    pub load_n: f64,
    /// Of the ground on the pad, N.
    pub ground_force_w: Vector3<f64>,
    /// Depth to which the pad has pressed soft soil.
    pub sinkage_m: f64,
}

/// Load at which the honeycomb flows at this stroke, N (T.11).
pub fn crush_load_n(strut: &Strut, stroke_m: f64) -> f64 {
    if stroke_m < strut.stroke_1_m { strut.crush_1_n } else { strut.crush_2_n }
}

/// Load of a strut in a step that began at `cap_n` and `crushed_m`, N (T.10): it pulls at most with
/// `foot_weight_n`, what hangs on it. The stop is not in it.
pub fn strut_load_n(
    strut: &Strut,
    cap_n: f64,
    crushed_m: f64,
    stroke_m: f64,
    rate_m_s: f64,
    foot_weight_n: f64,
) -> f64 {
    let crushed_m = crushed_after(strut, cap_n, crushed_m, stroke_m);
    let load_n = strut.stiffness_n_m * (stroke_m - crushed_m) + strut.damping_n_s_m * rate_m_s;
    load_n.max(-foot_weight_n).min(crush_load_n(strut, stroke_m))
}

/// Plastic stroke after a tick that led to `stroke_m` with the strut's force capped at `cap_n`
/// (T.12): the elastic strain never exceeds what the cap can hold, and crushing is never undone.
///
/// The cap is that of the tick, not of the stage that its stroke has just reached: the strain that
/// a higher cap allows has not been worked for.
pub fn crushed_after(strut: &Strut, cap_n: f64, crushed_m: f64, stroke_m: f64) -> f64 {
    let elastic_limit_m = cap_n / strut.stiffness_n_m;
    // Entering stage two raises the limit; the crush of stage one is kept.
    crushed_m.max((stroke_m - elastic_limit_m).min(strut.stroke_max_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strut() -> Strut {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
        lander_models::Vehicle::load(file.as_ref()).unwrap().gear.legs[0].strut
    }

    #[test]
    fn small_strokes_are_elastic_and_large_ones_leave_a_mark() {
        let strut = strut();
        let elastic_m = strut.crush_1_n / strut.stiffness_n_m;
        let after =
            |crushed_m, stroke_m| crushed_after(&strut, strut.crush_1_n, crushed_m, stroke_m);
        assert_eq!(after(0.0, 0.9 * elastic_m), 0.0);
        let crushed = after(0.0, 0.03);
        assert_eq!(crushed, 0.03 - elastic_m);
        assert_eq!(after(crushed, 0.01), crushed, "a rebound must not heal it");
    }

    #[test]
    fn the_second_stage_keeps_the_first_stages_crush() {
        let strut = strut();
        let at_boundary = crushed_after(&strut, strut.crush_1_n, 0.0, strut.stroke_1_m - 1e-12);
        let beyond_m = strut.stroke_1_m + 1e-12;
        assert!(crushed_after(&strut, strut.crush_2_n, at_boundary, beyond_m) >= at_boundary);
        assert!(crushed_after(&strut, strut.crush_2_n, 0.0, 0.15) > strut.stroke_1_m);
    }

    #[test]
    fn a_tick_across_the_stages_stores_no_more_than_it_was_given() {
        let strut = strut();
        let stored_j = |stroke_m: f64, crushed_m: f64| {
            0.5 * strut.stiffness_n_m * (stroke_m - crushed_m).powi(2)
        };
        // 4 mm in a tick that began 1 mm short of stage two, at the first stage's cap.
        let (from_m, to_m) = (strut.stroke_1_m - 1e-3, strut.stroke_1_m + 3e-3);
        let before_m = crushed_after(&strut, strut.crush_1_n, 0.0, from_m);
        let after_m = crushed_after(&strut, strut.crush_1_n, before_m, to_m);
        // Plastic flow at the cap stores nothing more; 1e-9 J is rounding of 5.6 J.
        assert!(stored_j(to_m, after_m) - stored_j(from_m, before_m) < 1e-9);
    }
}
