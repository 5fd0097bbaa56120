//! The terminal law (G.31 to G.34) and the fall-back, which is the same law with no target.
//!
//! Thrust cannot go below the floor, and the floor exceeds the weight: the vehicle can't hover,
//! so the law either brakes or has the engine off, and it never asks for anything between.

use lander_models::math::square;
use lander_models::scenario::Guidance as Task;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::attitude;
use crate::disturbance::EngineEstimate;
use crate::navigation::Navigation;
use crate::planning::Situation;

/// Lateral gains: critically damped at 0.6 rad/s, a sixth of the attitude loop's poles.
const LATERAL_POSITION_1_S2: f64 = 0.36;
const LATERAL_VELOCITY_1_S: f64 = 1.2;
/// Lateral tilt allowed high up and at cut-off, rad: a plan that ends turning leaves up to 2.7 m/s to take off, and the
/// vehicle has to arrive upright.
const TILT_HIGH_RAD: f64 = 0.35;
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
    situation: &Situation,
    engine: &EngineEstimate,
    aim: Aim,
    braking: &mut Braking,
) -> Demand {
    let Situation { vehicle, task, gravity_m_s2, ref capability, nav, axis_w, .. } = *situation;
    let speed_m_s = -nav.velocity_w.z;
    let height_m = (nav.altimeter_m - task.cutoff_height_m).max(0.05);
    let needed_m_s2 =
        (speed_m_s.abs() * speed_m_s - square(task.cutoff_speed_m_s)) / (2.0 * height_m);
    let net_m_s2 = |thrust_n: f64| thrust_n / nav.mass.mass_kg - gravity_m_s2;
    let floor_m_s2 = net_m_s2(engine.scale * vehicle.engine.thrust_min_n);
    let ceiling_m_s2 = net_m_s2(engine.ceiling_n(&vehicle.engine)).max(floor_m_s2);
    let start_m_s2 = match aim {
        Aim::Target(_) => {
            capability.terminal_deceleration_m_s2(task, nav.mass.mass_kg, gravity_m_s2)
        }
        Aim::Below => FALLBACK_SHARE * ceiling_m_s2,
    };
    braking.engine_on = if braking.engine_on {
        needed_m_s2 > WAIT_SHARE * floor_m_s2
    } else {
        needed_m_s2 >= start_m_s2
    };
    let vertical_m_s2 = gravity_m_s2 + needed_m_s2.clamp(floor_m_s2, ceiling_m_s2);
    // What the thrust gives on its way to where it is ordered (G.99).
    let given_w = match braking.engine_on {
        true => axis_w * (vertical_m_s2 * attitude::LAG_S),
        false => Vector3::zeros(),
    };
    let velocity_w = nav.velocity_w + given_w;
    let lateral_w = lateral_demand(situation, &velocity_w, aim, height_m, vertical_m_s2);
    let acceleration_w = lateral_w + Vector3::z() * vertical_m_s2;
    let thrust_acceleration_w = braking.engine_on.then_some(acceleration_w);
    Demand { thrust_acceleration_w, up_w: acceleration_w.normalize() }
}

/// Lateral acceleration within the tilt that the height still allows (G.32).
fn lateral_demand(
    situation: &Situation,
    velocity_w: &Vector3<f64>,
    aim: Aim,
    height_m: f64,
    vertical_m_s2: f64,
) -> Vector3<f64> {
    let Situation { task, nav, .. } = *situation;
    let offset_w = match aim {
        Aim::Target(target_w) => nav.position_w - target_w,
        Aim::Below => Vector3::zeros(),
    };
    let wanted_w = -offset_w * LATERAL_POSITION_1_S2 - velocity_w * LATERAL_VELOCITY_1_S;
    let share = (height_m / TILT_HEIGHT_M).min(1.0);
    let high_rad = match aim {
        Aim::Target(_) => TILT_HIGH_RAD,
        Aim::Below => task.tilt_max_rad,
    };
    let tilt_rad = TILT_LOW_RAD + (high_rad - TILT_LOW_RAD) * share;
    Vector3::new(wanted_w.x, wanted_w.y, 0.0).cap_magnitude(vertical_m_s2 * libm::tan(tilt_rad))
}

/// Cut-off by speed, height or leg probe (G.34). Speed counts what the tail-off still gives.
pub fn cut_off(vehicle: &Vehicle, task: &Task, nav: &Navigation, thrust_n: f64) -> bool {
    let tail_off_m_s = thrust_n * vehicle.engine.tail_off_lag_s / nav.mass.mass_kg;
    let slow = nav.velocity_w.z + tail_off_m_s >= -task.cutoff_speed_m_s
        && nav.altimeter_m < 2.0 * task.cutoff_height_m + 1.0;
    slow || nav.altimeter_m <= task.cutoff_height_m || nav.any_foot_down
}

#[cfg(test)]
mod tests {
    use lander_models::signals::{ALTIMETER_M, ATTITUDE_WB, GUIDANCE, MASS_KG, VELOCITY_W};
    use lander_models::{Scenario, Ticks, Vehicle};

    use crate::faults::Capability;

    use super::*;

    const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");

    fn descending(vehicle: &Vehicle, height_m: f64, speed_m_s: f64) -> Navigation {
        let mut inputs = vec![0.0; GUIDANCE.input_len()];
        let at = |name| GUIDANCE.input_offset(name).unwrap();
        inputs[at(ATTITUDE_WB.name)] = 1.0;
        inputs[at(MASS_KG.name)] = 250.0;
        inputs[at(ALTIMETER_M.name)] = height_m;
        inputs[at(VELOCITY_W.name) + 2] = -speed_m_s;
        Navigation::read(vehicle, &inputs).unwrap()
    }

    #[test]
    fn cut_off_comes_by_speed_by_height_and_by_probe() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        let task = &scenario.guidance;
        let cut = |nav: &Navigation| cut_off(&vehicle, task, nav, 1000.0);
        assert!(!cut(&descending(&vehicle, 1.8, 3.0)), "still fast and high");
        // 1000 N over a lag of 0.1 s give 0.4 m/s more: 0.7 m/s now is 0.3 m/s after the tail-off.
        assert!(cut(&descending(&vehicle, 1.8, 0.69)), "slow enough");
        assert!(!cut(&descending(&vehicle, 1.8, 0.71)), "not slow enough");
        assert!(!cut(&descending(&vehicle, task.cutoff_height_m + 0.01, 3.0)), "still above it");
        assert!(
            cut(&descending(&vehicle, task.cutoff_height_m - 0.01, 3.0)),
            "at the cut-off height"
        );
        assert!(!cut(&descending(&vehicle, 9.0, 0.1)), "slow but high: braking waits instead");
        let mut probed = descending(&vehicle, 2.0, 3.0);
        probed.any_foot_down = true;
        assert!(cut(&probed), "a foot touches");
    }

    #[test]
    fn a_lean_that_is_still_there_is_counted_as_speed() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        let (task, gravity_m_s2) = (&scenario.guidance, scenario.gravity_m_s2);
        let capability = Capability::nominal(task, &vehicle);
        let nav = descending(&vehicle, 10.0, 7.0);
        let asked_w = |lean_rad: f64| {
            let axis_w = Vector3::new(libm::sin(lean_rad), 0.0, libm::cos(lean_rad));
            let situation = Situation {
                now: Ticks::ZERO,
                vehicle: &vehicle,
                nav: &nav,
                task,
                gravity_m_s2,
                capability,
                axis_w,
            };
            let engine = EngineEstimate::default();
            let braking = &mut Braking { engine_on: true };
            let asked = demand(&situation, &engine, Aim::Target(nav.position_w), braking);
            asked.thrust_acceleration_w.unwrap()
        };
        let upright_w = asked_w(0.0);
        assert_eq!(upright_w.xy().norm(), 0.0, "above the target, at rest across");
        // (G.32), (G.99), written down again: 1.2/s times what 0.3 s of the lean give.
        let leaning_w = asked_w(0.1);
        let expected_m_s2 = -1.2 * 0.3 * libm::sin(0.1) * upright_w.z;
        assert!((leaning_w.x - expected_m_s2).abs() < 1e-12, "{leaning_w} m/s²");
    }

    #[test]
    fn braking_follows_the_constant_deceleration_and_never_asks_for_less_than_the_floor() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        let (task, gravity_m_s2) = (&scenario.guidance, scenario.gravity_m_s2);
        let aim = Aim::Target(task.target_w);
        let engine = EngineEstimate::default();
        let capability = Capability::nominal(task, &vehicle);
        let ask = |nav: &Navigation, braking: &mut Braking| {
            let (vehicle, now) = (&vehicle, Ticks::ZERO);
            let axis_w = Vector3::z();
            let situation = Situation { vehicle, task, gravity_m_s2, capability, now, nav, axis_w };
            demand(&situation, &engine, aim, braking)
        };
        // On the planned parabola at 8 m: a = 3 m/s² is exactly what is needed.
        let height_m = 8.0 - task.cutoff_height_m;
        let speed_m_s = (task.cutoff_speed_m_s.powi(2) + 2.0 * 3.0 * height_m).sqrt();
        let mut braking = Braking { engine_on: true };
        let nav = descending(&vehicle, 8.0, speed_m_s);
        let asked = ask(&nav, &mut braking);
        let vertical = asked.thrust_acceleration_w.unwrap().z;
        assert!((vertical - gravity_m_s2 - 3.0).abs() < 1e-12, "{vertical} m/s²");
        // Far too slow for the height: the floor would lift it, so the engine waits.
        let nav = descending(&vehicle, 8.0, 1.0);
        let asked = ask(&nav, &mut braking);
        assert!(asked.thrust_acceleration_w.is_none() && !braking.engine_on);
        // Far too fast: full thrust, no more.
        let nav = descending(&vehicle, 2.0, 20.0);
        let asked = ask(&nav, &mut braking);
        let most_m_s2 = vehicle.engine.thrust_max_n / nav.mass.mass_kg;
        assert!((asked.thrust_acceleration_w.unwrap().z - most_m_s2).abs() < 1e-9);
    }
}
