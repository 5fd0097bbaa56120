//! The kit's own engines: errors against many steps within each of their own, and CPU times of the one
//! thread, which a busy machine distorts least.

use std::error::Error;
use std::time::Duration;

use lander_models::frames::tilt_rad;
use lander_models::scenario::ContactEngine;
use lander_models::time::TICK_S;
use lander_models::{ModelError, Outcome, Vehicle};
use nalgebra::{Vector2, Vector3};
use nix::time::{ClockId, clock_gettime};
use rayon::prelude::*;
use truth_model::flight::{advance, free};
use truth_model::propulsion::Drive;
use truth_model::{State, TruthModel};

use crate::cases::{self, Family};
use crate::table::{Errors, Row};

pub const ENGINES: [(&str, ContactEngine); 2] =
    [("rapier", ContactEngine::Rapier), ("strut", ContactEngine::Strut)];
/// Contact steps of a tick.
pub const REFINEMENTS: [u32; 2] = [1, 2];
/// Of the reference of an error.
pub const REFERENCE_REFINEMENT: u32 = 16;

/// CPU time that this thread has taken, s.
fn cpu_s() -> Result<f64, nix::Error> {
    let now = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?;
    Ok(Duration::from(now).as_secs_f64())
}

/// Flights that are timed, with their thrust, N: under power, and falling as MuJoCo's lander does.
pub const FLIGHTS: [(&str, f64); 2] = [("powered", 2500.0), ("falling", 0.0)];

/// The flight integrator alone, from full tanks, microseconds a step.
///
/// # Panics
/// If the tanks run dry, as a dry flight is a cheaper one.
pub fn flight_us(vehicle: &Vehicle, model: &TruthModel, thrust_n: f64) -> Result<f64, nix::Error> {
    const STEPS: u32 = 50_000;
    let gimbal_rad = Vector2::new(0.001, 0.002);
    let drive =
        Drive { thrust_target_n: thrust_n, gimbal_target_rad: gimbal_rad, ..Drive::default() };
    let gravity_w = Vector3::z() * -model.scenario().gravity_m_s2;
    let mut motion = model.initial_state().motion;
    motion.propellant_kg = vehicle.mass.propellant.capacity_kg;
    motion.gimbal_rad = gimbal_rad;
    motion.rate_b = Vector3::new(0.02, 0.05, -0.03);
    let start_s = cpu_s()?;
    for _ in 0..STEPS {
        motion = advance(vehicle, &gravity_w, &motion, &drive, TICK_S, free);
    }
    let elapsed_s = cpu_s()? - start_s;
    assert!(std::hint::black_box(motion).propellant_kg > 0.0, "the tanks are dry");
    Ok(1e6 * elapsed_s / f64::from(STEPS))
}

/// From just above the ground to the verdict: the end, and how many ticks.
fn touch_down(model: &TruthModel) -> Result<(State, u32), ModelError> {
    let mut state = model.initial_state();
    let mut ticks = 1;
    while !model.tick(&mut state)?.terminate {
        ticks += 1;
    }
    Ok((state, ticks))
}

/// A family on one engine with one step.
pub struct Series {
    pub engine: &'static str,
    pub case: String,
    refinement: u32,
    models: Vec<TruthModel>,
    errors: Errors,
    ticks: u32,
    /// Per member, the least so far.
    cpu_s: Vec<f64>,
}

impl Series {
    /// Every series of a family, ready to be timed. One that does not bring each member to rest is none.
    pub fn of_family(vehicle: &Vehicle, family: &Family) -> Result<Vec<Self>, Box<dyn Error>> {
        let mut all = Vec::new();
        for (name, engine) in ENGINES {
            let models = |refinement| {
                let model = |member| cases::model(vehicle, member, engine, refinement);
                family.members.iter().map(model).collect::<Result<Vec<_>, _>>()
            };
            let exact = ends(&models(REFERENCE_REFINEMENT)?)?
                .ok_or_else(|| format!("{name}: {}: the reference does not rest", family.name))?;
            for refinement in REFINEMENTS {
                let models = models(refinement)?;
                let Some(ends) = ends(&models)? else { continue };
                all.push(Self {
                    engine: name,
                    case: family.name.clone(),
                    refinement,
                    errors: errors(&ends, &exact),
                    ticks: ends.iter().map(|(_, ticks)| ticks).sum(),
                    cpu_s: vec![f64::INFINITY; models.len()],
                    models,
                });
            }
        }
        Ok(all)
    }

    /// Once more to rest, each member.
    pub fn time(&mut self) -> Result<(), Box<dyn Error>> {
        for (model, least_s) in self.models.iter().zip(&mut self.cpu_s) {
            let start_s = cpu_s()?;
            std::hint::black_box(touch_down(model)?);
            *least_s = least_s.min(cpu_s()? - start_s);
        }
        Ok(())
    }

    pub fn row(&self) -> Row {
        let total_s: f64 = self.cpu_s.iter().sum();
        let refinement = f64::from(self.refinement);
        Row {
            engine: self.engine.to_owned(),
            case: self.case.clone(),
            step_ms: 1e3 * TICK_S / refinement,
            step_us: 1e6 * total_s / (f64::from(self.ticks) * refinement),
            to_rest_ms: Some(1e3 * total_s / self.models.len() as f64),
            errors: Some(self.errors),
            ..Row::default()
        }
    }
}

/// How each ends; `None` if one does not land.
fn ends(models: &[TruthModel]) -> Result<Option<Vec<(State, u32)>>, ModelError> {
    let ends: Vec<_> = models.par_iter().map(touch_down).collect::<Result<_, _>>()?;
    let landed = ends.iter().all(|(end, _)| end.touchdown.outcome == Outcome::Landed);
    Ok(landed.then_some(ends))
}

/// Root mean squares.
fn errors(ends: &[(State, u32)], exact: &[(State, u32)]) -> Errors {
    let rms = |error: fn(&State, &State) -> f64| {
        let squares =
            ends.iter().zip(exact).map(|((end, _), (exact, _))| error(end, exact).powi(2));
        (squares.sum::<f64>() / ends.len() as f64).sqrt()
    };
    Errors {
        place_m: rms(|end, exact| (end.motion.position_w - exact.motion.position_w).norm()),
        tilt_deg: rms(|end, exact| {
            let tilt_deg = |state: &State| tilt_rad(&state.motion.attitude_wb).to_degrees();
            tilt_deg(end) - tilt_deg(exact)
        }),
        stroke_percent: rms(|end, exact| {
            100.0 * (end.touchdown.peak_stroke_m / exact.touchdown.peak_stroke_m - 1.0)
        }),
    }
}
