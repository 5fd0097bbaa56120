//! Equation (eq:feasibility): the tilt beyond which an engine that never stops can sink.

use guidance_fmu::scvx::disprove;

use super::chapter::{Chapter, cell};
use super::drawing::{COLOURS, key};
use super::problems::{Start, always_on, plan, problem};
use super::{Error, Inputs};
use crate::csv::quoted;
use crate::report::Figure;
use crate::svg::{Frame, picture, text};

/// arccos(m g/ρ_min), deg; 0 where the floor does not lift the vehicle.
pub fn critical_deg(mass_kg: f64, gravity_m_s2: f64, floor_n: f64) -> f64 {
    libm::acos((mass_kg * gravity_m_s2 / floor_n).min(1.0)).to_degrees()
}

/// Resolution of the least tilt, deg.
const RESOLUTION_DEG: f64 = 0.02;
/// Widest tilt that is tried, deg.
const WIDEST_DEG: f64 = 85.0;

/// Least tilt limit, deg, at which a flight with the engine always on is found; `None` up to `WIDEST_DEG`.
fn least_deg(inputs: &Inputs, start: Start, mass_kg: f64) -> Result<Option<f64>, Error> {
    let problem = problem(start, &inputs.bug, &inputs.printed)?;
    let found = |tilt_deg: f64| plan(&always_on(&problem, tilt_deg, mass_kg)).is_ok();
    // From wide to narrow in steps, then bisection: a wider limit cannot take a plan away, but a search can fail.
    let steps = (0..=60).map(|n| WIDEST_DEG - f64::from(n));
    let mut least = None;
    for tilt_deg in steps {
        if found(tilt_deg) {
            least = Some(tilt_deg);
        } else if least.is_some() {
            break;
        }
    }
    let Some(mut works) = least else { return Ok(None) };
    let mut fails = works - 1.0;
    while works - fails > RESOLUTION_DEG {
        let middle = 0.5 * (works + fails);
        if found(middle) { works = middle } else { fails = middle }
    }
    Ok(Some(works))
}

/// Greatest tilt limit, deg, at which such a flight is disproven (G.102).
fn disproven_deg(inputs: &Inputs, start: Start, mass_kg: f64) -> Result<f64, Error> {
    let problem = problem(start, &inputs.bug, &inputs.printed)?;
    let (mut refused, mut open) = (0.0, WIDEST_DEG);
    while open - refused > 0.1 * RESOLUTION_DEG {
        let middle = 0.5 * (refused + open);
        match disprove(&always_on(&problem, middle, mass_kg)) {
            Ok(()) => open = middle,
            Err(_) => refused = middle,
        }
    }
    Ok(refused)
}

/// # Errors
/// A printed number that is missing.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let (gravity, floor_n) = (printed.number("gravity", "m/s2")?, bug.engine.thrust_min_n);
    let (wet_kg, dry_kg) = (bug.mass.wet_mass_kg(), bug.mass.dry.mass_kg);
    let wide_deg = printed.number("tvc_tilt_max", "deg")?;
    let printed_deg = printed.number("critical_tilt", "deg")?;
    let [fired_n, _] = printed.row::<2>("hot_fire_thrust", "N")?;
    let crossing_kg = floor_n * libm::cos(wide_deg.to_radians()) / gravity;
    let (mut rows, mut points) = (Vec::new(), Vec::new());
    for mass_kg in [wet_kg, crossing_kg, 220.0, 200.0, dry_kg + 12.0] {
        let formula_deg = critical_deg(mass_kg, gravity, floor_n);
        let least =
            [least_deg(inputs, Start::Hop, mass_kg)?, least_deg(inputs, Start::Descent, mass_kg)?];
        let word = |deg: Option<f64>| deg.map_or("none".to_owned(), |deg| cell(deg, 1));
        rows.push(vec![
            cell(mass_kg, 2),
            if mass_kg == wet_kg { cell(printed_deg, 0) } else { "not printed".to_owned() },
            cell(formula_deg, 2),
            cell(disproven_deg(inputs, Start::Hop, mass_kg)?, 2),
            word(least[0]),
            cell(disproven_deg(inputs, Start::Descent, mass_kg)?, 2),
            word(least[1]),
            cell(critical_deg(mass_kg, gravity, fired_n), 2),
        ]);
        points.push((mass_kg, least));
    }
    let mut chapter = Chapter::new("Critical tilt: equation (eq:feasibility)");
    chapter.table(
        "critical-tilt",
        "θ_crit = arccos(m g/ρ_min); the tilt limit up to which no flight with the engine always on \
         exists, because the floor ends every descent above the target (guidance-fmu/README.md, \
         G.102), and the limit from which the planner finds one.",
        &[
            "mass, kg",
            "printed, deg",
            "paper's formula, deg",
            "hop: none up to (proven), deg",
            "hop: planned from, deg",
            "descent: none up to (proven), deg",
            "descent: planned from, deg",
            "formula at 1,260 N, the least thrust fired, deg",
        ],
        rows,
    );
    chapter.differs(format!(
        "θ_crit grows as propellant is used: the printed 60° of the thrust vector control \
         exceeds it for the first {} kg only ({} kg and above), and with the least thrust that \
         was fired never. It separates having a net downward acceleration with the engine on \
         from having none, not the feasible from the infeasible: a vehicle at rest needs \
         somewhat more than θ_crit, one that arrives fast may be lifted all the way and lands \
         with less.",
        cell(wet_kg - crossing_kg, 1),
        cell(crossing_kg, 2),
    ));
    chapter.figure(curve(inputs, gravity, [floor_n, fired_n], &points)?);
    Ok(chapter)
}

type Least = (f64, [Option<f64>; 2]);

fn curve(
    inputs: &Inputs,
    gravity: f64,
    floors_n: [f64; 2],
    points: &[Least],
) -> Result<Figure, Error> {
    let frame = Frame {
        left: 60.0,
        top: 44.0,
        width: 620.0,
        height: 300.0,
        x: [170.0, 265.0],
        y: [25.0, 85.0],
    };
    let (dry_kg, wet_kg) = (inputs.bug.mass.dry.mass_kg, inputs.bug.mass.wet_mass_kg());
    let masses: Vec<f64> =
        (0..=171).map(|n| dry_kg + (wet_kg - dry_kg) * f64::from(n) / 171.0).collect();
    let (mut parts, mut csv) = (String::new(), "what,mass_kg,tilt_deg\n".to_owned());
    for (index, floor_n) in floors_n.into_iter().enumerate() {
        let curve: Vec<[f64; 2]> =
            masses.iter().map(|kg| [*kg, critical_deg(*kg, gravity, floor_n)]).collect();
        for [kg, deg] in &curve {
            csv += &format!("critical tilt at {floor_n} N,{kg},{deg}\n");
        }
        let colour = COLOURS[1 + 2 * index];
        parts += &frame.path(&curve, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
        parts += &key(&frame, index, &format!("θ_crit, {floor_n} N"), colour);
    }
    for (index, (name, colour)) in
        [("least, hop", COLOURS[0]), ("least, descent", COLOURS[5])].into_iter().enumerate()
    {
        for (kg, least) in points {
            let Some(deg) = least[index] else { continue };
            parts += &frame.dot([*kg, deg], 4.0, colour);
            csv += &format!("{},{kg},{deg}\n", quoted(name));
        }
        parts += &key(&frame, index + 2, name, colour);
    }
    for (key, words) in [("tvc_tilt_max", "TVC 60°"), ("guidance_tilt_max", "ACS 29°")] {
        let deg = inputs.printed.number(key, "deg")?;
        parts +=
            &frame.path(&[[170.0, deg], [265.0, deg]], "stroke=\"#666\" stroke-dasharray=\"5 4\"");
        parts += &text(frame.px(170.7), frame.py(deg) - 4.0, "start", 11, words);
    }
    parts += &frame.axes("", "mass, kg", "tilt limit, deg");
    Ok(Figure {
        name: "critical-tilt".to_owned(),
        caption: "The critical tilt over the mass; dots: the least limit at which a flight with \
                  the engine always on is found."
            .to_owned(),
        svg: picture(720.0, 395.0, &parts),
        csv,
    })
}
