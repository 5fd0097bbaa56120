//! Restoration: the exact flight of a subproblem's solution brought back to its target (G.94).

use nalgebra::{Matrix6, Vector3, Vector6};

use super::problem::{Problem, Terminal};
use super::structure::Grid;
use super::trajectory::{Iterate, Trajectory};

/// Newton steps; each leaves about the square of the relative miss.
const STEPS_MAX: usize = 3;
/// Miss that needs no further step, m and m/s: a thousandth of what a plan may have when it ends the loop.
pub(super) const MISS_MET: f64 = 1e-7;
/// Largest relative change of a duration or a thrust, and turn of a thrust, rad, in one step: the square of it
/// is what the linearisation leaves out. From 0.02 to 0.1 400 plans from about
/// the reference descents take as many solves within 1 %.
const CHANGE_MAX: f64 = 0.05;
/// Distance from a bound, relative or rad, within which a thrust or a duration stays on it. From 1e-4, the root of the
/// conic tolerance, to 1e-2 400 plans from about the reference descents take as many solves within 1 %.
const ON_BOUND: f64 = 1e-3;

/// `solved` with its thrusts on their bounds at the masses flown, and then with the least change of durations,
/// of thrusts inside their bounds and of directions inside the tilt limit that meets the target. `None` where
/// that brings it no nearer, and for problems with limits that the change does not heed.
pub(super) fn restore(problem: &Problem, grid: &Grid, solved: &Trajectory) -> Option<Trajectory> {
    if problem.thrust_rate_max_n_s.is_some() || problem.terminal == Terminal::SoftestImpact {
        return None;
    }
    let fly = |iterate: &Iterate| Trajectory::new(problem, grid, bounded(problem, grid, iterate));
    let mut flown = fly(&solved.iterate);
    for _ in 0..STEPS_MAX {
        if miss(&flown) <= MISS_MET {
            break;
        }
        let next = fly(&least_change(problem, grid, &flown)?);
        if miss(&next) >= miss(&flown) {
            break;
        }
        flown = next;
    }
    (miss(&flown) < miss(solved)).then_some(flown)
}

fn miss(trajectory: &Trajectory) -> f64 {
    trajectory.miss_r_w.norm().max(trajectory.miss_v_w.norm())
}

/// Thrusts out of their bounds, which the subproblem took at other masses, are put on them. What is more than slightly
/// above the nominal ceiling draws on the reserve; what is far below the floor is not lossless, and is left so.
fn bounded(problem: &Problem, grid: &Grid, iterate: &Iterate) -> Iterate {
    let mut bounded = iterate.clone();
    let flow_s_m = problem.mass_flow_s_m();
    let mut mass_kg = problem.mass_kg;
    for j in grid.burns() {
        let impulse_m_s = iterate.w_w[j].norm();
        let thrust_n = impulse_m_s / iterate.step_s[grid.phase_of[j]] * mass_kg;
        // The acceleration is held: the thrust is least at the end.
        let floor_n = problem.thrust_min_n * libm::exp(flow_s_m * impulse_m_s);
        let near = |bound_n: f64| (thrust_n / bound_n - 1.0).abs() < ON_BOUND;
        let bound_n = if thrust_n > problem.thrust_max_n && near(problem.thrust_max_n) {
            problem.thrust_max_n
        } else if thrust_n < floor_n && near(floor_n) {
            floor_n
        } else {
            thrust_n.min(problem.thrust_ceiling_n())
        };
        if thrust_n > 0.0 {
            bounded.w_w[j] *= bound_n / thrust_n;
            bounded.h[j] *= bound_n / thrust_n;
        }
        mass_kg *= libm::exp(-flow_s_m * bounded.w_w[j].norm());
    }
    bounded
}

/// One way to change an iterate, by a relative change or an angle in rad.
#[derive(Debug)]
pub(super) enum Freedom {
    /// Length of a phase, at its thrust accelerations.
    Duration { phase: usize },
    /// Thrust of an interval.
    Throttle { interval: usize },
    /// Direction of an interval's thrust, towards a unit vector normal to it.
    Turn { interval: usize, towards_w: Vector3<f64> },
}

/// Newton step of least norm to the target; `None` where none that is small meets it.
fn least_change(problem: &Problem, grid: &Grid, flown: &Trajectory) -> Option<Iterate> {
    let freedoms = freedoms(problem, grid, flown);
    let slopes: Vec<Vector6<f64>> =
        freedoms.iter().map(|freedom| slope(problem, grid, flown, freedom)).collect();
    let mut normal: Matrix6<f64> = slopes.iter().map(|slope| slope * slope.transpose()).sum();
    if problem.terminal == Terminal::Anywhere {
        // No slope leads there: the rows stand for themselves.
        (normal[(0, 0)], normal[(1, 1)]) = (1.0, 1.0);
    }
    let miss = scaled(flown, &flown.miss_r_w, &flown.miss_v_w);
    let multipliers = normal.cholesky()?.solve(&miss);
    let mut iterate = flown.iterate.clone();
    for (freedom, slope) in freedoms.iter().zip(&slopes) {
        let change = -slope.dot(&multipliers);
        if !(-CHANGE_MAX..=CHANGE_MAX).contains(&change) {
            return None;
        }
        freedom.apply(grid, &mut iterate, change);
    }
    Some(iterate)
}

impl Freedom {
    pub(super) fn apply(&self, grid: &Grid, iterate: &mut Iterate, change: f64) {
        let mut stretch = |interval: usize| {
            iterate.w_w[interval] *= 1.0 + change;
            iterate.h[interval] *= 1.0 + change;
        };
        match *self {
            Self::Throttle { interval } => stretch(interval),
            Self::Duration { phase } => {
                (0..grid.len()).filter(|&j| grid.phase_of[j] == phase).for_each(stretch);
                iterate.step_s[phase] *= 1.0 + change;
            }
            Self::Turn { interval, towards_w } => {
                let impulse_m_s = iterate.w_w[interval].norm();
                let turned_w = iterate.w_w[interval] + towards_w * (change * impulse_m_s);
                iterate.w_w[interval] = turned_w * (impulse_m_s / turned_w.norm());
            }
        }
    }
}

/// What `flown` may change without leaving a bound that it is on.
pub(super) fn freedoms(problem: &Problem, grid: &Grid, flown: &Trajectory) -> Vec<Freedom> {
    let Iterate { step_s, w_w, .. } = &flown.iterate;
    let free = |&phase: &usize| step_s[phase] > grid.phases[phase].step_min_s * (1.0 + ON_BOUND);
    let phases = (0..grid.phases.len()).filter(free);
    let mut freedoms: Vec<_> = phases.map(|phase| Freedom::Duration { phase }).collect();
    for j in grid.burns() {
        let impulse_m_s = w_w[j].norm();
        if impulse_m_s == 0.0 {
            continue;
        }
        let direction_w = w_w[j] / impulse_m_s;
        let thrust_n =
            |node: usize| impulse_m_s / step_s[grid.phase_of[j]] * flown.nodes[node].mass_kg;
        if thrust_n(j) < problem.thrust_max_n * (1.0 - ON_BOUND)
            && thrust_n(j + 1) > problem.thrust_min_n * (1.0 + ON_BOUND)
        {
            freedoms.push(Freedom::Throttle { interval: j });
        }
        let level_w =
            Vector3::z().cross(&direction_w).try_normalize(0.0).unwrap_or_else(Vector3::x);
        freedoms.push(Freedom::Turn { interval: j, towards_w: level_w });
        let tilt_rad = libm::atan2(direction_w.xy().norm(), direction_w.z);
        let limits_rad = [problem.tilt_limit_rad(j, grid.len()), problem.tilt_ceiling_rad()];
        if limits_rad.iter().all(|limit_rad| (tilt_rad - limit_rad).abs() > ON_BOUND) {
            let towards_w = direction_w.cross(&level_w);
            freedoms.push(Freedom::Turn { interval: j, towards_w });
        }
    }
    freedoms
}

/// Change of the scaled end state per unit of a freedom (G.4).
pub(super) fn slope(
    problem: &Problem,
    grid: &Grid,
    flown: &Trajectory,
    freedom: &Freedom,
) -> Vector6<f64> {
    let Iterate { step_s, w_w, .. } = &flown.iterate;
    let end_s = flown.nodes[grid.len()].t_s;
    // An impulse acts from the middle of its interval.
    let lever_s = |j: usize| end_s - flown.nodes[j].t_s - 0.5 * step_s[grid.phase_of[j]];
    let impulse = |j: usize, w_w: Vector3<f64>| (w_w * lever_s(j), w_w);
    let (r_w, v_w) = match *freedom {
        Freedom::Throttle { interval } => impulse(interval, w_w[interval]),
        Freedom::Turn { interval, towards_w } => {
            impulse(interval, towards_w * w_w[interval].norm())
        }
        Freedom::Duration { phase } => {
            let gravity_w = problem.gravity_w();
            let longer_s = step_s[phase] * grid.phases[phase].intervals as f64;
            let mut r_w = (problem.v0_w + gravity_w * end_s) * longer_s;
            let mut v_w = gravity_w * longer_s;
            let mut ahead_s = longer_s;
            for (j, w_w) in w_w.iter().enumerate() {
                if grid.phase_of[j] == phase {
                    let (stretched_r_w, stretched_v_w) = impulse(j, *w_w);
                    r_w += stretched_r_w + w_w * (ahead_s - 0.5 * step_s[phase]);
                    v_w += stretched_v_w;
                    ahead_s -= step_s[phase];
                } else {
                    r_w += w_w * ahead_s;
                }
            }
            (r_w, v_w)
        }
    };
    match problem.terminal {
        Terminal::Anywhere => scaled(flown, &(Vector3::z() * r_w.z), &v_w),
        _ => scaled(flown, &r_w, &v_w),
    }
}

/// Positions in the flight's own speeds, m/s.
fn scaled(flown: &Trajectory, r_w: &Vector3<f64>, v_w: &Vector3<f64>) -> Vector6<f64> {
    let r_m_s = r_w / flown.nodes[flown.nodes.len() - 1].t_s;
    Vector6::new(r_m_s.x, r_m_s.y, r_m_s.z, v_w.x, v_w.y, v_w.z)
}
