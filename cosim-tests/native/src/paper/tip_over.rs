//! Static tip-over: Tables I and II and the 52° of section II-B.

use lander_models::{ConfigError, Vehicle};
use nalgebra::Vector3;
use truth_model::stability::static_tip_angle_rad;

use super::chapter::{Chapter, cell};
use super::printed::Printed;
use super::tip_angle::{extremes_rad, ring};
use super::{Error, Inputs};
use crate::report::Figure;
use crate::svg::{Frame, picture, text};

/// The centre-of-mass height of Table I and the footprint of Table II, as their captions say.
const FIXED_HEIGHT_M: f64 = 1.0;
const FIXED_FOOTPRINT_M: f64 = 2.0;

/// # Errors
/// A printed number that is missing.
pub fn chapter(inputs: &Inputs) -> Result<Chapter, Error> {
    let Inputs { printed, bug, .. } = inputs;
    let mut chapter = Chapter::new("Static tip-over: Tables I and II, section II-B");
    let row = |varied_m: f64, footprint_m: f64, height_m: f64, printed_deg: f64| {
        let formula_deg = static_tip_angle_rad(0.5 * footprint_m, height_m).to_degrees();
        let com_b = Vector3::new(0.0, 0.0, height_m);
        let [four, three] =
            [4, 3].map(|pads| extremes_rad(&ring(pads, footprint_m), com_b).map(f64::to_degrees));
        let numbers = [printed_deg, formula_deg, four[0], four[1], three[0], formula_deg - four[0]];
        let mut cells = vec![cell(varied_m, 2), cell(0.5 * footprint_m, 3)];
        cells.extend(numbers.map(|number| cell(number, 3)));
        cells
    };
    let by_footprint = printed.rows::<2>("tip_by_footprint", "m, deg")?;
    let by_footprint =
        by_footprint.into_iter().map(|[d, deg]| row(d, d, FIXED_HEIGHT_M, deg)).collect();
    let by_height = printed.rows::<2>("tip_by_height", "m, deg")?;
    let by_height =
        by_height.into_iter().map(|[h, deg]| row(h, FIXED_FOOTPRINT_M, h, deg)).collect();
    let header = |varied| {
        [
            varied,
            "D/2, m",
            "printed, deg",
            "paper's formula atan((D/2)/h), deg",
            "four pads, least over heading, deg",
            "four pads, greatest, deg",
            "three pads, least, deg",
            "printed formula is high by, deg",
        ]
    };
    chapter.table(
        "tip-over-footprint",
        "Table I (tab:tipover_footprint): tip-over angle against footprint at a centre of mass \
         1.0 m high.",
        &header("footprint D, m"),
        by_footprint,
    );
    chapter.table(
        "tip-over-height",
        "Table II (tab:tipover_cgheight): tip-over angle against the height of the centre of \
         mass at D = 2.0 m.",
        &header("height h, m"),
        by_height,
    );
    chapter.differs(
        "the paper's distance D/2 is that of a pad. Four pads on the circle D stand on edges \
         D/(2√2) away, three on edges D/4 away, and a vehicle tips over the nearest edge: the \
         printed angle holds in four headings (in three) and is the greatest of all. The last \
         row of Table I is cut off, not rounded: 60.255.",
    );
    bug_table(&mut chapter, printed, bug)?;
    chapter.figure(against_heading(bug));
    Ok(chapter)
}

fn bug_table(chapter: &mut Chapter, printed: &Printed, bug: &Vehicle) -> Result<(), ConfigError> {
    let printed_deg = printed.number("tip_angle", "deg")?;
    let guidance_deg = printed.number("guidance_tilt_max", "deg")?;
    let footprint_m = printed.number("footprint_diameter", "m")?;
    let heights_m = printed.row::<3>("com_height_wet_mid_dry", "m")?;
    let feet_b: Vec<_> = bug.gear.feet_b().collect();
    let capacity_kg = bug.mass.propellant.capacity_kg;
    let states =
        [("wet", heights_m[0], capacity_kg, printed_deg), ("dry", heights_m[2], 0.0, f64::NAN)];
    let rows = states.map(|(name, height_m, propellant_kg, printed_deg)| {
        let on_axis =
            |pads| extremes_rad(&ring(pads, footprint_m), Vector3::new(0.0, 0.0, height_m));
        let [edge_rad, pad_rad] = on_axis(4);
        let real_rad = extremes_rad(&feet_b, bug.mass.at(propellant_kg).com_b)[0];
        let formula_rad = static_tip_angle_rad(0.5 * footprint_m, height_m);
        let slope_deg = 15.0;
        let mut cells = vec![name.to_owned(), cell(height_m, 2)];
        cells.push(if printed_deg.is_nan() {
            "not printed".to_owned()
        } else {
            cell(printed_deg, 0)
        });
        cells.extend(
            [formula_rad, edge_rad, pad_rad, real_rad, on_axis(3)[0]]
                .map(|rad| cell(rad.to_degrees(), 2)),
        );
        cells.push(cell(formula_rad.to_degrees() - guidance_deg, 1));
        cells.push(cell(edge_rad.to_degrees() - slope_deg, 1));
        cells
    });
    let [edge, real] = [4, 6].map(|column: usize| rows[0][column].clone());
    chapter.table(
        "tip-over-bug",
        "BUG's tip-over angle (section II-B, 52°), D = 3.77 m.",
        &[
            "BUG",
            "h, m",
            "printed, deg",
            "paper's formula, deg",
            "four pads, over an edge, deg",
            "four pads, over a pad, deg",
            "the vehicle file, CoM off its axis, deg",
            "three pads, over an edge, deg",
            "paper's margin above 29°, deg",
            "left on a slope of 15°, over an edge, deg",
        ],
        rows.to_vec(),
    );
    chapter.differs(format!(
        "52° is the wet vehicle over a pad; over an edge it is {edge}°, with the centre of mass where \
         the vehicle file has it {real}°. The 29° that the paper compares it with is the limit of the \
         thrust's direction in flight, not an angle of the ground: what tips a lander is slope plus the \
         tilt and the speeds at contact.",
    ));
    Ok(())
}

/// Tip angle over the azimuth of the fall line.
fn against_heading(bug: &Vehicle) -> Figure {
    let frame = Frame {
        left: 60.0,
        top: 30.0,
        width: 620.0,
        height: 260.0,
        x: [0.0, 360.0],
        y: [30.0, 60.0],
    };
    let feet_b: Vec<_> = bug.gear.feet_b().collect();
    let (mut parts, mut csv) = (String::new(), "azimuth_deg,wet_deg,dry_deg\n".to_owned());
    let angles = |azimuth_deg: f64| {
        [bug.mass.propellant.capacity_kg, 0.0].map(|propellant_kg| {
            let com_b = bug.mass.at(propellant_kg).com_b;
            super::tip_angle::towards_rad(&feet_b, com_b, azimuth_deg.to_radians()).to_degrees()
        })
    };
    let points: Vec<(f64, [f64; 2])> =
        (0..=720).map(|n| 0.5 * f64::from(n)).map(|azimuth| (azimuth, angles(azimuth))).collect();
    for (azimuth, [wet, dry]) in &points {
        csv += &format!("{azimuth},{wet},{dry}\n");
    }
    for (index, (name, colour)) in [("wet", "#2b6cb0"), ("dry", "#c05621")].into_iter().enumerate()
    {
        let curve: Vec<[f64; 2]> =
            points.iter().map(|(azimuth, both)| [*azimuth, both[index]]).collect();
        parts += &frame.path(&curve, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
        parts += &super::drawing::key(&frame, index, name, colour);
    }
    parts += &frame.path(&[[0.0, 52.0], [360.0, 52.0]], "stroke=\"#666\" stroke-dasharray=\"5 4\"");
    parts += &text(frame.px(4.0), frame.py(52.0) - 4.0, "start", 11, "printed: 52°");
    parts += &frame.axes("", "azimuth of the fall line from body x, deg", "static tip angle, deg");
    Figure {
        name: "tip-over-heading".to_owned(),
        caption: "BUG's static tip angle against the heading of the fall line: the printed 52° \
                  holds towards a pad only."
            .to_owned(),
        svg: picture(720.0, 340.0, &parts),
        csv,
    }
}
