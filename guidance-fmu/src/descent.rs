//! The terminal law (G.31 to G.34) and the fall-back, which is the same law with no target.
//!
//! Thrust cannot go below the floor, and the floor exceeds the weight: the vehicle can't hover,
//! so the law either brakes or has the engine off, and it never asks for anything between.

use lander_models::scenario::Guidance as Task;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::navigation::Navigation;

/// Lateral gains: critically damped at 0.7 rad/s, half the attitude loop's bandwidth.
const LATERAL_POSITION_1_S2: f64 = 0.25;
const LATERAL_VELOCITY_1_S: f64 = 1.0;
/// Lateral tilt allowed high up and at cut-off, rad: the vehicle has to arrive upright.
const TILT_HIGH_RAD: f64 = 0.14;
const TILT_LOW_RAD: f64 = 0.02;
/// Height over which the tilt limit shrinks, m.
const TILT_HEIGHT_M: f64 = 8.0;
/// Share of the floor's own deceleration below which braking waits with the engine off.
const WAIT_SHARE: f64 = 0.8;
/// Deceleration at which a fall-back brakes, as a share of what full thrust gives: gentle enough
/// to leave time for the sideways speed.
const FALLBACK_SHARE: f64 = 0.25;

/// Where the law aims.
#[derive(Clone, Copy, Debug)]
pub enum Aim {
    /// Above the target, with the planned deceleration.
    Target(Vector3<f64>),
    /// Anywhere: only the speed is taken off.
    Below,
}

/// What the law keeps between steps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Braking {
    pub engine_on: bool,
}

/// Thrust acceleration asked for, world frame; `None` has the engine off.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    pub thrust_acceleration_w: Option<Vector3<f64>>,
    pub up_w: Vector3<f64>,
}

/// One step of the law (G.31): brake so that the cut-off speed is reached at the cut-off height.
pub fn demand(
    vehicle: &Vehicle,
    gravity_m_s2: f64,
    task: &Task,
    nav: &Navigation,
    aim: Aim,
    braking: &mut Braking,
) -> Demand {
    let speed_m_s = -nav.velocity_w.z;
    let height_m = (nav.altimeter_m - task.cutoff_height_m).max(0.05);
    let needed_m_s2 =
        (speed_m_s.abs() * speed_m_s - task.cutoff_speed_m_s.powi(2)) / (2.0 * height_m);
    let floor_m_s2 = vehicle.engine.thrust_min_n / nav.mass.mass_kg - gravity_m_s2;
    let ceiling_m_s2 = vehicle.engine.thrust_max_n / nav.mass.mass_kg - gravity_m_s2;
    let start_m_s2 = match aim {
        Aim::Target(_) => task.terminal_deceleration_m_s2,
        Aim::Below => FALLBACK_SHARE * ceiling_m_s2,
    };
    braking.engine_on = if braking.engine_on {
        needed_m_s2 > WAIT_SHARE * floor_m_s2
    } else {
        needed_m_s2 >= start_m_s2
    };
    let vertical_m_s2 = gravity_m_s2 + needed_m_s2.clamp(floor_m_s2, ceiling_m_s2);
    let lateral_w = lateral_demand(task, nav, aim, height_m, vertical_m_s2);
    let acceleration_w = lateral_w + Vector3::z() * vertical_m_s2;
    let thrust_acceleration_w = braking.engine_on.then_some(acceleration_w);
    Demand { thrust_acceleration_w, up_w: acceleration_w.normalize() }
}

/// Lateral acceleration within the tilt that the height still allows (G.32).
fn lateral_demand(
    task: &Task,
    nav: &Navigation,
    aim: Aim,
    height_m: f64,
    vertical_m_s2: f64,
) -> Vector3<f64> {
    let offset_w = match aim {
        Aim::Target(target_w) => nav.position_w - target_w,
        Aim::Below => Vector3::zeros(),
    };
    let wanted_w = -offset_w * LATERAL_POSITION_1_S2 - nav.velocity_w * LATERAL_VELOCITY_1_S;
    let share = (height_m / TILT_HEIGHT_M).min(1.0);
    let high_rad = match aim {
        Aim::Target(_) => TILT_HIGH_RAD,
        Aim::Below => task.tilt_max_rad,
    };
    let tilt_rad = TILT_LOW_RAD + (high_rad - TILT_LOW_RAD) * share;
    Vector3::new(wanted_w.x, wanted_w.y, 0.0).cap_magnitude(vertical_m_s2 * tilt_rad.tan())
}

/// Cut-off by speed, height or leg probe (G.34). Speed counts what the tail-off still gives.
pub fn cut_off(vehicle: &Vehicle, task: &Task, nav: &Navigation, thrust_n: f64) -> bool {
    let tail_off_m_s = thrust_n * vehicle.engine.thrust_lag_s / nav.mass.mass_kg;
    let slow = nav.velocity_w.z + tail_off_m_s >= -task.cutoff_speed_m_s
        && nav.altimeter_m < 2.0 * task.cutoff_height_m + 1.0;
    slow || nav.altimeter_m <= task.cutoff_height_m || nav.any_foot_down
}
