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

const STATES: u32 = 100;

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

/// About the reference descent: 100 m, 10 m/s, tilts up to 16°, roll to 29°, 3 °/s.
fn random_problem(vehicle: &Vehicle, random: &mut Lcg, attitude_given: bool) -> SixDofProblem {
    let turn = random.vector().component_mul(&Vector3::new(0.2, 0.2, 0.5));
    let rate_b = random.vector() * 0.05;
    SixDofProblem {
        mass: vehicle.mass.clone(),
        start: Start {
            propellant_kg: 85.5,
            r_w: Vector3::new(300.0, 100.0, 500.0) + random.vector() * 100.0,
            v_w: Vector3::new(-15.0, -5.0, -25.0) + random.vector() * 10.0,
            attitude_wb: attitude_given.then(|| UnitQuaternion::new(turn)),
            rate_b: if attitude_given { rate_b } else { Vector3::zeros() },
        },
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        gravity_m_s2: 1.625,
        actuators: Actuators::of(vehicle),
        limits: Limits {
            tilt_max_rad: 29_f64.to_radians(),
            rate_max_rad_s: 0.8,
            glide_slope_rad: None,
            end_tilt_max_rad: 1_f64.to_radians(),
            end_rate_max_rad_s: 1_f64.to_radians(),
        },
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref())?;
    let settings = SixDofSettings::default();
    for (attitude_given, name) in
        [(false, "attitude free, 15 intervals"), (true, "attitude and rates given, 18 intervals")]
    {
        let mut random = Lcg(1);
        let (mut plan_ms, mut conic_ms, mut solves, mut ratios) = (vec![], vec![], vec![], vec![]);
        for n in 0..STATES {
            let problem = random_problem(&vehicle, &mut random, attitude_given);
            let start = cpu_time()?;
            let solved = solve(&problem, &settings);
            let time_ms = (cpu_time()? - start).as_secs_f64() * 1e3;
            match solved {
                Ok(plan) => {
                    plan_ms.push(time_ms);
                    solves.push(f64::from(plan.report.outer_iterations));
                    ratios.push(plan.propellant_kg() / plan.report.translation_propellant_kg);
                }
                Err(error) => {
                    println!("state {n}: {error}, {time_ms:.0} ms");
                    continue;
                }
            }
            let program = subproblem(&problem, &settings)?;
            let mut solver = ConicSolver::new(&program, settings.solver_iterations_max)?;
            let start = cpu_time()?;
            solver.solve(&program)?;
            conic_ms.push((cpu_time()? - start).as_secs_f64() * 1e3);
        }
        println!("{name}: {} of {STATES} states planned", plan_ms.len());
        for (name, values) in [
            ("plan, ms", &mut plan_ms),
            ("first conic solve, ms", &mut conic_ms),
            ("conic solves a plan", &mut solves),
            ("propellant over the translation's", &mut ratios),
        ] {
            values.sort_by(f64::total_cmp);
            let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
            let (half, high, most) = (at(0.5), at(0.9), at(1.0));
            println!("  {name}: p50 {half:.3}, p90 {high:.3}, max {most:.3}");
        }
    }
    Ok(())
}
