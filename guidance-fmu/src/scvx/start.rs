//! Starting points of the outer loop: a minimum-energy guess, the switching structure of a relaxed
//! solve, and the remainder of an earlier plan.

use std::ops::Range;

use nalgebra::Vector3;

use super::bounds;
use super::plan::{Phase, Plan};
use super::problem::{Problem, Settings, Terminal};
use super::propulsion::PHASE_REMAINDER_MIN_S;
use super::structure::{Grid, Structure};
use super::trajectory::{Iterate, Trajectory};
use lander_models::math::square;

/// Mean thrust over the ceiling above which a relaxed interval counts as part of a burn.
const RUNNING_SHARE: f64 = 0.1;
/// A burn of a relaxed solve shorter than this is none, s.
const RELAXED_BURN_MIN_S: f64 = 0.1;

/// Minimum-energy guess on a single burn (G.19), with the cheapest of a few flight times.
pub(super) fn minimum_energy(problem: &Problem, grid: &Grid) -> Iterate {
    cheapest(problem, grid, 7, |guess| guess.h.iter().sum())
}

/// Minimum-energy guess (G.19) on a flight a third longer than two impulses would like it: finite burns begin
/// earlier and end later, and a flight too long converges where one too short dips below the ground.
pub(super) fn finite_burns(problem: &Problem, grid: &Grid, impulsive_s: f64) -> Iterate {
    minimum_energy_at(problem, grid, impulsive_s * 4.0 / 3.0)
}

/// Minimum-energy guess for an engine that never stops: the flight time that is cheapest with the
/// thrust raised to its floor and the upward impulse to what the tilt limit makes of it (G.46).
fn always_on(problem: &Problem, grid: &Grid) -> Iterate {
    /// Price of upward impulse that is not wanted, against Δv: no flight can have it.
    const UPWARD_WEIGHT: f64 = 2.0;
    let floor_m_s2 = problem.thrust_min_n / problem.mass_kg;
    cheapest(problem, grid, 33, |guess| {
        let raised = guess.w_w.iter().map(|w| (w.norm().max(floor_m_s2 * guess.step_s[0]), w.z));
        let upward = |h: f64, w_z: f64| (libm::cos(problem.tilt_max_rad) * h - w_z).max(0.0);
        raised.map(|(h, w_z)| h + UPWARD_WEIGHT * upward(h, w_z)).sum()
    })
}

/// A guess for an engine that never stops: (G.46), leaning to and fro if upright the floor would lift it (G.101). About
/// upright impulses no sideways one changes the magnitude in first order, so no step would ever lean.
pub(super) fn never_off(problem: &Problem, grid: &Grid) -> Iterate {
    /// Lean of the tilt limit.
    const SHARE: f64 = 0.7;
    /// Sideways against upward, below which the guess stands upright.
    const UPRIGHT: f64 = 1e-3;
    let guess = always_on(problem, grid);
    let upright = Problem { tilt_max_rad: 0.0, reserve: None, ..problem.clone() };
    let leans = guess.w_w.iter().any(|w| w.xy().norm() > UPRIGHT * w.z.abs());
    if leans || bounds::lifted_at_rest(&upright).is_ok() {
        return guess;
    }
    let sideways = libm::tan(SHARE * problem.tilt_max_rad);
    let count = guess.w_w.len();
    // Quarters +, -, -, +: neither a change of velocity nor, with equal impulses, of position.
    let sense = |j: usize| if (1..3).contains(&(4 * j / count)) { -1.0 } else { 1.0 };
    let lean = |(j, w): (usize, &Vector3<f64>)| w + Vector3::x() * (sense(j) * sideways * w.z);
    let w_w = guess.w_w.iter().enumerate().map(lean).collect();
    Iterate::lossless(guess.step_s, w_w)
}

/// The guess (G.19) of least `price` among `count` flight times.
fn cheapest(
    problem: &Problem,
    grid: &Grid,
    count: i32,
    price: impl Fn(&Iterate) -> f64,
) -> Iterate {
    /// Flight times tried, against the larger of the ballistic and the braking time: in a geometric
    /// sequence, half of it the shortest.
    const SHORTEST: f64 = 0.5;
    const LONGEST: f64 = 4.0;
    let range_m = (problem.r0_w - problem.r_f_w).norm();
    let unit_s = fall_s(problem).max((2.0 * range_m / problem.gravity_m_s2).sqrt()).max(1.0);
    let ratio = libm::pow(LONGEST / SHORTEST, 1.0 / f64::from(count - 1));
    let guess =
        |k| minimum_energy_at(problem, grid, SHORTEST * libm::pow(ratio, f64::from(k)) * unit_s);
    let rest = (1..count).map(guess);
    let priced = rest.fold((price(&guess(0)), guess(0)), |(least, best), guess| {
        let found = price(&guess);
        if found < least { (found, guess) } else { (least, best) }
    });
    priced.1
}

/// Time to the target's height without thrust, s.
fn fall_s(problem: &Problem) -> f64 {
    let drop_m = (problem.r0_w.z - problem.r_f_w.z).max(0.0);
    let [rise_m_s, g_m_s2] = [problem.v0_w.z, problem.gravity_m_s2];
    (rise_m_s + (rise_m_s * rise_m_s + 2.0 * g_m_s2 * drop_m).sqrt()) / g_m_s2
}

/// Minimum-energy guess on the shortest flight whose sideways impulse the tilt limit allows (G.41):
/// long enough to climb while the sideways speed is turned round.
pub(super) fn climb(problem: &Problem, grid: &Grid) -> Iterate {
    /// Room for the impulse's distribution in time.
    const SHARE: f64 = 0.9;
    const GROWTH: f64 = 1.25;
    const TRIES: i32 = 30;
    let unit_s = (problem.v0_w - problem.v_f_w).norm() / problem.gravity_m_s2;
    let per_upward = SHARE * libm::tan(problem.tilt_max_rad);
    let guesses = (0..TRIES)
        .map(|k| minimum_energy_at(problem, grid, 0.1 * unit_s * libm::pow(GROWTH, f64::from(k))));
    let mut longest = None;
    for guess in guesses {
        let sideways_m_s: f64 = guess.w_w.iter().map(|w| w.xy().norm()).sum();
        let upward_m_s: f64 = guess.w_w.iter().map(|w| w.z).sum();
        longest = Some(guess);
        if sideways_m_s <= per_upward * upward_m_s {
            break;
        }
    }
    longest.unwrap_or_else(|| minimum_energy(problem, grid))
}

/// Thrust acceleration linear in time that meets both end states at `t_f_s` (G.19).
fn minimum_energy_at(problem: &Problem, grid: &Grid, t_f_s: f64) -> Iterate {
    let dv_w = problem.v_f_w - problem.v0_w;
    let mut dr_w = problem.r_f_w - problem.r0_w - problem.v0_w * t_f_s;
    if problem.terminal != Terminal::Point {
        // Where the position is free, the constant acceleration of b = 0.
        (dr_w.x, dr_w.y) = (0.5 * dv_w.x * t_f_s, 0.5 * dv_w.y * t_f_s);
    }
    let a_w = dr_w * (6.0 / square(t_f_s)) - dv_w * (2.0 / t_f_s);
    let b_w = dv_w * (6.0 / square(t_f_s)) - dr_w * (12.0 / (square(t_f_s) * t_f_s));
    let step_s = t_f_s / grid.len() as f64;
    let impulse = |j| (a_w + b_w * ((j as f64 + 0.5) * step_s) - problem.gravity_w()) * step_s;
    Iterate::lossless(vec![step_s], (0..grid.len()).map(impulse).collect())
}

/// First and last burn of a relaxed solve.
struct Burns {
    /// Impulse, m/s, and length at the ceiling, s.
    first: (Vector3<f64>, f64),
    last: (Vector3<f64>, f64),
    flight_s: f64,
    /// Whether the first burn lasts for the whole flight.
    whole: bool,
}

fn burns(problem: &Problem, relaxed: &Trajectory) -> Burns {
    let Iterate { step_s, w_w, .. } = &relaxed.iterate;
    let (n, flight_s) = (w_w.len(), step_s[0] * w_w.len() as f64);
    let running = |&j: &usize| {
        let thrust_n = w_w[j].norm() / step_s[0] * relaxed.nodes[j].mass_kg;
        thrust_n > RUNNING_SHARE * problem.thrust_max_n
    };
    let first_on = (0..n).take_while(running).count();
    let last_on = (first_on..n).rev().take_while(running).count();
    let burn = |range: Range<usize>| {
        let mass_kg = relaxed.nodes[range.start].mass_kg;
        let w_w: Vector3<f64> = w_w[range].iter().sum();
        (w_w, w_w.norm() * mass_kg / problem.thrust_max_n)
    };
    let (first, last) = (burn(0..first_on), burn(n - last_on..n));
    Burns { first, last, flight_s, whole: first_on == n }
}

/// The switching structure of a relaxed solve.
pub(super) fn structure(problem: &Problem, relaxed: &Trajectory) -> Structure {
    let Burns { first: (_, first_s), last: (_, last_s), whole, .. } = burns(problem, relaxed);
    match (first_s < RELAXED_BURN_MIN_S, last_s < RELAXED_BURN_MIN_S) {
        _ if whole => Structure::On,
        (true, true) if problem.terminal == Terminal::SoftestImpact => Structure::Off,
        (true, _) => Structure::OffOn,
        (_, true) => Structure::OnOff,
        _ => Structure::OnOffOn,
    }
}

/// A start in `structure` from a relaxed solve: each burn gives its impulse at the ceiling.
pub(super) fn from_relaxed(
    problem: &Problem,
    relaxed: &Trajectory,
    structure: Structure,
    settings: &Settings,
) -> (Grid, Iterate) {
    let Burns { first: (first_w, first_s), last: (last_w, last_s), flight_s, .. } =
        burns(problem, relaxed);
    let grid = Grid::new(structure, problem, settings);
    let coast = (Vector3::zeros(), (flight_s - first_s - last_s).max(PHASE_REMAINDER_MIN_S));
    let phases: &[(Vector3<f64>, f64)] = match structure {
        Structure::OnOffOn => &[(first_w, first_s), coast, (last_w, last_s)],
        Structure::OffOn => &[coast, (first_w + last_w, first_s + last_s)],
        Structure::OnOff => &[(first_w + last_w, first_s + last_s), coast],
        Structure::On => &[(relaxed.iterate.w_w.iter().sum(), flight_s)],
        Structure::Off => &[(Vector3::zeros(), fall_s(problem))],
    };
    let counts = || grid.phases.iter().map(|phase| phase.intervals as f64);
    let steps_s = phases.iter().zip(counts()).map(|((_, duration_s), n)| duration_s / n).collect();
    let shares: Vec<Vector3<f64>> = phases.iter().zip(counts()).map(|((w, _), n)| w / n).collect();
    let w_w = grid.phase_of.iter().map(|&phase| shares[phase]).collect();
    (grid, Iterate::lossless(steps_s, w_w))
}

/// The part of `last` after `elapsed_s` on a fresh grid; `None` when nothing is left that `problem`
/// allows.
pub(super) fn from_plan(
    problem: &Problem,
    settings: &Settings,
    last: &Plan,
    elapsed_s: f64,
) -> Option<(Grid, Iterate)> {
    let phases: Vec<&Phase> =
        last.phases.iter().filter(|p| p.end_s() - elapsed_s > PHASE_REMAINDER_MIN_S).collect();
    let powered: Vec<bool> = phases.iter().map(|phase| phase.powered).collect();
    let allowed = |structure: &Structure| structure.broken_limit(problem).is_none();
    let structure = Structure::of(&powered).filter(allowed)?;
    let grid = Grid::new(structure, problem, settings);

    let mut steps_s = Vec::new();
    let mut w_w = Vec::new();
    for (phase, new) in phases.iter().zip(&grid.phases) {
        let start_s = phase.start_s.max(elapsed_s);
        let step_s = (phase.end_s() - start_s) / new.intervals as f64;
        steps_s.push(step_s);
        w_w.extend((0..new.intervals).map(|j| {
            let from_s = start_s + j as f64 * step_s;
            last.impulse_w(from_s, from_s + step_s)
        }));
    }
    Some((grid, Iterate::lossless(steps_s, w_w)))
}
