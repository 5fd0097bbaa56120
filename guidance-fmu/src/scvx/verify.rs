//! Independent check of a plan: Runge-Kutta re-propagation of (G.1)-(G.3) under its thrust law (G.21), and
//! the acceptance limits.

use nalgebra::{SVector, Vector3};

use super::bounds;
use super::error::PlanError;
use super::plan::Plan;
use super::problem::Problem;
use super::structure::Structure;
use super::trajectory::{Node, altitude_excess_m, glide_slope_excess_m};

/// Largest accepted (σ − ‖u‖)/σ.
pub const LOSSLESS_GAP_MAX: f64 = 1e-4;
/// Largest accepted target miss, m and m/s.
pub const MISS_MAX: f64 = 1e-2;
/// Largest accepted thrust excursion relative to the ceiling.
pub const THRUST_EXCURSION_MAX: f64 = 1e-4;
/// Largest accepted excess of the thrust rate over its limit, relative: the masses it is frozen at
/// are far nearer than this.
pub const THRUST_RATE_EXCESS_MAX: f64 = 1e-3;
/// Largest accepted excursion of a node from the path limits, m.
pub const PATH_EXCESS_MAX_M: f64 = 1e-2;
/// Longest Runge-Kutta step, s: its local error is below 1e-9 m for these mass flows.
const STEP_MAX_S: f64 = 0.5;

/// r, v and m.
type State = SVector<f64, 7>;

/// Fills in what a report says about the finished plan alone.
pub(super) fn measure(problem: &Problem, plan: &mut Plan) {
    let end = repropagate(problem, plan);
    let (r_w, v_w) = (end.fixed_rows::<3>(0).into(), end.fixed_rows::<3>(3).into());
    let (miss_r_w, miss_v_w) = problem.miss(&r_w, &v_w);
    let end_kg = plan.nodes.last().map_or(problem.mass_kg, |node| node.mass_kg);
    let (dead_zone_n, thrust_rate_n_s) = (dead_zone_n(problem, plan), thrust_rate_n_s(plan));
    let report = &mut plan.report;
    (report.miss_m, report.miss_m_s) = (miss_r_w.norm(), miss_v_w.norm());
    report.impact_m_s = (v_w - problem.v_f_w).norm();
    report.mass_error_kg = (end_kg - end[6]).abs();
    report.propellant_left_kg = end_kg - problem.dry_mass_kg;
    (report.dead_zone_n, report.thrust_rate_n_s) = (dead_zone_n, thrust_rate_n_s);
}

/// How far the thrust of a burn falls below the floor, N (G.40); it is least where an interval ends.
fn dead_zone_n(problem: &Problem, plan: &Plan) -> f64 {
    let burns = plan.u_w.iter().zip(&plan.nodes[1..]).filter(|(u_w, _)| **u_w != Vector3::zeros());
    burns.map(|(u_w, end)| problem.thrust_min_n - u_w.norm() * end.mass_kg).fold(0.0, f64::max)
}

/// Largest jump of the thrust inside a burn over the length of an interval, N/s (G.42).
fn thrust_rate_n_s(plan: &Plan) -> f64 {
    let mut from = 0;
    let mut largest_n_s = 0.0_f64;
    for phase in &plan.phases {
        let step_s = phase.duration_s / phase.intervals as f64;
        let burn = &plan.u_w[from..from + phase.intervals];
        for (pair, node) in burn.windows(2).zip(&plan.nodes[from + 1..]) {
            largest_n_s = largest_n_s.max(node.mass_kg * (pair[1] - pair[0]).norm() / step_s);
        }
        from += phase.intervals;
    }
    largest_n_s
}

/// End state of the re-propagated plan.
fn repropagate(problem: &Problem, plan: &Plan) -> State {
    let gravity_w = problem.gravity_w();
    let flow_s_m = problem.mass_flow_s_m();
    let mut x = State::zeros();
    x.fixed_rows_mut::<3>(0).copy_from(&problem.r0_w);
    x.fixed_rows_mut::<3>(3).copy_from(&problem.v0_w);
    x[6] = problem.mass_kg;
    for (ends, u_w) in plan.nodes.windows(2).zip(&plan.u_w) {
        let span_s = ends[1].t_s - ends[0].t_s;
        let steps = (span_s / STEP_MAX_S).ceil().max(1.0);
        let step_s = span_s / steps;
        let thrust_w =
            |t_s: f64| u_w * (ends[0].mass_kg * libm::exp(-plan.mass_flow_s_m * u_w.norm() * t_s));
        let rate = |t_s: f64, x: &State| -> State {
            let thrust_w: Vector3<f64> = thrust_w(t_s);
            let mut dx = State::zeros();
            dx.fixed_rows_mut::<3>(0).copy_from(&x.fixed_rows::<3>(3));
            dx.fixed_rows_mut::<3>(3).copy_from(&(thrust_w / x[6] + gravity_w));
            dx[6] = -thrust_w.norm() * flow_s_m;
            dx
        };
        for k in 0..steps as usize {
            let t_s = k as f64 * step_s;
            let half_s = 0.5 * step_s;
            let k1 = rate(t_s, &x);
            let k2 = rate(t_s + half_s, &(x + k1 * half_s));
            let k3 = rate(t_s + half_s, &(x + k2 * half_s));
            let k4 = rate(t_s + step_s, &(x + k3 * step_s));
            x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (step_s / 6.0);
        }
    }
    x
}

/// Refuses a problem that starts outside its path limits.
pub(super) fn initial_path(problem: &Problem) -> Result<(), PlanError> {
    path_at(problem, 0.0, &problem.r0_w)
}

/// Refuses nodes outside the path limits; the last node is the target's business.
pub(super) fn path(problem: &Problem, nodes: &[Node]) -> Result<(), PlanError> {
    nodes[..nodes.len() - 1].iter().try_for_each(|node| path_at(problem, node.t_s, &node.r_w))
}

fn path_at(problem: &Problem, t_s: f64, r_w: &Vector3<f64>) -> Result<(), PlanError> {
    let below_m = altitude_excess_m(problem, r_w);
    if below_m > PATH_EXCESS_MAX_M {
        return Err(PlanError::Altitude { below_m, t_s });
    }
    let outside_m = glide_slope_excess_m(problem, r_w);
    if outside_m > PATH_EXCESS_MAX_M {
        return Err(PlanError::GlideSlope { outside_m, t_s });
    }
    Ok(())
}

/// Refuses a plan that misses its target, is not lossless, or leaves its thrust or fuel limits.
pub(super) fn accept(problem: &Problem, plan: &Plan) -> Result<(), PlanError> {
    let report = &plan.report;
    if report.miss_m > MISS_MAX || report.miss_m_s > MISS_MAX {
        return Err(out_of_reach(problem, plan));
    }
    // Without a floor any ‖u‖ below σ is allowed, and σ is free where the engine idles.
    if problem.thrust_min_n > 0.0 && report.lossless_gap > LOSSLESS_GAP_MAX {
        return Err(PlanError::NotLossless { gap: report.lossless_gap, limit: LOSSLESS_GAP_MAX });
    }
    let limit_n = THRUST_EXCURSION_MAX * problem.thrust_max_n;
    if report.thrust_violation_n > limit_n {
        return Err(PlanError::Thrust { violation_n: report.thrust_violation_n, limit_n });
    }
    let rate_max_n_s = problem.thrust_rate_max_n_s.unwrap_or(f64::INFINITY);
    if report.thrust_rate_n_s > (1.0 + THRUST_RATE_EXCESS_MAX) * rate_max_n_s {
        let rate_n_s = report.thrust_rate_n_s;
        return Err(PlanError::ThrustRate { rate_n_s, limit_n_s: rate_max_n_s });
    }
    let (needed_kg, available_kg) = (plan.propellant_kg(), problem.mass_kg - problem.dry_mass_kg);
    if needed_kg > available_kg {
        return Err(PlanError::Fuel { needed_kg, available_kg });
    }
    Ok(())
}

/// Why the target is missed: a plan without a coast that clings to the floor, which lifts the vehicle at any allowed
/// tilt (G.102) or may do so, or limits that are too tight in some other way.
fn out_of_reach(problem: &Problem, plan: &Plan) -> PlanError {
    let (miss_m, miss_m_s) = (plan.report.miss_m, plan.report.miss_m_s);
    let thrusts_n = plan.nodes.iter().map(|node| plan.sample(node.t_s).thrust_n);
    let mean_n = thrusts_n.sum::<f64>() / plan.nodes.len() as f64;
    let near_floor = mean_n < 0.5 * (problem.thrust_min_n + problem.thrust_max_n);
    if plan.structure == Structure::On && problem.thrust_min_n > 0.0 && near_floor {
        let undecided = PlanError::Floor { miss_m, miss_m_s };
        bounds::lifted_at_rest(problem).err().unwrap_or(undecided)
    } else {
        PlanError::Target { miss_m, miss_m_s }
    }
}
