//! Prints the CPU time of cold plans from 1,000 random states about a descent and a hop, and of warm
//! replans every half second along some of them, milliseconds.

use std::time::Duration;

use guidance_fmu::scvx::{PathLimits, Plan, PlanError, Problem, Settings, Terminal, replan, solve};
use nalgebra::Vector3;
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};

const STATES: usize = 500;
/// Every this many cold plans, one is flown.
const FLOWN: usize = 25;
const PERIOD_S: f64 = 0.5;
const FREEZE_S: f64 = 2.0;

/// Vehicle and limits of the reference descents; B starts at rest on the ground, so its height and
/// climb are only ever raised.
fn start(hop: bool, normal: &mut impl FnMut() -> f64) -> Problem {
    let mut draw = |sigma: f64| Vector3::from_fn(|_, _| sigma * normal());
    let (mut r0_w, mut v0_w) = if hop {
        (Vector3::new(200.0, 0.0, 5.0), Vector3::zeros())
    } else {
        (Vector3::new(300.0, 100.0, 500.0), Vector3::new(-15.0, -5.0, -25.0))
    };
    (r0_w, v0_w) = (r0_w + draw(60.0), v0_w + draw(6.0));
    if hop {
        (r0_w.z, v0_w.z) = (5.0 + (r0_w.z - 5.0).abs(), v0_w.z.abs());
    }
    Problem {
        r0_w,
        v0_w,
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        terminal: Terminal::Point,
        mass_kg: 259.5,
        dry_mass_kg: 174.0,
        gravity_m_s2: 1.625,
        isp_s: 225.0,
        thrust_min_n: 800.0,
        thrust_max_n: 5200.0,
        thrust_rate_max_n_s: None,
        propulsion: Default::default(),
        engine: Default::default(),
        tilt_max_rad: 29_f64.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    }
}

/// The result of a call and its CPU time, ms.
fn timed<T>(call: impl FnOnce() -> T) -> Result<(f64, T), nix::Error> {
    let now = || {
        let clock = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?;
        Ok::<_, nix::Error>(Duration::from_nanos(clock.num_nanoseconds().unsigned_abs()))
    };
    let start = now()?;
    let result = call();
    Ok(((now()? - start).as_secs_f64() * 1e3, result))
}

fn print(name: &str, mut times_ms: Vec<f64>) {
    times_ms.sort_by(f64::total_cmp);
    let at = |share: f64| times_ms[((times_ms.len() - 1) as f64 * share) as usize];
    let [half, high, max] = [0.5, 0.99, 1.0].map(at);
    println!("{name}: n {}, p50 {half:.2}, p99 {high:.2}, max {max:.2} ms", times_ms.len());
}

/// Times of the replans along one plan, and how many of them started cold.
fn fly(
    mut problem: Problem,
    mut current: Plan,
    times_ms: &mut Vec<f64>,
) -> Result<usize, nix::Error> {
    let settings = Settings::default();
    let mut cold = 0;
    while current.time_to_go(PERIOD_S) > FREEZE_S {
        let now = current.sample(PERIOD_S);
        (problem.r0_w, problem.v0_w, problem.mass_kg) = (now.r_w, now.v_w, now.mass_kg);
        let (time_ms, found) = timed(|| replan(&problem, &settings, &current, PERIOD_S))?;
        times_ms.push(time_ms);
        let Ok(found) = found else { break };
        cold += usize::from(!found.report.warm);
        current = found;
    }
    Ok(cold)
}

fn main() -> Result<(), nix::Error> {
    // Knuth's MMIX generator, and twelve uniform deviates for a normal one.
    let mut state = 1_u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    for (name, hop) in [("descent", false), ("hop", true)] {
        let (mut cold_ms, mut warm_ms, mut restarts) = (Vec::new(), Vec::new(), 0);
        let mut refused: Vec<PlanError> = Vec::new();
        for k in 0..STATES {
            let problem = start(hop, &mut normal);
            let (time_ms, found) = timed(|| solve(&problem, &Settings::default()))?;
            cold_ms.push(time_ms);
            match found {
                Ok(found) if k % FLOWN == 0 => restarts += fly(problem, found, &mut warm_ms)?,
                Ok(_) => {}
                Err(error) => refused.push(error),
            }
        }
        print(&format!("{name}, cold"), cold_ms);
        print(&format!("{name}, warm ({restarts} fell back to cold)"), warm_ms);
        println!("{name}: {} of {STATES} refused", refused.len());
        refused.iter().for_each(|error| println!("  {error}"));
    }
    Ok(())
}
