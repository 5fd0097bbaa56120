//! What equation (eq:feasibility) stands for: the speeds at each height from which a descent can end at rest.

use super::chapter::{Chapter, cell};
use super::critical_tilt::critical_deg;
use super::drawing::{COLOURS, key};
use super::problems::{Start, always_on, plan, problem};
use super::{Error, Inputs};
use crate::csv::quoted;
use crate::report::Figure;
use crate::svg::{Frame, picture, text};
use guidance_fmu::scvx::{PathLimits, Problem, disprove};
use nalgebra::Vector3;

fn straight_down(problem: &Problem, height_m: f64, speed_m_s: f64) -> Problem {
    let (r0_w, v0_w) = (Vector3::new(0.0, 0.0, height_m), Vector3::new(0.0, 0.0, -speed_m_s));
    let path = PathLimits { altitude_min_m: Some(0.0), ..PathLimits::default() };
    Problem { r0_w, v0_w, path, ..problem.clone() }
}

/// Where `allowed` speeds end, m/s, from one that is towards one that need not be; `None` if not even the first is.
fn end_m_s(allowed: impl Fn(f64) -> bool, from_m_s: f64, to_m_s: f64) -> Option<f64> {
    let (mut inside, mut outside) = (from_m_s, to_m_s);
    if !allowed(inside) || allowed(outside) {
        return allowed(outside).then_some(outside);
    }
    while (inside - outside).abs() > RESOLUTION_M_S {
        let middle = 0.5 * (inside + outside);
        if allowed(middle) { inside = middle } else { outside = middle }
    }
    Some(inside)
}

/// Greatest speed of arrival at a height that is not disproven (G.93), m/s.
fn greatest_m_s(problem: &Problem, height_m: f64) -> Option<f64> {
    end_m_s(|speed| disprove(&straight_down(problem, height_m, speed)).is_ok(), 0.0, FASTEST_M_S)
}

/// Least speed of arrival that is not disproven for an engine that never stops (G.102), m/s.
fn least_m_s(problem: &Problem, tilt_deg: f64, height_m: f64) -> Option<f64> {
    let on = always_on(problem, tilt_deg, problem.mass_kg);
    let allowed = |speed: f64| disprove(&straight_down(&on, height_m, speed)).is_ok();
    greatest_m_s(problem, height_m).and_then(|greatest| end_m_s(allowed, greatest, 0.0))
}

/// Resolution of the ends of the band, m/s.
const RESOLUTION_M_S: f64 = 0.005;
/// Nothing that fast can be stopped from the greatest height.
const FASTEST_M_S: f64 = 250.0;
const HEIGHTS_M: [f64; 5] = [50.0, 100.0, 200.0, 500.0, 1000.0];
const TILTS_DEG: [f64; 4] = [29.0, 45.0, 55.0, 60.0];

/// # Errors
/// A printed number that is missing.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let descent = problem(Start::Descent, &inputs.bug, &inputs.printed)?;
    let word = |speed: Option<f64>| speed.map_or("none".to_owned(), |speed| cell(speed, 2));
    let mut rows = Vec::new();
    for height_m in HEIGHTS_M {
        let greatest = greatest_m_s(&descent, height_m);
        let on_and_off = |speed: f64| plan(&straight_down(&descent, height_m, speed)).is_ok();
        let planned = greatest.and_then(|greatest| end_m_s(on_and_off, 0.5 * greatest, greatest));
        let mut row = vec![cell(height_m, 0), word(greatest), word(planned)];
        for tilt_deg in TILTS_DEG {
            let least = least_m_s(&descent, tilt_deg, height_m);
            let on = always_on(&descent, tilt_deg, descent.mass_kg);
            let never_off = |speed: f64| plan(&straight_down(&on, height_m, speed)).is_ok();
            let ends = least.zip(greatest);
            // From half-way into the band, where a flight is easily found.
            let planned = ends
                .and_then(|(least, greatest)| end_m_s(never_off, 0.5 * (least + greatest), least));
            row.extend([word(least), word(planned)]);
        }
        rows.push(row);
    }
    let heads = TILTS_DEG.map(|tilt| {
        let least = format!("least with the engine always on, {tilt}°, m/s");
        [least, format!("planner, {tilt}°")]
    });
    let mut header = vec!["height, m", "greatest, m/s", "planner, on and off, 29°"];
    header.extend(heads.iter().flatten().map(String::as_str));
    let mut chapter = Chapter::new("Feasible speeds: what equation (eq:feasibility) stands for");
    chapter.table(
        "feasible-band",
        "Straight down at the wet mass: the downward speeds at each height from which a descent \
         can end at rest, by proof, and how far from the middle of that band the planner finds \
         flights.",
        &header,
        rows,
    );
    let (gravity, floor_n) = (descent.gravity_m_s2, descent.thrust_min_n);
    chapter.differs(format!(
        "the paper calls burn-coast-burn required below θ_crit, {}° here. What is required with \
         an engine that never stops is an arrival within a band: no faster than full thrust can \
         brake, no slower than the floor, tilted to its limit, would stop the vehicle above the \
         ground. Beyond θ_crit the lower end is zero, up to the height from which the vehicle \
         burns itself so light that the floor lifts it. Below the least speed there is no flight \
         (proof: guidance-fmu/README.md, G.102). Down to it a vehicle must swing from side to \
         side, tilted all the way; the planner finds such flights near the ends of its columns \
         only with luck, and says \"not found\" where it finds none.",
        cell(critical_deg(descent.mass_kg, gravity, floor_n), 2),
    ));
    chapter.figure(figure(&descent));
    Ok(chapter)
}

fn figure(descent: &Problem) -> Figure {
    let frame = Frame {
        left: 60.0,
        top: 44.0,
        width: 620.0,
        height: 320.0,
        x: [0.0, 1000.0],
        y: [0.0, 100.0],
    };
    let heights = || (1..=200).map(|n| 5.0 * f64::from(n));
    let (mut parts, mut csv) = (String::new(), "what,height_m,speed_m_s\n".to_owned());
    let mut add = |index: usize, name: &str, curve: Vec<[f64; 2]>| {
        for [height_m, speed_m_s] in &curve {
            csv += &format!("{},{height_m},{speed_m_s}\n", quoted(name));
        }
        let colour = COLOURS[index];
        parts += &frame.path(&curve, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
        parts += &key(&frame, index, name, colour);
    };
    let most = heights().filter_map(|h| Some([h, greatest_m_s(descent, h)?]));
    add(0, "greatest", most.collect());
    for (index, tilt_deg) in (1..).zip(TILTS_DEG) {
        let least = heights().filter_map(|h| Some([h, least_m_s(descent, tilt_deg, h)?]));
        add(index, &format!("least, {tilt_deg}°"), least.collect());
    }
    let (height_m, speed_m_s) = (descent.r0_w.z, -descent.v0_w.z);
    csv += &format!("start of the descent,{height_m},{speed_m_s}\n");
    parts += &frame.dot([height_m, speed_m_s], 4.0, COLOURS[5]);
    let (x, y) = (frame.px(height_m) + 7.0, frame.py(speed_m_s) + 14.0);
    parts += &text(x, y, "start", 11, "the descent's start");
    parts += &frame.axes("", "height, m", "downward speed, m/s");
    Figure {
        name: "feasible-band".to_owned(),
        caption: "Speeds from which a vertical descent at the wet mass can end at rest: below \
                  the greatest, and with an engine that never stops above the least of its tilt \
                  limit."
            .to_owned(),
        svg: picture(720.0, 415.0, &parts),
        csv,
    }
}
