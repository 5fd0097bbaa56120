//! The crushable strut (T.10 to T.12): elastic up to the crush load of the stage that the stroke
//! has reached, then plastic flow; what is crushed stays crushed.

use lander_models::vehicle::Strut;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// One leg. Strokes are those of the pad along its stroke axis, from the free length, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LegState {
    pub stroke_m: f64,
    /// Plastic part: the length that the strut springs back to.
    pub crushed_m: f64,
    /// Load along the stroke axis, compression positive.
    pub load_n: f64,
    /// Of the ground on the pad, N.
    pub ground_force_w: Vector3<f64>,
}

/// Load at which the honeycomb flows at this stroke, N (T.11).
pub fn crush_load_n(strut: &Strut, stroke_m: f64) -> f64 {
    if stroke_m < strut.stroke_1_m { strut.crush_1_n } else { strut.crush_2_n }
}

/// Load of a strut that was crushed to `crushed_m`, N (T.10): never pulls. The stop is not in it.
pub fn strut_load_n(strut: &Strut, crushed_m: f64, stroke_m: f64, rate_m_s: f64) -> f64 {
    let crushed_m = crushed_after(strut, crushed_m, stroke_m);
    let load_n = strut.stiffness_n_m * (stroke_m - crushed_m) + strut.damping_n_s_m * rate_m_s;
    load_n.clamp(0.0, crush_load_n(strut, stroke_m))
}

/// Plastic stroke after the strut was at `stroke_m` (T.12): the elastic strain never exceeds
/// what the crush load of its stage can hold, and crushing is never undone.
pub fn crushed_after(strut: &Strut, crushed_m: f64, stroke_m: f64) -> f64 {
    let elastic_limit_m = crush_load_n(strut, stroke_m) / strut.stiffness_n_m;
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
        assert_eq!(crushed_after(&strut, 0.0, 0.9 * elastic_m), 0.0);
        let crushed = crushed_after(&strut, 0.0, 0.03);
        assert_eq!(crushed, 0.03 - elastic_m);
        assert_eq!(crushed_after(&strut, crushed, 0.01), crushed, "a rebound must not heal it");
    }

    #[test]
    fn the_second_stage_keeps_the_first_stages_crush() {
        let strut = strut();
        let at_boundary = crushed_after(&strut, 0.0, strut.stroke_1_m - 1e-12);
        let just_beyond = crushed_after(&strut, at_boundary, strut.stroke_1_m + 1e-12);
        assert!(just_beyond >= at_boundary);
        assert!(crushed_after(&strut, 0.0, 0.15) > strut.stroke_1_m);
    }
}
