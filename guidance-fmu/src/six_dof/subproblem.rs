//! The convex subproblem about a reference (G.77), in scaled deviations from it.

use super::dynamics::{Q, R, THRUST, TORQUE, V, W, quaternion};
use super::problem::SixDofProblem;
use super::shooting::{END_CONTROL, LENGTH, START_CONTROL};
use super::trajectory::{Grid, Interval, Iterate, Scale, Trajectory};
use crate::scvx::{Affine, Program};

/// Price of a scaled unit of virtual control against the scaled propellant: above the multipliers
/// of the dynamics, of order one in these units, so that the penalty is exact.
pub(super) const DEFECT_WEIGHT: f64 = 1e1;
/// Trust radius on the relative change of a duration.
const DURATION_TRUST: f64 = 0.5;
/// Proximal weight of the variables that enter the dynamics linearly, against the others'.
const LINEAR_STIFFNESS: f64 = 1e-3;

/// Columns: nodes, control nodes, phase durations, positive and negative virtual controls.
pub(super) struct Columns {
    nodes: usize,
    controls: usize,
    phases: usize,
}

impl Columns {
    pub fn new(grid: &Grid) -> Self {
        let nodes = grid.nodes();
        let phases = grid.phases.len();
        Self { nodes, controls: nodes - 1 + phases, phases }
    }

    fn state(&self, node: usize, row: usize) -> usize {
        14 * node + row
    }

    fn control(&self, control: usize, row: usize) -> usize {
        14 * self.nodes + 6 * control + row
    }

    fn step(&self, phase: usize) -> usize {
        14 * self.nodes + 6 * self.controls + phase
    }

    fn virtual_control(&self, interval: usize, row: usize) -> [usize; 2] {
        let first = self.step(self.phases) + 2 * (14 * interval + row);
        [first, first + 1]
    }

    fn len(&self) -> usize {
        self.virtual_control(self.nodes - 1, 0)[0]
    }
}

/// What the limits of a node are drawn in by, so that they hold beside it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Margin {
    pub tilt_rad: f64,
    pub rate_rad_s: f64,
    pub glide_slope_m: f64,
}

/// The subproblem of one outer iteration.
pub(super) struct Subproblem<'a> {
    pub problem: &'a SixDofProblem,
    pub grid: &'a Grid,
    pub scale: &'a Scale,
    pub phase_min_s: f64,
    /// What the limits of each node are drawn in by.
    pub margins: &'a [Margin],
}

impl Subproblem<'_> {
    /// Program about `reference` with proximal weight `stiffness`.
    pub fn build(&self, reference: &Trajectory, stiffness: f64) -> Program {
        let columns = Columns::new(self.grid);
        let mut curvature = vec![0.0; columns.len()];
        let mut cost = vec![0.0; columns.len()];
        curvature[..columns.virtual_control(0, 0)[0]].fill(stiffness);
        for node in 0..columns.nodes {
            curvature[columns.state(node, 0)..columns.state(node, Q)]
                .fill(LINEAR_STIFFNESS * stiffness);
        }
        cost[columns.state(columns.nodes - 1, 0)] = -1.0;
        cost[columns.virtual_control(0, 0)[0]..].fill(DEFECT_WEIGHT);
        let mut program = Program::new(curvature, cost);
        self.dynamics_rows(&mut program, &columns, reference);
        self.end_rows(&mut program, &columns, &reference.iterate);
        self.unlit_rows(&mut program, &columns, &reference.iterate);
        for column in columns.virtual_control(0, 0)[0]..columns.len() {
            program.nonnegative(Affine::new([(column, 1.0)], 0.0));
        }
        self.duration_rows(&mut program, &columns, &reference.iterate);
        self.thrust_rows(&mut program, &columns, &reference.iterate);
        self.rate_rows(&mut program, &columns, &reference.iterate);
        self.path_rows(&mut program, &columns, &reference.iterate);
        program
    }

    /// The iterate that a solution means, and its virtual control (scaled sum).
    pub fn extract(&self, reference: &Iterate, x: &[f64]) -> (Iterate, f64) {
        let columns = Columns::new(self.grid);
        let mut next = reference.clone();
        for (node, state) in next.states.iter_mut().enumerate() {
            for row in 0..14 {
                state[row] += self.scale.state[row] * x[columns.state(node, row)];
            }
        }
        for (n, control) in next.controls.iter_mut().enumerate() {
            for row in 0..6 {
                control[row] += self.scale.control[row] * x[columns.control(n, row)];
            }
        }
        for (phase, step_s) in next.step_s.iter_mut().enumerate() {
            *step_s *= 1.0 + x[columns.step(phase)];
        }
        next.normalise();
        (next, x[columns.virtual_control(0, 0)[0]..].iter().sum())
    }

    /// Linearised shooting with virtual control.
    fn dynamics_rows(&self, program: &mut Program, columns: &Columns, reference: &Trajectory) {
        let scale = self.scale;
        for (n, Interval { phase, node, control }) in self.grid.intervals().enumerate() {
            let (sensitivity, defect) = (&reference.sensitivities[n], &reference.defects[n]);
            for row in 0..14 {
                let unit = 1.0 / scale.state[row];
                let mut terms = Vec::with_capacity(30);
                for k in 0..14 {
                    let c = sensitivity[(row, k)] * scale.state[k] * unit;
                    terms.push((columns.state(node, k), c));
                }
                for k in 0..6 {
                    let [start, end] = [START_CONTROL, END_CONTROL]
                        .map(|first| sensitivity[(row, first + k)] * scale.control[k] * unit);
                    terms.push((columns.control(control, k), start));
                    terms.push((columns.control(control + 1, k), end));
                }
                let step_s = reference.iterate.step_s[phase];
                terms.push((columns.step(phase), sensitivity[(row, LENGTH)] * step_s * unit));
                terms.push((columns.state(node + 1, row), -1.0));
                let [plus, minus] = columns.virtual_control(n, row);
                terms.extend([(plus, 1.0), (minus, -1.0)]);
                program.zero(Affine::new(terms, defect[row] * unit));
            }
        }
    }

    /// The start, and the end's position and velocity.
    fn end_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        let (problem, last) = (self.problem, columns.nodes - 1);
        let mut pin = |node: usize, row: usize, value: f64| {
            let error = (reference.states[node][row] - value) / self.scale.state[row];
            program.zero(Affine::new([(columns.state(node, row), 1.0)], error));
        };
        pin(0, 0, problem.mass_kg());
        for axis in 0..3 {
            pin(0, R + axis, problem.start.r_w[axis]);
            pin(0, V + axis, problem.start.v_w[axis]);
            pin(0, W + axis, problem.start.rate_b[axis]);
            pin(last, R + axis, problem.r_f_w[axis]);
            pin(last, V + axis, problem.v_f_w[axis]);
        }
        let q = quaternion(&reference.states[0]);
        if problem.start.attitude_wb.is_some() {
            (0..4).for_each(|k| pin(0, Q + k, q[k]));
        } else {
            // Along the unit sphere.
            let along: Vec<_> = (0..4).map(|k| (columns.state(0, Q + k), q[k])).collect();
            program.zero(Affine::new(along, 0.0));
        }
    }

    /// No thrust in a coast, no torque without thrusters.
    fn unlit_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        for (n, powered) in self.grid.control_powered().enumerate() {
            for row in 0..6 {
                let able = match row {
                    0..TORQUE => powered,
                    _ => self.problem.actuators.torque_max_b[row - TORQUE] > 0.0,
                };
                if !able {
                    program.zero(self.control(columns, reference, n, row));
                }
            }
        }
    }

    /// Durations within their trust region and above their minimum.
    fn duration_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        for (phase, grid) in self.grid.phases.iter().enumerate() {
            let shortest = self.phase_min_s / grid.intervals as f64 / reference.step_s[phase] - 1.0;
            let low = shortest.max(-DURATION_TRUST);
            program.nonnegative(Affine::new([(columns.step(phase), 1.0)], -low));
            program.nonnegative(Affine::new([(columns.step(phase), -1.0)], DURATION_TRUST));
        }
    }

    /// Thrust band, gimbal cone and thruster torque at every control node (G.75).
    fn thrust_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        let actuators = &self.problem.actuators;
        for (n, powered) in self.grid.control_powered().enumerate() {
            let part = |row| self.control(columns, reference, n, row);
            if powered {
                let floor = actuators.thrust_min_n / actuators.thrust_max_n;
                program.nonnegative(shifted(part(THRUST), -floor));
                program.nonnegative(shifted(scaled(part(THRUST), -1.0), 1.0));
                program.second_order([Affine::new([], 1.0), part(0), part(1)]);
            }
            for row in (0..3).filter(|&axis| actuators.torque_max_b[axis] > 0.0) {
                program.nonnegative(shifted(scaled(part(TORQUE + row), -1.0), 1.0));
                program.nonnegative(shifted(part(TORQUE + row), 1.0));
            }
        }
    }

    /// Rates of thrust and gimbal over every powered interval (G.75).
    fn rate_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        let actuators = &self.problem.actuators;
        for Interval { phase, control, .. } in self.grid.intervals() {
            if !self.grid.phases[phase].powered {
                continue;
            }
            let step_s = reference.step_s[phase];
            let change = |row| {
                let [start, end] =
                    [control, control + 1].map(|n| self.control(columns, reference, n, row));
                sum(end, scaled(start, -1.0))
            };
            let most = |rate: f64, row: usize| {
                let share = rate * step_s / self.scale.control[row];
                Affine::new([(columns.step(phase), share)], share)
            };
            let thrust = most(actuators.thrust_rate_max_n_s, THRUST);
            program.nonnegative(sum(thrust.clone(), change(THRUST)));
            program.nonnegative(sum(thrust, scaled(change(THRUST), -1.0)));
            let gimbal = most(actuators.gimbal_rate_max_rad_s, 0);
            program.second_order([gimbal, change(0), change(1)]);
        }
    }

    /// Tilt, body rate and glide slope at the nodes; the end has its own limits (G.74).
    fn path_rows(&self, program: &mut Program, columns: &Columns, reference: &Iterate) {
        let (limits, last) = (&self.problem.limits, columns.nodes - 1);
        let fixed = usize::from(self.problem.start.attitude_wb.is_some());
        for node in fixed..=last {
            let part = |row| self.state(columns, reference, node, row);
            let margin = &self.margins[node];
            let (tilt_rad, rate_rad_s) = if node == last {
                (limits.end_tilt_max_rad, limits.end_rate_max_rad_s)
            } else {
                let drawn_in = limits.tilt_max_rad - margin.tilt_rad;
                (drawn_in.max(0.0), (limits.rate_max_rad_s - margin.rate_rad_s).max(0.0))
            };
            let lean = libm::sin(0.5 * tilt_rad);
            program.second_order([Affine::new([], lean), part(Q + 1), part(Q + 2)]);
            if node == 0 {
                continue;
            }
            let rate = rate_rad_s / limits.rate_max_rad_s;
            program.second_order([Affine::new([], rate), part(W), part(W + 1), part(W + 2)]);
            if let Some(angle_rad) = limits.glide_slope_rad.filter(|_| node < last) {
                let unit_m = self.scale.state[R];
                let from_target =
                    |axis: usize| shifted(part(R + axis), -self.problem.r_f_w[axis] / unit_m);
                let reach = scaled(from_target(2), libm::tan(angle_rad));
                let reach = shifted(reach, -margin.glide_slope_m / unit_m);
                program.second_order([reach, from_target(0), from_target(1)]);
            }
        }
    }

    /// Scaled state at a node.
    fn state(&self, columns: &Columns, reference: &Iterate, node: usize, row: usize) -> Affine {
        let value = reference.states[node][row] / self.scale.state[row];
        Affine::new([(columns.state(node, row), 1.0)], value)
    }

    /// Scaled control at a control node.
    fn control(&self, columns: &Columns, reference: &Iterate, n: usize, row: usize) -> Affine {
        let value = reference.controls[n][row] / self.scale.control[row];
        Affine::new([(columns.control(n, row), 1.0)], value)
    }
}

fn scaled(mut row: Affine, factor: f64) -> Affine {
    row.terms.iter_mut().for_each(|(_, c)| *c *= factor);
    row.constant *= factor;
    row
}

fn shifted(mut row: Affine, by: f64) -> Affine {
    row.constant += by;
    row
}

/// Sum of two rows without a common column.
fn sum(mut row: Affine, other: Affine) -> Affine {
    row.terms.extend(other.terms);
    row.constant += other.constant;
    row
}
