//! Fig. 6 as numbers: propellant and flight time over the tilt limit, engine on and off or always on.

use guidance_fmu::scvx::{Plan, PlanError, Problem};
use rayon::prelude::*;

use super::chapter::{Chapter, cell};
use super::drawing::{COLOURS, key};
use super::problems::{Start, always_on, plan, problem};
use super::{Error, Inputs};
use crate::report::Figure;
use crate::svg::{Frame, picture};

/// Between two limits of the figure, deg.
const STEP_DEG: f64 = 2.0;
/// Every so many of them stands in the table: the paper's 10°.
const TABLE_EVERY: usize = 5;

/// The four sweeps: what flies, and whether the engine may be switched.
const SWEEPS: [(Start, bool); 4] =
    [(Start::Descent, false), (Start::Descent, true), (Start::Hop, false), (Start::Hop, true)];

type Found = Vec<Result<Plan, PlanError>>;

fn sweep(problem: &Problem, always: bool, limits_deg: &[f64]) -> Found {
    let one = |tilt_deg: &f64| {
        let limited = match always {
            true => always_on(problem, *tilt_deg, problem.mass_kg),
            false => Problem { tilt_max_rad: tilt_deg.to_radians(), ..problem.clone() },
        };
        plan(&limited)
    };
    limits_deg.par_iter().map(one).collect()
}

/// # Errors
/// A printed number that is missing.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let [low_deg, high_deg] = inputs.printed.row::<2>("sweep_tilt", "deg")?;
    let steps = ((high_deg - low_deg) / STEP_DEG).round() as u32;
    let limits_deg: Vec<f64> = (0..=steps).map(|n| low_deg + STEP_DEG * f64::from(n)).collect();
    let mut sweeps = Vec::new();
    for (start, always) in SWEEPS {
        sweeps.push(sweep(&problem(start, &inputs.bug, &inputs.printed)?, always, &limits_deg));
    }
    let rows = limits_deg.iter().enumerate().step_by(TABLE_EVERY).map(|(index, tilt_deg)| {
        let mut cells = vec![cell(*tilt_deg, 0)];
        for found in &sweeps {
            cells.extend(match &found[index] {
                Ok(plan) => [cell(plan.propellant_kg(), 3), cell(plan.duration_s(), 2)],
                Err(error) => [reason(error).to_owned(), reason(error).to_owned()],
            });
        }
        cells
    });
    let mut chapter = Chapter::new("Tilt sweep: section V-B, Fig. 6 as numbers");
    chapter.table(
        "tilt-sweep",
        "Propellant (kg) and flight time (s) over the limit of the thrust's tilt, wet mass. The \
         paper prints no number, only that both decrease with the limit. A word instead of a \
         number is the planner's reason for no plan.",
        &[
            "tilt limit, deg",
            "descent, on/off, kg",
            "descent, on/off, s",
            "descent, always on, kg",
            "descent, always on, s",
            "hop, on/off, kg",
            "hop, on/off, s",
            "hop, always on, kg",
            "hop, always on, s",
        ],
        rows.collect(),
    );
    chapter.differs(
        "with an engine that switches, propellant and time fall with the limit, as printed, and there is \
         a flight at every one of them: no \"sharp feasibility transition\". The transition is that of the \
         engine that never stops, which takes far more propellant and finds its first flight where θ_crit \
         lets it, a descent that arrives fast some ten degrees below (chapter above). It can't be \
         \"strictly on\" at 29°.",
    );
    chapter.figure(curves(&limits_deg, &sweeps));
    Ok(chapter)
}

fn reason(error: &PlanError) -> &'static str {
    match error {
        PlanError::Tilt { .. } => "tilt",
        PlanError::Fuel { .. } => "fuel",
        PlanError::Altitude { .. } => "altitude",
        PlanError::Target { .. } => "target",
        _ => "none found",
    }
}

fn curves(limits_deg: &[f64], sweeps: &[Found]) -> Figure {
    let panel = |left: f64, y: [f64; 2]| Frame {
        left,
        top: 44.0,
        width: 370.0,
        height: 250.0,
        x: [8.0, 62.0],
        y,
    };
    let panels = [panel(60.0, [3.0, 15.0]), panel(510.0, [10.0, 50.0])];
    let (mut parts, mut csv) =
        (String::new(), "flight,engine,tilt_limit_deg,propellant_kg,flight_time_s\n".to_owned());
    let colours = [COLOURS[1], COLOURS[5], COLOURS[2], COLOURS[4]];
    for (index, ((start, always), found)) in SWEEPS.into_iter().zip(sweeps).enumerate() {
        let engine = if always { "always on" } else { "on/off" };
        let mut points = [Vec::new(), Vec::new()];
        for (tilt_deg, plan) in limits_deg.iter().zip(found) {
            let Ok(plan) = plan else { continue };
            let both = [plan.propellant_kg(), plan.duration_s()];
            csv += &format!("{},{engine},{tilt_deg},{},{}\n", start.name(), both[0], both[1]);
            for (curve, value) in points.iter_mut().zip(both) {
                curve.push([*tilt_deg, value]);
            }
        }
        for (frame, curve) in panels.iter().zip(&points) {
            parts +=
                &frame.path(curve, &format!("stroke=\"{}\" stroke-width=\"1.8\"", colours[index]));
            // Also a curve of one point is seen.
            for point in curve {
                parts += &frame.dot(*point, 2.2, colours[index]);
            }
        }
        let name = format!("{}, {engine}", start.name());
        parts += &key(
            &Frame { left: 60.0 + 40.0 * index as f64, ..panels[0] },
            index,
            &name,
            colours[index],
        );
    }
    for (frame, words) in panels.iter().zip(["propellant, kg", "flight time, s"]) {
        parts += &frame.axes("", "tilt limit, deg", words);
    }
    Figure {
        name: "tilt-sweep".to_owned(),
        caption: "Propellant and flight time of minimum-propellant flights over the tilt limit; \
                  no point where there is no plan."
            .to_owned(),
        svg: picture(900.0, 345.0, &parts),
        csv,
    }
}
