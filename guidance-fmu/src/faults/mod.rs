//! Failures as guidance sees them: what it commands against what it measures, and nothing of the
//! truth. Each watch declares one failure by its own test (G.80 to G.86); the laws ask what is
//! declared and what is left.

mod engine;
mod gimbal;
mod propellant;
mod sensors;
#[cfg(test)]
mod tests;
mod thrusters;

use lander_models::Ticks;
use lander_models::scenario::{Guidance as Task, PerSensor};
use lander_models::signals::FAULT_SLOTS;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::disturbance::EngineEstimate;
use crate::navigation::Navigation;
use crate::scvx::Terminal;

pub use engine::EngineWatch;
pub use gimbal::GimbalWatch;
pub use propellant::PropellantWatch;
pub use sensors::SensorWatch;
pub use thrusters::{StuckPair, ThrusterWatch};

/// What the last step showed, and what had been asked of it.
pub struct Evidence<'a> {
    pub vehicle: &'a Vehicle,
    pub nav: &'a Navigation,
    /// Asked of the thrusters through the step.
    pub rcs_torque_b: Vector3<f64>,
    /// Of sensors, that arrived so far.
    pub samples: PerSensor<f64>,
    /// Navigation is perfect: force is the centre of mass's, mass is measured.
    pub perfect: bool,
    pub duration: Ticks,
}

impl Evidence<'_> {
    /// Force on the centre of mass, N; `None` while it is not measured.
    fn force_b(&self, turn_b: &Vector3<f64>) -> Option<Vector3<f64>> {
        let imu = self.vehicle.sensors.as_ref().filter(|_| !self.perfect).map(|s| &s.imu);
        let mass = &self.nav.mass;
        // An IMU off the centre of mass feels the turn, too.
        let lever_b = imu.map_or(Vector3::zeros(), |imu| turn_b.cross(&(imu.mount_b - mass.com_b)));
        self.nav.specific_force_b.map(|force_b| (force_b - lever_b) * mass.mass_kg)
    }
}

/// Torque and turn of the last step, as the body felt them.
#[derive(Clone, Copy, Debug)]
pub struct Felt {
    /// About the centre of mass, without what was asked of the thrusters (G.80).
    torque_b: Vector3<f64>,
    /// Angular acceleration.
    turn_b: Vector3<f64>,
}

impl Felt {
    fn new(evidence: &Evidence, before_b: &Vector3<f64>) -> Self {
        let Evidence { nav, rcs_torque_b, duration, .. } = evidence;
        let turn_b = (nav.rate_b - before_b) / duration.seconds();
        let middle_b = (before_b + nav.rate_b) * 0.5;
        let inertia_b = &nav.mass.inertia_b;
        let torque_b = inertia_b * turn_b + middle_b.cross(&(inertia_b * middle_b)) - rcs_torque_b;
        Self { torque_b, turn_b }
    }
}

/// What two measures of one quantity agree on: slosh spoils those by force, a gimbal that doesn't
/// follow those by command, a stuck thruster those by torque.
fn lesser(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
}

/// What has been declared, and the memory of the tests.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Faults {
    pub engine: EngineWatch,
    pub gimbal: GimbalWatch,
    pub thrusters: ThrusterWatch,
    pub propellant: PropellantWatch,
    pub sensors: SensorWatch,
    /// Guidance has started anew in flight, without memory.
    pub restarted: bool,
    /// Body rates at the end of the step before; none until the first.
    rate_b: Option<Vector3<f64>>,
}

impl Faults {
    /// Of a guidance that starts anew in flight.
    pub fn after_restart() -> Self {
        Self { restarted: true, ..Self::default() }
    }

    /// Looks at the last step, and tells the engine's estimate what was declared.
    pub fn observe(&mut self, evidence: &Evidence, engine: &mut EngineEstimate) {
        self.sensors.observe(evidence);
        self.propellant.observe(evidence);
        self.engine.observe(evidence, engine);
        let Some(before_b) = self.rate_b.replace(evidence.nav.rate_b) else { return };
        let felt = Felt::new(evidence, &before_b);
        self.gimbal.observe(evidence, &felt, engine);
        let doubtful = self.engine.out() || self.gimbal.doubtful();
        self.thrusters.observe(evidence, &felt, engine, doubtful);
    }

    /// In the order of the signal `fault_declared`.
    pub fn declared(&self) -> [bool; FAULT_SLOTS] {
        [
            self.engine.out(),
            self.engine.weak(),
            self.gimbal.seized().is_some(),
            self.thrusters.stuck.is_some(),
            self.propellant.leaking(),
            self.sensors.any_silent(),
            self.restarted,
        ]
    }

    /// Whether what plans rest on differs from `before`, so that the last one can't be flown.
    pub fn outdates(&self, before: &Self) -> bool {
        let basis =
            |faults: &Self| (faults.engine.out(), faults.engine.weak(), faults.gimbal.proven());
        basis(self) != basis(before)
    }

    /// What plans may count on.
    pub fn capability(
        &self,
        task: &Task,
        vehicle: &Vehicle,
        engine: &EngineEstimate,
    ) -> Capability {
        let nominal = Capability::nominal(task, vehicle);
        let loss_kg_s = if self.propellant.leaking() { self.propellant.loss_kg_s() } else { 0.0 };
        if !self.engine.weak() && !self.gimbal.proven() {
            return Capability { loss_kg_s, ..nominal };
        }
        // (G.87)
        let floor_n = task.plan_thrust_min_n * engine.scale.min(1.0);
        let ceiling_n = engine.ceiling_n(&vehicle.engine).max(floor_n);
        let planned_n = (PLANNED_SHARE * ceiling_n).max(floor_n);
        Capability {
            plan_thrust_min_n: floor_n,
            plan_thrust_max_n: planned_n.min(task.plan_thrust_max_n),
            thrust_max_n: ceiling_n,
            loss_kg_s,
            degraded: true,
        }
    }
}

/// Share of what is left of the engine that plans use once something has failed: the rest is
/// tracking's.
const PLANNED_SHARE: f64 = 0.8;

/// What plans may count on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    pub plan_thrust_min_n: f64,
    pub plan_thrust_max_n: f64,
    /// That can be delivered at all, N.
    pub thrust_max_n: f64,
    /// Propellant lost without thrust, kg/s.
    pub loss_kg_s: f64,
    /// Less than the vehicle's own.
    pub degraded: bool,
}

impl Capability {
    pub fn nominal(task: &Task, vehicle: &Vehicle) -> Self {
        Self {
            plan_thrust_min_n: task.plan_thrust_min_n,
            plan_thrust_max_n: task.plan_thrust_max_n,
            thrust_max_n: vehicle.engine.thrust_max_n,
            loss_kg_s: 0.0,
            degraded: false,
        }
    }

    /// Ceiling of a plan, N: all that is left where nothing can be kept for later.
    pub fn ceiling_n(&self, terminal: Terminal) -> f64 {
        match terminal {
            Terminal::Anywhere if self.loss_kg_s > 0.0 => PLANNED_SHARE * self.thrust_max_n,
            Terminal::SoftestImpact if self.degraded => self.thrust_max_n,
            _ => self.plan_thrust_max_n,
        }
    }

    /// Deceleration of the terminal law: the task's, or what is left, with a share for control.
    pub fn terminal_deceleration_m_s2(&self, task: &Task, mass_kg: f64, gravity_m_s2: f64) -> f64 {
        let net_m_s2 = self.thrust_max_n / mass_kg - gravity_m_s2;
        task.terminal_deceleration_m_s2.min((TERMINAL_SHARE * net_m_s2).max(LEAST_M_S2))
    }
}

/// Of the net deceleration left, that the terminal descent is planned with.
const TERMINAL_SHARE: f64 = 0.6;
/// A planned deceleration is never nought: its gate would have no speed.
const LEAST_M_S2: f64 = 0.1;
