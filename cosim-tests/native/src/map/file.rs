//! `[map]` of a study: the plane of velocities, and the cases mapped on it.

use lander_models::quantity::{ConfigError, Limit, Section};
use nalgebra::{UnitQuaternion, Vector3};

use crate::study::parameter::case_unit;
use crate::touchdowns::{COLUMNS, Case};

/// The plane, its first grid, and when a cell is split.
#[derive(Clone, Debug)]
pub struct Map {
    /// Least and greatest horizontal velocity, along azimuth 0, m/s.
    pub across_m_s: [f64; 2],
    /// Least and greatest velocity down, m/s.
    pub down_m_s: [f64; 2],
    /// Columns and rows of the first grid.
    pub cells: [u32; 2],
    /// How often a cell may be split.
    pub depth: u32,
    pub near: Near,
    pub cases: Vec<MapCase>,
}

/// Margins below which another class counts as close to a corner of a first cell; of a smaller cell in
/// proportion to its side.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    pub distance_m: f64,
    pub clearance_m: f64,
    pub stroke_m: f64,
    /// A tip-over that takes longer hardly tipped.
    pub slow_tip_s: f64,
}

/// One touchdown but for its velocity.
#[derive(Clone, Debug)]
pub struct MapCase {
    pub name: String,
    /// Columns that the case sets.
    columns: Vec<(usize, f64)>,
    /// Turn of the vehicle about its own axis: for legs at 45° to the axes, 0 leads with two and 45° with one.
    pub heading_deg: f64,
    pub lean_deg: f64,
    /// Azimuth towards which it leans.
    lean_azimuth_deg: f64,
}

impl Map {
    /// `None` for a study without `[map]`.
    pub fn read(root: &Section) -> Result<Option<Self>, ConfigError> {
        if !root.has("map") {
            return Ok(None);
        }
        let s = root.section("map")?;
        let range = |key: &str, limit| {
            let [low, high] = s.vector(key, "m/s", limit)?;
            match low < high {
                true => Ok([low, high]),
                false => Err(s.error(key, format!("is [{low}, {high}] m/s, must ascend"))),
            }
        };
        let cells: [f64; 2] = s.vector("cells", "1", Limit::Within(1.0, 200.0))?;
        let depth = s.number_or("depth", "1", Limit::Within(0.0, 6.0), 2.0)?;
        for (key, number) in [("cells", cells[0]), ("cells", cells[1]), ("depth", depth)] {
            if number.fract() != 0.0 {
                return Err(s.error(key, format!("has {number}, must be whole")));
            }
        }
        let near = |key, unit, default| s.number_or(key, unit, Limit::Positive, default);
        let map = Self {
            across_m_s: range("across", Limit::NotNegative)?,
            down_m_s: range("down", Limit::NotNegative)?,
            cells: cells.map(|number| number as u32),
            depth: depth as u32,
            near: Near {
                distance_m: near("near_distance", "m", 0.2)?,
                clearance_m: near("near_clearance", "m", 0.05)?,
                stroke_m: near("near_stroke", "m", 0.01)?,
                slow_tip_s: near("slow_tip", "s", 2.5)?,
            },
            cases: s.sections("cases")?.into_iter().map(MapCase::read).collect::<Result<_, _>>()?,
        };
        if map.cases.is_empty() {
            return Err(s.error("cases", "is missing: a map needs at least one"));
        }
        let names: Vec<&str> = map.cases.iter().map(|case| case.name.as_str()).collect();
        if let Some(n) = (1..names.len()).find(|n| names[..*n].contains(&names[*n])) {
            return Err(s.error("cases", format!("has two of the name {:?}", names[n])));
        }
        s.finish()?;
        Ok(Some(map))
    }
}

impl MapCase {
    fn read(s: Section) -> Result<Self, ConfigError> {
        let angle = |key| s.number_or(key, "deg", Limit::Within(-360.0, 360.0), 0.0);
        // The velocity is the map's, the attitude is given by heading and lean.
        const OWN: [&str; 6] =
            ["down_m_s", "across_m_s", "travel_deg", "roll_deg", "pitch_deg", "yaw_deg"];
        let mut columns = Vec::new();
        for (index, (column, limit)) in COLUMNS.into_iter().enumerate() {
            if !OWN.contains(&column) && s.has(column) {
                columns.push((index, s.number(column, case_unit(column), limit)?));
            }
        }
        let case = Self {
            name: s.text("name")?,
            columns,
            heading_deg: angle("heading")?,
            lean_deg: s.number_or("lean", "deg", Limit::Within(-90.0, 90.0), 0.0)?,
            lean_azimuth_deg: angle("lean_azimuth")?,
        };
        s.finish()?;
        Ok(case)
    }

    /// The contact state at a velocity, from the study's.
    pub fn at(&self, nominal: &Case, across_m_s: f64, down_m_s: f64) -> Case {
        let mut case = *nominal;
        for (index, value) in &self.columns {
            case[*index] = *value;
        }
        let (sin, cos) = libm::sincos(self.lean_azimuth_deg.to_radians());
        let lean = Vector3::new(-sin, cos, 0.0) * self.lean_deg.to_radians();
        let heading = Vector3::z() * self.heading_deg.to_radians();
        let attitude_wb =
            UnitQuaternion::from_scaled_axis(lean) * UnitQuaternion::from_scaled_axis(heading);
        let (roll, pitch, yaw) = attitude_wb.euler_angles();
        let set = [
            ("down_m_s", down_m_s),
            ("across_m_s", across_m_s),
            ("travel_deg", 0.0),
            ("roll_deg", roll.to_degrees()),
            ("pitch_deg", pitch.to_degrees()),
            ("yaw_deg", yaw.to_degrees()),
        ];
        for ((column, _), slot) in COLUMNS.iter().zip(&mut case) {
            if let Some((_, value)) = set.iter().find(|(name, _)| name == column) {
                *slot = *value;
            }
        }
        case
    }
}
