//! A plan: phases, exact nodes and the held thrust accelerations, as plain data.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::problem::Problem;
use super::propulsion::EngineState;
use super::residuals::LastStep;
use super::structure::{Grid, PhaseGrid, Structure};
use super::trajectory::{Node, Trajectory};

/// A burn or a coast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// Whether the engine runs.
    pub powered: bool,
    /// Start, s since the start of the plan.
    pub start_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Equal intervals it is divided into.
    pub intervals: usize,
}

impl Phase {
    /// End, s since the start of the plan.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }
}

/// How a plan was found and how well it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Outer iterations (conic solves) over all attempts of the call.
    pub outer_iterations: u32,
    /// Interior-point iterations over all attempts of the call.
    pub solver_iterations: u32,
    /// Whether the last plan was the starting point of the accepted attempt.
    pub warm: bool,
    /// Lossless lower bound: largest (σ − ‖u‖)/σ (G.10).
    pub lossless_gap: f64,
    /// Thrust-mass coupling and free final time: what the last step's linearisation missed.
    pub last_step: LastStep,
    /// Thrust-mass coupling: largest excursion of the thrust from its bounds after the exact
    /// roll-out, N; zero or less inside.
    pub thrust_violation_n: f64,
    /// Mass depletion: end mass less the mass without usable propellant, kg.
    pub propellant_left_kg: f64,
    /// Mass depletion: end mass of the plan against that of the re-propagation, kg.
    pub mass_error_kg: f64,
    /// Dead zone: largest excursion of a burn's thrust below the floor, N (G.40).
    pub dead_zone_n: f64,
    /// Target position miss of the independent re-propagation, m.
    pub miss_m: f64,
    /// Target velocity miss of the independent re-propagation, m/s.
    pub miss_m_s: f64,
    /// End velocity less target velocity, m/s: the impact where that is minimised.
    pub impact_m_s: f64,
    /// Largest change of the thrust vector between neighbouring intervals of a burn, N/s (G.42).
    pub thrust_rate_n_s: f64,
    /// Impulse the plan takes from the reserve limits, m/s; zero for a nominal plan.
    pub reserve_m_s: f64,
    /// Largest turn of the thrust beyond its limit, rad (G.97); zero within it.
    pub turn_excess_rad: f64,
}

/// A minimum-fuel trajectory. In a burn interval the thrust acceleration u = T/m is constant, so
/// the thrust falls with the mass and stays within its bounds over the whole interval (G.4, G.5).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Order of burns and coasts.
    pub structure: Structure,
    /// Burns and coasts in order of time.
    pub phases: Vec<Phase>,
    /// States at the ends of the intervals: one more than intervals.
    pub nodes: Vec<Node>,
    /// Thrust acceleration held in each interval, m/s²; zero in a coast.
    pub u_w: Vec<Vector3<f64>>,
    /// Gravity along −z the plan was made with, m/s².
    pub gravity_m_s2: f64,
    /// Mass flow per newton the plan was made with, s/m.
    pub mass_flow_s_m: f64,
    /// What the engine had done when the plan starts.
    pub engine: EngineState,
    /// How the plan was found and how well it holds.
    pub report: Report,
}

/// State and thrust of a plan at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Position, m.
    pub r_w: Vector3<f64>,
    /// Velocity, m/s.
    pub v_w: Vector3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Thrust, N; zero in a coast.
    pub thrust_w: Vector3<f64>,
    /// Its magnitude, N.
    pub thrust_n: f64,
    /// Whether the engine runs.
    pub powered: bool,
    /// Index into the phases of the plan.
    pub phase: usize,
}

impl Plan {
    /// Plan of a trajectory whose first phase begins now; the report is still empty.
    pub(super) fn new(problem: &Problem, grid: &Grid, trajectory: Trajectory) -> Self {
        let step_s = &trajectory.iterate.step_s;
        let mut start_s = 0.0;
        let phases = grid.phases.iter().zip(step_s).map(|(phase, step_s)| {
            let duration_s = step_s * phase.intervals as f64;
            let PhaseGrid { powered, intervals, .. } = *phase;
            let phase = Phase { powered, start_s, duration_s, intervals };
            start_s += duration_s;
            phase
        });
        Self {
            structure: grid.structure,
            phases: phases.collect(),
            u_w: (0..grid.len())
                .map(|j| trajectory.iterate.w_w[j] / step_s[grid.phase_of[j]])
                .collect(),
            nodes: trajectory.nodes,
            gravity_m_s2: problem.gravity_m_s2,
            mass_flow_s_m: problem.mass_flow_s_m(),
            engine: problem.engine,
            report: Report::default(),
        }
    }

    /// Length of the plan, s.
    pub fn duration_s(&self) -> f64 {
        self.nodes.last().map_or(0.0, |node| node.t_s)
    }

    /// Time left at `t_s`, s; negative after the end.
    pub fn time_to_go(&self, t_s: f64) -> f64 {
        self.duration_s() - t_s
    }

    /// Propellant the whole plan uses, kg.
    pub fn propellant_kg(&self) -> f64 {
        match (self.nodes.first(), self.nodes.last()) {
            (Some(first), Some(last)) => first.mass_kg - last.mass_kg,
            _ => 0.0,
        }
    }

    /// State and thrust at `t_s` since the start of the plan, held at the ends outside of it.
    pub fn sample(&self, t_s: f64) -> Sample {
        let t_s = t_s.clamp(0.0, self.duration_s());
        let j = self.interval(t_s);
        let gravity_w = Vector3::new(0.0, 0.0, -self.gravity_m_s2);
        let node = &self.nodes[j];
        let now = node.advance(t_s - node.t_s, &self.u_w[j], &gravity_w, self.mass_flow_s_m);
        let thrust_w = self.u_w[j] * now.mass_kg;
        let phase = self.phase(j);
        Sample {
            r_w: now.r_w,
            v_w: now.v_w,
            mass_kg: now.mass_kg,
            thrust_w,
            thrust_n: thrust_w.norm(),
            powered: self.phases[phase].powered,
            phase,
        }
    }

    /// Thrust direction at `t_s`, or at the start of the next burn in a coast; `None` when no burn
    /// is left.
    pub fn next_burn_direction(&self, t_s: f64) -> Option<Vector3<f64>> {
        let from = self.interval(t_s);
        self.u_w[from..].iter().find_map(|u_w| u_w.try_normalize(0.0))
    }

    /// Length of the last burn, s, where nothing but a coast lies before it from `t_s` on.
    pub fn last_burn_after(&self, t_s: f64) -> Option<f64> {
        let mut left = self.phases.iter().filter(|phase| phase.end_s() > t_s);
        match (left.next(), left.next(), left.next()) {
            (Some(coast), Some(burn), None) if !coast.powered && burn.powered => {
                Some(burn.duration_s)
            }
            _ => None,
        }
    }

    /// Time from `t_s` to the next ignition, s; zero in a burn, `None` when no burn is left.
    pub fn time_to_ignition_s(&self, t_s: f64) -> Option<f64> {
        let burns = self.phases.iter().filter(|phase| phase.powered && phase.end_s() > t_s);
        burns.map(|phase| (phase.start_s - t_s).max(0.0)).next()
    }

    /// Thrust direction averaged over `window_s` either side of `t_s`: the held accelerations
    /// jump from interval to interval, an attitude can't. `None` with no thrust in the window.
    pub fn smoothed_direction(&self, t_s: f64, window_s: f64) -> Option<Vector3<f64>> {
        self.impulse_w(t_s - window_s, t_s + window_s).try_normalize(1e-9)
    }

    /// What the engine has done at `t_s` since the start of the plan.
    pub fn engine_at(&self, t_s: f64) -> EngineState {
        let begun = self.phases.iter().filter(|phase| phase.start_s <= t_s);
        begun.fold(self.engine, |engine, phase| {
            engine.after(phase.powered, t_s.min(phase.end_s()) - phase.start_s)
        })
    }

    /// ∫ T/m dt between two times, m/s.
    pub(super) fn impulse_w(&self, from_s: f64, to_s: f64) -> Vector3<f64> {
        let overlap =
            |j: usize| (to_s.min(self.nodes[j + 1].t_s) - from_s.max(self.nodes[j].t_s)).max(0.0);
        self.u_w.iter().enumerate().map(|(j, u_w)| u_w * overlap(j)).sum()
    }

    /// Interval that holds `t_s`; a node belongs to the interval it starts.
    fn interval(&self, t_s: f64) -> usize {
        let started = self.nodes.partition_point(|node| node.t_s <= t_s);
        started.saturating_sub(1).min(self.u_w.len() - 1)
    }

    /// Phase of an interval.
    fn phase(&self, interval: usize) -> usize {
        let mut end = 0;
        let ends = self.phases.iter().map(|phase| {
            end += phase.intervals;
            end
        });
        ends.take_while(|&end| end <= interval).count()
    }
}
