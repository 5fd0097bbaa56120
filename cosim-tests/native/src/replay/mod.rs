//! A landing as one HTML page to be watched: play, scrub, camera. The page needs no network, no
//! server and no graphics card; `viewer.js` draws what is collected here.

mod shape;

use lander_models::frames::attitude_from_wxyz;
use lander_models::signals::{ATTITUDE_WB, POSITION_W};
use lander_models::{Scenario, Ticks, Vehicle};
use serde::Serialize;
use truth_model::terrain::Ground;

use crate::layout::Layout;
use crate::relief::Relief;
use shape::Shape;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const VIEWER: &str = include_str!("viewer.js");

/// Between two frames of flight and of contact: the viewer interpolates the former by eye, the
/// latter must show a stroke.
const FLIGHT_PERIOD: Ticks = Ticks(50);
const CONTACT_PERIOD: Ticks = Ticks(10);

/// Takes the rows of a landing.
pub struct Film {
    layout: Layout,
    frames: Vec<Frame>,
    last: Vec<f64>,
}

/// One instant: SI units and degrees, rounded to what the eye can see.
#[derive(Serialize)]
struct Frame {
    time_s: f64,
    position_w: [f64; 3],
    velocity_w: [f64; 3],
    /// Quaternion x, y, z, w: body to world.
    attitude: [f64; 4],
    thrust_n: f64,
    gimbal_rad: [f64; 2],
    propellant_kg: f64,
    tilt_deg: f64,
    strokes_m: Vec<f64>,
    loads_n: Vec<f64>,
}

#[derive(Serialize)]
struct Page<'a> {
    name: &'a str,
    outcome: &'a str,
    contact_time_s: Option<f64>,
    tip_time_s: Option<f64>,
    target_w: [f64; 3],
    shape: Shape,
    ground: Relief,
    frames: Vec<Frame>,
}

impl Film {
    pub fn new(layout: Layout) -> Self {
        Self { layout, frames: Vec::new(), last: Vec::new() }
    }

    pub fn row(&mut self, row: &[f64]) {
        let near = self.layout.scalar(row, "contact_active") == 1.0;
        let period = if near { CONTACT_PERIOD } else { FLIGHT_PERIOD };
        let on_grid = Ticks::from_seconds(row[0]).is_ok_and(|time| time.0.is_multiple_of(period.0));
        self.last = row.to_vec();
        if on_grid {
            self.frames.extend(self.frame(row));
        }
    }

    fn frame(&self, row: &[f64]) -> Option<Frame> {
        let layout = &self.layout;
        let attitude = attitude_from_wxyz(layout.vector(row, ATTITUDE_WB.name)?);
        let per_leg = |name, unit| -> Vec<f64> {
            row[layout.columns(name)].iter().map(|value| round(*value, unit)).collect()
        };
        Some(Frame {
            time_s: row[0],
            position_w: layout.vector::<3>(row, POSITION_W.name)?.map(|value| round(value, 1e-4)),
            velocity_w: layout.vector::<3>(row, "velocity_w")?.map(|value| round(value, 1e-3)),
            attitude: <[f64; 4]>::from(attitude.coords).map(|value| round(value, 1e-6)),
            thrust_n: round(layout.scalar(row, "thrust_n"), 1.0),
            gimbal_rad: layout.vector::<2>(row, "gimbal_rad")?.map(|value| round(value, 1e-4)),
            propellant_kg: round(layout.scalar(row, "propellant_kg"), 1e-2),
            tilt_deg: round(layout.scalar(row, "tilt_deg"), 1e-2),
            strokes_m: per_leg("foot_stroke_m", 1e-4),
            loads_n: per_leg("foot_load_n", 1.0),
        })
    }

    /// The page, with the verdict in words; `None` of no rows.
    ///
    /// # Errors
    /// JSON refuses a number.
    pub fn page(
        mut self,
        scenario: &Scenario,
        vehicle: &Vehicle,
        ground: &Ground,
        (outcome, verdict): (&str, &str),
    ) -> Result<Option<String>, serde_json::Error> {
        let Some(end) = self.frame(&self.last) else { return Ok(None) };
        let measured = |name| Some(self.layout.scalar(&self.last, name)).filter(|t| t.is_finite());
        let page = Page {
            name: &scenario.name,
            outcome,
            contact_time_s: measured("contact_time_s"),
            tip_time_s: measured("tip_time_s"),
            target_w: scenario.guidance.target_w.into(),
            shape: Shape::of(vehicle),
            ground: Relief::about(ground, &end.position_w.into(), &scenario.initial.position_w),
            frames: {
                if self.frames.last().is_none_or(|last| last.time_s < end.time_s) {
                    self.frames.push(end);
                }
                self.frames
            },
        };
        // `</` would end the script.
        let data = serde_json::to_string(&page)?.replace("</", "<\\/");
        Ok(Some(
            PAGE.replace("{{name}}", &escape(&scenario.name))
                .replace("{{verdict}}", &escape(verdict))
                .replace("{{style}}", STYLE)
                .replace("{{viewer}}", VIEWER)
                .replace("{{data}}", &data),
        ))
    }
}

/// To a multiple of `unit`, which is 1 over a whole number; 0 for what was not measured.
fn round(value: f64, unit: f64) -> f64 {
    let per_unit = (1.0 / unit).round();
    if value.is_finite() { (value * per_unit).round() / per_unit } else { 0.0 }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_text_stays_text() {
        assert_eq!(round(1.234_56, 1e-2), 1.23);
        assert_eq!(round(f64::NAN, 1.0), 0.0);
        assert_eq!(escape("a < b & c"), "a &lt; b &amp; c");
    }
}
