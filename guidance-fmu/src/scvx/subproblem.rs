//! The convex subproblem about a reference trajectory (G.8-G.18), assembled in scaled units.

use nalgebra::Vector3;

use super::conic::{Affine, Program};
use super::problem::{Problem, Terminal};
use super::structure::{Grid, Structure};
use super::trajectory::{Iterate, Trajectory};
use super::turn;

/// Weight of a scaled unit of terminal or path slack against a scaled unit of Δv. The target's
/// multipliers are of order one in these units, so the penalty is exact (Han & Mangasarian 1979).
pub(super) const SLACK_WEIGHT: f64 = 1e2;

/// Price of a scaled unit of impulse in reserve: above the Δv it saves, below the slack weight.
pub(super) const RESERVE_WEIGHT: f64 = 10.0;

/// Price of a scaled unit of impact speed: above the Δv that mends it, and far enough below the
/// slack weight that no height is given up for speed (G.44).
pub(super) const IMPACT_WEIGHT: f64 = 10.0;

/// Price of a radian of turn beyond the limit: above the Δv that it saves. From 18 on flights give up a target for it (three of
/// a thousand, tried by hand): a turn must stay cheaper than a miss.
pub(super) const TURN_WEIGHT: f64 = 10.0;

/// Units that bring durations to order one, positions and velocities to order `EXTENT`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub length_m: f64,
    pub velocity_m_s: f64,
    pub time_s: f64,
}

impl Scale {
    pub fn new(problem: &Problem) -> Self {
        /// Distance to fly, in units. The conic solver starts from slacks and multipliers of order one, and takes a
        /// fifth more iterations with 1, over 200 states about the reference descents; from 10 to 20 as many within 1 %.
        const EXTENT: f64 = 20.0;
        let g_m_s2 = problem.gravity_m_s2;
        let distance_m = problem.miss(&problem.r0_w, &problem.v0_w).0.norm();
        let braking_m = (problem.v0_w - problem.v_f_w).norm_squared() / (2.0 * g_m_s2);
        let length_m = distance_m.max(braking_m).max(1.0);
        let velocity_m_s = (length_m * g_m_s2).sqrt();
        Self {
            length_m: length_m / EXTENT,
            velocity_m_s: velocity_m_s / EXTENT,
            time_s: velocity_m_s / g_m_s2,
        }
    }
}

/// Columns of the program: w, h and the reserve e of each burn interval, then d of each phase, then
/// slacks. Without a reserve there is no e.
struct Columns {
    stride: usize,
    /// Rank of an interval among the powered ones.
    rank: Vec<Option<usize>>,
    burns: usize,
    phases: usize,
    impact_columns: usize,
    turn_columns: usize,
    path_columns: usize,
}

impl Columns {
    fn new(problem: &Problem, grid: &Grid) -> Self {
        let mut rank = vec![None; grid.len()];
        let mut burns = 0;
        for j in grid.burns() {
            rank[j] = Some(burns);
            burns += 1;
        }
        Self {
            stride: if problem.reserve.is_some() { 5 } else { 4 },
            rank,
            burns,
            phases: grid.phases.len(),
            impact_columns: usize::from(problem.terminal == Terminal::SoftestImpact),
            turn_columns: usize::from(problem.turn.is_some()),
            path_columns: 0,
        }
    }

    fn w(&self, rank: usize, axis: usize) -> usize {
        self.stride * rank + axis
    }

    fn h(&self, rank: usize) -> usize {
        self.stride * rank + 3
    }

    fn reserve(&self, rank: usize) -> Option<usize> {
        (self.stride == 5).then_some(self.stride * rank + 4)
    }

    fn step(&self, phase: usize) -> usize {
        self.stride * self.burns + phase
    }

    /// Price of missing the target velocity.
    fn slack_v(&self) -> usize {
        self.stride * self.burns + self.phases
    }

    /// Price of missing the target position.
    fn slack_r(&self) -> usize {
        self.slack_v() + 1
    }

    /// Impact speed (G.44); only where the velocity may be missed.
    fn impact(&self) -> usize {
        self.slack_v() + 2
    }

    /// Largest turn beyond the limit (G.97); only where there is one.
    fn turn(&self) -> usize {
        self.impact() + self.impact_columns
    }

    /// Price of leaving a path limit; only where a node has one.
    fn path_slack(&self) -> usize {
        self.turn() + self.turn_columns
    }

    fn len(&self) -> usize {
        self.path_slack() + self.path_columns
    }
}

/// What an outer iteration adds to the reference.
#[derive(Clone, Debug)]
pub(super) struct Local {
    /// Relative trust radius on the durations.
    pub trust: f64,
    /// Proximal weight on the relative change of the durations.
    pub stiffness: f64,
    /// Nodes with path rows.
    pub path_nodes: Vec<usize>,
    /// Whether the thrust itself, not only its bound variable, is kept above its floor.
    pub thrust_floor: bool,
}

/// The subproblem of one outer iteration.
pub(super) struct Subproblem<'a> {
    pub problem: &'a Problem,
    pub grid: &'a Grid,
    pub scale: Scale,
}

impl Subproblem<'_> {
    /// Program about `reference`.
    pub fn build(&self, reference: &Trajectory, local: &Local) -> Program {
        let path_columns = usize::from(!local.path_nodes.is_empty());
        let columns = Columns { path_columns, ..Columns::new(self.problem, self.grid) };
        let mut cost = vec![0.0; columns.len()];
        let mut curvature = vec![0.0; columns.len()];
        for (index, phase) in self.grid.phases.iter().enumerate() {
            // ½ κ ((d − d̄)/d̄)² (G.16), softened where a phase has nearly vanished.
            let reference_s = reference.iterate.step_s[index];
            let unit = phase.softened_s(reference_s) / self.scale.time_s;
            let weight = local.stiffness / (unit * unit);
            curvature[columns.step(index)] = weight;
            cost[columns.step(index)] = -weight * reference_s / self.scale.time_s;
        }
        for rank in 0..columns.burns {
            cost[columns.h(rank)] = 1.0;
            columns.reserve(rank).into_iter().for_each(|e| cost[e] = RESERVE_WEIGHT);
        }
        cost[columns.slack_v()..].fill(1.0);
        cost[columns.impact()..columns.turn()].fill(IMPACT_WEIGHT);
        cost[columns.turn()..columns.path_slack()].fill(TURN_WEIGHT);
        let mut program = Program::new(curvature, cost);

        self.thrust_rows(&mut program, &columns, reference, local);
        self.propellant_row(&mut program, &columns);
        self.trust_rows(&mut program, &columns, reference, local.trust);
        for column in columns.slack_v()..columns.len() {
            program.nonnegative(Affine::new([(column, 1.0)], 0.0));
        }
        if let Some(z_min_m) = self.problem.path.altitude_min_m {
            // (G.17)
            for &node in &local.path_nodes {
                let mut row = self.position(&columns, reference, node, 2);
                row.constant -= z_min_m / self.scale.length_m;
                row.terms.push((columns.path_slack(), 1.0 / SLACK_WEIGHT));
                program.nonnegative(row);
            }
        }
        for (rank, _) in self.grid.burns().enumerate() {
            let cone =
                [columns.h(rank), columns.w(rank, 0), columns.w(rank, 1), columns.w(rank, 2)];
            program.second_order(cone.map(|column| Affine::new([(column, 1.0)], 0.0))); // (G.10)
        }
        self.terminal_cones(&mut program, &columns, reference);
        self.impact_cone(&mut program, &columns);
        self.rate_cones(&mut program, &columns, reference);
        self.turn_cones(&mut program, &columns, reference);
        if let Some(angle_rad) = self.problem.path.glide_slope_rad {
            for &node in &local.path_nodes {
                program.second_order(self.glide_slope(&columns, reference, node, angle_rad));
            }
        }
        program
    }

    /// Physical iterate from a solution vector.
    pub fn extract(&self, x: &[f64]) -> Iterate {
        let columns = Columns::new(self.problem, self.grid);
        let (velocity_m_s, time_s) = (self.scale.velocity_m_s, self.scale.time_s);
        let w = |rank: &Option<usize>| {
            rank.map_or(Vector3::zeros(), |rank| {
                Vector3::from_fn(|axis, _| x[columns.w(rank, axis)] * velocity_m_s)
            })
        };
        let h = |rank: &Option<usize>| rank.map_or(0.0, |rank| x[columns.h(rank)] * velocity_m_s);
        Iterate {
            step_s: (0..columns.phases).map(|phase| x[columns.step(phase)] * time_s).collect(),
            w_w: columns.rank.iter().map(w).collect(),
            h: columns.rank.iter().map(h).collect(),
        }
    }

    /// Target miss of the linearised flight of a solution, m and m/s.
    pub fn terminal_slack(
        &self,
        reference: &Trajectory,
        x: &[f64],
    ) -> (Vector3<f64>, Vector3<f64>) {
        let columns = Columns::new(self.problem, self.grid);
        let r_w = Vector3::from_fn(|axis, _| self.position_error(&columns, reference, axis).at(x));
        let v_w = Vector3::from_fn(|axis, _| self.velocity_error(&columns, axis).at(x));
        let r_f_w = self.problem.r_f_w + r_w * self.scale.length_m;
        self.problem.miss(&r_f_w, &(self.problem.v_f_w + v_w * self.scale.velocity_m_s))
    }

    /// Target velocity (G.8) and linearised target position (G.9), each with the norm of its error priced.
    fn terminal_cones(&self, program: &mut Program, columns: &Columns, reference: &Trajectory) {
        let price = |column| Affine::new([(column, 1.0 / SLACK_WEIGHT)], 0.0);
        let r = |axis| self.position_error(columns, reference, axis);
        let v = |axis| self.velocity_error(columns, axis);
        if self.problem.terminal != Terminal::SoftestImpact {
            program.second_order([price(columns.slack_v()), v(0), v(1), v(2)]);
        }
        if self.problem.terminal == Terminal::Point {
            program.second_order([price(columns.slack_r()), r(0), r(1), r(2)]);
        } else {
            program.second_order([price(columns.slack_r()), r(2)]);
        }
    }

    /// Scaled linearised end position less the target's (G.9).
    fn position_error(&self, columns: &Columns, reference: &Trajectory, axis: usize) -> Affine {
        let mut row = self.position(columns, reference, self.grid.len(), axis);
        row.constant -= self.problem.r_f_w[axis] / self.scale.length_m;
        row
    }

    /// Scaled end velocity less the target's (G.8).
    fn velocity_error(&self, columns: &Columns, axis: usize) -> Affine {
        let (problem, scale) = (self.problem, &self.scale);
        let excess_m_s = (problem.v0_w - problem.v_f_w)[axis];
        let mut row = Affine::new([], excess_m_s / scale.velocity_m_s);
        row.terms.extend((0..columns.burns).map(|rank| (columns.w(rank, axis), 1.0)));
        let gravity_m_s2 = problem.gravity_w()[axis];
        // A zero would be carried through every factorisation.
        for (index, phase) in self.grid.phases.iter().enumerate().filter(|_| gravity_m_s2 != 0.0) {
            let gain_m_s2 = gravity_m_s2 * phase.intervals as f64;
            row.terms.push((columns.step(index), gain_m_s2 * scale.time_s / scale.velocity_m_s));
        }
        row
    }

    /// Impact speed above the norm of the velocity error (G.44).
    fn impact_cone(&self, program: &mut Program, columns: &Columns) {
        if self.problem.terminal == Terminal::SoftestImpact {
            let [x, y, z] = [0, 1, 2].map(|axis| self.velocity_error(columns, axis));
            program.second_order([Affine::new([(columns.impact(), 1.0)], 0.0), x, y, z]);
        }
    }

    /// Propellant on board (G.44): only an impact is asked for with too little of it.
    fn propellant_row(&self, program: &mut Program, columns: &Columns) {
        if self.problem.terminal == Terminal::SoftestImpact && columns.burns > 0 {
            /// Room for the solver's tolerance, so that the roll-out stays above the dry mass.
            const USABLE_SHARE: f64 = 1.0 - 1e-6;
            let most = USABLE_SHARE * self.problem.delta_v_max_m_s() / self.scale.velocity_m_s;
            let spent = (0..columns.burns).map(|rank| (columns.h(rank), -1.0));
            program.nonnegative(Affine::new(spent.collect::<Vec<_>>(), most));
        }
    }

    /// Thrust rate between neighbouring intervals of a burn, with d² from below (G.42).
    fn rate_cones(&self, program: &mut Program, columns: &Columns, reference: &Trajectory) {
        let Some(rate_n_s) = self.problem.thrust_rate_max_n_s else { return };
        for j in 1..self.grid.len() {
            let phase = self.grid.phase_of[j];
            let (Some(before), Some(after)) = (columns.rank[j - 1], columns.rank[j]) else {
                continue;
            };
            let step_s = reference.iterate.step_s[phase];
            let per_s = rate_n_s / (reference.nodes[j].mass_kg * self.scale.velocity_m_s);
            let slope = 2.0 * step_s * self.scale.time_s * per_s;
            let limit = Affine::new([(columns.step(phase), slope)], -step_s * step_s * per_s);
            let change = |axis| {
                Affine::new([(columns.w(after, axis), 1.0), (columns.w(before, axis), -1.0)], 0.0)
            };
            program.second_order([limit, change(0), change(1), change(2)]);
        }
    }

    /// Turn from each direction to the next, at the reference's impulses (G.97).
    fn turn_cones(&self, program: &mut Program, columns: &Columns, reference: &Trajectory) {
        let Some(limit) = self.problem.turn else { return };
        let iterate = &reference.iterate;
        // The horizontal part of an interval's unit vector.
        let across = |interval: usize, axis: usize, sign: f64| {
            let rank = columns.rank[interval]?;
            let impulse = iterate.w_w[interval].norm() / self.scale.velocity_m_s;
            (impulse > 0.0).then(|| (columns.w(rank, axis), sign / impulse))
        };
        for link in turn::links(self.problem, self.grid, iterate) {
            let turned = |axis: usize| {
                let before = link.before.and_then(|j| across(j, axis, -1.0));
                let start = limit.axis_w.filter(|_| link.before.is_none());
                let terms = across(link.after, axis, 1.0).into_iter().chain(before);
                Affine::new(terms.collect::<Vec<_>>(), start.map_or(0.0, |axis_w| -axis_w[axis]))
            };
            let mut most = Affine::new([(columns.turn(), 1.0)], 0.0);
            let spans = link.intervals.iter().enumerate().filter(|(_, n)| **n > 0.0);
            most.terms.extend(spans.map(|(phase, n)| {
                (columns.step(phase), n * limit.rate_max_rad_s * self.scale.time_s)
            }));
            program.second_order([most, turned(0), turned(1)]);
        }
    }

    /// Thrust bounds at the ends of each interval (G.11), tilt (G.12) and their reserve (G.14).
    fn thrust_rows(
        &self,
        program: &mut Program,
        columns: &Columns,
        reference: &Trajectory,
        local: &Local,
    ) {
        let (problem, grid) = (self.problem, self.grid);
        let per_step = self.scale.time_s / self.scale.velocity_m_s;
        for (rank, j) in grid.burns().enumerate() {
            let (h, w_z) = (columns.h(rank), columns.w(rank, 2));
            let step = columns.step(grid.phase_of[j]);
            let low = problem.thrust_min_n / reference.nodes[j + 1].mass_kg * per_step;
            let ceiling = |thrust_n: f64| {
                let high = thrust_n / reference.nodes[j].mass_kg * per_step;
                Affine::new([(h, -1.0), (step, high)], 0.0)
            };
            let tilt = |tilt_rad: f64| Affine::new([(w_z, 1.0), (h, -libm::cos(tilt_rad))], 0.0);
            let tilt_rad = problem.tilt_limit_rad(j, grid.len());
            let mut nominal = [ceiling(problem.thrust_max_n), tilt(tilt_rad)];
            if let (Some(reserve), Some(e)) = (problem.reserve, columns.reserve(rank)) {
                nominal.iter_mut().for_each(|row| row.terms.push((e, 1.0)));
                program.nonnegative(ceiling(reserve.thrust_max_n));
                program.nonnegative(tilt(reserve.tilt_max_rad));
                program.nonnegative(Affine::new([(e, 1.0)], 0.0));
            }
            nominal.into_iter().for_each(|row| program.nonnegative(row));
            // A flight without a coast is seldom lossless: its (G.13) has its place from the start, so that
            // the factorisation fits throughout.
            if local.thrust_floor || (low > 0.0 && grid.structure == Structure::On) {
                // (G.13): the floor on the thrust itself, along its reference direction.
                let w_ref = tilted(&reference.iterate.w_w[j], tilt_rad);
                let [on_h, on_w] = if local.thrust_floor { [0.0, 1.0] } else { [1.0, 0.0] };
                let mut row = Affine::new([(step, -low), (h, on_h)], 0.0);
                row.terms.extend((0..3).map(|axis| (columns.w(rank, axis), on_w * w_ref[axis])));
                program.nonnegative(row);
            } else if low > 0.0 {
                // With (G.13), or without a floor, (G.10) says as much.
                program.nonnegative(Affine::new([(h, 1.0), (step, -low)], 0.0));
            }
        }
    }

    /// Trust region on the durations (G.15).
    fn trust_rows(
        &self,
        program: &mut Program,
        columns: &Columns,
        reference: &Trajectory,
        trust: f64,
    ) {
        for (index, phase) in self.grid.phases.iter().enumerate() {
            let step_s = reference.iterate.step_s[index];
            let radius_s = trust * phase.softened_s(step_s);
            let low = (step_s - radius_s).max(phase.step_min_s) / self.scale.time_s;
            let high = (step_s + radius_s).max(phase.step_min_s) / self.scale.time_s;
            program.nonnegative(Affine::new([(columns.step(index), 1.0)], -low));
            program.nonnegative(Affine::new([(columns.step(index), -1.0)], high));
        }
    }

    /// Glide-slope cone at a node (G.17).
    fn glide_slope(
        &self,
        columns: &Columns,
        reference: &Trajectory,
        node: usize,
        angle_rad: f64,
    ) -> [Affine; 3] {
        let relative = |axis| {
            let mut row = self.position(columns, reference, node, axis);
            row.constant -= self.problem.r_f_w[axis] / self.scale.length_m;
            row
        };
        let mut height = relative(2);
        height.constant *= libm::tan(angle_rad);
        height.terms.iter_mut().for_each(|(_, c)| *c *= libm::tan(angle_rad));
        height.terms.push((columns.path_slack(), 1.0 / SLACK_WEIGHT));
        [height, relative(0), relative(1)]
    }

    /// Scaled position at a node, linearised in the durations about the reference (G.9).
    fn position(
        &self,
        columns: &Columns,
        reference: &Trajectory,
        node: usize,
        axis: usize,
    ) -> Affine {
        let (problem, grid, scale) = (self.problem, self.grid, &self.scale);
        let Iterate { step_s, w_w, .. } = &reference.iterate;
        let t_node_s = reference.nodes[node].t_s;
        let gravity_m_s2 = problem.gravity_w()[axis];
        // ∂(t_node)/∂d of each phase: its intervals between interval j and the node.
        let mut ahead = vec![0.0; columns.phases];
        grid.phase_of[..node].iter().for_each(|&phase| ahead[phase] += 1.0);
        let fall_m_s = problem.v0_w[axis] + gravity_m_s2 * t_node_s;
        let fall_slope_m_s: Vec<f64> = ahead.iter().map(|n| n * fall_m_s).collect();

        let mut row = Affine::default();
        let mut thrust_slope_m_s = vec![0.0; columns.phases];
        for (j, &phase) in grid.phase_of[..node].iter().enumerate() {
            if let Some(rank) = columns.rank[j] {
                // The impulse acts from the middle of its interval.
                let lever_s = t_node_s - reference.nodes[j].t_s - 0.5 * step_s[phase];
                let per_w = lever_s * scale.velocity_m_s / scale.length_m;
                row.terms.push((columns.w(rank, axis), per_w));
                (0..columns.phases).for_each(|p| thrust_slope_m_s[p] += w_w[j][axis] * ahead[p]);
                thrust_slope_m_s[phase] -= 0.5 * w_w[j][axis];
            }
            ahead[phase] -= 1.0;
        }
        let mut constant_m = problem.r0_w[axis] - 0.5 * gravity_m_s2 * t_node_s * t_node_s;
        for p in 0..columns.phases {
            let slope_m_s = fall_slope_m_s[p] + thrust_slope_m_s[p];
            row.terms.push((columns.step(p), slope_m_s * scale.time_s / scale.length_m));
            constant_m -= thrust_slope_m_s[p] * step_s[p];
        }
        row.constant = constant_m / scale.length_m;
        row
    }
}

/// Direction of `w_w`, or the nearest one within a tilt: no thrust could meet a floor along others.
fn tilted(w_w: &Vector3<f64>, tilt_max_rad: f64) -> Vector3<f64> {
    let across_w = Vector3::new(w_w.x, w_w.y, 0.0);
    if libm::atan2(across_w.norm(), w_w.z) <= tilt_max_rad {
        return w_w.try_normalize(0.0).unwrap_or_else(Vector3::z);
    }
    let (sin, cos) = libm::sincos(tilt_max_rad);
    across_w.try_normalize(0.0).unwrap_or_else(Vector3::x) * sin + Vector3::z() * cos
}
