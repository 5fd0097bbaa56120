//! Table V: BUG among its peers, as printed and as sourced, with the criteria of tip-over over what is not known.

use lander_models::vehicle::G0_M_S2;
use lander_models::{ConfigError, Vehicle};
use nalgebra::Vector3;
use truth_model::stability::{captured_tip_speed_m_s, static_tip_angle_rad};

use super::chapter::{Chapter, cell};
use super::drawing::COLOURS;
use super::printed::Printed;
use super::tip_angle::extremes_rad;
use super::{Error, Inputs};
use crate::csv::quoted;
use crate::report::Figure;
use crate::svg::{Frame, picture, styled_line, text};

/// Files of the vehicles in the table's order, and whether the paper prints wet mass and thrust-to-weight.
pub const FILES: [&str; 7] =
    ["bug", "colibri", "xodiac", "morpheus", "blue-ghost", "resilience", "im-2"];
/// Vehicles with a landing on record, which the paper does not list.
pub const BESIDE: [&str; 2] = ["apollo-lm", "surveyor"];
const WITH_MASS: usize = 4;

/// What the paper prints of one vehicle; NaN for "N/A".
struct Row {
    thrust_kn: [f64; 2],
    wet_kg: f64,
    height_m: f64,
    footprint_m: f64,
    aspect: f64,
    to_weight: f64,
}

fn printed_rows(printed: &Printed) -> Result<Vec<Row>, ConfigError> {
    let row = |key: &str, unit: &str| printed.row::<7>(key, unit);
    let (low, high) = (row("comparison_thrust_low", "kN")?, row("comparison_thrust_high", "kN")?);
    let (heights, footprints) = (row("comparison_height", "m")?, row("comparison_footprint", "m")?);
    let aspects = row("comparison_aspect_ratio", "1")?;
    let wet = printed.row::<WITH_MASS>("comparison_wet_mass", "kg")?;
    let to_weight = printed.row::<WITH_MASS>("comparison_thrust_to_weight", "1")?;
    let known = |values: &[f64; WITH_MASS], n: usize| values.get(n).copied().unwrap_or(f64::NAN);
    let one = |n: usize| Row {
        thrust_kn: [low[n], high[n]],
        wet_kg: known(&wet, n),
        height_m: heights[n],
        footprint_m: footprints[n],
        aspect: aspects[n],
        to_weight: known(&to_weight, n),
    };
    Ok((0..FILES.len()).map(one).collect())
}

/// The criteria at the ends of what is known of the centre of mass; equal where it is known.
pub struct Criteria {
    /// Of the nearly empty vehicle, m above the pads.
    pub com_height_m: [f64; 2],
    /// The paper's formula, over a pad, deg; the higher the centre of mass, the less.
    pub pad_deg: [f64; 2],
    /// Least over all headings, deg.
    pub edge_deg: [f64; 2],
    /// Speed at which captured pads tip it over an edge on level lunar ground (T.17), m/s.
    pub tip_speed_m_s: [f64; 2],
}

/// Of a vehicle without propellant; `least` comes from the highest centre of mass.
pub fn criteria(vehicle: &Vehicle, gravity_m_s2: f64) -> Criteria {
    let mass = vehicle.mass.at(0.0);
    let feet_b: Vec<Vector3<f64>> = vehicle.gear.feet_b().collect();
    let radius_m = feet_b.iter().map(|foot_b| foot_b.xy().norm()).fold(0.0, f64::max);
    let com_height_m = vehicle.com_height_range_m.unwrap_or([mass.com_b.z; 2]);
    let of_heights = |of: &dyn Fn(f64) -> f64| {
        let [low, high] = com_height_m;
        [of(high), of(low)]
    };
    let com_at = |height_m: f64| Vector3::new(mass.com_b.x, mass.com_b.y, height_m);
    let tip_speed = |height_m: f64| {
        let next = feet_b.iter().cycle().skip(1);
        let over_edge = |(foot_b, next_b): (&Vector3<f64>, &Vector3<f64>)| {
            let edge_b = (next_b - foot_b).normalize();
            let distance_m = (foot_b - com_at(height_m)).dot(&edge_b.cross(&Vector3::z()));
            let inertia = edge_b.dot(&(mass.inertia_b * edge_b));
            captured_tip_speed_m_s(mass.mass_kg, inertia, distance_m, height_m, gravity_m_s2)
        };
        feet_b.iter().zip(next).map(over_edge).fold(f64::INFINITY, f64::min)
    };
    Criteria {
        com_height_m,
        pad_deg: of_heights(&|h| static_tip_angle_rad(radius_m, h).to_degrees()),
        edge_deg: of_heights(&|h| extremes_rad(&feet_b, com_at(h))[0].to_degrees()),
        tip_speed_m_s: of_heights(&tip_speed),
    }
}

/// One number, or low to high.
fn range([low, high]: [f64; 2], decimals: usize) -> String {
    match low == high {
        true => cell(low, decimals),
        false => format!("{} to {}", cell(low, decimals), cell(high, decimals)),
    }
}

fn or_none(value: f64, decimals: usize) -> String {
    if value.is_nan() { "N/A".to_owned() } else { cell(value, decimals) }
}

/// # Errors
/// A printed number that is missing, a vehicle that is missing or wrong.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let printed = &inputs.printed;
    let gravity = printed.number("gravity", "m/s2")?;
    let load = |name: &&str| Vehicle::load(&inputs.models.join(format!("vehicles/{name}.toml")));
    let vehicles: Vec<Vehicle> = FILES.iter().map(load).collect::<Result<_, _>>()?;
    let beside: Vec<Vehicle> = BESIDE.iter().map(load).collect::<Result<_, _>>()?;
    let mut as_printed = Vec::new();
    for (vehicle, row) in vehicles.iter().zip(printed_rows(printed)?) {
        let footprint_m = 2.0 * vehicle.gear.feet_b().map(|f| f.xy().norm()).fold(0.0, f64::max);
        let (wet_kg, thrust_n) = (vehicle.mass.wet_mass_kg(), vehicle.engine.thrust_max_n);
        as_printed.push(vec![
            vehicle.name.clone(),
            range(row.thrust_kn, 1),
            cell(1e-3 * thrust_n, 1),
            or_none(row.wet_kg, 0),
            cell(wet_kg, 0),
            cell(row.height_m, 2),
            cell(vehicle.hull.top_height_m, 2),
            cell(row.footprint_m, 2),
            cell(footprint_m, 2),
            cell(row.aspect, 2),
            cell(row.height_m / row.footprint_m, 3),
            or_none(row.to_weight, 2),
            or_none(1e3 * row.thrust_kn[1] / (row.wet_kg * G0_M_S2), 2),
            cell(thrust_n / (wet_kg * G0_M_S2), 2),
            cell(thrust_n / (vehicle.mass.dry.mass_kg * gravity), 2),
        ]);
    }
    let mut chapter = Chapter::new("Vehicle comparison: Table V");
    chapter.table(
        "comparison",
        "Table V (tab:comparison). P: as printed; F: by the paper's own numbers; S: as sourced \
         in models/vehicles, each number with source and grade there. T/W: thrust over weight on \
         Earth, wet; in the last column on the Moon, empty.",
        &[
            "vehicle",
            "thrust P, kN",
            "thrust S, kN",
            "wet mass P, kg",
            "wet mass S, kg",
            "height H P, m",
            "height H S, m",
            "footprint D P, m",
            "footprint D S, m",
            "H/D P",
            "H/D F",
            "T/W P",
            "T/W F",
            "T/W S",
            "T/W Moon S",
        ],
        as_printed,
    );
    let [morpheus, resilience] = [3, 5].map(|n: usize| &vehicles[n]);
    chapter.differs(format!(
        "Morpheus' printed 2.3 is not its printed 20 kN over 1,050 kg, which is 1.94: it needs the {} kN \
         that are published. Colibri is publicly 100 kg and 1.2 kN, half of what is printed, with nearly the \
         same ratio. The main engine alone, 0.4 kN as printed, can't hold Resilience on the Moon even \
         empty ({} N).",
        cell(1e-3 * morpheus.engine.thrust_max_n, 0),
        cell(resilience.mass.dry.mass_kg * gravity, 1),
    ));
    let mut bars = Vec::new();
    let rows = vehicles.iter().chain(&beside).map(|vehicle| {
        let found = criteria(vehicle, gravity);
        let cells = vec![
            vehicle.name.clone(),
            vehicle.gear.legs.len().to_string(),
            range(found.com_height_m, 2),
            if vehicle.com_height_range_m.is_some() { "assumed range" } else { "file" }.to_owned(),
            range(found.pad_deg, 1),
            range(found.edge_deg, 1),
            range(found.tip_speed_m_s, 2),
        ];
        bars.push((vehicle.name.clone(), found));
        cells
    });
    let rows: Vec<_> = rows.collect();
    chapter.table(
        "comparison-tip-over",
        "Tip-over of the empty vehicles on the Moon: static angle by the paper's formula and \
         over the nearest edge, and the speed at which captured pads tip them over an edge on \
         level ground (T.17). A vehicle whose centre of mass is not published has a range, \
         never one angle.",
        &[
            "vehicle",
            "legs",
            "height of CoM, m",
            "known from",
            "paper's formula, over a pad, deg",
            "over the nearest edge, deg",
            "captured tip speed, m/s",
        ],
        rows,
    );
    chapter.differs(
        "the paper compares aspect ratios, which say nothing without the height of the centre \
         of mass and the number of legs: six legs on a circle are worth four on one 1.22 times \
         as wide. Apollo LM and Surveyor stand beside, with landings on record \
         (docs/validation/history.md).",
    );
    chapter.figure(ranges(&bars));
    Ok(chapter)
}

fn ranges(bars: &[(String, Criteria)]) -> Figure {
    const BAR: f64 = 24.0;
    let panel = |left: f64, high: f64| Frame {
        left,
        top: 20.0,
        width: 360.0,
        height: BAR * bars.len() as f64 + 8.0,
        x: [0.0, high],
        y: [0.0, 1.0],
    };
    let panels = [panel(110.0, 80.0), panel(520.0, 4.0)];
    let mut parts = String::new();
    let mut csv = "vehicle,com_low_m,com_high_m,pad_low_deg,pad_high_deg,edge_low_deg,\
                   edge_high_deg,tip_speed_low_m_s,tip_speed_high_m_s\n"
        .to_owned();
    for (index, (name, found)) in bars.iter().enumerate() {
        let all = [found.com_height_m, found.pad_deg, found.edge_deg, found.tip_speed_m_s];
        let numbers: Vec<String> = all.iter().flatten().map(f64::to_string).collect();
        csv += &format!("{},{}\n", quoted(name), numbers.join(","));
        let y = panels[0].top + 16.0 + BAR * index as f64;
        parts += &text(panels[0].left - 8.0, y + 4.0, "end", 12, name);
        for (frame, [low, high], colour, dy) in [
            (&panels[0], found.pad_deg, COLOURS[3], -5.0),
            (&panels[0], found.edge_deg, COLOURS[1], 5.0),
            (&panels[1], found.tip_speed_m_s, COLOURS[1], 0.0),
        ] {
            // A vehicle that is known is a mark, not nothing.
            let [from, to] = [frame.px(low) - 3.0, frame.px(high) + 3.0];
            let style = format!("stroke=\"{colour}\" stroke-width=\"7\"");
            parts += &styled_line([from, y + dy], [to, y + dy], &style);
        }
    }
    for (frame, words) in panels.iter().zip([
        "static tip angle, deg: over a pad (amber), over an edge (blue)",
        "captured tip speed over an edge, m/s",
    ]) {
        parts += &horizontal_axis(frame, words);
    }
    Figure {
        name: "comparison-tip-over".to_owned(),
        caption: "Criteria of tip-over, empty, on the Moon; a bar is the range over the unknown \
                  height of the centre of mass."
            .to_owned(),
        svg: picture(910.0, panels[0].top + panels[0].height + 45.0, &parts),
        csv,
    }
}

/// A frame whose rows have names instead of a scale.
fn horizontal_axis(frame: &Frame, words: &str) -> String {
    let bottom = frame.top + frame.height;
    let mut parts = format!(
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" \
         stroke=\"#333\"/>\n",
        frame.left, frame.top, frame.width, frame.height
    );
    for tick in crate::svg::ticks(frame.x) {
        let x = frame.px(tick);
        parts += &styled_line([x, bottom], [x, bottom + 4.0], "stroke=\"#333\"");
        parts += &text(x, bottom + 15.0, "middle", 10, &format!("{tick}"));
    }
    parts + &text(frame.left + 0.5 * frame.width, bottom + 31.0, "middle", 11, words)
}
