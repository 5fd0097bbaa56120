//! Prints the time of cold plans and of warm replans along one descent, milliseconds.

use std::time::Instant;

use guidance_fmu::scvx::{
    EngineState, PathLimits, PlanError, Problem, Propulsion, Settings, Terminal, replan, solve,
};
use nalgebra::Vector3;

fn main() -> Result<(), PlanError> {
    let mut problem = Problem {
        r0_w: Vector3::new(300.0, 100.0, 500.0),
        v0_w: Vector3::new(-15.0, -5.0, -25.0),
        r_f_w: Vector3::new(0.0, 0.0, 12.0),
        v_f_w: Vector3::new(0.0, 0.0, -8.0),
        terminal: Terminal::Point,
        mass_kg: 259.5,
        dry_mass_kg: 174.0,
        gravity_m_s2: 1.625,
        isp_s: 225.0,
        thrust_min_n: 900.0,
        thrust_max_n: 2500.0,
        thrust_rate_max_n_s: None,
        propulsion: Propulsion::default(),
        engine: EngineState::default(),
        tilt_max_rad: 29_f64.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    };
    let settings = Settings::default();
    let (mut cold_ms, mut warm_ms) = (Vec::new(), Vec::new());
    for k in 0..100 {
        problem.r0_w.x = 250.0 + k as f64;
        let start = Instant::now();
        solve(&problem, &settings)?;
        cold_ms.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let mut current = solve(&problem, &settings)?;
    while current.time_to_go(0.1) > 2.0 {
        let now = current.sample(0.1);
        (problem.r0_w, problem.v0_w, problem.mass_kg) = (now.r_w, now.v_w, now.mass_kg);
        let start = Instant::now();
        current = replan(&problem, &settings, &current, 0.1)?;
        warm_ms.push(start.elapsed().as_secs_f64() * 1e3);
    }
    for (name, times_ms) in [("cold", &mut cold_ms), ("warm", &mut warm_ms)] {
        times_ms.sort_by(f64::total_cmp);
        let at = |share: f64| times_ms[((times_ms.len() - 1) as f64 * share) as usize];
        let (half, high, max) = (at(0.5), at(0.99), at(1.0));
        println!("{name}: n {}, p50 {half:.2}, p99 {high:.2}, max {max:.2} ms", times_ms.len());
    }
    Ok(())
}
