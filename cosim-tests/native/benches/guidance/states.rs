//! Cold plans from the 1,000 random states of the planner's envelope, and warm replans every half second
//! along some of them, in CPU time.

#[path = "../../../../guidance-fmu/tests/scvx_scenarios/mod.rs"]
mod scvx_scenarios;

use guidance_fmu::TURN_RAD_S;
use guidance_fmu::scvx::{Plan, Problem, Settings, Turn, replan, solve};
use serde::Serialize;

use crate::ours::timed;

const STATES: u64 = 1000;
/// Every this many cold plans, one is flown.
const FLOWN: u64 = 25;
const PERIOD_S: f64 = 0.5;
/// A plan with less than this to go is not replanned, s.
const FREEZE_S: f64 = 2.0;
/// Calls of which the least time counts, so that a neighbour on the core is outlasted.
const REPEATS: usize = 3;

/// Times of the calls of one kind.
#[derive(Clone, Debug, Serialize)]
pub struct Calls {
    pub kind: &'static str,
    pub calls: usize,
    /// Calls that found no plan.
    pub refused: usize,
    /// Replans that started cold.
    pub restarted: usize,
    /// Half, 99 in a hundred and all of the calls take at most this, ms.
    pub p50_ms: f64,
    pub p99_ms: f64,
    pub max_ms: f64,
}

impl Calls {
    fn new(kind: &'static str, mut times_ms: Vec<f64>, refused: usize, restarted: usize) -> Self {
        times_ms.sort_by(f64::total_cmp);
        let at = |share: f64| times_ms[((times_ms.len() - 1) as f64 * share) as usize];
        let (p50_ms, p99_ms, max_ms) = (at(0.5), at(0.99), at(1.0));
        Self { kind, calls: times_ms.len(), refused, restarted, p50_ms, p99_ms, max_ms }
    }
}

/// Times of the replans along a plan, and how many of them started cold and found none.
#[derive(Default)]
struct Flight {
    times_ms: Vec<f64>,
    restarted: usize,
    refused: usize,
}

impl Flight {
    fn replans(&mut self, mut problem: Problem, mut current: Plan) -> Result<(), nix::Error> {
        let settings = Settings::default();
        while current.time_to_go(PERIOD_S) > FREEZE_S {
            let now = current.sample(PERIOD_S);
            (problem.r0_w, problem.v0_w, problem.mass_kg) = (now.r_w, now.v_w, now.mass_kg);
            // As replans are flown (G.97).
            let axis_w = current.next_burn_direction(PERIOD_S);
            problem.turn = Some(Turn { rate_max_rad_s: TURN_RAD_S, axis_w });
            let ([least_s, _], found) =
                timed(REPEATS, || replan(&problem, &settings, &current, PERIOD_S))?;
            self.times_ms.push(1e3 * least_s);
            let Ok(found) = found else {
                self.refused += 1;
                break;
            };
            self.restarted += usize::from(!found.report.warm);
            current = found;
        }
        Ok(())
    }
}

pub fn run() -> Result<Vec<Calls>, nix::Error> {
    let (mut planned_ms, mut refused_ms, mut warm) = (Vec::new(), Vec::new(), Flight::default());
    for index in 0..STATES {
        let problem = scvx_scenarios::envelope::state(index);
        let ([least_s, _], found) = timed(REPEATS, || solve(&problem, &Settings::default()))?;
        match found {
            Ok(plan) => {
                planned_ms.push(1e3 * least_s);
                if index % FLOWN == 0 {
                    warm.replans(problem, plan)?;
                }
            }
            Err(_) => refused_ms.push(1e3 * least_s),
        }
    }
    let refused = refused_ms.len();
    let all_ms = [planned_ms.clone(), refused_ms].concat();
    Ok(vec![
        Calls::new("cold", all_ms, refused, 0),
        Calls::new("cold, planned", planned_ms, 0, 0),
        Calls::new("warm", warm.times_ms, warm.refused, warm.restarted),
    ])
}
