//! Times cold plans in six degrees of freedom from random states, and their first conic solve:
//! thread CPU time, milliseconds.

use std::error::Error;
use std::time::Duration;

use guidance_fmu::scvx::ConicSolver;
use guidance_fmu::six_dof::{
    Actuators, Limits, SixDofProblem, SixDofSettings, Start, solve, subproblem,
};
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};
use nix::time::{ClockId, clock_gettime};

const STATES: u32 = 30;

/// A linear congruential generator (Knuth's MMIX constants): equal states on every machine.
struct Lcg(u64);

impl Lcg {
    /// In [−1, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next())
    }
}

fn cpu_time() -> Result<Duration, nix::Error> {
    Ok(Duration::from(clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?))
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref())?;
    let mode = std::env::args().nth(1).unwrap_or_default();
    let settings = if mode == "a" { SixDofSettings { structure: Some(guidance_fmu::scvx::Structure::OffOn), coast_intervals: 4, last_burn_intervals: 11, ..Default::default() } } else { SixDofSettings::default() };
    let (r, v) = if mode == "a" { (Vector3::new(80.0, 27.0, 180.0), Vector3::new(-18.6, -6.2, -36.0)) } else { (Vector3::new(300.0, 100.0, 500.0), Vector3::new(-15.0, -5.0, -25.0)) };
    let (dr, dv) = if mode == "a" { (20.0, 3.0) } else { (100.0, 10.0) };
    let mut random = Lcg(1);
    let (mut plan_ms, mut conic_ms, mut solves, mut ratios) = (vec![], vec![], vec![], vec![]);
    for n in 0..STATES {
        let tilt = random.vector().component_mul(&Vector3::new(0.2, 0.2, 0.5));
        let problem = SixDofProblem {
            mass: vehicle.mass.clone(),
            start: Start {
                propellant_kg: 85.5,
                r_w: r + random.vector() * dr,
                v_w: v + random.vector() * dv,
                attitude_wb: (mode != "b").then(|| UnitQuaternion::new(tilt)),
                rate_b: random.vector() * if mode == "b" { 0.0 } else { 0.05 },
            },
            r_f_w: Vector3::zeros(),
            v_f_w: Vector3::zeros(),
            gravity_m_s2: 1.625,
            actuators: Actuators::of(&vehicle),
            limits: Limits {
                tilt_max_rad: 29_f64.to_radians(),
                rate_max_rad_s: 0.8,
                glide_slope_rad: None,
                end_tilt_max_rad: 1_f64.to_radians(),
                end_rate_max_rad_s: 1_f64.to_radians(),
            },
        };
        let program = match subproblem(&problem, &settings) { Ok(p) => p, Err(e) => { println!("state {n}: {e}"); continue } };
        let start = cpu_time()?;
        ConicSolver::new(&program, settings.solver_iterations_max)?.solve(&program)?;
        conic_ms.push((cpu_time()? - start).as_secs_f64() * 1e3);
        let start = cpu_time()?;
        let solved = solve(&problem, &settings);
        let time_ms = (cpu_time()? - start).as_secs_f64() * 1e3;
        match solved {
            Ok(plan) => {
                plan_ms.push(time_ms);
                solves.push(f64::from(plan.report.outer_iterations));
                ratios.push(plan.propellant_kg() / plan.report.translation_propellant_kg);
            }
            Err(error) => println!("state {n}: {error}, {time_ms:.0} ms"),
        }
    }
    println!("{} of {STATES} states planned", plan_ms.len());
    for (name, values) in [
        ("plan, ms", &mut plan_ms),
        ("first conic solve with its set-up, ms", &mut conic_ms),
        ("conic solves a plan", &mut solves),
        ("propellant over the translation's", &mut ratios),
    ] {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
        println!("{name}: p50 {:.3}, p90 {:.3}, max {:.3}", at(0.5), at(0.9), at(1.0));
    }
    Ok(())
}
