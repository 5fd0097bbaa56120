//! Three tables: cold plans, one conic solve, and plans over the envelope.

use serde::Serialize;

use crate::peer::{Cvxpy, Descent, Generated, Peer};
use crate::states::Calls;

/// A cold plan of one case by one planner.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    pub planner: String,
    pub case: String,
    pub construction_ms: Option<f64>,
    /// Least and median.
    pub cpu_ms: Option<[f64; 2]>,
    pub fuel_kg: f64,
    pub outer_iterations: Option<u32>,
    pub miss_m: Option<f64>,
    pub miss_m_s: Option<f64>,
    pub lossless_gap: Option<f64>,
    /// Its least time over the planner's.
    pub times_ours: Option<f64>,
}

/// One solve of one case's conic program.
#[derive(Clone, Debug, Serialize)]
pub struct Solve {
    pub solver: String,
    pub case: String,
    /// CPU time, least and median.
    pub us: [f64; 2],
    pub iterations: u32,
    pub objective: f64,
    /// The planner's least time over this one.
    pub ours_times: Option<f64>,
}

#[derive(Debug, Serialize)]
pub struct Tables {
    pub plans: Vec<Plan>,
    pub solves: Vec<Solve>,
    pub states: Vec<Calls>,
}

/// A row of a table that is timed in several rounds.
pub trait Row {
    fn is_of(&self, other: &Self) -> bool;
    fn least(&self) -> f64;
}

impl Row for Plan {
    fn is_of(&self, other: &Self) -> bool {
        (&self.planner, &self.case) == (&other.planner, &other.case)
    }

    fn least(&self) -> f64 {
        self.cpu_ms.map_or(f64::INFINITY, |[least_ms, _]| least_ms)
    }
}

impl Row for Solve {
    fn is_of(&self, other: &Self) -> bool {
        (&self.solver, &self.case) == (&other.solver, &other.case)
    }

    fn least(&self) -> f64 {
        self.us[0]
    }
}

/// Each row of a round joins `rows`, or takes its place there if it is the faster one.
pub fn keep_fastest<T: Row>(rows: &mut Vec<T>, round: impl IntoIterator<Item = T>) {
    for new in round {
        match rows.iter_mut().find(|row| row.is_of(&new)) {
            Some(row) if new.least() < row.least() => *row = new,
            Some(_) => {}
            None => rows.push(new),
        }
    }
}

impl Plan {
    pub fn of_peer(descent: &Descent) -> Vec<Self> {
        let cvxpy = |planner: &str, run: &Cvxpy| Self {
            planner: planner.to_owned(),
            case: descent.name.clone(),
            construction_ms: Some(run.construction_ms),
            cpu_ms: Some([run.loop_ms, run.loop_p50_ms]),
            fuel_kg: run.fuel_kg,
            outer_iterations: Some(run.outer_iterations),
            miss_m: Some(run.miss_m),
            miss_m_s: Some(run.miss_m_s),
            lossless_gap: Some(run.lossless_gap),
            times_ours: None,
        };
        let optimum = descent.optimum_kg.map(|fuel_kg| Self {
            planner: "Pontryagin".to_owned(),
            case: descent.name.clone(),
            construction_ms: None,
            cpu_ms: None,
            fuel_kg,
            outer_iterations: None,
            miss_m: None,
            miss_m_s: None,
            lossless_gap: None,
            times_ours: None,
        });
        let rows = [cvxpy("CVXPY DPP", &descent.dpp), cvxpy("CVXPY naive", &descent.naive)];
        rows.into_iter().chain(optimum).collect()
    }
}

impl Solve {
    pub fn of_peer<T>(((case, _), runs): (&(String, T), &Vec<Generated>)) -> Vec<Self> {
        let solve = |run: &Generated| Self {
            solver: format!("QOCOGEN, cc {}", run.flags),
            case: case.clone(),
            us: [run.least_us, run.p50_us],
            iterations: run.iterations,
            objective: run.objective,
            ours_times: None,
        };
        runs.iter().map(solve).collect()
    }
}

impl Tables {
    /// Fills in the ratios.
    pub fn compare(&mut self) {
        let ours = self.plans.clone();
        for plan in &mut self.plans {
            let own = ours.iter().find(|own| own.planner == "ours" && own.case == plan.case);
            plan.times_ours = own
                .and_then(|own| Some(plan.cpu_ms?[0] / own.cpu_ms?[0]))
                .filter(|_| plan.planner != "ours");
        }
        let ours = self.solves.clone();
        for solve in &mut self.solves {
            let own = ours.iter().find(|own| own.solver == "ours" && own.case == solve.case);
            solve.ours_times =
                own.map(|own| own.us[0] / solve.us[0]).filter(|_| solve.solver != "ours");
        }
        self.plans.sort_by(|a, b| a.case.cmp(&b.case));
        self.solves.sort_by(|a, b| a.case.cmp(&b.case));
    }

    pub fn print(&self, peer: &Result<Peer, String>) {
        println!(
            "{:<16} {:<12} {:>8} {:>8} {:>8} {:>9} {:>6} {:>8} {:>8} {:>8} {:>7}",
            "descent",
            "planner",
            "built ms",
            "CPU ms",
            "p50 ms",
            "fuel kg",
            "outer",
            "miss m",
            "miss m/s",
            "gap",
            "× ours"
        );
        let small =
            |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.0e}"));
        let figure =
            |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
        for plan in &self.plans {
            println!(
                "{:<16} {:<12} {:>8} {:>8} {:>8} {:>9.5} {:>6} {:>8} {:>8} {:>8} {:>7}",
                plan.case,
                plan.planner,
                figure(plan.construction_ms),
                figure(plan.cpu_ms.map(|[least_ms, _]| least_ms)),
                figure(plan.cpu_ms.map(|[_, p50_ms]| p50_ms)),
                plan.fuel_kg,
                plan.outer_iterations.map_or("–".to_owned(), |count| count.to_string()),
                small(plan.miss_m),
                small(plan.miss_m_s),
                small(plan.lossless_gap),
                figure(plan.times_ours),
            );
        }
        println!(
            "\n{:<16} {:<30} {:>8} {:>8} {:>10} {:>12} {:>12}",
            "conic program",
            "solver",
            "CPU µs",
            "p50 µs",
            "iterations",
            "objective",
            "ours takes ×"
        );
        for solve in &self.solves {
            println!(
                "{:<16} {:<30} {:>8.1} {:>8.1} {:>10} {:>12.8} {:>12}",
                solve.case,
                solve.solver,
                solve.us[0],
                solve.us[1],
                solve.iterations,
                solve.objective,
                figure(solve.ours_times),
            );
        }
        println!(
            "\n{:<16} {:>6} {:>8} {:>9} {:>8} {:>8} {:>8}",
            "envelope, on/off", "calls", "refused", "restarted", "p50 ms", "p99 ms", "max ms"
        );
        for Calls { kind, calls, refused, restarted, p50_ms, p99_ms, max_ms } in &self.states {
            println!(
                "{kind:<16} {calls:>6} {refused:>8} {restarted:>9} {p50_ms:>8.2} {p99_ms:>8.2} {max_ms:>8.2}"
            );
        }
        match peer {
            Ok(Peer { cvxpy, clarabel, .. }) => println!("\nCVXPY {cvxpy}, Clarabel {clarabel}"),
            Err(reason) => println!("\nThe peers were not run: {reason}"),
        }
        println!(
            "CPU ms: the least of cold plans; CVXPY: the outer loop alone, built ms: what precedes it.\n\
             Always on and relaxed: 30 intervals; on/off: 6 + 1 + 8. Tolerance 1e-8 throughout.\n\
             A relaxed gap is that of idle intervals. Pontryagin: the optimum without intervals.\n\
             × ours, ours takes ×: by the least of all rounds, which is the machine undisturbed."
        );
    }
}
