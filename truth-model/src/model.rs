//! The component: flies, hands over to contact and back, and keeps the verdict.

use lander_models::component::{Component, ModelError, Settings, StepReport};
use lander_models::scenario::Scenario;
use lander_models::signals::{self, FOOT_SLOTS, Interface};
use lander_models::time::{TICK_S, Ticks};
use lander_models::vehicle::Vehicle;
use lander_models::{ConfigError, Outcome};
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::contact::{Contact, Site};
use crate::disturbances::{self, Biases};
use crate::engine;
use crate::flight::{self, Motion};
use crate::gear::LegState;
use crate::propulsion::{Command, Drive, Plant, Propulsion};
use crate::sensors::{SensorState, SensorSuite};
use crate::sight;
use crate::slosh::Pendulums;
use crate::terrain::Ground;
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
    scenario: Scenario,
    vehicle: Vehicle,
    biases: Biases,
    /// The scenario's terrain, made ready for queries.
    ground: Ground,
    sensors: SensorSuite,
    /// Radius of the ball about O that holds pads, hull and nozzle at any stroke, m.
    reach_m: f64,
}

/// All that a bit-exact restart needs.
#[derive(Clone, Serialize, Deserialize)]
pub struct State {
    pub now: Ticks,
    pub motion: Motion,
    pub command: Command,
    /// What the command came to in the last tick.
    pub drive: Drive,
    pub propulsion: Propulsion,
    pub legs: Vec<LegState>,
    pub contact: Option<Contact>,
    pub feet_down: [bool; FOOT_SLOTS],
    /// Has been clear of the ground, so the next contact is a touchdown.
    pub airborne: bool,
    pub touchdown: Touchdown,
    /// Mean non-gravitational acceleration of the centre of mass over the last step.
    pub specific_force_b: Vector3<f64>,
    pub dead_zone: Ticks,
    pub sensors: SensorState,
}

impl TruthModel {
    pub fn new(scenario: Scenario, vehicle: Vehicle) -> Self {
        let biases = Biases::draw(&scenario.disturbances, scenario.seed);
        let (scenario, vehicle) = disturbances::disperse(scenario, vehicle);
        let ground = Ground::new(&scenario.terrain);
        let sensors = SensorSuite::new(&scenario, &vehicle);
        let reach_m = sight::reach_m(&vehicle);
        Self { scenario, vehicle, biases, ground, sensors, reach_m }
    }

    /// Whether the lowest point is known to be higher than `gap_m`: most of a flight needs to know no more.
    pub(crate) fn surely_clear(&self, motion: &Motion, gap_m: f64) -> bool {
        self.ground.surely_clear(&motion.position_w, self.reach_m, gap_m)
    }

    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    pub fn sensors(&self) -> &SensorSuite {
        &self.sensors
    }

    /// What contact engines work on.
    pub fn site(&self) -> Site<'_> {
        let gravity_w = Vector3::z() * -self.scenario.gravity_m_s2;
        let Self { scenario, vehicle, ground, .. } = self;
        let refinement = scenario.contact_refinement;
        Site { vehicle, terrain: &scenario.terrain, ground, gravity_w, refinement }
    }

    /// State at t = 0.
    pub fn initial_state(&self) -> State {
        let start = &self.scenario.initial;
        let motion = Motion {
            position_w: start.position_w,
            velocity_w: start.velocity_w,
            attitude_wb: start.attitude_wb,
            rate_b: start.rate_b,
            propellant_kg: start.propellant_kg,
            thrust_n: 0.0,
            gimbal_rad: Vector2::zeros(),
            slosh: self.initial_slosh(),
        };
        let mut state = State {
            now: Ticks::ZERO,
            motion,
            command: Command::default(),
            drive: Drive::default(),
            propulsion: Propulsion::default(),
            legs: vec![LegState::default(); self.vehicle.gear.legs.len()],
            contact: None,
            feet_down: [false; FOOT_SLOTS],
            airborne: false,
            touchdown: Touchdown::default(),
            specific_force_b: Vector3::zeros(),
            dead_zone: Ticks::ZERO,
            sensors: self.start_sensors(&motion),
        };
        // A vehicle that starts on its feet at rest lifts off first; any other start is a flight.
        state.airborne =
            self.lowest_m(&state) > START_GAP_M || state.motion.velocity_w.norm() > START_SPEED_M_S;
        state
    }

    fn initial_slosh(&self) -> Pendulums {
        let tanks = self.vehicle.slosh.as_ref().filter(|_| self.scenario.sloshes());
        tanks.map(Pendulums::hanging).unwrap_or_default()
    }

    /// Advances one tick of `TICK_S`.
    pub fn tick(&self, state: &mut State) -> Result<StepReport, ModelError> {
        let limits = &self.scenario.touchdown;
        let before = self.discrete(state);
        let site = self.site();
        self.choose_engine(state);
        let Self { scenario, vehicle, biases, .. } = self;
        let plant = Plant { scenario, vehicle, biases };
        if let Some(angle_rad) = scenario.faults.slosh_onset(state.now) {
            state.motion.slosh.excite(angle_rad, 0.0, 0.0);
        }
        let in_flight = state.contact.is_none();
        state.drive =
            state.propulsion.drive(&plant, state.now, &state.command, &state.motion, in_flight);
        if let Some(mut contact) = state.contact.take() {
            let before = state.motion;
            let touch = contact.step(&site, &mut state.motion, &mut state.legs, &state.drive);
            let touch = touch.ok_or_else(|| diverged(state, "a body in contact"))?;
            let sight = self.sight(state, &before, &touch);
            state.contact = Some(contact);
            state.touchdown.look(limits, &sight);
            state.feet_down = touch.feet;
        } else {
            let Site { vehicle, gravity_w, .. } = site;
            state.motion = flight::advance(
                vehicle,
                &gravity_w,
                &state.motion,
                &state.drive,
                TICK_S,
                flight::free,
            );
            self.watch_flight(state);
        }
        state.now += Ticks(1);
        if state.now >= self.scenario.stop_time {
            state.touchdown.end();
        }
        if !state.motion.is_finite() {
            return Err(diverged(state, "motion"));
        }
        self.sense(state, &self.scenario.faults.failed_sensors(state.now));
        Ok(StepReport {
            event: self.discrete(state) != before,
            terminate: state.touchdown.decided(),
        })
    }

    /// What changes only at an event: verdict, first touch, fire in the engine, faults past onset.
    fn discrete(&self, state: &State) -> (Outcome, bool, bool, usize) {
        let State { touchdown, propulsion, now, .. } = state;
        let faults = self.scenario.faults.active(*now);
        (touchdown.outcome, touchdown.first.is_some(), propulsion.phase.burns(), faults)
    }

    /// Ticks until `duration` has passed, the run is decided or, with `to_event`, something
    /// discrete has happened; returns how far it came.
    fn advance(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
        to_event: bool,
    ) -> Result<(Ticks, StepReport), ModelError> {
        if state.touchdown.decided() {
            // What is decided stays as it was seen.
            return Ok((duration, StepReport { event: false, terminate: true }));
        }
        let start = state.now;
        let start_velocity_w = self.com_velocity_w(&state.motion);
        state.command = Command::from_inputs(inputs);
        let mut report = StepReport::default();
        while state.now.0 < start.0 + duration.0 && !report.terminate {
            let tick = self.tick(state)?;
            report.event |= tick.event;
            report.terminate = tick.terminate;
            if to_event && report.event {
                break;
            }
        }
        let elapsed = Ticks(state.now.0 - start.0);
        if engine::in_dead_zone(&self.vehicle.engine, inputs[0]) {
            state.dead_zone += elapsed;
        }
        let gained_w = self.com_velocity_w(&state.motion) - start_velocity_w;
        let specific_force_w =
            gained_w / elapsed.seconds() + Vector3::z() * self.scenario.gravity_m_s2;
        state.specific_force_b = state.motion.attitude_wb.inverse() * specific_force_w;
        Ok((elapsed, report))
    }

    fn choose_engine(&self, state: &mut State) {
        // A pad that touched in the last tick is neither clear of the ground nor new to it.
        if state.contact.is_some() && state.feet_down.contains(&true) {
            return;
        }
        let near_m = TAKE_OVER_GAP_M + 2.0 * TICK_S * state.motion.velocity_w.norm();
        if state.contact.is_none() && self.surely_clear(&state.motion, near_m.max(AIRBORNE_GAP_M)) {
            state.airborne = true;
            return;
        }
        let lowest_m = self.lowest_m(state);
        state.airborne |= lowest_m > AIRBORNE_GAP_M;
        if state.contact.is_none() && lowest_m < near_m {
            let choice = self.scenario.contact_engine;
            let (motion, legs) = (&state.motion, &state.legs);
            state.contact = Some(Contact::take_over(choice, &self.site(), motion, legs));
        } else if state.contact.is_some() && lowest_m > HAND_BACK_GAP_M.max(2.0 * near_m) {
            // Off the ground the struts spring back to their crushed length.
            state.contact = None;
            state.feet_down.fill(false);
            for leg in &mut state.legs {
                let crushed_m = leg.crushed_m;
                *leg = LegState { stroke_m: crushed_m, crushed_m, ..LegState::default() };
            }
        }
    }
}

fn diverged(state: &State, what: &'static str) -> ModelError {
    ModelError::Diverged { time_s: state.now.seconds(), what }
}

impl Component for TruthModel {
    const INTERFACE: &'static Interface = &signals::TRUTH;
    type State = State;

    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        Self::create_changed(settings, "")
    }

    fn create_changed(settings: &Settings, changes: &str) -> Result<(Self, State), ModelError> {
        let (scenario, vehicle) = Scenario::load_changed(&settings.scenario_file, changes)?;
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
        self.advance(state, inputs, duration, false).map(|(_, report)| report)
    }

    fn step_to_event(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<(Ticks, StepReport), ModelError> {
        self.advance(state, inputs, duration, true)
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        self.write_outputs(state, outputs);
    }
}
