//! Rest: a vehicle that stands still and would go on doing so.
//!
//! Slow is not at rest. A lander that slides with an acceleration a, or that teeters, is slow for
//! a while; so it must also stay where it is (T.22).

use lander_models::frames::Attitude;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::Ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Sight;

/// Limits of the vibration that may be left: 2 mJ for 174 kg, the energy that lifts its centre of
/// mass by 8 µm.
const REST_SPEED_M_S: f64 = 5e-3;
const REST_RATE_RAD_S: f64 = 1e-3;
/// For so long it must stand still.
const REST_TIME: Ticks = Ticks(500);
/// How far the footprint may move meanwhile, level: ten times what a contact engine creeps in a
/// minute, and below what a slide of 1 mm/s² covers in that time from a standstill.
const REST_DRIFT_M: f64 = 1e-4;
/// How far the vehicle may turn meanwhile: 0.2 mm at a foot 2 m out.
const REST_TURN_RAD: f64 = 1e-4;
/// Feet that must carry load meanwhile, unless hull or nozzle does: two make an axis to teeter about.
/// A third that hardly bears more than itself may come and go.
const REST_FEET: usize = 3;

/// Where the vehicle was when it began to stand still.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Still {
    since: Ticks,
    footprint_w: Vector3<f64>,
    attitude_wb: Attitude,
    /// When each foot last carried load since.
    feet: [Option<Ticks>; FOOT_SLOTS],
    /// When hull or nozzle did.
    structure: Option<Ticks>,
}

/// Whether the vehicle has now stood still for long enough.
pub(super) fn comes_to_rest(still: &mut Option<Still>, sight: &Sight) -> bool {
    let slow = sight.speed_m_s < REST_SPEED_M_S && sight.rate_rad_s < REST_RATE_RAD_S;
    // With a margin of energy it can't tip over by itself; beyond an edge the margin is negative.
    if !(slow && sight.tip.margin_j > 0.0) {
        *still = None;
        return false;
    }
    let here = Still {
        since: sight.now,
        footprint_w: sight.footprint_w,
        attitude_wb: sight.attitude_wb,
        feet: [None; FOOT_SLOTS],
        structure: None,
    };
    let start = still.get_or_insert(here);
    for (felt, down) in start.feet.iter_mut().zip(sight.feet_down) {
        *felt = if down { Some(sight.now) } else { *felt };
    }
    if sight.structure_down.any() {
        start.structure = Some(sight.now);
    }
    let drift_m = (sight.footprint_w - start.footprint_w).xy().norm();
    if drift_m > REST_DRIFT_M || start.attitude_wb.angle_to(&sight.attitude_wb) > REST_TURN_RAD {
        *still = Some(here);
        return false;
    }
    let lately = |felt: &&Option<Ticks>| felt.is_some_and(|time| sight.now < time + REST_TIME);
    let stands = start.feet.iter().filter(lately).count() >= REST_FEET
        || Some(&start.structure).filter(lately).is_some();
    stands && sight.now >= start.since + REST_TIME
}
