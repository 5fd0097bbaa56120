//! What the paper leaves out of its stability analysis: the speed at which a vehicle tips over.

use lander_models::scenario::ContactEngine;
use lander_models::signals::TRUTH;
use lander_models::{Outcome, Ticks, Vehicle};
use rayon::prelude::*;
use truth_model::stability::{Captured, static_tip_angle_rad};

use super::chapter::{Chapter, cell};
use super::drawing::{COLOURS, key};
use super::flights::PAPER;
use super::{Error, Inputs};
use crate::report::Figure;
use crate::statistics::quantile::quantile;
use crate::svg::{Frame, picture, text};
use crate::touchdowns::{self, COLUMNS, Case};

/// Speed down in the simulated touchdowns, m/s: soft, so that the speed across decides.
const DOWN_M_S: f64 = 0.3;
/// Speeds across that are tried, m/s: upwards until one tips, then between the last two.
const COARSE_M_S: f64 = 0.5;
const FASTEST_M_S: f64 = 4.5;
const RESOLUTION_M_S: f64 = 0.01;
const STOP: Ticks = Ticks(30_000);

/// Which way the vehicle moves: to an edge or to a pad, with the heading that does it.
const WAYS: [(&str, f64); 2] = [("over an edge", 0.0), ("over a pad", 45.0)];

/// The closed form (T.24) on point pads, by the distance to what it tips over.
fn captured(bug: &Vehicle, propellant_kg: f64, over_pad: bool, slope_deg: f64) -> Captured {
    let mass = bug.mass.at(propellant_kg);
    let radius_m = bug.gear.feet_b().map(|foot_b| foot_b.xy().norm()).fold(0.0, f64::max);
    let distance_m = if over_pad { radius_m } else { radius_m * std::f64::consts::FRAC_1_SQRT_2 };
    Captured {
        mass_kg: mass.mass_kg,
        inertia_kg_m2: mass.inertia_b[(1, 1)],
        distance_m,
        height_m: mass.com_b.z,
        pad_radius_m: 0.0,
        slope_rad: slope_deg.to_radians(),
    }
}

/// Speed across from which on the whole model tips over on captured pads; `None` up to `FASTEST_M_S`.
fn simulated(
    bug: &Vehicle,
    propellant_kg: f64,
    yaw_deg: f64,
    slope_deg: f64,
    gravity_m_s2: f64,
) -> Result<Option<f64>, Error> {
    let case = |across_m_s: f64| -> Case {
        COLUMNS.map(|(column, _)| match column {
            "propellant_kg" => propellant_kg,
            "gravity_m_s2" => gravity_m_s2,
            "down_m_s" => DOWN_M_S,
            "across_m_s" => across_m_s,
            // With the slope: the body leans downhill, towards x.
            "pitch_deg" | "slope_deg" => slope_deg,
            "yaw_deg" => yaw_deg,
            "friction" => 0.5,
            "captured" => 1.0,
            _ => 0.0,
        })
    };
    let tips = |across_m_s: f64| -> Result<bool, Error> {
        let model = touchdowns::model(bug, ContactEngine::Strut, STOP, &case(across_m_s))?;
        let (_, outputs) = touchdowns::settle(&model)?;
        let code = TRUTH.output_offset("outcome").map_or(f64::NAN, |offset| outputs[offset]);
        Ok(Outcome::from_code(code) == Some(Outcome::Tipped))
    };
    let mut over_m_s = COARSE_M_S;
    while !tips(over_m_s)? {
        over_m_s += COARSE_M_S;
        if over_m_s > FASTEST_M_S {
            return Ok(None);
        }
    }
    let mut upright_m_s = over_m_s - COARSE_M_S;
    while over_m_s - upright_m_s > RESOLUTION_M_S {
        let middle_m_s = 0.5 * (over_m_s + upright_m_s);
        if tips(middle_m_s)? { over_m_s = middle_m_s } else { upright_m_s = middle_m_s }
    }
    Ok(Some(over_m_s))
}

/// # Errors
/// A printed number that is missing, a touchdown that breaks off.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let gravity = printed.number("gravity", "m/s2")?;
    let mut cases = Vec::new();
    for (fill, propellant_kg) in [("wet", bug.mass.propellant.capacity_kg), ("dry", 0.0)] {
        for slope_deg in [0.0, 12.0] {
            for way in WAYS {
                cases.push((fill, propellant_kg, slope_deg, way));
            }
        }
    }
    let row = |(fill, propellant_kg, slope_deg, (way, yaw_deg)): (&str, f64, f64, (&str, f64))| {
        let form = captured(bug, propellant_kg, yaw_deg != 0.0, slope_deg);
        let static_deg = static_tip_angle_rad(form.distance_m, form.height_m).to_degrees();
        let found = simulated(bug, propellant_kg, yaw_deg, slope_deg, gravity)?;
        Ok(vec![
            fill.to_owned(),
            cell(slope_deg, 0),
            way.to_owned(),
            "not printed".to_owned(),
            cell(static_deg - slope_deg, 2),
            cell(form.tip_speed_m_s(gravity), 3),
            found.map_or("none to 4.5".to_owned(), |speed_m_s| cell(speed_m_s, 2)),
        ])
    };
    let rows: Vec<Result<Vec<String>, Error>> = cases.into_par_iter().map(row).collect();
    let rows: Vec<_> = rows.into_iter().collect::<Result<_, _>>()?;
    // In the order of the cases: dry, over an edge, level and on 12°.
    let [level, stands, downhill] = [(4, 5), (4, 4), (6, 5)].map(|(row, column)| {
        let row: &Vec<String> = &rows[row];
        row[column].clone()
    });
    let mut chapter = Chapter::new("Dynamic tip-over: what section II-B leaves out");
    chapter.table(
        "dynamic-tip-over",
        "Speed, parallel to the ground and downhill, at which a vehicle on captured pads tips \
         over: the closed form of a rigid vehicle (T.17, T.24), and touchdowns at 0.3 m/s down \
         with legs that crush, to 0.01 m/s (strut engine).",
        &[
            "BUG",
            "slope, deg",
            "moves",
            "printed",
            "static margin, deg",
            "closed form, m/s",
            "simulated, m/s",
        ],
        rows,
    );
    let [median, high] = [0.5, 0.99].map(|share| {
        let across = inputs.flights.of(PAPER).map(|flown| flown.sorted("contact_speed_across_m_s"));
        cell(quantile(across.unwrap_or_default(), share).value, 1)
    });
    chapter.differs(format!(
        "a static angle is no criterion for a landing: dry and level, {level} m/s tip it over an edge \
         though it stands on a slope of {stands}°. On 12° the closed form leaves {downhill} m/s; a plan \
         each 10 s without feedback touches down at {median} m/s across in the median and {high} m/s at \
         99 % (below). Level, legs that crush take up energy and the simulated limit is higher; downhill, \
         the crushed legs lean the body on and hardly anything of that is left.",
    ));
    chapter.figure(curves(bug, gravity));
    Ok(chapter)
}

fn curves(bug: &Vehicle, gravity: f64) -> Figure {
    let panel = |left: f64, high: f64| Frame {
        left,
        top: 44.0,
        width: 370.0,
        height: 260.0,
        x: [0.0, 45.0],
        y: [0.0, high],
    };
    let panels = [panel(60.0, 60.0), panel(510.0, 3.5)];
    let (mut parts, mut csv) =
        (String::new(), "vehicle,over,slope_deg,static_margin_deg,tip_speed_m_s\n".to_owned());
    let kinds = [
        ("dry, pad", 0.0, true, COLOURS[3]),
        ("dry, edge", 0.0, false, COLOURS[1]),
        ("wet, pad", bug.mass.propellant.capacity_kg, true, COLOURS[5]),
        ("wet, edge", bug.mass.propellant.capacity_kg, false, COLOURS[0]),
    ];
    for (index, (name, propellant_kg, over_pad, colour)) in kinds.into_iter().enumerate() {
        let mut points = [Vec::new(), Vec::new()];
        for step in 0..=180 {
            let slope_deg = 0.25 * f64::from(step);
            let form = captured(bug, propellant_kg, over_pad, slope_deg);
            let margin_deg =
                static_tip_angle_rad(form.distance_m, form.height_m).to_degrees() - slope_deg;
            if margin_deg < 0.0 {
                break;
            }
            let speed = form.tip_speed_m_s(gravity);
            csv += &format!("{},{},{slope_deg},{margin_deg},{speed}\n", &name[..3], &name[5..]);
            points[0].push([slope_deg, margin_deg]);
            points[1].push([slope_deg, speed]);
        }
        for (frame, curve) in panels.iter().zip(&points) {
            parts += &frame.path(curve, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
        }
        parts += &key(&panels[0], index, name, colour);
    }
    parts +=
        &panels[0].path(&[[0.0, 29.0], [45.0, 29.0]], "stroke=\"#666\" stroke-dasharray=\"5 4\"");
    parts += &text(panels[0].px(0.6), panels[0].py(29.0) - 4.0, "start", 11, "29°");
    parts += &panels[0].axes("", "slope, deg", "static margin, deg");
    parts += &panels[1].axes("", "slope, deg", "captured tip speed downhill, m/s");
    Figure {
        name: "dynamic-tip-over".to_owned(),
        caption: "Margin of the static angle and captured tip speed over the slope. At 15° the \
                  margin of the dry vehicle over an edge is the 29° that the paper compares 52° \
                  with."
            .to_owned(),
        svg: picture(900.0, 355.0, &parts),
        csv,
    }
}
