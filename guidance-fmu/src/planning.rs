//! What is asked of the planner, and when its answer is flown.

use lander_models::Ticks;
use lander_models::scenario::{Guidance as Task, GuidanceMode};
use lander_models::vehicle::{G0_M_S2, Vehicle};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::navigation::Navigation;
use crate::scvx::{self, FinalTilt, PathLimits, Plan, Problem, Reserve, Settings};

/// Free fall between the first plan and its first burn, tried in this order: time for a slew of
/// 29° at the slew rate, for a small one, and none when the ground is near. A hop burns already.
const DESCENT_LEADS: [Ticks; 3] = [Ticks(2500), Ticks(1000), Ticks(0)];
const HOP_LEADS: [Ticks; 1] = [Ticks(0)];
/// The planned path keeps O this far above the target's level, m: half the gate, room for a
/// vehicle that tracks with a metre of error.
const PATH_HEIGHT_MIN_M: f64 = 6.0;
/// No new plan in the last seconds of the flown one: burns shorter than the attitude loop's
/// response only disturb it (guidance notes: freeze at 2 s to go).
const FREEZE_S: f64 = 2.0;
/// The planned thrust direction ends within this of the vertical.
const FINAL_TILT_RAD: f64 = 0.07;
const FINAL_TILT_INTERVALS: usize = 3;

/// What a disturbed flight may draw on beyond the planned band: this share of the thrust between
/// the planned ceiling and the engine's, and 2° of tilt (29° + 2° stays within the body's 34°).
const RESERVE_SHARE: f64 = 0.5;
const RESERVE_TILT_RAD: f64 = 0.035;

/// The plan being flown.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Flown {
    pub plan: Plan,
    pub start: Ticks,
}

impl Flown {
    /// Time since the plan's start, s; negative before it.
    pub fn elapsed_s(&self, now: Ticks) -> f64 {
        now.seconds() - self.start.seconds()
    }

    pub fn time_to_go_s(&self, now: Ticks) -> f64 {
        self.plan.time_to_go(self.elapsed_s(now))
    }
}

/// Plans made and missed so far, and when the next is due.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Planning {
    pub flown: Option<Flown>,
    pub next_due: Ticks,
    pub accepted: u32,
    pub failed: u32,
}

impl Planning {
    /// A first plan, with the longest lead that has one.
    pub fn first(
        &mut self,
        vehicle: &Vehicle,
        gravity_m_s2: f64,
        task: &Task,
        now: Ticks,
        nav: &Navigation,
    ) {
        let hop = task.mode == GuidanceMode::Hop;
        let leads: &[Ticks] = if hop { &HOP_LEADS } else { &DESCENT_LEADS };
        for lead in leads {
            let problem = problem(vehicle, gravity_m_s2, task, nav, lead.seconds());
            let start = now + *lead;
            self.take(scvx::plan(&problem, &Settings::default()), start);
            self.next_due = start + task.replan_period;
            if self.flown.is_some() {
                return;
            }
        }
    }

    /// A new plan from here when one is due; the last one stays in force when it fails.
    pub fn update(
        &mut self,
        vehicle: &Vehicle,
        gravity_m_s2: f64,
        task: &Task,
        now: Ticks,
        nav: &Navigation,
    ) {
        let Some(flown) = &self.flown else { return };
        if now < self.next_due || flown.time_to_go_s(now) < FREEZE_S {
            return;
        }
        let problem = problem(vehicle, gravity_m_s2, task, nav, 0.0);
        let answer =
            scvx::replan(&problem, &Settings::default(), &flown.plan, flown.elapsed_s(now));
        self.take(answer, now);
        self.next_due = now + task.replan_period;
    }

    fn take(&mut self, answer: Result<Plan, scvx::PlanError>, start: Ticks) {
        match answer {
            Ok(plan) => {
                self.flown = Some(Flown { plan, start });
                self.accepted += 1;
            }
            Err(_) => self.failed += 1,
        }
    }
}

/// The landing problem from `lead_s` of free fall ahead of now to the gate above the target.
fn problem(
    vehicle: &Vehicle,
    gravity_m_s2: f64,
    task: &Task,
    nav: &Navigation,
    lead_s: f64,
) -> Problem {
    let fall_w = Vector3::z() * -gravity_m_s2;
    let r0_w = nav.position_w + nav.velocity_w * lead_s + fall_w * (0.5 * lead_s * lead_s);
    let v0_w = nav.velocity_w + fall_w * lead_s;
    let (r_f_w, v_f_w) = gate(task, nav);
    // The terminal law's own need: the gate's speed, and gravity for as long as it brakes.
    let braking_s = v_f_w.norm() / task.terminal_deceleration_m_s2;
    let reserve_kg = nav.mass.mass_kg * (v_f_w.norm() + gravity_m_s2 * braking_s)
        / (vehicle.engine.isp_s * G0_M_S2);
    let lowest_m = r_f_w.z.min(task.target_w.z + nav.mass.com_b.z + PATH_HEIGHT_MIN_M);
    // A start below it is where the vehicle is: only to sink further is refused.
    let lowest_m = lowest_m.min(nav.position_w.z);
    Problem {
        r0_w,
        v0_w,
        r_f_w,
        v_f_w,
        mass_kg: nav.mass.mass_kg,
        dry_mass_kg: (vehicle.mass.dry.mass_kg + reserve_kg).min(nav.mass.mass_kg),
        gravity_m_s2,
        isp_s: vehicle.engine.isp_s,
        thrust_min_n: task.plan_thrust_min_n,
        thrust_max_n: task.plan_thrust_max_n,
        tilt_max_rad: task.tilt_max_rad,
        final_tilt: Some(FinalTilt {
            tilt_max_rad: FINAL_TILT_RAD.min(task.tilt_max_rad),
            intervals: FINAL_TILT_INTERVALS,
        }),
        reserve: Some(Reserve {
            thrust_max_n: RESERVE_SHARE * vehicle.engine.thrust_max_n
                + (1.0 - RESERVE_SHARE) * task.plan_thrust_max_n,
            tilt_max_rad: task.tilt_max_rad + RESERVE_TILT_RAD,
        }),
        path: PathLimits { glide_slope_rad: None, altitude_min_m: Some(lowest_m) },
    }
}

/// Centre-of-mass state at which the terminal law takes over: above the target, with the speed
/// that its deceleration takes off down to the cut-off height (G.33).
pub fn gate(task: &Task, nav: &Navigation) -> (Vector3<f64>, Vector3<f64>) {
    let com_height_m = nav.mass.com_b.z;
    let gate_height_m = if task.terminal_law { task.gate_height_m } else { task.cutoff_height_m };
    let position_w = task.target_w + Vector3::z() * (gate_height_m + com_height_m);
    let braking_m = (gate_height_m - task.cutoff_height_m).max(0.0);
    let speed_m_s =
        (task.cutoff_speed_m_s.powi(2) + 2.0 * task.terminal_deceleration_m_s2 * braking_m).sqrt();
    (position_w, Vector3::z() * -speed_m_s)
}
