//! Which law flies now, and what it asks of engine and attitude.

use lander_models::Ticks;
use lander_models::scenario::{Guidance as Task, GuidanceMode};
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::attitude::{self, GIMBAL_THRUST_MIN_N};
use crate::descent::{self, Aim, Braking};
use crate::disturbance::EngineEstimate;
use crate::faults::Faults;
use crate::navigation::Navigation;
use crate::planning::{FINAL_TILT_RAD, Planning, Situation};
use crate::scvx::Terminal;

/// A last burn shorter than this is left to the terminal law, s: the attitude takes as long for the turns that a plan
/// makes in one.
const SHORT_BURN_S: f64 = 1.5;
/// Tracking gains: critically damped at 0.8 rad/s, a quarter of the attitude loop's bandwidth.
const TRACK_POSITION_1_S2: f64 = 0.64;
const TRACK_VELOCITY_1_S: f64 = 1.6;
/// Half-width of the average over planned thrust directions, s: an interval of a last burn and what the gimbal takes to swing
/// over, so that a turn begins and ends as the vehicle can.
const DIRECTION_WINDOW_S: f64 = 0.6;
/// Half-width of the difference that gives the planned turn rate, s.
const TURN_WINDOW_S: f64 = 0.1;
/// Time before the end of a plan from which on the tilt limit falls to that of an upright end, s: what a turn takes. Between
/// 0.4 and 0.7 s the worst misses of 109 hard starts on the filter agree within 3 cm.
const HANDOVER_S: f64 = 0.5;
/// Net upward acceleration of a lift-off.
const LIFT_OFF_ACCELERATION_M_S2: f64 = 3.0;

/// Coded as an output: the number is part of the interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Phase {
    /// Nothing is commanded.
    #[default]
    Standby = 0,
    LiftOff = 1,
    Coast = 2,
    Burn = 3,
    Terminal = 4,
    CutOff = 5,
    /// No plan could be had: brake and land wherever that is.
    FallBack = 6,
}

/// How much of the target is still flown for. Coded as an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Goal {
    Target = 0,
    /// A landing wherever it costs least.
    Anywhere = 1,
    /// The slowest impact that the propellant allows.
    SoftestImpact = 2,
    /// Below, without a plan.
    Below = 3,
    /// Without an engine: upright.
    Upright = 4,
}

/// What the flight laws keep between steps.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Mission {
    pub phase: Phase,
    pub planning: Planning,
    pub braking: Braking,
    pub touched: bool,
}

/// What one step asks for.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// Zero, or within the engine's range.
    pub thrust_n: f64,
    pub up_w: Vector3<f64>,
    /// Angular velocity at which `up_w` is planned to turn, rad/s.
    pub up_rate_w: Vector3<f64>,
    /// Whether attitude is controlled at all.
    pub hold_attitude: bool,
}

impl Orders {
    const NONE: Self = Self {
        thrust_n: 0.0,
        up_w: Vector3::new(0.0, 0.0, 1.0),
        up_rate_w: Vector3::new(0.0, 0.0, 0.0),
        hold_attitude: false,
    };

    fn coast(up_w: Vector3<f64>) -> Self {
        Self { up_w, hold_attitude: true, ..Self::NONE }
    }
}

/// What the laws may look at.
pub struct Context<'a> {
    pub vehicle: &'a Vehicle,
    pub task: &'a Task,
    pub gravity_m_s2: f64,
    pub now: Ticks,
    pub nav: &'a Navigation,
    pub engine: &'a EngineEstimate,
    pub faults: &'a Faults,
    /// Of what has been declared something is new, or no longer holds.
    pub outdated: bool,
}

impl<'a> Context<'a> {
    fn situation(&self) -> Situation<'a> {
        let Self { vehicle, task, gravity_m_s2, now, nav, engine, faults, .. } = *self;
        let capability = faults.capability(task, vehicle, engine);
        Situation { vehicle, task, gravity_m_s2, capability, now, nav, axis_w: self.axis_w() }
    }

    fn axis_w(&self) -> Vector3<f64> {
        attitude::thrust_axis_w(self.vehicle, self.nav, self.engine, self.faults)
    }
}

impl Mission {
    pub fn goal(&self, faults: &Faults) -> Goal {
        match self.planning.terminal {
            _ if faults.engine.out() => Goal::Upright,
            _ if self.phase == Phase::FallBack => Goal::Below,
            Terminal::Point => Goal::Target,
            Terminal::Anywhere => Goal::Anywhere,
            Terminal::SoftestImpact => Goal::SoftestImpact,
        }
    }

    /// Chooses the phase and flies it.
    pub fn step(&mut self, context: &Context) -> Orders {
        if context.faults.engine.out() && self.phase != Phase::CutOff {
            if context.nav.any_foot_down {
                self.phase = Phase::CutOff;
            }
            return self.without_engine(context);
        }
        self.change_phase(context);
        match self.phase {
            Phase::Standby => Orders::NONE,
            Phase::LiftOff => lift_off(context),
            Phase::Coast | Phase::Burn => self.follow_plan(context),
            Phase::Terminal => self.descend(context, self.planning.aim(context.task)),
            Phase::FallBack => self.descend(context, Aim::Below),
            Phase::CutOff => {
                self.touched |= context.nav.any_foot_down;
                Orders { hold_attitude: !self.touched, ..Orders::NONE }
            }
        }
    }

    fn change_phase(&mut self, context: &Context) {
        let Context { vehicle, task, now, nav, engine, .. } = *context;
        match self.phase {
            Phase::Standby => match task.mode {
                GuidanceMode::Off => {}
                GuidanceMode::Hop => self.phase = Phase::LiftOff,
                GuidanceMode::Descent => self.begin(context),
            },
            Phase::LiftOff if nav.altimeter_m >= task.lift_off_height_m => self.begin(context),
            Phase::Coast | Phase::Burn => {
                if context.outdated {
                    self.planning.again(&context.situation());
                } else {
                    self.planning.update(&context.situation());
                }
                let over = self.planning.flown.as_ref().is_none_or(|f| f.time_to_go_s(now) <= 0.0);
                if nav.any_foot_down || over && !task.terminal_law {
                    self.phase = Phase::CutOff;
                } else if self.planning.flown.is_none() {
                    self.phase = Phase::FallBack;
                } else if over {
                    self.phase = Phase::Terminal;
                    self.braking.engine_on = true;
                } else if self.only_a_touch_left(context) {
                    self.phase = Phase::Terminal;
                    self.braking.engine_on = false;
                }
            }
            Phase::Terminal | Phase::FallBack => {
                if descent::cut_off(vehicle, task, nav, engine.thrust_n()) {
                    self.phase = Phase::CutOff;
                }
            }
            Phase::LiftOff | Phase::CutOff => {}
        }
    }

    /// Whether the plan falls and then burns for so short that the attitude could not follow: the terminal law brakes
    /// as late by itself, and upright.
    fn only_a_touch_left(&self, context: &Context) -> bool {
        let Some(flown) = &self.planning.flown else { return false };
        let left = flown.plan.last_burn_after(flown.elapsed_s(context.now));
        context.task.terminal_law && left.is_some_and(|burn_s| burn_s < SHORT_BURN_S)
    }

    fn begin(&mut self, context: &Context) {
        let Context { task, nav, faults, .. } = *context;
        if faults.restarted && task.fault_response {
            if nav.any_foot_down {
                self.phase = Phase::CutOff;
                return;
            }
            // Below the gate there is nothing left to plan.
            if task.terminal_law && nav.altimeter_m <= task.gate_height_m {
                self.phase = Phase::Terminal;
                self.braking.engine_on = true;
                return;
            }
        }
        self.planning.first(&context.situation());
        self.phase = if self.planning.flown.is_some() { Phase::Coast } else { Phase::FallBack };
    }

    /// Upright, as it should meet the ground and as a restart lifts most, with valves opened again
    /// and again (G.81): a vehicle that falls has nothing to save its starts for.
    fn without_engine(&self, context: &Context) -> Orders {
        let Context { vehicle, task, nav, faults, .. } = *context;
        let spec = &vehicle.engine;
        let ignition_s = spec.ignition_delay.seconds() + 3.0 * spec.ignition_lag_s;
        let open = faults.engine.tries_restart(ignition_s) && !nav.any_foot_down;
        let thrust_n = if open { task.plan_thrust_max_n } else { 0.0 };
        Orders { thrust_n, ..Orders::coast(Vector3::z()) }
    }

    /// Feed-forward of the plan with feedback on its path (G.30). Commands lead by the engine's
    /// lag, so that the thrust itself is in time.
    fn follow_plan(&mut self, context: &Context) -> Orders {
        let Context { vehicle, now, nav, engine, .. } = *context;
        let Some(flown) = &self.planning.flown else { return Orders::NONE };
        let elapsed_s = flown.elapsed_s(now);
        let ahead_s = elapsed_s + engine.lead_s(&vehicle.engine);
        let ahead = flown.plan.sample(ahead_s);
        let powered = ahead_s >= 0.0 && ahead.powered;
        self.phase = if powered { Phase::Burn } else { Phase::Coast };
        if !powered {
            let up_w = flown.plan.next_burn_direction(ahead_s.max(0.0)).unwrap_or(Vector3::z());
            return Orders::coast(up_w);
        }
        let reference = flown.plan.sample(elapsed_s.max(0.0));
        let direction = |t_s: f64| {
            flown.plan.smoothed_direction(t_s, DIRECTION_WINDOW_S).unwrap_or(Vector3::z())
        };
        let feedback_w = if context.task.tracking {
            // What a thrust that is off its line fails to give until it is back (G.99).
            let off_w = direction(elapsed_s) - context.axis_w();
            let acceleration_m_s2 = if engine.thrust_n() > GIMBAL_THRUST_MIN_N {
                ahead.thrust_n / ahead.mass_kg
            } else {
                0.0
            };
            let missing_w = off_w * (acceleration_m_s2 * attitude::LAG_S);
            (reference.r_w - nav.position_w) * TRACK_POSITION_1_S2
                + (reference.v_w - nav.velocity_w + missing_w) * TRACK_VELOCITY_1_S
        } else {
            Vector3::zeros()
        };
        let up_w = direction(ahead_s);
        let turned_w = direction(ahead_s + TURN_WINDOW_S) - direction(ahead_s - TURN_WINDOW_S);
        let wanted_w = up_w * (ahead.thrust_n / ahead.mass_kg) + feedback_w;
        let tilt_max_rad = handover_tilt_rad(context.task, flown.time_to_go_s(now));
        Orders {
            up_rate_w: up_w.cross(&turned_w) / (2.0 * TURN_WINDOW_S),
            ..powered_orders(context, &wanted_w, tilt_max_rad)
        }
    }

    fn descend(&mut self, context: &Context, aim: Aim) -> Orders {
        let (situation, engine) = (context.situation(), context.engine);
        let demand = descent::demand(&situation, engine, aim, &mut self.braking);
        match demand.thrust_acceleration_w {
            Some(acceleration_w) => {
                powered_orders(context, &acceleration_w, context.task.tilt_max_rad)
            }
            None => Orders::coast(demand.up_w),
        }
    }
}

fn lift_off(context: &Context) -> Orders {
    let up_m_s2 = context.gravity_m_s2 + LIFT_OFF_ACCELERATION_M_S2;
    powered_orders(context, &(Vector3::z() * up_m_s2), context.task.tilt_max_rad)
}

/// Tilt limit towards the end of a plan, rad (G.96): the terminal law takes over a vehicle that stands up. A plan that draws
/// on its reserve to the end would hand over one that leans, and what the lean gives in the second that it takes to
/// undo is more than is left to mend.
fn handover_tilt_rad(task: &Task, time_to_go_s: f64) -> f64 {
    if !(task.tracking && task.terminal_law) {
        return task.tilt_max_rad;
    }
    let upright_rad = FINAL_TILT_RAD.min(task.tilt_max_rad);
    let share = (time_to_go_s / HANDOVER_S).clamp(0.0, 1.0);
    upright_rad + (task.tilt_max_rad - upright_rad) * share
}

/// Thrust acceleration within a tilt limit and the throttle range.
fn powered_orders(context: &Context, acceleration_w: &Vector3<f64>, tilt_max_rad: f64) -> Orders {
    let Context { vehicle, nav, engine, .. } = *context;
    let up_w = within_tilt(acceleration_w, tilt_max_rad);
    let thrust_n = acceleration_w.dot(&up_w) * nav.mass.mass_kg;
    Orders {
        thrust_n: engine.command_n(&vehicle.engine, thrust_n),
        up_w,
        hold_attitude: true,
        ..Orders::NONE
    }
}

/// Direction of `v_w`, turned towards the vertical where it exceeds the tilt limit.
fn within_tilt(v_w: &Vector3<f64>, tilt_max_rad: f64) -> Vector3<f64> {
    let lateral_w = Vector3::new(v_w.x, v_w.y, 0.0);
    if lateral_w.norm() <= v_w.z * libm::tan(tilt_max_rad) {
        return v_w.normalize();
    }
    let side_w = lateral_w.try_normalize(0.0).unwrap_or_default();
    side_w * libm::sin(tilt_max_rad) + Vector3::z() * libm::cos(tilt_max_rad)
}

#[cfg(test)]
mod tests {
    use lander_models::Scenario;

    use super::*;

    const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/landing.toml");

    #[test]
    fn a_plan_hands_over_a_vehicle_that_stands_up() {
        let (scenario, _) = Scenario::load(FILE.as_ref()).unwrap();
        let task = scenario.guidance;
        let limit_rad = |time_to_go_s| handover_tilt_rad(&task, time_to_go_s);
        assert_eq!(limit_rad(0.0), FINAL_TILT_RAD);
        assert_eq!(limit_rad(-0.1), FINAL_TILT_RAD);
        assert_eq!(limit_rad(HANDOVER_S), task.tilt_max_rad);
        assert_eq!(limit_rad(10.0), task.tilt_max_rad);
        assert!(limit_rad(0.2) < limit_rad(0.3));
        // Without a terminal law there is nobody to hand over to.
        let task = Task { terminal_law: false, ..task };
        assert_eq!(handover_tilt_rad(&task, 0.0), task.tilt_max_rad);
    }
}
