//! The component: flies, hands over to contact and back, and keeps the verdict.

use lander_models::ConfigError;
use lander_models::component::{Component, ModelError, Settings, StepReport};
use lander_models::scenario::Scenario;
use lander_models::signals::{self, Interface};
use lander_models::time::{TICK_S, Ticks};
use lander_models::vehicle::Vehicle;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::contact::{ContactWorld, Touch};
use crate::engine;
use crate::flight::{self, Drive, Motion};
use crate::gear::Leg;
use crate::verdict::Touchdown;

/// The contact engine takes over when the lowest point may be this close, m, plus what two ticks
/// of its speed cover.
const TAKE_OVER_GAP_M: f64 = 0.02;
/// It hands back beyond this, m: apart from the former, so that the two don't alternate.
const HAND_BACK_GAP_M: f64 = 0.06;
/// A lander that starts on the ground touches down only after it was this high, m.
const AIRBORNE_GAP_M: f64 = 0.5;

/// A start with the pads nearer than this to the ground, and slower, stands on it. One that has
/// them this far below ground is refused.
const START_GAP_M: f64 = 1e-3;
const START_SPEED_M_S: f64 = 1e-3;

/// Constant configuration.
#[derive(Clone, Debug)]
pub struct TruthModel {
    pub scenario: Scenario,
    pub vehicle: Vehicle,
}

/// All that a bit-exact restart needs.
#[derive(Clone, Serialize, Deserialize)]
pub struct State {
    pub now: Ticks,
    pub motion: Motion,
    pub drive: Drive,
    pub legs: Vec<Leg>,
    pub contact: Option<ContactWorld>,
    pub feet_down: Vec<bool>,
    /// Has been clear of the ground, so the next contact is a touchdown.
    pub airborne: bool,
    pub touchdown: Touchdown,
    /// Mean non-gravitational acceleration of the centre of mass over the last step.
    pub specific_force_b: Vector3<f64>,
    pub dead_zone: Ticks,
}

impl TruthModel {
    pub fn new(scenario: Scenario, vehicle: Vehicle) -> Self {
        Self { scenario, vehicle }
    }

    /// State at t = 0.
    pub fn initial_state(&self) -> State {
        let start = &self.scenario.initial;
        let feet = self.vehicle.gear.feet_b.len();
        let motion = Motion {
            position_w: start.position_w,
            velocity_w: start.velocity_w,
            attitude_wb: start.attitude_wb,
            rate_b: start.rate_b,
            propellant_kg: start.propellant_kg,
            thrust_n: 0.0,
            gimbal_rad: Vector2::zeros(),
        };
        let mut state = State {
            now: Ticks::ZERO,
            motion,
            drive: Drive::default(),
            legs: vec![Leg::default(); feet],
            contact: None,
            feet_down: vec![false; feet],
            airborne: false,
            touchdown: Touchdown::default(),
            specific_force_b: Vector3::zeros(),
            dead_zone: Ticks::ZERO,
        };
        // A vehicle that starts on its feet at rest lifts off first; any other start is a flight.
        state.airborne =
            self.lowest_m(&state) > START_GAP_M || state.motion.velocity_w.norm() > START_SPEED_M_S;
        state
    }

    /// Advances one tick of `TICK_S`.
    pub fn tick(&self, state: &mut State) -> Result<StepReport, ModelError> {
        let limits = &self.scenario.touchdown;
        let (outcome, touched) = (state.touchdown.outcome, state.touchdown.first.is_some());
        self.choose_engine(state);
        if let Some(mut world) = state.contact.take() {
            let before = state.motion;
            let touch = self.contact_tick(&mut world, state)?;
            let sight = self.sight(state, &before, &touch);
            state.contact = Some(world);
            state.touchdown.look(limits, &sight);
            state.feet_down = touch.feet;
        } else {
            state.motion = flight::advance(
                &self.vehicle,
                self.scenario.gravity_m_s2,
                &state.motion,
                &state.drive,
                TICK_S,
            );
        }
        state.now += Ticks(1);
        if state.now >= self.scenario.stop_time {
            state.touchdown.end(limits);
        }
        if !state.motion.is_finite() {
            return Err(diverged(state, "motion"));
        }
        Ok(StepReport {
            event: state.touchdown.outcome != outcome || state.touchdown.first.is_some() != touched,
            terminate: state.touchdown.decided(),
        })
    }

    /// Propulsion and mass go on while the contact engine owns the motion.
    fn contact_tick(
        &self,
        world: &mut ContactWorld,
        state: &mut State,
    ) -> Result<Touch, ModelError> {
        let motion = &mut state.motion;
        let wrench = flight::propulsion(&self.vehicle, motion, &state.drive);
        let touch = world.step(&self.vehicle, motion, &mut state.legs, &wrench);
        let flow_kg_s = flight::propellant_flow_kg_s(&self.vehicle, motion, &state.drive);
        motion.propellant_kg = (motion.propellant_kg - flow_kg_s * TICK_S).max(0.0);
        (motion.thrust_n, motion.gimbal_rad) =
            flight::actuators_after(&self.vehicle, motion, &state.drive, TICK_S);
        touch.ok_or_else(|| diverged(state, "a body in contact"))
    }

    fn choose_engine(&self, state: &mut State) {
        let lowest_m = self.lowest_m(state);
        state.airborne |= lowest_m > AIRBORNE_GAP_M;
        let near_m = TAKE_OVER_GAP_M + 2.0 * TICK_S * state.motion.velocity_w.norm();
        if state.contact.is_none() && lowest_m < near_m {
            state.contact = Some(ContactWorld::take_over(
                &self.vehicle,
                &self.scenario.terrain,
                self.scenario.gravity_m_s2,
                &state.motion,
                &state.legs,
            ));
        } else if state.contact.is_some() && lowest_m > HAND_BACK_GAP_M.max(2.0 * near_m) {
            // Off the ground the struts spring back to their crushed length.
            state.contact = None;
            state.feet_down.fill(false);
            for leg in &mut state.legs {
                *leg = Leg { stroke_m: leg.crushed_m, load_n: 0.0, ..*leg };
            }
        }
    }

    fn take_commands(&self, state: &mut State, inputs: &[f64]) {
        let (engine, rcs) = (&self.vehicle.engine, &self.vehicle.rcs);
        // Order of the truth's inputs in the signal table.
        let [thrust_n, gimbal_x, gimbal_y, torque_x, torque_y, torque_z] =
            std::array::from_fn(|n| inputs[n]);
        let limit = rcs.torque_max_b;
        state.drive = Drive {
            thrust_target_n: engine::thrust_target_n(engine, self.scenario.ignition, thrust_n),
            gimbal_target_rad: engine::gimbal_target_rad(engine, Vector2::new(gimbal_x, gimbal_y)),
            rcs_torque_b: Vector3::new(torque_x, torque_y, torque_z)
                .zip_map(&limit, |t, max| t.clamp(-max, max)),
        };
    }
}

fn diverged(state: &State, what: &'static str) -> ModelError {
    ModelError::Diverged { time_s: state.now.seconds(), what }
}

impl Component for TruthModel {
    const INTERFACE: &'static Interface = &signals::TRUTH;
    type State = State;

    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        let (scenario, vehicle) = Scenario::load(&settings.scenario_file)?;
        let model = Self::new(scenario, vehicle);
        let state = model.initial_state();
        let lowest_m = model.lowest_m(&state);
        if lowest_m < -START_GAP_M {
            let file = settings.scenario_file.clone();
            let reason = format!("puts the vehicle {:.3} m below ground", -lowest_m);
            return Err(ConfigError::Key { file, key: "initial.position_w".into(), reason }.into());
        }
        Ok((model, state))
    }

    fn step(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        if state.touchdown.decided() {
            // What is decided stays as it was seen.
            return Ok(StepReport { event: false, terminate: true });
        }
        let start = state.now;
        let start_velocity_w = self.com_velocity_w(&state.motion);
        self.take_commands(state, inputs);
        let mut report = StepReport::default();
        while state.now.0 < start.0 + duration.0 && !report.terminate {
            let tick = self.tick(state)?;
            report.event |= tick.event;
            report.terminate = tick.terminate;
        }
        let elapsed = Ticks(state.now.0 - start.0);
        if engine::in_dead_zone(&self.vehicle.engine, inputs[0]) {
            state.dead_zone += elapsed;
        }
        let gained_w = self.com_velocity_w(&state.motion) - start_velocity_w;
        let specific_force_w =
            gained_w / elapsed.seconds() + Vector3::z() * self.scenario.gravity_m_s2;
        state.specific_force_b = state.motion.attitude_wb.inverse() * specific_force_w;
        Ok(report)
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        self.write_outputs(state, outputs);
    }
}
