//! One landing's communication steps, timed by what they do.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use guidance_fmu::Guidance;
use lander_models::signals::{GUIDANCE, TRUTH, connections};
use lander_models::{Component, Settings, Ticks};
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};
use serde::Serialize;
use truth_model::TruthModel;

const STEP: Ticks = Ticks(10);
/// Flights of which each step's least time counts, so that a neighbour on the core is outlasted.
const REPEATS: usize = 5;

#[derive(Clone, Serialize)]
pub struct Part {
    pub name: &'static str,
    pub steps: usize,
    pub cpu_s: f64,
}

const NAMES: [&str; 4] = [
    "truth, in flight",
    "truth, in contact",
    "guidance, a step with a plan",
    "guidance, a step without",
];

/// A step's part, as a place in `NAMES`, and its time.
type Step = (usize, f64);

pub fn measure(scenario: &Path) -> Result<Vec<Part>, Box<dyn Error>> {
    let mut least = fly(scenario)?;
    for _ in 1..REPEATS {
        for (step, (_, again_s)) in least.iter_mut().zip(fly(scenario)?) {
            step.1 = step.1.min(again_s);
        }
    }
    let part = |(place, name): (usize, &'static str)| {
        let times_s = || least.iter().filter(|step| step.0 == place).map(|step| step.1);
        Part { name, steps: times_s().count(), cpu_s: times_s().sum() }
    };
    Ok(NAMES.into_iter().enumerate().map(|(place, name)| part((place, name))).collect())
}

/// The steps of one flight to rest.
fn fly(scenario: &Path) -> Result<Vec<Step>, Box<dyn Error>> {
    let settings = Settings { scenario_file: scenario.to_owned() };
    let (truth, mut world) = TruthModel::create(&settings)?;
    let (guidance, mut mind) = Guidance::create(&settings)?;
    let mut readings = vec![0.0; TRUTH.output_len()];
    let mut inputs = vec![0.0; GUIDANCE.input_len()];
    let mut orders = vec![0.0; GUIDANCE.output_len()];
    let mut commands = vec![0.0; TRUTH.input_len()];
    let output = |name| GUIDANCE.output_offset(name).ok_or(name);
    let [accepted, failed] = [output("plans_accepted")?, output("plans_failed")?];
    let contact = TRUTH.output_offset("contact_active").ok_or("contact_active")?;
    let (to_guidance, to_truth) = (connections(&TRUTH, &GUIDANCE), connections(&GUIDANCE, &TRUTH));
    let mut steps = Vec::new();
    loop {
        truth.outputs(&world, &mut readings);
        copy(&to_guidance, &readings, &mut inputs);
        let plans = orders[accepted] + orders[failed];
        let start = cpu_time()?;
        guidance.step(&mut mind, &inputs, STEP)?;
        guidance.outputs(&mind, &mut orders);
        let planned = orders[accepted] + orders[failed] > plans;
        steps.push((if planned { 2 } else { 3 }, (cpu_time()? - start).as_secs_f64()));
        copy(&to_truth, &orders, &mut commands);
        let touching = readings[contact] > 0.0;
        let start = cpu_time()?;
        let report = truth.step(&mut world, &commands, STEP)?;
        steps.push((usize::from(touching), (cpu_time()? - start).as_secs_f64()));
        if report.terminate {
            return Ok(steps);
        }
    }
}

fn copy(links: &[(usize, usize, usize)], from: &[f64], to: &mut [f64]) {
    for &(output, input, size) in links {
        to[input..input + size].copy_from_slice(&from[output..output + size]);
    }
}

fn cpu_time() -> Result<Duration, nix::Error> {
    let now = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID)?;
    Ok(Duration::from_nanos(now.num_nanoseconds().unsigned_abs()))
}
