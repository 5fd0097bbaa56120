//! What no flight can do, in closed form: refusals that are proven before anything is solved (G.91-G.93, G.102).

use nalgebra::Vector3;

use super::error::PlanError;
use super::problem::{Problem, Terminal};
use super::propulsion::Propulsion;
use super::verify::{MISS_MAX, PATH_EXCESS_MAX_M};

/// Least velocity that a flight to the target takes, and the flight time that takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeastImpulse {
    /// Not above that of any flight, m/s.
    pub delta_v_m_s: f64,
    pub flight_s: f64,
}

/// Refuses a problem that closed forms prove infeasible, in 10 µs: more propellant than is on board for the cheapest two impulses
/// (G.92), below the minimum altitude at full thrust straight up (G.93), above the target at the floor of an engine that
/// never stops (G.102). What they let pass may be infeasible still.
///
/// # Errors
/// The proof: `PlanError::FuelBound`, `AltitudeBound` or `Tilt`; `Input` for numbers that are none.
pub fn disprove(problem: &Problem) -> Result<(), PlanError> {
    problem.validate()?;
    check(problem, least_impulse(problem).as_ref())
}

/// As [`disprove`], with what (G.92) gave.
pub(super) fn check(problem: &Problem, least: Option<&LeastImpulse>) -> Result<(), PlanError> {
    if problem.terminal == Terminal::SoftestImpact {
        return Ok(());
    }
    if let Some((t_s, below_m)) = deepest(problem).filter(|(_, m)| *m > PATH_EXCESS_MAX_M) {
        return Err(PlanError::AltitudeBound { below_m, t_s });
    }
    if problem.propulsion == Propulsion::AlwaysOn {
        lifted_at_rest(problem)?;
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

/// Refuses a flight without a coast that the floor ends too high (G.102).
pub(super) fn lifted_at_rest(problem: &Problem) -> Result<(), PlanError> {
    match least_height(problem).filter(|(_, above_m)| *above_m > MISS_MAX) {
        Some((t_s, above_m)) => {
            Err(PlanError::Tilt { tilt_max_rad: problem.tilt_ceiling_rad(), above_m, t_s })
        }
        None => Ok(()),
    }
}

/// A constant thrust at a constant tilt, from the problem's start: what it does vertically.
struct Burn {
    lift_n: f64,
    flow_kg_s: f64,
    mass_kg: f64,
    gravity_m_s2: f64,
    burnout_s: f64,
}

impl Burn {
    fn new(problem: &Problem, thrust_n: f64, tilt_rad: f64) -> Self {
        let flow_kg_s = problem.mass_flow_s_m() * thrust_n;
        Self {
            lift_n: thrust_n * libm::cos(tilt_rad),
            flow_kg_s,
            mass_kg: problem.mass_kg,
            gravity_m_s2: problem.gravity_m_s2,
            burnout_s: (problem.mass_kg - problem.dry_mass_kg) / flow_kg_s,
        }
    }

    /// Upward velocity gained, m/s.
    fn gained_m_s(&self, t_s: f64) -> f64 {
        let log = libm::log1p(-self.flow_kg_s * t_s / self.mass_kg);
        -self.lift_n / self.flow_kg_s * log - self.gravity_m_s2 * t_s
    }

    /// Height gained, but for the start's velocity, m.
    fn lifted_m(&self, t_s: f64) -> f64 {
        let left = 1.0 - self.flow_kg_s * t_s / self.mass_kg;
        let braked_s = t_s + self.mass_kg / self.flow_kg_s * left * libm::log(left);
        self.lift_n / self.flow_kg_s * braked_s - 0.5 * self.gravity_m_s2 * t_s * t_s
    }

    /// When it has gained so much after `from_s`, since when the gain rises; at burn-out if it never has, s.
    fn gains_s(&self, velocity_m_s: f64, from_s: f64) -> f64 {
        let (mut from_s, mut to_s) = (from_s, self.burnout_s);
        // Sixty halvings leave less than a rounding error.
        for _ in 0..60 {
            let middle_s = 0.5 * (from_s + to_s);
            if self.gained_m_s(middle_s) < velocity_m_s {
                from_s = middle_s;
            } else {
                to_s = middle_s;
            }
        }
        to_s
    }
}

/// Time and depth below the minimum altitude, s and m, where full thrust straight up ends the descent (G.93);
/// `None` without such a limit, for a thrust that cannot stop it, or where the propellant runs out before.
fn deepest(problem: &Problem) -> Option<(f64, f64)> {
    let z_min_m = problem.path.altitude_min_m?;
    let burn = Burn::new(problem, problem.thrust_ceiling_n(), 0.0);
    // No flight ends before: up to here it sinks faster than its target velocity.
    let to_gain_m_s = problem.v_f_w.z.min(0.0) - problem.v0_w.z;
    let lifts = burn.lift_n > problem.mass_kg * problem.gravity_m_s2;
    let stops = lifts && burn.gained_m_s(burn.burnout_s) >= to_gain_m_s;
    if !stops || to_gain_m_s <= 0.0 {
        return None;
    }
    let t_s = burn.gains_s(to_gain_m_s, 0.0);
    Some((t_s, z_min_m - height_m(problem, &burn, t_s)))
}

/// Time and height above the target, s and m, of the lowest that an engine which never stops can be at no more than the
/// target's velocity (G.102); `None` without a floor, and for a target that is met rising.
fn least_height(problem: &Problem) -> Option<(f64, f64)> {
    if problem.thrust_min_n <= 0.0 || problem.v_f_w.z > 0.0 {
        return None;
    }
    let burn = Burn::new(problem, problem.thrust_min_n, problem.tilt_ceiling_rad());
    // Until then it does not lift its own weight: the velocity falls, and rises afterwards.
    let heavy_kg = problem.mass_kg - burn.lift_n / problem.gravity_m_s2;
    let lifts_s = (heavy_kg / burn.flow_kg_s).clamp(0.0, burn.burnout_s);
    let t_s = burn.gains_s(problem.v_f_w.z - problem.v0_w.z, lifts_s);
    Some((t_s, height_m(problem, &burn, t_s) - problem.r_f_w.z))
}

/// Height at `t_s` into a burn, m.
fn height_m(problem: &Problem, burn: &Burn, t_s: f64) -> f64 {
    problem.r0_w.z + problem.v0_w.z * t_s + burn.lifted_m(t_s)
}
