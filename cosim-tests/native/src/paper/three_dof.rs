//! The paper's own truth (section V-A): a point with mass and thrust, Runge-Kutta 4 in steps of 0.1 s, errors held
//! over a step. A cross-check and the paper's side of the comparison, not this kit's truth.

use guidance_fmu::scvx::{Plan, Problem, Settings, replan, solve};
use lander_models::random;
use lander_models::scenario::Disturbances;
use nalgebra::{Rotation3, Vector3};

/// The paper's step, s.
const STEP_S: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub r_w: Vector3<f64>,
    pub v_w: Vector3<f64>,
    pub mass_kg: f64,
}

impl Point {
    fn moved(&self, rate: &Self, step_s: f64) -> Self {
        Self {
            r_w: self.r_w + rate.r_w * step_s,
            v_w: self.v_w + rate.v_w * step_s,
            mass_kg: self.mass_kg + rate.mass_kg * step_s,
        }
    }
}

/// One step of Runge-Kutta 4; `rate` takes the time within the step and the state.
fn runge_kutta(now: &Point, step_s: f64, rate: impl Fn(f64, &Point) -> Point) -> Point {
    let k1 = rate(0.0, now);
    let k2 = rate(0.5 * step_s, &now.moved(&k1, 0.5 * step_s));
    let k3 = rate(0.5 * step_s, &now.moved(&k2, 0.5 * step_s));
    let k4 = rate(step_s, &now.moved(&k3, step_s));
    let sixth = step_s / 6.0;
    now.moved(&k1, sixth).moved(&k2, 2.0 * sixth).moved(&k3, 2.0 * sixth).moved(&k4, sixth)
}

/// How guidance flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// The plan from the nominal start, to its end.
    OpenLoop,
    /// The plan from the run's own start, to its end.
    KnownStart,
    /// That, and a new plan from where the vehicle is, each so many seconds.
    Replanned(f64),
}

/// Where a flight ended: on the ground, or where it crossed the target's level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    pub time_s: f64,
    /// Horizontal distance from the target.
    pub miss_m: f64,
    pub down_m_s: f64,
    pub across_m_s: f64,
}

/// What a run draws once.
struct Run<'a> {
    seed: u64,
    errors: &'a Disturbances,
    thrust: f64,
    pointing_rad: [f64; 2],
    gravity: f64,
    isp: f64,
}

impl<'a> Run<'a> {
    fn new(errors: &'a Disturbances, seed: u64) -> Self {
        let once = |stream: &str| random::normal(seed, stream, 0);
        Self {
            seed,
            errors,
            thrust: 1.0 + errors.thrust_bias * once("thrust bias"),
            pointing_rad: [0, 1]
                .map(|axis| errors.pointing_bias_rad * random::normal(seed, "pointing bias", axis)),
            gravity: 1.0 + errors.gravity * once("gravity"),
            isp: 1.0 + errors.specific_impulse * once("specific impulse"),
        }
    }

    fn start(&self, nominal: &Problem) -> Point {
        let Self { seed, errors, .. } = *self;
        let mass = 1.0 + errors.mass * random::normal(seed, "mass", 0);
        Point {
            r_w: nominal.r0_w + random::normal3(seed, "position", 0) * errors.initial_position_m,
            v_w: nominal.v0_w + random::normal3(seed, "velocity", 0) * errors.initial_velocity_m_s,
            mass_kg: nominal.mass_kg * mass,
        }
    }
}

/// Flies a plan that was made for `nominal` to the ground.
pub fn fly(
    nominal: &Problem,
    first: &Plan,
    scheme: Scheme,
    errors: &Disturbances,
    seed: u64,
) -> End {
    let run = Run::new(errors, seed);
    let mut now = run.start(nominal);
    let (mut plan, mut since_s) = (first.clone(), 0.0);
    let mut last_plan_step = 0;
    let from = |here: &Point| Problem {
        r0_w: here.r_w,
        v0_w: here.v_w,
        mass_kg: here.mass_kg,
        ..nominal.clone()
    };
    if scheme == Scheme::KnownStart
        && let Ok(better) = solve(&from(&now), &Settings::default())
    {
        plan = better;
    }
    let gravity_w = nominal.gravity_w() * run.gravity;
    let mass_flow_s_m = nominal.mass_flow_s_m() / run.isp;
    // Falls to the ground at the latest: ten minutes are beyond any flight here.
    for step in 0..6000_u64 {
        let time_s = step as f64 * STEP_S;
        if let Scheme::Replanned(period_s) = scheme
            && ((step - last_plan_step) as f64 * STEP_S) > period_s - 0.5 * STEP_S
        {
            last_plan_step = step;
            // Without a new plan the last one stays in force.
            if let Ok(better) = replan(&from(&now), &Settings::default(), &plan, time_s - since_s) {
                (plan, since_s) = (better, time_s);
            }
        }
        let share = run.thrust + errors.thrust_noise * random::normal(seed, "thrust noise", step);
        let [about_x, about_y] = [0, 1].map(|axis: u64| {
            let jitter = random::normal(seed, "pointing jitter", 2 * step + axis);
            run.pointing_rad[axis as usize] + errors.pointing_jitter_rad * jitter
        });
        let off = Rotation3::from_euler_angles(about_x, about_y, 0.0);
        let push_w = random::normal3(seed, "acceleration", step) * errors.acceleration_noise_m_s2;
        let rate = |in_step_s: f64, state: &Point| {
            let plan_s = time_s + in_step_s - since_s;
            let thrust_w = if plan_s < plan.duration_s() {
                off * plan.sample(plan_s).thrust_w * share
            } else {
                Vector3::zeros()
            };
            Point {
                r_w: state.v_w,
                v_w: thrust_w / state.mass_kg + gravity_w + push_w,
                mass_kg: -thrust_w.norm() * mass_flow_s_m,
            }
        };
        let next = runge_kutta(&now, STEP_S, rate);
        if next.r_w.z <= nominal.r_f_w.z {
            return ground(nominal, &now, &next, time_s);
        }
        now = next;
    }
    ground(nominal, &now, &now, 600.0)
}

/// Where the level is crossed between two steps, linearly.
fn ground(nominal: &Problem, before: &Point, after: &Point, time_s: f64) -> End {
    let fall_m = before.r_w.z - after.r_w.z;
    let part = if fall_m > 0.0 { (before.r_w.z - nominal.r_f_w.z) / fall_m } else { 0.0 };
    let r_w = before.r_w.lerp(&after.r_w, part);
    let v_w = before.v_w.lerp(&after.v_w, part);
    End {
        time_s: time_s + part * STEP_S,
        miss_m: (r_w - nominal.r_f_w).xy().norm(),
        down_m_s: -v_w.z,
        across_m_s: v_w.xy().norm(),
    }
}

/// Where an undisturbed plan ends in this truth: position and speed off the target, in so many steps
/// an interval of the plan.
pub fn re_propagated(problem: &Problem, plan: &Plan, steps: u32) -> (f64, f64) {
    let mut now = Point { r_w: problem.r0_w, v_w: problem.v0_w, mass_kg: problem.mass_kg };
    for (pair, u_w) in plan.nodes.windows(2).zip(&plan.u_w) {
        let step_s = (pair[1].t_s - pair[0].t_s) / f64::from(steps);
        // As the planner holds it: thrust over the plan's own mass, which this one then should have.
        for step in 0..steps {
            let from_s = f64::from(step) * step_s;
            let rate = |in_step_s: f64, state: &Point| {
                let planned_kg = pair[0].mass_kg
                    * libm::exp(-plan.mass_flow_s_m * u_w.norm() * (from_s + in_step_s));
                let thrust_w = u_w * planned_kg;
                Point {
                    r_w: state.v_w,
                    v_w: thrust_w / state.mass_kg + problem.gravity_w(),
                    mass_kg: -thrust_w.norm() * problem.mass_flow_s_m(),
                }
            };
            now = runge_kutta(&now, step_s, rate);
        }
    }
    ((now.r_w - problem.r_f_w).norm(), (now.v_w - problem.v_f_w).norm())
}
