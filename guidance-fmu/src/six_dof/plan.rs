//! A plan in six degrees of freedom, as plain data.

use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::dynamics::{Control, Q, R, State, THRUST, TORQUE, V, W};
use super::excess::Excess;
use super::trajectory::{Grid, Iterate};
use crate::scvx::Phase;

/// State at a node of a plan; positions and velocities are those of the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SixDofNode {
    /// Time since the start of the plan, s.
    pub t_s: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Position, m.
    pub r_w: Vector3<f64>,
    /// Velocity, m/s.
    pub v_w: Vector3<f64>,
    /// Attitude, body to world.
    pub attitude_wb: UnitQuaternion<f64>,
    /// Body rates, rad/s.
    pub rate_b: Vector3<f64>,
}

/// Engine and thruster torque; no thrust in a coast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SixDofControl {
    /// Thrust, N.
    pub thrust_n: f64,
    /// Lateral over axial thrust along body x and y: the tangents of the gimbal angle.
    pub gimbal_tan: Vector2<f64>,
    /// Torque by thrusters, N m.
    pub torque_b: Vector3<f64>,
}

/// How a plan was found and how well it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SixDofReport {
    /// Conic solves of the outer loop.
    pub outer_iterations: u32,
    /// Of these, solved without being accepted.
    pub refused_steps: u32,
    /// Interior-point iterations over all conic solves.
    pub solver_iterations: u32,
    /// Times that the limits at the nodes were drawn in to hold between them.
    pub tightenings: u32,
    /// Conic solves of the translation's plan that the loop started from.
    pub translation_iterations: u32,
    /// Propellant of that plan, kg.
    pub translation_propellant_kg: f64,
    /// Virtual control left in the last conic solution, scaled sum.
    pub virtual_control: f64,
    /// Largest shooting defect of an interval: position, m.
    pub defect_m: f64,
    /// Velocity, m/s.
    pub defect_m_s: f64,
    /// Miss of the independent re-propagation against the target: position, m.
    pub miss_m: f64,
    /// Velocity, m/s.
    pub miss_m_s: f64,
    /// Against the planned end: attitude, rad.
    pub miss_rad: f64,
    /// Body rates, rad/s.
    pub miss_rad_s: f64,
    /// Tilt of body z at the end as re-propagated, rad.
    pub end_tilt_rad: f64,
    /// Body rate at the end as re-propagated, rad/s.
    pub end_rate_rad_s: f64,
    /// Over the nodes as planned.
    pub at_nodes: Excess,
    /// Over the whole flight as re-propagated.
    pub between_nodes: Excess,
}

/// A trajectory that keeps (G.70)-(G.74). Controls are linear in time within each interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SixDofPlan {
    /// Burns and coasts in order of time.
    pub phases: Vec<Phase>,
    /// States at the ends of the intervals: one more than intervals.
    pub nodes: Vec<SixDofNode>,
    /// Controls at the ends of the intervals, phase by phase: they may jump between phases.
    pub controls: Vec<Vec<SixDofControl>>,
    /// How the plan was found and how well it holds.
    pub report: SixDofReport,
}

impl SixDofPlan {
    /// The plan of an iterate; the report is still empty.
    pub(super) fn new(grid: &Grid, iterate: &Iterate) -> Self {
        let (mut phases, mut controls) = (Vec::new(), Vec::new());
        let mut nodes = vec![SixDofNode::new(0.0, &iterate.states[0])];
        let (mut start_s, mut first) = (0.0, 0);
        for (phase, &step_s) in grid.phases.iter().zip(&iterate.step_s) {
            let intervals = phase.intervals;
            let duration_s = step_s * intervals as f64;
            phases.push(Phase { powered: phase.powered, start_s, duration_s, intervals });
            for n in 1..=intervals {
                let state = &iterate.states[nodes.len()];
                nodes.push(SixDofNode::new(start_s + step_s * n as f64, state));
            }
            let ends = &iterate.controls[first..=first + intervals];
            let control = |u: &Control| {
                let torque_b = u.fixed_rows::<3>(TORQUE).into();
                // A coast's thrust is zero to the solver's tolerance; the engine is off.
                if !phase.powered {
                    return SixDofControl { torque_b, ..SixDofControl::default() };
                }
                let gimbal_tan = u.fixed_rows::<2>(0).into();
                SixDofControl { thrust_n: u[THRUST], gimbal_tan, torque_b }
            };
            controls.push(ends.iter().map(control).collect());
            start_s += duration_s;
            first += intervals + 1;
        }
        Self { phases, nodes, controls, report: SixDofReport::default() }
    }

    /// Length of the plan, s.
    pub fn duration_s(&self) -> f64 {
        self.nodes.last().map_or(0.0, |node| node.t_s)
    }

    /// Propellant the engine uses, kg; that of the thrusters is not counted.
    pub fn propellant_kg(&self) -> f64 {
        match (self.nodes.first(), self.nodes.last()) {
            (Some(first), Some(last)) => first.mass_kg - last.mass_kg,
            _ => 0.0,
        }
    }

    /// Control at `t_s` since the start, held at the ends outside of the plan; at a switch, that of
    /// the phase that begins.
    pub fn control(&self, t_s: f64) -> SixDofControl {
        let started = self.phases.partition_point(|phase| phase.start_s <= t_s);
        self.control_in(started.saturating_sub(1), t_s)
    }

    /// Control of one phase at `t_s`, held at the phase's ends outside of it.
    pub(super) fn control_in(&self, phase: usize, t_s: f64) -> SixDofControl {
        let (phase, controls) = (&self.phases[phase], &self.controls[phase]);
        let at = (t_s - phase.start_s) / phase.duration_s * phase.intervals as f64;
        let at = at.clamp(0.0, phase.intervals as f64);
        let k = (at as usize).min(phase.intervals - 1);
        let (share, start, end) = (at - k as f64, &controls[k], &controls[k + 1]);
        SixDofControl {
            thrust_n: start.thrust_n + (end.thrust_n - start.thrust_n) * share,
            gimbal_tan: start.gimbal_tan.lerp(&end.gimbal_tan, share),
            torque_b: start.torque_b.lerp(&end.torque_b, share),
        }
    }
}

impl SixDofControl {
    /// Thrust on the gimbal pivot in body axes, N.
    pub fn thrust_b(&self) -> Vector3<f64> {
        self.gimbal_tan.push(1.0).normalize() * self.thrust_n
    }
}

impl SixDofNode {
    pub(super) fn new(t_s: f64, x: &State) -> Self {
        let q = Quaternion::new(x[Q], x[Q + 1], x[Q + 2], x[Q + 3]);
        Self {
            t_s,
            mass_kg: x[0],
            r_w: x.fixed_rows::<3>(R).into(),
            v_w: x.fixed_rows::<3>(V).into(),
            attitude_wb: UnitQuaternion::from_quaternion(q),
            rate_b: x.fixed_rows::<3>(W).into(),
        }
    }

    /// Angle of body z from the vertical, rad.
    pub fn tilt_rad(&self) -> f64 {
        // From the sine of the half angle: the cosine is blind near upright.
        2.0 * libm::asin(self.attitude_wb.imag().xy().norm().min(1.0))
    }
}
