//! The component: inputs to commands, once per communication step.

use lander_models::component::{Component, ModelError, Settings, StepReport};
use lander_models::frames::attitude_to_wxyz;
use lander_models::scenario::{self, Guidance as Task, GuidanceMode, Scenario};
use lander_models::signals::{self, Interface};
use lander_models::time::Ticks;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::attitude::{self, Torquers};
use crate::disturbance::EngineEstimate;
use crate::faults::{Evidence, Faults};
use crate::guard;
use crate::mission::{Context, Mission, Orders, Phase};
use crate::navigation::{Actuation, Estimator, Inputs, Navigation, Navigator, Solution};

/// Constant configuration: nominal values only. The truth's initial state, terrain and faults
/// are not kept.
#[derive(Clone, Debug)]
pub struct Guidance {
    vehicle: Vehicle,
    task: Task,
    gravity_m_s2: f64,
    /// None: navigation is perfect.
    navigator: Option<Navigator>,
}

/// All that a bit-exact restart needs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct State {
    pub now: Ticks,
    pub mission: Mission,
    engine: EngineEstimate,
    faults: Faults,
    commands: Commands,
    /// Present where the guidance has a navigator.
    estimator: Option<Estimator>,
    /// What was taken for true in the last step, for the log.
    solution: Solution,
    /// Planned position and velocity of O, for the log.
    plan_position_w: Vector3<f64>,
    plan_velocity_w: Vector3<f64>,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Commands {
    thrust_n: f64,
    gimbal_rad: [f64; 2],
    rcs_torque_b: [f64; 3],
    up_w: [f64; 3],
}

impl Guidance {
    pub fn new(scenario: &Scenario, vehicle: Vehicle) -> Self {
        let navigator = match scenario.sensing.navigation {
            scenario::Navigation::Sensors => Navigator::new(scenario, &vehicle),
            scenario::Navigation::Perfect => None,
        };
        let (task, gravity_m_s2) = (scenario.guidance.clone(), scenario.gravity_m_s2);
        Self { vehicle, task, gravity_m_s2, navigator }
    }

    /// State at t = 0.
    pub fn initial_state(&self) -> State {
        State { estimator: self.navigator.as_ref().map(Navigator::start), ..State::default() }
    }

    /// What a restart finds in memory that outlives it: the time and the filter's state.
    fn restarted(&self, state: &State) -> State {
        let faults = Faults::after_restart();
        State { now: state.now, estimator: state.estimator.clone(), faults, ..State::default() }
    }

    /// What to take for true now.
    fn navigate(&self, state: &mut State, inputs: &Inputs) -> Result<Solution, ModelError> {
        let (Some(navigator), Some(estimator)) = (&self.navigator, &mut state.estimator) else {
            let mut solution = Solution::perfect(inputs)?;
            if state.faults.sensors.altimeter_silent() {
                // Over the target's level: all that is known of the ground.
                solution.height_m = solution.position_w.z - self.task.target_w.z;
            }
            return Ok(solution);
        };
        let Commands { gimbal_rad, rcs_torque_b, .. } = state.commands;
        let knows = self.task.fault_response;
        let actuation = Actuation {
            thrust_n: state.engine.thrust_n(),
            gimbal_rad: if knows { state.engine.line_rad().into() } else { gimbal_rad },
            rcs_torque_b: rcs_torque_b.into(),
        };
        navigator.step(estimator, state.now, inputs, &actuation)?;
        let solution = navigator.solution(estimator, state.now);
        // At the IMU's mounting: what the turn adds there is little, and averaged.
        let specific_force_b = inputs.imu.specific_force_b - solution.accelerometer_bias_b;
        let specific_force_b = inputs.valid.imu.then_some(specific_force_b);
        Ok(Solution { specific_force_b, ..solution })
    }

    /// Looks for failures in the last step. Whether what plans rest on has changed.
    fn look(&self, state: &mut State, nav: &Navigation, inputs: &Inputs, duration: Ticks) -> bool {
        let flies = self.task.mode != GuidanceMode::Off && state.mission.phase != Phase::CutOff;
        if !self.task.fault_response || !flies {
            return false;
        }
        let before = state.faults.clone();
        let evidence = Evidence {
            vehicle: &self.vehicle,
            nav,
            rcs_torque_b: state.commands.rcs_torque_b.into(),
            samples: inputs.samples,
            perfect: self.navigator.is_none(),
            duration,
        };
        state.faults.observe(&evidence, &mut state.engine);
        state.faults.outdates(&before)
    }

    fn orders(&self, state: &mut State, nav: &Navigation, outdated: bool) -> Orders {
        let context = Context {
            vehicle: &self.vehicle,
            task: &self.task,
            gravity_m_s2: self.gravity_m_s2,
            now: state.now,
            nav,
            engine: &state.engine,
            faults: &state.faults,
            outdated,
        };
        state.mission.step(&context)
    }

    fn fly(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        guard::check(inputs)?;
        if inputs.iter().all(|value| *value == 0.0) {
            // Nobody has spoken on the bus yet: some masters exchange after the first step only.
            state.commands = Commands::default();
            state.now += duration;
            return Ok(StepReport::default());
        }
        let inputs = Inputs::read(inputs);
        if !inputs.computer_up {
            let now = state.now + duration;
            *state = State { now, ..self.restarted(state) };
            return Ok(StepReport::default());
        }
        state.solution = self.navigate(state, &inputs)?;
        let nav = Navigation::new(&self.vehicle, &state.solution, inputs.any_foot_down);
        let phase = state.mission.phase;
        if let (true, Some(specific_force_b)) = (self.task.compensation, nav.specific_force_b) {
            state.engine.learn(&specific_force_b, nav.mass.mass_kg, duration);
        }
        let outdated = self.look(state, &nav, &inputs, duration);
        let orders = self.orders(state, &nav, outdated);
        let torquers = if orders.hold_attitude && self.task.mode != GuidanceMode::Off {
            let (engine, faults) = (&state.engine, &state.faults);
            attitude::control(&self.vehicle, &nav, engine, faults, &orders.up_w, &orders.up_rate_w)
        } else {
            Torquers::default()
        };
        state.commands = Commands {
            thrust_n: orders.thrust_n,
            gimbal_rad: torquers.gimbal_rad.into(),
            rcs_torque_b: torquers.rcs_torque_b.into(),
            up_w: orders.up_w.into(),
        };
        self.note_plan(state, &nav);
        let Commands { thrust_n, gimbal_rad, .. } = state.commands;
        state.engine.expect(&self.vehicle.engine, thrust_n, &gimbal_rad.into(), duration);
        if let (Some(navigator), Some(estimator)) = (&self.navigator, &mut state.estimator) {
            let torque_n_m: f64 = state.commands.rcs_torque_b.iter().map(|t| t.abs()).sum();
            let impulse_n_s = state.engine.nominal_impulse_n_s(duration);
            navigator.spend(estimator, impulse_n_s, torque_n_m * duration.seconds());
        }
        state.now += duration;
        Ok(StepReport { event: state.mission.phase != phase, terminate: false })
    }

    fn note_plan(&self, state: &mut State, nav: &Navigation) {
        let Some(flown) = &state.mission.planning.flown else { return };
        let sample = flown.plan.sample(flown.elapsed_s(state.now));
        state.plan_position_w = sample.r_w - nav.attitude_wb * nav.mass.com_b;
        state.plan_velocity_w = sample.v_w;
    }
}

impl Component for Guidance {
    const INTERFACE: &'static Interface = &signals::GUIDANCE;
    type State = State;

    fn create(settings: &Settings) -> Result<(Self, State), ModelError> {
        Self::create_changed(settings, "")
    }

    fn create_changed(settings: &Settings, changes: &str) -> Result<(Self, State), ModelError> {
        let (scenario, vehicle) = Scenario::load_changed(&settings.scenario_file, changes)?;
        let guidance = Self::new(&scenario, vehicle);
        let state = guidance.initial_state();
        Ok((guidance, state))
    }

    /// Inputs that are refused leave the safe command: engine and thrusters off, gimbal centred.
    /// Thrust in a direction that nobody knows is worse than none.
    fn step(
        &self,
        state: &mut State,
        inputs: &[f64],
        duration: Ticks,
    ) -> Result<StepReport, ModelError> {
        let stepped = self.fly(state, inputs, duration);
        if stepped.is_err() {
            state.commands = Commands::default();
        }
        stepped
    }

    fn outputs(&self, state: &State, outputs: &mut [f64]) {
        let planning = &state.mission.planning;
        let commands = &state.commands;
        let (to_go_s, propellant_kg) = planning.flown.as_ref().map_or((0.0, 0.0), |flown| {
            let left = flown.plan.sample(flown.elapsed_s(state.now)).mass_kg;
            let end = flown.plan.nodes.last().map_or(left, |node| node.mass_kg);
            (flown.time_to_go_s(state.now).max(0.0), left - end)
        });
        let mut at = 0;
        let mut put = |values: &[f64]| {
            outputs[at..at + values.len()].copy_from_slice(values);
            at += values.len();
        };
        // Order of the signal table.
        put(&[commands.thrust_n]);
        put(&commands.gimbal_rad);
        put(&commands.rcs_torque_b);
        put(&[f64::from(state.mission.phase as u8)]);
        put(state.plan_position_w.as_slice());
        put(state.plan_velocity_w.as_slice());
        put(&commands.up_w);
        put(&[to_go_s, propellant_kg]);
        put(&[f64::from(planning.accepted), f64::from(planning.failed)]);
        put(&[f64::from(state.mission.goal(&state.faults) as u8)]);
        put(&state.faults.declared().map(|declared| if declared { 1.0 } else { 0.0 }));
        let Solution { sigma, .. } = &state.solution;
        put(state.solution.position_w.as_slice());
        put(state.solution.velocity_w.as_slice());
        put(&attitude_to_wxyz(&state.solution.attitude_wb));
        put(state.solution.rate_b.as_slice());
        put(&[state.solution.height_m, state.solution.mass_kg]);
        put(state.solution.gyro_bias_b.as_slice());
        put(state.solution.accelerometer_bias_b.as_slice());
        put(sigma.position_w.as_slice());
        put(sigma.velocity_w.as_slice());
        put(sigma.attitude_b.as_slice());
        put(sigma.gyro_bias_b.as_slice());
        put(sigma.accelerometer_bias_b.as_slice());
        put(&[sigma.height_m]);
        put(&state.solution.rejected.to_array());
    }
}
