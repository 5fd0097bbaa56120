//! Iterates of the outer loop on their grid, and the shooting defects between their nodes.

use nalgebra::SVector;

use super::dynamics::{Control, Q, R, State, THRUST, TORQUE, V, W};
use super::problem::{SixDofProblem, SixDofSettings};
use super::shooting::{Sensitivity, shoot};

/// Longest Runge-Kutta step of the shooting, s, in a burn and in a coast: its error stays below
/// 0.1 mm over a flight, a hundredth of the accepted miss.
const STEP_MAX_S: [f64; 2] = [0.1, 0.25];

/// A burn or a coast of equal intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PhaseGrid {
    pub powered: bool,
    pub intervals: usize,
}

/// Phases in order of time. Controls jump between phases, so each phase has its own at both ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    pub phases: Vec<PhaseGrid>,
}

/// An interval of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub phase: usize,
    /// Node at its start; the end is the next.
    pub node: usize,
    /// Control node at its start; the end is the next.
    pub control: usize,
}

impl Grid {
    pub fn new(powered: impl IntoIterator<Item = bool>, settings: &SixDofSettings) -> Self {
        let powered: Vec<bool> = powered.into_iter().collect();
        let last = powered.len() - 1;
        let phases = powered.iter().enumerate().map(|(n, &powered)| {
            let intervals = match (powered, n == last) {
                (false, _) => settings.coast_intervals,
                (true, true) => settings.last_burn_intervals,
                (true, false) => settings.first_burn_intervals,
            };
            PhaseGrid { powered, intervals }
        });
        Self { phases: phases.collect() }
    }

    pub fn intervals(&self) -> impl Iterator<Item = Interval> + '_ {
        let mut node = 0;
        self.phases.iter().enumerate().flat_map(move |(phase, grid)| {
            let first = node;
            node += grid.intervals;
            (first..node).map(move |node| Interval { phase, node, control: node + phase })
        })
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.phases.iter().map(|phase| phase.intervals).sum::<usize>() + 1
    }

    /// Whether the engine runs, control node by control node.
    pub fn control_powered(&self) -> impl Iterator<Item = bool> + '_ {
        self.phases.iter().flat_map(|p| std::iter::repeat_n(p.powered, p.intervals + 1))
    }
}

/// Decision variables of the outer loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Iterate {
    pub states: Vec<State>,
    pub controls: Vec<Control>,
    /// Length of the intervals of each phase, s.
    pub step_s: Vec<f64>,
}

impl Iterate {
    /// Puts the first attitude back on the unit sphere, which a linear step leaves to second order;
    /// the dynamics keep the others there.
    pub fn normalise(&mut self) {
        let norm = self.states[0].fixed_rows::<4>(Q).norm();
        let mut q = self.states[0].fixed_rows_mut::<4>(Q);
        q /= norm;
    }
}

/// An iterate, its shooting maps and their defects.
pub(super) struct Trajectory {
    pub iterate: Iterate,
    pub sensitivities: Vec<Sensitivity>,
    /// End of each interval less the next node (G.76).
    pub defects: Vec<State>,
}

impl Trajectory {
    pub fn new(problem: &SixDofProblem, grid: &Grid, iterate: Iterate) -> Self {
        let dynamics = problem.dynamics();
        let (mut sensitivities, mut defects) = (Vec::new(), Vec::new());
        for Interval { phase, node, control } in grid.intervals() {
            let length_s = iterate.step_s[phase];
            let step_max_s = STEP_MAX_S[usize::from(!grid.phases[phase].powered)];
            let steps = (length_s / step_max_s).ceil().max(1.0) as usize;
            let controls = [&iterate.controls[control], &iterate.controls[control + 1]];
            let (end, sensitivity) =
                shoot(&dynamics, &iterate.states[node], controls, length_s, steps);
            sensitivities.push(sensitivity);
            defects.push(end - iterate.states[node + 1]);
        }
        Self { iterate, sensitivities, defects }
    }

    /// Mass at the end, kg.
    pub fn end_mass_kg(&self) -> f64 {
        self.iterate.states.last().map_or(0.0, |x| x[0])
    }

    /// Sum and largest of the scaled defects.
    pub fn defect(&self, scale: &Scale) -> (f64, f64) {
        let scaled = || self.defects.iter().map(|d| d.component_div(&scale.state).abs());
        (scaled().map(|d| d.sum()).sum(), scaled().map(|d| d.max()).fold(0.0, f64::max))
    }
}

/// Units that bring the variables to order one.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    pub state: State,
    pub control: Control,
}

impl Scale {
    /// Of a flight that uses `propellant_kg` in `flight_s`.
    pub fn new(problem: &SixDofProblem, propellant_kg: f64, flight_s: f64) -> Self {
        let delta_v_m_s = propellant_kg / problem.mass_kg() / problem.dynamics().mass_flow_s_m;
        let mut state = State::zeros();
        state[0] = propellant_kg;
        state.fixed_rows_mut::<3>(R).fill(delta_v_m_s * flight_s / 4.0);
        state.fixed_rows_mut::<3>(V).fill(delta_v_m_s);
        state.fixed_rows_mut::<4>(Q).fill(1.0);
        state.fixed_rows_mut::<3>(W).fill(problem.limits.rate_max_rad_s);
        let mut control = Control::repeat(libm::tan(problem.actuators.gimbal_max_rad));
        control[THRUST] = problem.actuators.thrust_max_n;
        let torque: SVector<f64, 3> =
            problem.actuators.torque_max_b.map(|max| if max > 0.0 { max } else { 1.0 });
        control.fixed_rows_mut::<3>(TORQUE).copy_from(&torque);
        Self { state, control }
    }
}
