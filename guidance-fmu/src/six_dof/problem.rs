//! The landing problem in six degrees of freedom and the planner's settings.

use lander_models::mass::MassModel;
use lander_models::vehicle::{G0_M_S2, Vehicle};
use nalgebra::{UnitQuaternion, Vector3};

use super::dynamics::Dynamics;
use super::error::SixDofError;
use crate::scvx::{EngineState, PathLimits, Problem, Propulsion, Terminal};

/// A minimum-fuel powered descent of a rigid body (G.70-G.74) in a site-fixed frame with z up.
#[derive(Clone, Debug)]
pub struct SixDofProblem {
    /// Mass, centre of mass and inertia against the propellant left.
    pub mass: MassModel,
    /// Where and how the flight starts.
    pub start: Start,
    /// Target position of the centre of mass, m.
    pub r_f_w: Vector3<f64>,
    /// Target velocity of the centre of mass, m/s.
    pub v_f_w: Vector3<f64>,
    /// Gravity along −z, m/s².
    pub gravity_m_s2: f64,
    /// Engine and thrusters.
    pub actuators: Actuators,
    /// Limits on the body.
    pub limits: Limits,
}

/// State at the start; positions and velocities are those of the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Propellant on board, kg.
    pub propellant_kg: f64,
    /// Position, m.
    pub r_w: Vector3<f64>,
    /// Velocity, m/s.
    pub v_w: Vector3<f64>,
    /// Attitude, body to world; `None` leaves it to the plan, within the tilt limit.
    pub attitude_wb: Option<UnitQuaternion<f64>>,
    /// Body rates, rad/s.
    pub rate_b: Vector3<f64>,
}

/// What the engine and the thrusters can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuators {
    /// Gimbal pivot from O, m.
    pub pivot_b: Vector3<f64>,
    /// Specific impulse, s.
    pub isp_s: f64,
    /// Thrust floor of a running engine, N.
    pub thrust_min_n: f64,
    /// Thrust ceiling, N.
    pub thrust_max_n: f64,
    /// Largest rate of the thrust within a burn, N/s.
    pub thrust_rate_max_n_s: f64,
    /// Largest gimbal angle, rad.
    pub gimbal_max_rad: f64,
    /// Largest gimbal rate, rad/s.
    pub gimbal_rate_max_rad_s: f64,
    /// Largest thruster torque about each body axis, N m; 0 leaves the axis to the engine.
    pub torque_max_b: Vector3<f64>,
}

/// What the body must keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest angle of body z from the vertical, rad.
    pub tilt_max_rad: f64,
    /// Largest body rate, rad/s.
    pub rate_max_rad_s: f64,
    /// Glide-slope cone above the target, half-angle from the vertical, rad.
    pub glide_slope_rad: Option<f64>,
    /// Largest tilt at the end, rad.
    pub end_tilt_max_rad: f64,
    /// Largest body rate at the end, rad/s.
    pub end_rate_max_rad_s: f64,
}

impl Actuators {
    /// Time from thrust floor to ceiling, s: assumed, ten times the engines' lag.
    pub const FULL_RANGE_S: f64 = 1.0;

    /// Of a vehicle. No vehicle file states a thrust rate: the full range takes
    /// [`FULL_RANGE_S`](Self::FULL_RANGE_S).
    pub fn of(vehicle: &Vehicle) -> Self {
        let engine = &vehicle.engine;
        Self {
            pivot_b: engine.pivot_b,
            isp_s: engine.isp_s,
            thrust_min_n: engine.thrust_min_n,
            thrust_max_n: engine.thrust_max_n,
            thrust_rate_max_n_s: (engine.thrust_max_n - engine.thrust_min_n) / Self::FULL_RANGE_S,
            gimbal_max_rad: engine.gimbal_limit_rad,
            gimbal_rate_max_rad_s: engine.gimbal_rate_rad_s,
            torque_max_b: vehicle.rcs.torque_max_b,
        }
    }
}

impl SixDofProblem {
    /// Mass at the start, kg.
    pub fn mass_kg(&self) -> f64 {
        self.mass.dry.mass_kg + self.start.propellant_kg
    }

    /// The centre of mass alone after `turn_s` of free fall, its thrust tilted no more than the body
    /// may be.
    pub fn translation(&self, turn_s: f64) -> Problem {
        let gained_w = Vector3::new(0.0, 0.0, -self.gravity_m_s2 * turn_s);
        Problem {
            r0_w: self.start.r_w + (self.start.v_w + gained_w * 0.5) * turn_s,
            v0_w: self.start.v_w + gained_w,
            r_f_w: self.r_f_w,
            v_f_w: self.v_f_w,
            terminal: Terminal::Point,
            mass_kg: self.mass_kg(),
            dry_mass_kg: self.mass.dry.mass_kg,
            gravity_m_s2: self.gravity_m_s2,
            isp_s: self.actuators.isp_s,
            thrust_min_n: self.actuators.thrust_min_n,
            thrust_max_n: self.actuators.thrust_max_n,
            thrust_rate_max_n_s: None,
            turn: None,
            propulsion: Propulsion::default(),
            engine: EngineState::default(),
            tilt_max_rad: self.limits.tilt_max_rad,
            final_tilt: None,
            reserve: None,
            path: PathLimits { glide_slope_rad: self.limits.glide_slope_rad, altitude_min_m: None },
        }
    }

    pub(super) fn dynamics(&self) -> Dynamics<'_> {
        Dynamics {
            mass: &self.mass,
            pivot_b: self.actuators.pivot_b,
            gravity_m_s2: self.gravity_m_s2,
            mass_flow_s_m: 1.0 / (self.actuators.isp_s * G0_M_S2),
        }
    }

    /// Names the first input of the six-degree-of-freedom part that is not finite or not physical;
    /// the translation's inputs are named by its own planner.
    pub fn validate(&self) -> Result<(), SixDofError> {
        const ANGLE: &str = "(0, π/2) rad";
        let right_angle = std::f64::consts::FRAC_PI_2;
        let (a, l) = (&self.actuators, &self.limits);
        let capacity_kg = self.mass.propellant.capacity_kg;
        within("propellant_kg", self.start.propellant_kg, 0.0, capacity_kg, "[0, capacity] kg")?;
        for &rate in &self.start.rate_b {
            within("rate_b", rate, -10.0, 10.0, "±10 rad/s")?;
        }
        for &torque in &a.torque_max_b {
            within("torque_max_b", torque, 0.0, 1e7, "[0, 1e7] N m")?;
        }
        for &lever in &a.pivot_b {
            within("pivot_b", lever, -100.0, 100.0, "±100 m")?;
        }
        within("thrust_min_n", a.thrust_min_n, 1e-3, a.thrust_max_n, "(0, thrust_max_n] N")?;
        within("thrust_rate_max_n_s", a.thrust_rate_max_n_s, 1e-3, 1e9, "[1e-3, 1e9] N/s")?;
        within("gimbal_max_rad", a.gimbal_max_rad, 1e-4, 0.8, "[1e-4, 0.8] rad")?;
        within("gimbal_rate_max_rad_s", a.gimbal_rate_max_rad_s, 1e-4, 1e3, "[1e-4, 1e3] rad/s")?;
        within("tilt_max_rad", l.tilt_max_rad, 1e-3, right_angle, ANGLE)?;
        within("rate_max_rad_s", l.rate_max_rad_s, 1e-4, 10.0, "[1e-4, 10] rad/s")?;
        within("end_tilt_max_rad", l.end_tilt_max_rad, 1e-4, l.tilt_max_rad, "(0, tilt_max_rad]")?;
        let end_rate = l.end_rate_max_rad_s;
        within("end_rate_max_rad_s", end_rate, 1e-5, l.rate_max_rad_s, "(0, rate_max_rad_s]")
    }
}

/// Fails, naming `field`, unless low ≤ value ≤ high; a NaN is outside.
fn within(
    field: &'static str,
    value: f64,
    low: f64,
    high: f64,
    allowed: &'static str,
) -> Result<(), SixDofError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(SixDofError::Input { field, value, allowed })
    }
}

/// Discretisation and budgets of the planner.
#[derive(Clone, Debug, PartialEq)]
pub struct SixDofSettings {
    /// Whether and how often the engine may be switched: the translation's plan then sets the order
    /// of burns and coasts.
    pub propulsion: Propulsion,
    /// Intervals of a burn that a coast follows.
    pub first_burn_intervals: usize,
    /// Intervals of a coast.
    pub coast_intervals: usize,
    /// Intervals of the burn that ends the flight.
    pub last_burn_intervals: usize,
    /// Free fall ahead of the first burn, to turn in, where the attitude at the start is given, s; the
    /// plan finds its own duration from here. 0 lights the engine at once.
    pub turn_s: f64,
    /// Shortest phase, s.
    pub phase_min_s: f64,
    /// Conic solves of one call.
    pub solves_max: u32,
    /// Interior-point iterations of one conic solve.
    pub solver_iterations_max: u32,
}

impl Default for SixDofSettings {
    /// Fifteen intervals for two burns with a coast between them.
    fn default() -> Self {
        Self {
            propulsion: Propulsion::default(),
            first_burn_intervals: 3,
            coast_intervals: 3,
            last_burn_intervals: 9,
            turn_s: 2.5,
            phase_min_s: 0.2,
            solves_max: 40,
            solver_iterations_max: 60,
        }
    }
}

impl SixDofSettings {
    /// Names the first setting outside its range.
    pub fn validate(&self) -> Result<(), SixDofError> {
        for (field, intervals) in [
            ("first_burn_intervals", self.first_burn_intervals),
            ("coast_intervals", self.coast_intervals),
            ("last_burn_intervals", self.last_burn_intervals),
        ] {
            within(field, intervals as f64, 2.0, 100.0, "[2, 100]")?;
        }
        within("turn_s", self.turn_s, 0.0, 100.0, "[0, 100] s")?;
        within("phase_min_s", self.phase_min_s, 0.01, 100.0, "[0.01, 100] s")
    }
}
