//! What is asked of the planner, and when its answer is flown.

use lander_models::Ticks;
use lander_models::math::square;
use lander_models::scenario::{Guidance as Task, GuidanceMode};
use lander_models::vehicle::{G0_M_S2, Vehicle};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::descent::Aim;
use crate::faults::Capability;
use crate::navigation::Navigation;
use crate::scvx::{
    self, EngineState, FinalTilt, PathLimits, Plan, Problem, Propulsion, Reserve, Settings,
    Terminal, Turn,
};

/// Free fall between the first plan and its first burn, tried in this order: time for a slew of
/// 29° at the slew rate, for a small one, and none when the ground is near. A hop burns already.
const DESCENT_LEADS: [Ticks; 3] = [Ticks(2500), Ticks(1000), Ticks(0)];
const HOP_LEADS: [Ticks; 1] = [Ticks(0)];
/// The planned path keeps O this far above the target's level, m: half the gate, room for a
/// vehicle that tracks with a metre of error.
const PATH_HEIGHT_MIN_M: f64 = 6.0;
/// No new plan in the last seconds of the flown one: the burns of a shorter plan turn faster than the attitude can, and
/// the upright end that each plan has, three intervals of eight, is then shorter than a turn takes (0.7 s).
const FREEZE_S: f64 = 2.5;
/// Flight left after a plan, s: from the gate at 8 m/s to the ground.
const TERMINAL_S: f64 = 4.0;
/// The planned thrust direction ends within this of the vertical.
pub const FINAL_TILT_RAD: f64 = 0.07;
const FINAL_TILT_INTERVALS: usize = 3;

/// Planned turns of the thrust, rad/s: half the rate of a slew, for a turn begins and ends slower than it goes.
pub const TURN_RAD_S: f64 = 0.25;

/// The engine's switching limits. Valves need tenths of a second; the restarts cover a plan and
/// three changes of mind.
const PROPULSION: Propulsion = Propulsion::OnOff { on_min_s: 0.2, off_min_s: 0.2, restarts_max: 4 };
/// Failed plans in a row, each a period apart, after which the last one no longer counts: 2 s at
/// 0.5 s, in which tracking at 0.7 rad/s has either mended the error or never will.
const FAILED_IN_A_ROW_MAX: u32 = 4;

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

/// What a plan is made for.
#[derive(Clone, Copy)]
pub struct Situation<'a> {
    pub vehicle: &'a Vehicle,
    pub task: &'a Task,
    pub gravity_m_s2: f64,
    pub capability: Capability,
    pub now: Ticks,
    pub nav: &'a Navigation,
    /// Unit vector along which the vehicle thrusts, or would.
    pub axis_w: Vector3<f64>,
}

impl Situation<'_> {
    /// Whether the propellant lasts for a plan and the descent below it (G.90).
    fn lasts(&self, plan: &Plan) -> bool {
        let lost_kg = self.capability.loss_kg_s * (plan.duration_s() + TERMINAL_S);
        lost_kg <= 0.0 || plan.report.propellant_left_kg >= lost_kg
    }
}

/// Plans made and missed so far, and when the next is due.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Planning {
    pub flown: Option<Flown>,
    pub next_due: Ticks,
    pub accepted: u32,
    pub failed: u32,
    /// Failed plans since the last accepted one.
    pub failed_in_a_row: u32,
    /// How much of the target is still asked for.
    pub terminal: Terminal,
}

impl Planning {
    /// A first plan: of the target as far as one can be had, with the longest lead that has one.
    pub fn first(&mut self, situation: &Situation) {
        let Situation { task, now, .. } = *situation;
        let hop = task.mode == GuidanceMode::Hop;
        let leads: &[Ticks] = if hop { &HOP_LEADS } else { &DESCENT_LEADS };
        // A hop has burnt since its lift-off, at time zero; a descent begins unlit.
        let lit = EngineState { running: true, for_s: now.seconds(), ignitions: 1 };
        let engine = if hop { lit } else { EngineState::default() };
        for terminal in FALL_BACKS {
            for lead in leads {
                let nominal = problem(situation, lead.seconds(), terminal);
                let problem = Problem { engine, ..nominal };
                let start = now + *lead;
                let answer = scvx::solve(&problem, &Settings::default());
                self.next_due = start + task.replan_period;
                if self.take(answer, start, terminal) {
                    return;
                }
            }
        }
    }

    /// Where to land once the plan is over: at the target, or below the end of the plan.
    pub fn aim(&self, task: &Task) -> Aim {
        let end = self.flown.as_ref().and_then(|flown| flown.plan.nodes.last());
        match (self.terminal, end) {
            (Terminal::Point, _) => Aim::Target(task.target_w),
            (Terminal::Anywhere, Some(end)) => {
                Aim::Target(Vector3::new(end.r_w.x, end.r_w.y, task.target_w.z))
            }
            _ => Aim::Below,
        }
    }

    /// A new plan from here when one is due. When it fails, the last one stays in force for a while;
    /// then less of the target is asked for.
    pub fn update(&mut self, situation: &Situation) {
        let Situation { now, .. } = *situation;
        let Some(flown) = &self.flown else { return };
        if now < self.next_due || flown.time_to_go_s(now) < FREEZE_S {
            return;
        }
        self.replan(situation, self.terminal, FAILED_IN_A_ROW_MAX);
    }

    /// A new plan at once, since the last one can't be flown any more: of the target as far as one
    /// can be had. With none, there is nothing left to follow.
    pub fn again(&mut self, situation: &Situation) {
        let accepted = self.accepted;
        self.replan(situation, Terminal::Point, 0);
        if self.accepted == accepted {
            self.flown = None;
        }
    }

    /// Asks for ever less from `asked_for` on, once more than `patience` plans have failed in a row.
    fn replan(&mut self, situation: &Situation, asked_for: Terminal, patience: u32) {
        let Situation { task, now, .. } = *situation;
        self.next_due = now + task.replan_period;
        for terminal in FALL_BACKS.into_iter().skip_while(|&terminal| terminal != asked_for) {
            let Some(flown) = &self.flown else { return };
            let problem = problem(situation, 0.0, terminal);
            let answer =
                scvx::replan(&problem, &Settings::default(), &flown.plan, flown.elapsed_s(now));
            if terminal == Terminal::Point && answer.as_ref().is_ok_and(|p| !situation.lasts(p)) {
                self.failed += 1;
            } else if self.take(answer, now, terminal) || self.failed_in_a_row <= patience {
                return;
            }
        }
    }

    /// Whether the answer is a plan, which is flown from `start` on.
    fn take(
        &mut self,
        answer: Result<Plan, scvx::PlanError>,
        start: Ticks,
        terminal: Terminal,
    ) -> bool {
        let Ok(plan) = answer else {
            self.failed += 1;
            self.failed_in_a_row += 1;
            return false;
        };
        self.flown = Some(Flown { plan, start });
        self.terminal = terminal;
        self.accepted += 1;
        self.failed_in_a_row = 0;
        true
    }
}

/// What is asked of the planner, each when the one before has no plan.
const FALL_BACKS: [Terminal; 3] = [Terminal::Point, Terminal::Anywhere, Terminal::SoftestImpact];

/// The landing problem from `lead_s` of free fall ahead of now to the gate above the target.
fn problem(situation: &Situation, lead_s: f64, terminal: Terminal) -> Problem {
    let Situation { vehicle, task, gravity_m_s2, ref capability, nav, axis_w, .. } = *situation;
    let fall_w = Vector3::z() * -gravity_m_s2;
    let r0_w = nav.position_w + nav.velocity_w * lead_s + fall_w * (0.5 * lead_s * lead_s);
    let v0_w = nav.velocity_w + fall_w * lead_s;
    let braking_m_s2 = capability.terminal_deceleration_m_s2(task, nav.mass.mass_kg, gravity_m_s2);
    let thrust_max_n = capability.ceiling_n(terminal);
    let (r_f_w, v_f_w) = gate(task, nav, braking_m_s2);
    // The terminal law's own need: the gate's speed, and gravity for as long as it brakes.
    let braking_s = v_f_w.norm() / braking_m_s2;
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
        terminal,
        mass_kg: nav.mass.mass_kg,
        dry_mass_kg: (vehicle.mass.dry.mass_kg + reserve_kg).min(nav.mass.mass_kg),
        gravity_m_s2,
        isp_s: vehicle.engine.isp_s,
        thrust_min_n: capability.plan_thrust_min_n,
        thrust_max_n,
        thrust_rate_max_n_s: None,
        // What is turned before the plan begins is no part of it.
        turn: Some(Turn { rate_max_rad_s: TURN_RAD_S, axis_w: (lead_s == 0.0).then_some(axis_w) }),
        propulsion: PROPULSION,
        engine: EngineState::default(),
        tilt_max_rad: task.tilt_max_rad,
        final_tilt: Some(FinalTilt {
            tilt_max_rad: FINAL_TILT_RAD.min(task.tilt_max_rad),
            intervals: FINAL_TILT_INTERVALS,
        }),
        reserve: Some(Reserve {
            thrust_max_n: RESERVE_SHARE * capability.thrust_max_n
                + (1.0 - RESERVE_SHARE) * thrust_max_n,
            tilt_max_rad: task.tilt_max_rad + RESERVE_TILT_RAD,
        }),
        path: PathLimits { glide_slope_rad: None, altitude_min_m: Some(lowest_m) },
    }
}

/// Centre-of-mass state at which the terminal law takes over: above the target, with the speed
/// that its deceleration takes off down to the cut-off height (G.33).
fn gate(task: &Task, nav: &Navigation, braking_m_s2: f64) -> (Vector3<f64>, Vector3<f64>) {
    let com_height_m = nav.mass.com_b.z;
    let gate_height_m = if task.terminal_law { task.gate_height_m } else { task.cutoff_height_m };
    let position_w = task.target_w + Vector3::z() * (gate_height_m + com_height_m);
    let braking_m = (gate_height_m - task.cutoff_height_m).max(0.0);
    let speed_m_s = (square(task.cutoff_speed_m_s) + 2.0 * braking_m_s2 * braking_m).sqrt();
    (position_w, Vector3::z() * -speed_m_s)
}

#[cfg(test)]
mod tests {
    use lander_models::scenario::Scenario;
    use lander_models::signals::{ATTITUDE_WB, GUIDANCE, MASS_KG, POSITION_W, VELOCITY_W};

    use super::*;

    const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");

    /// Upright, `across_m` from the target, 500 m above it, falling.
    fn falling(vehicle: &Vehicle, across_m: f64, propellant_kg: f64) -> Navigation {
        let mut inputs = vec![0.0; GUIDANCE.input_len()];
        let at = |name| GUIDANCE.input_offset(name).unwrap();
        inputs[at(ATTITUDE_WB.name)] = 1.0;
        inputs[at(MASS_KG.name)] = vehicle.mass.dry.mass_kg + propellant_kg;
        inputs[at(POSITION_W.name)] = across_m;
        inputs[at(POSITION_W.name) + 2] = 500.0;
        inputs[at(VELOCITY_W.name) + 2] = -25.0;
        Navigation::read(vehicle, &inputs).unwrap()
    }

    fn situation<'a>(
        scenario: &'a Scenario,
        vehicle: &'a Vehicle,
        now: Ticks,
        nav: &'a Navigation,
    ) -> Situation<'a> {
        let (task, gravity_m_s2) = (&scenario.guidance, scenario.gravity_m_s2);
        let capability = Capability::nominal(task, vehicle);
        let axis_w = Vector3::z();
        Situation { vehicle, task, gravity_m_s2, capability, now, nav, axis_w }
    }

    #[test]
    fn a_first_plan_asks_for_less_where_the_target_cannot_be_had() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        // Across 100 m, 3 km with little propellant, and with too little to stop at all: free fall
        // to the ground is 47 m/s, and 2 kg are 25 m/s.
        for (across_m, propellant_kg, terminal) in [
            (100.0, 70.0, Terminal::Point),
            (3000.0, 10.0, Terminal::Anywhere),
            (100.0, 2.0, Terminal::SoftestImpact),
        ] {
            let mut planning = Planning::default();
            let nav = falling(&vehicle, across_m, propellant_kg);
            planning.first(&situation(&scenario, &vehicle, Ticks(0), &nav));
            assert!(planning.flown.is_some(), "{terminal:?}");
            assert_eq!(planning.terminal, terminal);
        }
    }

    #[test]
    fn a_plan_from_now_begins_where_the_vehicle_points_and_one_from_later_anywhere() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        let nav = falling(&vehicle, 100.0, 70.0);
        let axis_w = Vector3::new(-0.45, 0.0, 0.893).normalize();
        let situation = Situation { axis_w, ..situation(&scenario, &vehicle, Ticks(0), &nav) };
        let turn = |lead_s| problem(&situation, lead_s, Terminal::Point).turn.unwrap();
        assert_eq!(turn(0.0), Turn { rate_max_rad_s: TURN_RAD_S, axis_w: Some(axis_w) });
        assert_eq!(turn(1.0).axis_w, None);
    }

    #[test]
    fn the_last_plan_is_flown_until_it_has_failed_too_often() {
        let (scenario, vehicle) = Scenario::load(FILE.as_ref()).unwrap();
        let task = &scenario.guidance;
        let mut planning = Planning::default();
        let nav = falling(&vehicle, 100.0, 70.0);
        planning.first(&situation(&scenario, &vehicle, Ticks(0), &nav));
        let first = planning.flown.clone().unwrap().plan;
        // Suddenly 3 km away: the target is out of reach.
        let astray = falling(&vehicle, 3000.0, 10.0);
        let mut now = planning.next_due;
        for failed in 1..=FAILED_IN_A_ROW_MAX {
            planning.update(&situation(&scenario, &vehicle, now, &astray));
            assert_eq!(planning.failed_in_a_row, failed);
            assert_eq!(planning.flown.as_ref().unwrap().plan, first);
            now = planning.next_due;
        }
        planning.update(&situation(&scenario, &vehicle, now, &astray));
        assert_eq!((planning.terminal, planning.failed_in_a_row), (Terminal::Anywhere, 0));
        assert!(matches!(planning.aim(task), Aim::Target(site_w) if site_w.x > 2000.0));
    }
}
