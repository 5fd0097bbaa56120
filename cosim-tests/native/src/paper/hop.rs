//! Fig. 6: the hop over the tilt limit, as planned and as flown in six degrees of freedom.

use std::ops::ControlFlow;

use guidance_fmu::scvx::{Plan, Problem};
use lander_models::signals::{GUIDANCE, Interface, POSITION_W, TRUTH};
use lander_models::{ModelError, Outcome, Scenario, Vehicle};
use rayon::prelude::*;

use super::chapter::{Chapter, cell};
use super::drawing::{COLOURS, key};
use super::problems::{Start, plan, problem};
use super::{Error, Inputs};
use crate::flight;
use crate::layout::Layout;
use crate::report::Figure;
use crate::schedule::{Pair, Schedule};
use crate::svg::{Frame, picture};

const LIMITS_DEG: [f64; 6] = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0];
const BASE: &str = include_str!("../../../../models/scenarios/hop.toml");
/// Between two points of a path as drawn, s.
const DRAWN_S: f64 = 0.1;

/// A hop in six degrees of freedom.
struct Flown {
    /// Distance to the target and height, m.
    path: Vec<[f64; 2]>,
    outcome: &'static str,
    propellant_kg: f64,
    flight_s: f64,
    down_m_s: f64,
    across_m_s: f64,
    tilt_deg: f64,
    miss_m: f64,
}

fn fly(bug: &Vehicle, tilt_deg: f64, schedule: &Schedule, layout: &Layout) -> Result<Flown, Error> {
    let limit = format!("[guidance]\ntilt_max = {{ value = {tilt_deg:?}, unit = \"deg\" }}");
    let text = BASE.replacen("[guidance]", &limit, 1);
    let scenario = Scenario::parse("hop.toml".as_ref(), &text, bug)?;
    let (mut path, mut last, mut next_s) = (Vec::new(), Vec::new(), 0.0);
    let world = (&scenario, bug);
    flight::fly(schedule, world, world, |row| {
        if row[0] >= next_s {
            next_s = row[0] + DRAWN_S;
            let [x, y, z] = layout.vector(row, POSITION_W.name).unwrap_or_default();
            path.push([libm::hypot(x, y) * x.signum(), z]);
        }
        last.clear();
        last.extend_from_slice(row);
        Ok::<_, ModelError>(ControlFlow::Continue(()))
    })?;
    let value = |name| layout.scalar(&last, name);
    Ok(Flown {
        path,
        outcome: Outcome::from_code(value("outcome")).unwrap_or_default().name(),
        propellant_kg: value("propellant_used_kg"),
        flight_s: value("flight_time_s"),
        down_m_s: value("contact_speed_down_m_s"),
        across_m_s: value("contact_speed_across_m_s"),
        tilt_deg: value("contact_tilt_deg"),
        miss_m: value("position_error_m"),
    })
}

/// # Errors
/// A printed number that is missing, a hop without a plan, a flight that a component breaks off.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let interfaces: Pair<&'static Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };
    let schedule = Schedule::load(&interfaces)?;
    let layout = Layout::new(&schedule, &interfaces);
    let nominal = problem(Start::Hop, bug, printed)?;
    let planned: Vec<Plan> = LIMITS_DEG
        .iter()
        .map(|tilt_deg| plan(&Problem { tilt_max_rad: tilt_deg.to_radians(), ..nominal.clone() }))
        .collect::<Result<_, _>>()
        .map_err(|source| Error::Plan { what: "hop", source })?;
    let flown: Vec<Flown> = LIMITS_DEG
        .par_iter()
        .map(|tilt_deg| fly(bug, *tilt_deg, &schedule, &layout))
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<_, _>>()?;
    let rows =
        LIMITS_DEG.iter().zip(planned.iter().zip(&flown)).map(|(tilt_deg, (plan, flown))| {
            let height_m = top_m(&path(plan));
            let mut cells: Vec<String> =
                [(*tilt_deg, 0), (plan.propellant_kg(), 3), (plan.duration_s(), 2), (height_m, 1)]
                    .map(|(value, decimals)| cell(value, decimals))
                    .to_vec();
            cells.extend(
                [(flown.propellant_kg, 2), (flown.flight_s, 1)].map(|(value, d)| cell(value, d)),
            );
            cells.push(flown.outcome.to_owned());
            let contact = [
                (flown.down_m_s, 2),
                (flown.across_m_s, 2),
                (flown.tilt_deg, 2),
                (flown.miss_m, 2),
            ];
            cells.extend(contact.map(|(value, decimals)| cell(value, decimals)));
            cells
        });
    let mut chapter = Chapter::new("Hop trajectories: Fig. 6");
    chapter.table(
        "hop",
        "The hop of 200 m over the tilt limit: planned within the engine's whole range, and \
         flown to rest by the closed loop.",
        &[
            "tilt limit, deg",
            "plan: propellant, kg",
            "plan: time, s",
            "plan: apex, m",
            "flown: propellant, kg",
            "flown: time to contact, s",
            "flown: outcome",
            "down at contact, m/s",
            "across, m/s",
            "tilt at contact, deg",
            "miss, m",
        ],
        rows.collect(),
    );
    chapter.differs(
        "the paper's figure gives neither distance nor numbers. A plan is a point's, from rest \
         5 m up to rest; a flight lifts off, turns a body of 140 kg m² at a finite rate, keeps \
         the thrust between 900 and 2,500 N so that tracking has room, brakes to cut-off and \
         falls the last 0.45 m onto its legs.",
    );
    chapter.figure(paths(&planned, &flown));
    Ok(chapter)
}

/// A plan as it is drawn: distance to the target and height, m.
fn path(plan: &Plan) -> Vec<[f64; 2]> {
    let steps = (plan.duration_s() / DRAWN_S).ceil();
    let times = (0..=steps as u32).map(|n| plan.duration_s() * f64::from(n) / steps);
    times
        .map(|t_s| plan.sample(t_s).r_w)
        .map(|r_w| [r_w.xy().norm() * r_w.x.signum(), r_w.z])
        .collect()
}

fn top_m(path: &[[f64; 2]]) -> f64 {
    path.iter().map(|[_, height_m]| *height_m).fold(0.0, f64::max)
}

fn paths(planned: &[Plan], flown: &[Flown]) -> Figure {
    let planned: Vec<_> = planned.iter().map(path).collect();
    let paths = planned.iter().chain(flown.iter().map(|flown| &flown.path));
    let high_m = 1.05 * paths.map(|path| top_m(path)).fold(1.0, f64::max);
    let frame = |top: f64| Frame {
        left: 60.0,
        top,
        width: 660.0,
        height: 260.0,
        x: [-10.0, 210.0],
        y: [0.0, high_m],
    };
    let (upper, lower) = (frame(54.0), frame(374.0));
    let (mut parts, mut csv) =
        (String::new(), "what,tilt_limit_deg,distance_m,height_m\n".to_owned());
    for (index, ((planned, flown), tilt_deg)) in
        planned.iter().zip(flown).zip(LIMITS_DEG).enumerate()
    {
        for (what, path) in [("planned", planned), ("flown", &flown.path)] {
            for [distance, height] in path {
                csv += &format!("{what},{tilt_deg},{distance},{height}\n");
            }
        }
        let style = format!("stroke=\"{}\" stroke-width=\"1.8\"", COLOURS[index]);
        parts += &upper.path(planned, &style);
        parts += &lower.path(&flown.path, &style);
        parts +=
            &key(&Frame { top: 36.0, ..upper }, index, &format!("{tilt_deg}°"), COLOURS[index]);
    }
    parts += &upper.axes("planned (minimum propellant)", "distance to the target, m", "height, m");
    parts +=
        &lower.axes("flown in six degrees of freedom", "distance to the target, m", "height, m");
    Figure {
        name: "hop".to_owned(),
        caption: "Fig. 6 (fig:theta_combined): hop trajectories for tilt limits of 10° to 60°."
            .to_owned(),
        svg: picture(760.0, 685.0, &parts),
        csv,
    }
}
