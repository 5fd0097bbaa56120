//! The component: flies, hands over to contact and back, and keeps the verdict.

use lander_models::component::{Component, ModelError, Settings, StepReport};
use lander_models::frames::tilt_rad;
use lander_models::scenario::Scenario;
use lander_models::signals::{self, Interface};
use lander_models::time::{TICK_S, Ticks};
use lander_models::vehicle::Vehicle;
use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::contact::{ContactWorld, Touch};
use crate::flight::{self, Drive, Motion};
use crate::gear::Leg;
use crate::stability::{Tipping, tip_state};
use crate::verdict::{FirstContact, Sight, Touchdown};
use crate::{engine, terrain};

/// The contact engine takes over when the lowest point may be this close, m, plus what two ticks
/// of its speed cover.
const TAKE_OVER_GAP_M: f64 = 0.02;
/// It hands back beyond this, m: apart from the former, so that the two don't alternate.
const HAND_BACK_GAP_M: f64 = 0.06;
/// A lander that starts on the ground touches down only after it was this high, m.
const AIRBORNE_GAP_M: f64 = 0.5;

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
    pub peak_stroke_m: f64,
    pub peak_load_n: f64,
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
            peak_stroke_m: 0.0,
            peak_load_n: 0.0,
            specific_force_b: Vector3::zeros(),
            dead_zone: Ticks::ZERO,
        };
        // A start in the air at all is a start in flight: only a vehicle on its feet lifts off.
        state.airborne = self.lowest_m(&state) > TAKE_OVER_GAP_M;
        state
    }

    /// Advances one tick of `TICK_S`.
    pub fn tick(&self, state: &mut State) -> Result<StepReport, ModelError> {
        let before = state.touchdown.outcome;
        let had_contact = state.touchdown.first.is_some();
        self.choose_engine(state);
        let touch = match state.contact.take() {
            Some(mut world) => {
                let pre = state.motion;
                let touch = self.contact_tick(&mut world, state);
                state.contact = Some(world);
                self.judge(state, &pre, &touch);
                touch
            }
            None => {
                state.motion = flight::advance(
                    &self.vehicle,
                    self.scenario.gravity_m_s2,
                    &state.motion,
                    &state.drive,
                    TICK_S,
                );
                Touch { feet: vec![false; state.legs.len()], structure: false }
            }
        };
        state.feet_down = touch.feet;
        state.now += Ticks(1);
        if state.now >= self.scenario.stop_time {
            state.touchdown.end();
        }
        if !state.motion.is_finite() {
            return Err(ModelError::Diverged { time_s: state.now.seconds(), what: "truth motion" });
        }
        Ok(StepReport {
            event: state.touchdown.outcome != before
                || state.touchdown.first.is_some() != had_contact,
            terminate: state.touchdown.decided(),
        })
    }

    /// Propulsion and mass go on while the contact engine owns the motion.
    fn contact_tick(&self, world: &mut ContactWorld, state: &mut State) -> Touch {
        let motion = &mut state.motion;
        let wrench = flight::propulsion(&self.vehicle, motion, &state.drive);
        let touch = world.step(&self.vehicle, motion, &mut state.legs, &wrench);
        let flow_kg_s = flight::propellant_flow_kg_s(&self.vehicle, motion, &state.drive);
        motion.propellant_kg = (motion.propellant_kg - flow_kg_s * TICK_S).max(0.0);
        (motion.thrust_n, motion.gimbal_rad) =
            flight::actuators_after(&self.vehicle, motion, &state.drive, TICK_S);
        for leg in &state.legs {
            state.peak_stroke_m = state.peak_stroke_m.max(leg.stroke_m);
            state.peak_load_n = state.peak_load_n.max(leg.load_n);
        }
        touch
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
        } else if lowest_m > HAND_BACK_GAP_M.max(2.0 * near_m) {
            state.contact = None;
        }
    }

    /// Pads' ground points from O at the struts' present length.
    pub fn feet_b<'a>(&'a self, state: &'a State) -> impl Iterator<Item = Vector3<f64>> + 'a {
        let legs = state.legs.iter();
        self.vehicle.gear.feet_b.iter().zip(legs).map(|(f, leg)| f + Vector3::z() * leg.stroke_m)
    }

    /// Clearance of each pad, m.
    pub fn foot_clearances_m<'a>(&'a self, state: &'a State) -> impl Iterator<Item = f64> + 'a {
        let radius_m = self.vehicle.gear.pad_radius_m;
        self.feet_b(state).map(move |foot_b| {
            let centre_w = state.motion.point_position_w(&(foot_b + Vector3::z() * radius_m));
            terrain::clearance_m(&self.scenario.terrain, &centre_w) - radius_m
        })
    }

    /// Clearance of the lowest pad or hull point, m.
    fn lowest_m(&self, state: &State) -> f64 {
        let hull = &self.vehicle.hull;
        let rims = [hull.bottom_height_m, hull.top_height_m].map(|height_m| {
            let centre_w = state.motion.point_position_w(&(Vector3::z() * height_m));
            terrain::clearance_m(&self.scenario.terrain, &centre_w) - hull.radius_m
        });
        self.foot_clearances_m(state).chain(rims).fold(f64::INFINITY, f64::min)
    }

    pub fn com_velocity_w(&self, motion: &Motion) -> Vector3<f64> {
        motion.point_velocity_w(&self.vehicle.mass.at(motion.propellant_kg).com_b)
    }

    fn judge(&self, state: &mut State, pre: &Motion, touch: &Touch) {
        let limits = &self.scenario.touchdown;
        let felt = touch.structure || touch.feet.contains(&true);
        let feet_w: Vec<_> =
            self.feet_b(state).map(|foot_b| state.motion.point_position_w(&foot_b)).collect();
        let footprint_w = feet_w.iter().sum::<Vector3<f64>>() / feet_w.len() as f64;
        if state.airborne && felt && state.touchdown.first.is_none() {
            let first = FirstContact {
                time: state.now,
                com_velocity_w: self.com_velocity_w(pre),
                tilt_rad: tilt_rad(&pre.attitude_wb),
                rate_rad_s: pre.rate_b.norm(),
                footprint_w,
            };
            state.touchdown.begin(limits, first);
        }
        let motion = &state.motion;
        let mass = self.vehicle.mass.at(motion.propellant_kg);
        let rotation = motion.attitude_wb.to_rotation_matrix();
        let tipping = Tipping {
            mass_kg: mass.mass_kg,
            com_w: motion.point_position_w(&mass.com_b),
            com_velocity_w: self.com_velocity_w(motion),
            rate_w: motion.attitude_wb * motion.rate_b,
            inertia_w: rotation * mass.inertia_b * rotation.inverse(),
            gravity_m_s2: self.scenario.gravity_m_s2,
        };
        let sight = Sight {
            now: state.now,
            tip: tip_state(&tipping, &feet_w),
            feet_down: touch.feet.iter().filter(|down| **down).count(),
            structure_down: touch.structure,
            speed_m_s: tipping.com_velocity_w.norm(),
            rate_rad_s: motion.rate_b.norm(),
            footprint_w,
        };
        state.touchdown.look(limits, &sight);
    }

    fn take_commands(&self, state: &mut State, inputs: &[f64], duration: Ticks) {
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
        if engine::in_dead_zone(engine, thrust_n) {
            state.dead_zone += duration;
        }
    }
}

impl Component for TruthModel {
    const INTERFACE: &'static Interface = &signals::TRUTH;
    type State = State;

    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        let (scenario, vehicle) = Scenario::load(&settings.scenario_file)?;
        let model = Self::new(scenario, vehicle);
        let state = model.initial_state();
        Ok((model, state))
    }

    fn step(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        self.take_commands(state, inputs, duration);
        let start_velocity_w = self.com_velocity_w(&state.motion);
        let mut report = StepReport::default();
        for _ in 0..duration.0 {
            let tick = self.tick(state)?;
            report.event |= tick.event;
            report.terminate = tick.terminate;
            if tick.terminate {
                // What is decided stays as it was seen; the rest of the step stands still.
                break;
            }
        }
        let gained_w = self.com_velocity_w(&state.motion) - start_velocity_w;
        let specific_force_w =
            gained_w / duration.seconds() + Vector3::z() * self.scenario.gravity_m_s2;
        state.specific_force_b = state.motion.attitude_wb.inverse() * specific_force_w;
        Ok(report)
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        self.write_outputs(state, outputs);
    }
}
