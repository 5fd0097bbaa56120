//! What no flight can do, in closed form: refusals that are proven before anything is solved (G.91-G.93).

use nalgebra::Vector3;

use super::error::PlanError;
use super::problem::{Problem, Terminal};
use super::verify::PATH_EXCESS_MAX_M;

/// Least velocity that a flight to the target takes, and the flight time that takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeastImpulse {
    /// Not above that of any flight, m/s.
    pub delta_v_m_s: f64,
    pub flight_s: f64,
}

/// Refuses a problem that these bounds prove infeasible. What they let pass may be infeasible still.
pub(super) fn check(problem: &Problem, least: Option<&LeastImpulse>) -> Result<(), PlanError> {
    if problem.terminal == Terminal::SoftestImpact {
        return Ok(());
    }
    if let Some((t_s, below_m)) = deepest(problem).filter(|(_, m)| *m > PATH_EXCESS_MAX_M) {
        return Err(PlanError::AltitudeBound { below_m, t_s });
    }
    match least {
        Some(least) if least.delta_v_m_s > problem.delta_v_max_m_s() => {
            let share = -libm::expm1(-problem.mass_flow_s_m() * least.delta_v_m_s);
            let available_kg = problem.mass_kg - problem.dry_mass_kg;
            Err(PlanError::FuelBound { least_kg: problem.mass_kg * share, available_kg })
        }
        _ => Ok(()),
    }
}

/// The least of (G.92) over all flight times, by branch and bound; `None` for a softest impact, or if it was
/// not found within the iterations.
pub(super) fn least_impulse(problem: &Problem) -> Option<LeastImpulse> {
    /// What the least may be too low by, relative: a tenth of what finite burns add.
    const TOLERANCE: f64 = 1e-3;
    const INTERVALS_MAX: usize = 20_000;
    if problem.terminal == Terminal::SoftestImpact {
        return None;
    }
    // Shorter and longer flights take more than twice what is on board.
    let limit_m_s = 2.0 * problem.delta_v_max_m_s() + 1.0;
    let climb_m_s = problem.v0_w.z - problem.v_f_w.z;
    let longest_s = (limit_m_s + climb_m_s) / problem.gravity_m_s2;
    let speed_m_s = problem.v0_w.norm() + problem.gravity_m_s2 * longest_s;
    let distance_m = problem.miss(&problem.r0_w, &problem.v0_w).0.norm();
    let shortest_s = (distance_m / (limit_m_s + speed_m_s)).max(1e-3);
    let mut least = LeastImpulse { delta_v_m_s: limit_m_s, flight_s: longest_s };
    let mut open = Vec::from_iter((longest_s > shortest_s).then_some((shortest_s, longest_s)));
    for _ in 0..INTERVALS_MAX {
        let Some((from_s, to_s)) = open.pop() else {
            least.delta_v_m_s *= 1.0 - TOLERANCE;
            return Some(least);
        };
        let middle_s = (from_s * to_s).sqrt();
        let slack_m_s = distance_m * (1.0 / from_s - 1.0 / middle_s)
            + 0.5 * problem.gravity_m_s2 * (to_s - middle_s);
        let found_m_s = two_impulses(problem, middle_s, 0.0);
        if found_m_s < least.delta_v_m_s {
            least = LeastImpulse { delta_v_m_s: found_m_s, flight_s: middle_s };
        }
        let cut_m_s = (1.0 - TOLERANCE) * least.delta_v_m_s;
        if two_impulses(problem, middle_s, slack_m_s) < cut_m_s {
            open.push((middle_s, to_s));
            open.push((from_s, middle_s));
        }
    }
    None
}

/// (G.92) at one flight time, lessened for moments that are uncertain by `slack_m_s`, m/s; infinite where they
/// leave the tilt cone.
fn two_impulses(problem: &Problem, flight_s: f64, slack_m_s: f64) -> f64 {
    let mean_w = (problem.r_f_w - problem.r0_w) / flight_s;
    let fall_w = problem.gravity_w() * (0.5 * flight_s);
    let first_w = mean_w - problem.v0_w - fall_w;
    let last_w = problem.v_f_w - mean_w - fall_w;
    let (sin, cos) = libm::sincos(problem.tilt_ceiling_rad());
    let least = |w_w: Vector3<f64>, slack_m_s: f64| {
        let outside_m_s = w_w.xy().norm() * cos - w_w.z * sin;
        let inside = outside_m_s <= slack_m_s;
        if inside { (w_w.norm() - slack_m_s).max(0.0) } else { f64::INFINITY }
    };
    match problem.terminal {
        Terminal::Point => least(first_w, slack_m_s) + least(last_w, slack_m_s),
        // The sideways impulse may be spread at will: parallel moments are cheapest.
        _ if first_w.z.min(last_w.z) >= -slack_m_s => least(first_w + last_w, 2.0 * slack_m_s),
        _ => f64::INFINITY,
    }
}

/// Time and depth below the minimum altitude, s and m, where full thrust straight up ends the descent (G.93);
/// `None` without such a limit, for a thrust that cannot stop it, or where the propellant runs out before.
fn deepest(problem: &Problem) -> Option<(f64, f64)> {
    let z_min_m = problem.path.altitude_min_m?;
    let thrust_n = problem.thrust_ceiling_n();
    let exhaust_m_s = 1.0 / problem.mass_flow_s_m();
    let flow_kg_s = thrust_n / exhaust_m_s;
    let (m0_kg, g_m_s2) = (problem.mass_kg, problem.gravity_m_s2);
    let burnout_s = (m0_kg - problem.dry_mass_kg) / flow_kg_s;
    let gained_m_s = |t_s: f64| -exhaust_m_s * libm::log1p(-flow_kg_s * t_s / m0_kg) - g_m_s2 * t_s;
    // No flight ends before: up to here it sinks faster than its target velocity.
    let to_gain_m_s = problem.v_f_w.z.min(0.0) - problem.v0_w.z;
    let stops = thrust_n > m0_kg * g_m_s2 && gained_m_s(burnout_s) >= to_gain_m_s;
    if !stops || to_gain_m_s <= 0.0 {
        return None;
    }
    let (mut from_s, mut to_s) = (0.0, burnout_s);
    // The gain rises with time; sixty halvings leave less than a rounding error.
    for _ in 0..60 {
        let middle_s = 0.5 * (from_s + to_s);
        if gained_m_s(middle_s) < to_gain_m_s { from_s = middle_s } else { to_s = middle_s }
    }
    let t_s = to_s;
    let left = 1.0 - flow_kg_s * t_s / m0_kg;
    let lifted_m = exhaust_m_s * (t_s + m0_kg / flow_kg_s * left * libm::log(left));
    let z_m = problem.r0_w.z + problem.v0_w.z * t_s + lifted_m - 0.5 * g_m_s2 * t_s * t_s;
    Some((t_s, z_min_m - z_m))
}
