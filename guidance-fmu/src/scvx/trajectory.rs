//! Exact roll-out of a sequence of impulses, and what it says about the thrust, path and target.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::problem::Problem;
use super::structure::Grid;
use super::subproblem::IMPACT_WEIGHT;
use super::turn;

/// Decision variables of the outer loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Iterate {
    /// Length of the intervals of each phase, s.
    pub step_s: Vec<f64>,
    /// Velocity gained from thrust in each interval, m/s; zero in a coast.
    pub w_w: Vec<Vector3<f64>>,
    /// Its relaxed magnitude, m/s; equals ‖w‖ when the relaxation is lossless.
    pub h: Vec<f64>,
}

impl Iterate {
    /// An iterate whose relaxation is tight.
    pub fn lossless(step_s: Vec<f64>, w_w: Vec<Vector3<f64>>) -> Self {
        let h = w_w.iter().map(|w| w.norm()).collect();
        Self { step_s, w_w, h }
    }
}

/// State at a node of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Time since the start of the plan, s.
    pub t_s: f64,
    /// Position, m.
    pub r_w: Vector3<f64>,
    /// Velocity, m/s.
    pub v_w: Vector3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
}

impl Node {
    /// State `dt_s` later under constant thrust acceleration `u_w` (G.4).
    pub fn advance(
        &self,
        dt_s: f64,
        u_w: &Vector3<f64>,
        gravity_w: &Vector3<f64>,
        mass_flow_s_m: f64,
    ) -> Self {
        let a_w = u_w + gravity_w;
        Self {
            t_s: self.t_s + dt_s,
            r_w: self.r_w + self.v_w * dt_s + a_w * (0.5 * dt_s * dt_s),
            v_w: self.v_w + a_w * dt_s,
            mass_kg: self.mass_kg * libm::exp(-mass_flow_s_m * u_w.norm() * dt_s),
        }
    }
}

/// An iterate, its nodes and its measured defects.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    pub iterate: Iterate,
    pub nodes: Vec<Node>,
    /// Target position error, m.
    pub miss_r_w: Vector3<f64>,
    /// Target velocity error, m/s.
    pub miss_v_w: Vector3<f64>,
    /// Σ‖w‖ and the priced impact: what is minimised, m/s (G.44).
    pub cost_m_s: f64,
    /// Largest (h − ‖w‖)/h.
    pub lossless_gap: f64,
    /// Largest excursion of the thrust from its bounds, N.
    pub thrust_violation_n: f64,
    /// Impulse beyond the nominal ceiling and tilt that the reserve covers, m/s.
    pub reserve_m_s: f64,
    /// Largest turn of the thrust beyond its limit, rad (G.97).
    pub turn_excess_rad: f64,
}

impl Trajectory {
    pub fn new(problem: &Problem, grid: &Grid, iterate: Iterate) -> Self {
        let (gravity_w, flow_s_m) = (problem.gravity_w(), problem.mass_flow_s_m());
        let mut node =
            Node { t_s: 0.0, r_w: problem.r0_w, v_w: problem.v0_w, mass_kg: problem.mass_kg };
        let mut nodes = vec![node];
        for (j, w_w) in iterate.w_w.iter().enumerate() {
            let step_s = iterate.step_s[grid.phase_of[j]];
            node = node.advance(step_s, &(w_w / step_s), &gravity_w, flow_s_m);
            nodes.push(node);
        }
        let (mut lossless_gap, mut thrust_violation_n, mut reserve_m_s) = (0.0_f64, 0.0_f64, 0.0);
        for j in grid.burns() {
            let (norm, h) = (iterate.w_w[j].norm(), iterate.h[j]);
            let step_s = iterate.step_s[grid.phase_of[j]];
            let u_m_s2 = norm / step_s;
            lossless_gap = lossless_gap.max((h - norm) / h.max(f64::MIN_POSITIVE));
            // The acceleration is held, so the thrust falls with the mass (G.5).
            thrust_violation_n = thrust_violation_n
                .max(u_m_s2 * nodes[j].mass_kg - problem.thrust_ceiling_n())
                .max(problem.thrust_min_n - u_m_s2 * nodes[j + 1].mass_kg);
            if problem.reserve.is_some() {
                let upright = libm::cos(problem.tilt_limit_rad(j, grid.len()));
                let over_m_s = norm - problem.thrust_max_n / nodes[j].mass_kg * step_s;
                let tilted_m_s = upright * norm - iterate.w_w[j].z;
                reserve_m_s += over_m_s.max(tilted_m_s).max(0.0);
            }
        }
        let delta_v_m_s: f64 = iterate.w_w.iter().map(|w| w.norm()).sum();
        let (miss_r_w, miss_v_w) = problem.miss(&node.r_w, &node.v_w);
        Self {
            miss_r_w,
            miss_v_w,
            cost_m_s: delta_v_m_s + IMPACT_WEIGHT * problem.impact_m_s(&node.v_w),
            lossless_gap,
            thrust_violation_n,
            reserve_m_s,
            turn_excess_rad: turn::excess_rad(problem, grid, &iterate),
            nodes,
            iterate,
        }
    }

    /// Inner nodes more than `tolerance_m` outside the path limits, with the excess in m.
    pub fn path_violations(&self, problem: &Problem, tolerance_m: f64) -> Vec<(usize, f64)> {
        let inner = 1..self.nodes.len() - 1;
        inner
            .map(|n| (n, path_excess_m(problem, &self.nodes[n].r_w)))
            .filter(|&(_, excess_m)| excess_m > tolerance_m)
            .collect()
    }
}

/// How far `r_w` lies outside the path limits, m; negative inside.
pub(super) fn path_excess_m(problem: &Problem, r_w: &Vector3<f64>) -> f64 {
    altitude_excess_m(problem, r_w).max(glide_slope_excess_m(problem, r_w))
}

/// Depth below the minimum altitude, m.
pub(super) fn altitude_excess_m(problem: &Problem, r_w: &Vector3<f64>) -> f64 {
    problem.path.altitude_min_m.map_or(f64::NEG_INFINITY, |z_min_m| z_min_m - r_w.z)
}

/// Horizontal distance outside the glide-slope cone, m (G.7).
pub(super) fn glide_slope_excess_m(problem: &Problem, r_w: &Vector3<f64>) -> f64 {
    problem.path.glide_slope_rad.map_or(f64::NEG_INFINITY, |angle_rad| {
        let to_target_w = r_w - problem.r_f_w;
        to_target_w.xy().norm() - to_target_w.z * libm::tan(angle_rad)
    })
}
