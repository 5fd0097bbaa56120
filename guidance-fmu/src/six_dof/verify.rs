//! Independent check of a plan: a fine Runge-Kutta flight under its controls, written apart from the
//! shooting, and the acceptance limits (G.79).

use lander_models::vehicle::G0_M_S2;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::dynamics::{Q, R, State, V, W};
use super::error::SixDofError;
use super::excess::Excess;
use super::plan::{SixDofControl, SixDofNode, SixDofPlan};
use super::problem::SixDofProblem;

/// Largest accepted miss of the re-propagated end: m, m/s, rad, rad/s.
pub const MISS_MAX: [f64; 4] = [1e-2, 1e-2, 1.745e-3, 1.745e-3];
/// Largest accepted excess at a node, relative to the limit.
pub const NODE_EXCESS_MAX: f64 = 1e-4;
/// Largest accepted excess of the re-propagated tilt, rad, and of its body rate, relative to the limit.
const BETWEEN_TILT_MAX_RAD: f64 = 1.745e-3;
const BETWEEN_RATE_MAX: f64 = 1e-2;
/// The same of the glide slope, m.
const BETWEEN_GLIDE_SLOPE_MAX_M: f64 = 0.1;
/// Longest step, s, in a burn and in a coast: a tenth of the shooting's.
const STEP_MAX_S: [f64; 2] = [0.01, 0.05];

/// What the independent flight of a plan shows.
pub(super) struct Flown {
    pub end: SixDofNode,
    /// Of each interval.
    pub excesses: Vec<Excess>,
}

/// Flies `plan` from its first node.
pub(super) fn fly(problem: &SixDofProblem, plan: &SixDofPlan) -> Flown {
    let start = &plan.nodes[0];
    let mut x = State::zeros();
    x[0] = start.mass_kg;
    x.fixed_rows_mut::<3>(R).copy_from(&start.r_w);
    x.fixed_rows_mut::<3>(V).copy_from(&start.v_w);
    x.fixed_rows_mut::<4>(Q).copy_from(&super::guess::wxyz(&start.attitude_wb));
    x.fixed_rows_mut::<3>(W).copy_from(&start.rate_b);
    let mut excesses = Vec::new();
    for (n, phase) in plan.phases.iter().enumerate() {
        let length_s = phase.duration_s / phase.intervals as f64;
        let steps = (length_s / STEP_MAX_S[usize::from(!phase.powered)]).ceil().max(1.0) as usize;
        let h = length_s / steps as f64;
        for k in 0..phase.intervals {
            let ends = [&plan.controls[n][k], &plan.controls[n][k + 1]];
            let mut excess = Excess::default();
            let at_s = phase.start_s + k as f64 * length_s;
            for j in 0..steps {
                let t_s = at_s + j as f64 * h;
                let u = |ahead_s: f64| plan.control_in(n, t_s + ahead_s);
                let k1 = rate(problem, &x, &u(0.0));
                let k2 = rate(problem, &(x + k1 * (0.5 * h)), &u(0.5 * h));
                let k3 = rate(problem, &(x + k2 * (0.5 * h)), &u(0.5 * h));
                let k4 = rate(problem, &(x + k3 * h), &u(h));
                x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
                excess.see_state(problem, &SixDofNode::new(t_s + h, &x));
                excess.see_control(problem, &u(h), phase.powered);
            }
            if phase.powered {
                excess.see_rates(problem, ends, length_s);
            }
            excesses.push(excess);
        }
    }
    Flown { end: SixDofNode::new(plan.duration_s(), &x), excesses }
}

/// x' by rotation of vectors and a solved Euler equation; of the shooting's code it shares only
/// the vehicle's mass model.
fn rate(problem: &SixDofProblem, x: &State, u: &SixDofControl) -> State {
    let q = Quaternion::new(x[Q], x[Q + 1], x[Q + 2], x[Q + 3]);
    let rate_b: Vector3<f64> = x.fixed_rows::<3>(W).into();
    let body = problem.mass.at(x[0] - problem.mass.dry.mass_kg);
    let thrust_b = u.thrust_b();
    let lift_w = UnitQuaternion::from_quaternion(q) * thrust_b / x[0];
    let gravity_w = Vector3::new(0.0, 0.0, -problem.gravity_m_s2);
    let engine_b = (problem.actuators.pivot_b - body.com_b).cross(&thrust_b);
    let moment_b = engine_b + u.torque_b - rate_b.cross(&(body.inertia_b * rate_b));
    // An inertia that is not positive definite gives no turn, and so a miss that is refused.
    let turn_b = body.inertia_b.cholesky().map_or_else(Vector3::zeros, |j| j.solve(&moment_b));
    let spin = (q * Quaternion::from_imag(rate_b)).coords * 0.5;
    let mut dx = State::zeros();
    dx[0] = -thrust_b.norm() / (problem.actuators.isp_s * G0_M_S2);
    dx.fixed_rows_mut::<3>(R).copy_from(&x.fixed_rows::<3>(V));
    dx.fixed_rows_mut::<3>(V).copy_from(&(lift_w + gravity_w));
    // nalgebra stores (x, y, z, w).
    dx.fixed_rows_mut::<4>(Q).copy_from_slice(&[spin.w, spin.x, spin.y, spin.z]);
    dx.fixed_rows_mut::<3>(W).copy_from(&turn_b);
    dx
}

/// Limits at the nodes as planned.
pub(super) fn at_nodes(problem: &SixDofProblem, plan: &SixDofPlan) -> Excess {
    let mut excess = Excess::default();
    plan.nodes[1..].iter().for_each(|node| excess.see_state(problem, node));
    for (phase, controls) in plan.phases.iter().zip(&plan.controls) {
        controls.iter().for_each(|u| excess.see_control(problem, u, phase.powered));
        if phase.powered {
            let length_s = phase.duration_s / phase.intervals as f64;
            for ends in controls.windows(2) {
                excess.see_rates(problem, [&ends[0], &ends[1]], length_s);
            }
        }
    }
    excess
}

/// Largest accepted excess anywhere on the flight.
pub(super) struct BetweenNodes {
    pub tilt_rad: f64,
    pub rate_rad_s: f64,
    pub glide_slope_m: f64,
}

impl BetweenNodes {
    pub fn new(problem: &SixDofProblem) -> Self {
        Self {
            tilt_rad: BETWEEN_TILT_MAX_RAD,
            rate_rad_s: BETWEEN_RATE_MAX * problem.limits.rate_max_rad_s,
            glide_slope_m: BETWEEN_GLIDE_SLOPE_MAX_M,
        }
    }
}

/// Refuses a plan that misses its end, leaves a limit at a node, or needs too much propellant.
pub(super) fn accept(problem: &SixDofProblem, plan: &SixDofPlan) -> Result<(), SixDofError> {
    let report = &plan.report;
    let miss = [report.miss_m, report.miss_m_s, report.miss_rad, report.miss_rad_s];
    // Written so that a NaN is a miss.
    if !miss.iter().zip(MISS_MAX).all(|(miss, limit)| *miss <= limit) {
        let [miss_m, miss_m_s, miss_rad, miss_rad_s] = miss;
        return Err(SixDofError::Target { miss_m, miss_m_s, miss_rad, miss_rad_s });
    }
    let (between, flown) = (BetweenNodes::new(problem), &report.between_nodes);
    for (limit, excess, allowed) in [
        ("tilt between nodes", flown.tilt_rad, between.tilt_rad),
        ("body rate between nodes", flown.rate_rad_s, between.rate_rad_s),
        ("glide slope between nodes", flown.glide_slope_m, between.glide_slope_m),
    ] {
        if excess > allowed {
            return Err(SixDofError::Limit { limit, excess, allowed });
        }
    }
    let (nodes, actuators, limits) = (&report.at_nodes, &problem.actuators, &problem.limits);
    for (limit, excess, size) in [
        ("tilt", nodes.tilt_rad, limits.tilt_max_rad),
        ("body rate", nodes.rate_rad_s, limits.rate_max_rad_s),
        ("glide slope", nodes.glide_slope_m, (problem.start.r_w - problem.r_f_w).norm()),
        ("thrust", nodes.thrust_n, actuators.thrust_max_n),
        ("gimbal angle", nodes.gimbal_rad, actuators.gimbal_max_rad),
        ("thrust rate", nodes.thrust_rate_n_s, actuators.thrust_rate_max_n_s),
        ("gimbal rate", nodes.gimbal_rate_rad_s, actuators.gimbal_rate_max_rad_s),
        ("thruster torque", nodes.torque_nm, actuators.torque_max_b.max().max(1.0)),
    ] {
        let allowed = NODE_EXCESS_MAX * size;
        if excess > allowed {
            return Err(SixDofError::Limit { limit, excess, allowed });
        }
    }
    let (needed_kg, available_kg) = (plan.propellant_kg(), problem.start.propellant_kg);
    if needed_kg > available_kg {
        return Err(SixDofError::Fuel { needed_kg, available_kg });
    }
    Ok(())
}
