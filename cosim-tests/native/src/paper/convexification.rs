//! Table VII and Fig. 5: each convexification, and what accepted plans leave of the nonconvexity.

use guidance_fmu::scvx::{Plan, Problem};
use lander_models::random;
use lander_models::scenario::Disturbances;
use rayon::prelude::*;

use super::chapter::Chapter;
use super::drawing::{COLOURS, key};
use super::problems::{Start, always_on, plan, problem};
use super::three_dof::re_propagated;
use super::{Error, Inputs};
use crate::csv::quoted;
use crate::report::Figure;
use crate::statistics::spread::Spread;
use crate::svg::{Frame, picture, styled_line, text};

/// Dispersed starts of each engine mode.
const STARTS: u64 = 100;
/// Steps of the re-propagation an interval of a plan: its own error is then far below the plans'.
const STEPS: u32 = 40;

/// A start dispersed as Table VIII says.
fn dispersed(nominal: &Problem, number: u64) -> Problem {
    let errors = Disturbances::MONTE_CARLO_TABLE;
    let mass = 1.0 + errors.mass * random::normal(number, "mass", 0);
    Problem {
        r0_w: nominal.r0_w + random::normal3(number, "position", 0) * errors.initial_position_m,
        v0_w: nominal.v0_w + random::normal3(number, "velocity", 0) * errors.initial_velocity_m_s,
        mass_kg: nominal.mass_kg * mass,
        ..nominal.clone()
    }
}

/// A plan that was accepted, with its problem.
struct Accepted {
    problem: Problem,
    plan: Plan,
}

fn accepted(nominal: &Problem) -> Vec<Accepted> {
    let one = |number: u64| {
        let problem = dispersed(nominal, number);
        let plan = plan(&problem).ok()?;
        Some(Accepted { problem, plan })
    };
    (1..=STARTS).into_par_iter().filter_map(one).collect()
}

type Measure = fn(&Accepted) -> f64;

/// Source, the paper's technique, this kit's, residual, its unit and measure.
const ROWS: [(&str, &str, &str, &str, &str, Measure); 11] = [
    (
        "thrust lower bound",
        "lossless convexification",
        "slack bound (G.10); linearised where it is not tight (G.13)",
        "(σ − ‖u‖)/σ",
        "1",
        |a| a.plan.report.lossless_gap,
    ),
    ("", "", "", "thrust out of its bounds, relative to the floor", "1", |a| {
        a.plan.report.thrust_violation_n.max(0.0) / a.problem.thrust_min_n
    }),
    (
        "thrust-mass coupling T/m",
        "log-mass substitution",
        "u = T/m is the unknown; bounds at the masses of the exact roll-out (G.11)",
        "mass against the one frozen in the last step, relative",
        "1",
        |a| a.plan.report.last_step.mass_error,
    ),
    (
        "mass depletion",
        "Taylor linearisation of e^−z",
        "none needed: ln m = ln m0 − α Σ‖w‖ is exact (G.4)",
        "mass re-propagated by Runge-Kutta",
        "kg",
        |a| a.plan.report.mass_error_kg.abs(),
    ),
    (
        "free final time",
        "time normalisation and SCvx",
        "phase lengths are unknowns (G.9, G.15)",
        "end position linearised against exact, in the last step",
        "m",
        |a| a.plan.report.last_step.position_error_m,
    ),
    ("", "", "", "change of the flight time in the last step", "s", |a| {
        a.plan.report.last_step.duration_change_s
    }),
    (
        "",
        "",
        "",
        "Δv that makes up for what the last step's linearisation left out (G.94)",
        "m/s",
        |a| a.plan.report.last_step.restoration_m_s.abs(),
    ),
    (
        "thruster dead zone",
        "strictly-on constraint",
        "order of burns and coasts, then held (G.40)",
        "burn below the floor",
        "N",
        |a| a.plan.report.dead_zone_n.max(0.0),
    ),
    (
        "all together",
        "residual < 1e-10",
        "this report's own Runge-Kutta 4",
        "target missed by",
        "m",
        |a| re_propagated(&a.problem, &a.plan, STEPS).0,
    ),
    ("", "", "", "target missed by", "m/s", |a| re_propagated(&a.problem, &a.plan, STEPS).1),
    ("iterations", "8 to 12", "conic solves of a cold plan", "solves", "1", |a| {
        f64::from(a.plan.report.outer_iterations)
    }),
];

/// # Errors
/// A printed number that is missing.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let nominal = problem(Start::Descent, bug, printed)?;
    let wide_deg = printed.number("tvc_tilt_max", "deg")?;
    let sets = [accepted(&nominal), accepted(&always_on(&nominal, wide_deg, nominal.mass_kg))];
    let rows = ROWS.map(|(source, technique, ours, residual, unit, measure)| {
        let mut cells = [source, technique, ours, residual, unit].map(str::to_owned).to_vec();
        for set in &sets {
            let spread = Spread::of(set.iter().map(measure));
            cells.extend([spread.p50, spread.max].map(|value| small(value, residual == "solves")));
        }
        cells
    });
    let mut chapter = Chapter::new("Convexification: Table VII, Fig. 5");
    chapter.words(format!(
        "Residuals of the plans accepted from {STARTS} starts dispersed as Table VIII says \
         about the descent: {} of {STARTS} with the engine on and off within 29°, {} of \
         {STARTS} with it always on within {wide_deg}°.",
        sets[0].len(),
        sets[1].len()
    ));
    chapter.table(
        "convexification",
        "Table VII (tab:nonconvex_summary) with what each technique leaves, in plans that were \
         accepted.",
        &[
            "source of nonconvexity",
            "paper's technique",
            "this kit's",
            "residual",
            "unit",
            "on/off: median",
            "on/off: worst",
            "always on: median",
            "always on: worst",
        ],
        rows.to_vec(),
    );
    let solve_ms = 1e3 * printed.number("solve_time", "s")?;
    chapter.differs(format!(
        "the paper prints one residual, below 1e-10, of what it does not say. z = ln m makes \
         the mass rate linear; the Taylor step it names is for the bounds ρ e^−z. Here the \
         roll-out is exact, so that only the target's position and the frozen masses are \
         iterated, and a plan is accepted on an independent re-propagation: below 1 cm and 1 \
         cm/s, losslessness below 1e-4. The paper prints {solve_ms} ms a trajectory; this \
         kit's times stand in the benchmark (`cargo bench -p cosim --bench guidance`), since no \
         result here depends on a clock.",
    ));
    chapter.figure(sets_of_thrust(&sets, inputs)?);
    Ok(chapter)
}

fn small(value: f64, whole: bool) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if whole => format!("{value:.0}"),
        _ => format!("{value:.1e}"),
    }
}

/// Fig. 5: (a) the thrust that the engine and the tilt limit allow, with planned thrusts in it; (b) the lifted cone.
fn sets_of_thrust(sets: &[Vec<Accepted>; 2], inputs: &Inputs) -> Result<Figure, Error> {
    let engine = &inputs.bug.engine;
    let (floor, ceiling, dead) = (engine.thrust_min_n, engine.thrust_max_n, engine.dead_zone_n);
    let panel = |left: f64, x: [f64; 2]| Frame {
        left,
        top: 60.0,
        width: 380.0,
        height: 380.0,
        x,
        y: [0.0, 6000.0],
    };
    let annulus = panel(70.0, [-3000.0, 3000.0]);
    let lifted = panel(530.0, [0.0, 6000.0]);
    let (mut parts, mut csv) = (String::new(), "engine,sideways_n,up_n,magnitude_n\n".to_owned());
    let arc = |radius: f64| -> Vec<[f64; 2]> {
        let angle = |n: i32| f64::from(n).to_radians();
        (-90..=90).map(|n| [radius * libm::sin(angle(n)), radius * libm::cos(angle(n))]).collect()
    };
    for (radius, style) in [
        (floor, "stroke=\"#333\" stroke-width=\"1.5\""),
        (ceiling, "stroke=\"#333\" stroke-width=\"1.5\""),
        (dead, "stroke=\"#c53030\" stroke-dasharray=\"3 3\""),
    ] {
        parts += &annulus.path(&arc(radius), style);
    }
    for tilt_deg in ["guidance_tilt_max", "tvc_tilt_max"] {
        let (sin, cos) = libm::sincos(inputs.printed.number(tilt_deg, "deg")?.to_radians());
        let reach = ceiling.min(3000.0 / sin);
        for side in [-1.0, 1.0] {
            let end = [side * reach * sin, reach * cos];
            let [from, to] = [[0.0, 0.0], end].map(|[x, y]| [annulus.px(x), annulus.py(y)]);
            parts += &styled_line(from, to, "stroke=\"#888\" stroke-dasharray=\"6 4\"");
        }
    }
    for (set, (name, colour)) in
        sets.iter().zip([("on/off, 29°", COLOURS[1]), ("always on, 60°", COLOURS[4])])
    {
        for Accepted { plan, .. } in set {
            let starts = plan.nodes.iter().zip(&plan.u_w).filter(|(_, u_w)| u_w.norm() > 0.0);
            for (node, u_w) in starts {
                let thrust_w = u_w * node.mass_kg;
                // Sideways with the sign of its larger component's axis, so that both halves fill.
                let sideways = thrust_w.xy().norm() * thrust_w.x.signum();
                let magnitude = thrust_w.norm();
                csv += &format!("{},{sideways},{},{magnitude}\n", quoted(name), thrust_w.z);
                if sideways.abs() < 3000.0 {
                    parts += &annulus.dot([sideways, thrust_w.z], 1.4, colour);
                }
                // The bound lies above by the plan's own gap at most: not seen at this scale.
                let sigma = magnitude / (1.0 - plan.report.lossless_gap);
                parts += &lifted.dot([magnitude, sigma], 1.8, colour);
            }
        }
    }
    for (index, (name, colour)) in
        [("on/off, 29°", COLOURS[1]), ("always on, 60°", COLOURS[4])].into_iter().enumerate()
    {
        parts += &key(&Frame { top: 28.0, ..annulus }, index, name, colour);
    }
    let cone = [[0.0, 0.0], [6000.0, 6000.0]];
    parts += &lifted.path(&cone, "stroke=\"#333\" stroke-width=\"1.5\"");
    for (sigma, words) in [(floor, "σ = 800 N"), (ceiling, "σ = 5200 N")] {
        parts += &lifted.path(&[[0.0, sigma], [sigma, sigma]], "stroke=\"#333\"");
        parts += &text(lifted.px(80.0), lifted.py(sigma) - 5.0, "start", 11, words);
    }
    parts += &text(lifted.px(700.0), lifted.py(3000.0), "start", 11, "‖T‖ ≤ σ: convex, and");
    parts += &text(lifted.px(700.0), lifted.py(2720.0), "start", 11, "every plan on its edge");
    parts += &text(annulus.px(0.0), annulus.py(150.0), "middle", 11, "dead zone");
    parts += &annulus.axes("(a) allowed thrust: nonconvex", "sideways, N", "up, N");
    parts += &lifted.axes("(b) lifted", "‖T‖, N", "σ, N");
    Ok(Figure {
        name: "lossless-convexification".to_owned(),
        caption: "Fig. 5 (fig:thrust_constraint) with the thrusts of all accepted plans. (a): \
                  between the arcs of 800 and 5,200 N, within the tilt limits (dashed: 29° and \
                  60°), away from the dead zone (red). (b): on the edge of the lifted cone, \
                  where the relaxation is lossless."
            .to_owned(),
        svg: picture(940.0, 495.0, &parts),
        csv,
    })
}
