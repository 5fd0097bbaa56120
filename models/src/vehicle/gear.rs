//! Landing legs: `[gear]` of a vehicle.

use nalgebra::Vector3;

use crate::mass::MassModel;
use crate::quantity::{ConfigError, Limit, Section};
use crate::signals::FOOT_SLOTS;

#[derive(Clone, Debug)]
pub struct Gear {
    /// Counter-clockwise from above.
    pub legs: Vec<Leg>,
    /// Of the ball with which a pad touches hard ground.
    pub pad_radius_m: f64,
    /// Of the disc with which a pad presses on soil.
    pub bearing_radius_m: f64,
    /// Footpad and lower strut, part of the dry mass.
    pub foot_mass_kg: f64,
    /// How each leg gives way across its stroke; `None` is rigid.
    pub lateral: Option<Lateral>,
}

/// Elastic give of a leg across its stroke axis, alike in both directions, as its pad feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lateral {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
}

/// A leg as an inverted tripod: two secondary struts of fixed length hold the pad on a circle
/// about the line through their upper ends, the primary strut crushes. Over a stroke small
/// against that circle the pad moves along its tangent.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Pad's ground point from O, strut at free length.
    pub foot_b: Vector3<f64>,
    /// Unit direction in which the pad moves as the strut is compressed.
    pub stroke_axis_b: Vector3<f64>,
    /// Compression of the primary strut per stroke of the pad, in (0, 1].
    pub strut_ratio: f64,
    /// The strut's law as the pad feels it along `stroke_axis_b`.
    pub strut: Strut,
}

/// A crushable strut: elastic with damping up to a crush load of two stages, then plastic, with a
/// stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strut {
    /// Elastic stiffness below the crush load.
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    pub crush_1_n: f64,
    /// Stroke at which the second stage takes over.
    pub stroke_1_m: f64,
    pub crush_2_n: f64,
    /// Stroke at which the strut is bottomed out.
    pub stroke_max_m: f64,
}

impl Strut {
    /// The law along a path of which the strut compresses by `ratio` per length (virtual work).
    fn along_path(&self, ratio: f64) -> Self {
        Self {
            stiffness_n_m: self.stiffness_n_m * ratio * ratio,
            damping_n_s_m: self.damping_n_s_m * ratio * ratio,
            crush_1_n: self.crush_1_n * ratio,
            stroke_1_m: self.stroke_1_m / ratio,
            crush_2_n: self.crush_2_n * ratio,
            stroke_max_m: self.stroke_max_m / ratio,
        }
    }
}

impl Leg {
    /// Compression at which the primary strut is bottomed out, m.
    pub fn strut_stroke_max_m(&self) -> f64 {
        self.strut.stroke_max_m * self.strut_ratio
    }
}

impl Gear {
    pub fn feet_b(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.legs.iter().map(|leg| leg.foot_b)
    }

    /// Centre of a ball-shaped pad from O, strut at free length.
    pub fn pad_centre_b(&self, leg: &Leg) -> Vector3<f64> {
        leg.foot_b + Vector3::z() * self.pad_radius_m
    }
}

/// Lightest foot body, kg: at 0.1 kg and 1 ms contact diverges, at 2 kg it is proven.
const FOOT_MASS_MIN_KG: f64 = 0.5;
/// Largest share of the dry yaw inertia that the feet may carry: the rest is the hull body's, and
/// contact needs it well away from zero.
const FOOT_INERTIA_SHARE: f64 = 0.75;

pub(super) fn read(root: &Section, mass: &MassModel) -> Result<Gear, ConfigError> {
    let s = root.section("gear")?;
    let feet = s.points::<3>("feet_b", "m")?;
    if !(3..=FOOT_SLOTS).contains(&feet.len()) {
        return Err(
            s.error("feet_b", format!("has {} feet, must be 3 to {FOOT_SLOTS}", feet.len()))
        );
    }
    let feet_b: Vec<Vector3<f64>> = feet.into_iter().map(Vector3::from).collect();
    if !is_convex_counter_clockwise(&feet_b) {
        return Err(s.error("feet_b", "must go round the axis once, counter-clockwise from above"));
    }
    let reach_m2: f64 = feet_b.iter().map(|foot_b| foot_b.xy().norm_squared()).sum();
    let foot_mass_max_kg = FOOT_INERTIA_SHARE * mass.dry.inertia_kg_m2.z / reach_m2;
    let stroke_max_m = s.number("stroke_max", "m", Limit::Positive)?;
    let crush_1_n = s.number("crush_load_1", "N", Limit::Positive)?;
    let strut = Strut {
        stiffness_n_m: s.number("stiffness", "N/m", Limit::Positive)?,
        damping_n_s_m: s.number("damping", "N.s/m", Limit::NotNegative)?,
        crush_1_n,
        stroke_1_m: s.number("stroke_1", "m", Limit::Within(0.0, stroke_max_m))?,
        crush_2_n: s.number("crush_load_2", "N", Limit::Within(crush_1_n, f64::MAX))?,
        stroke_max_m,
    };
    let pad_radius_m = s.number("pad_radius", "m", Limit::Positive)?;
    let gear = Gear {
        legs: read_legs(&s, &feet_b, &strut)?,
        pad_radius_m,
        bearing_radius_m: s.number_or("bearing_radius", "m", Limit::Positive, pad_radius_m)?,
        foot_mass_kg: s.number(
            "foot_mass",
            "kg",
            Limit::Within(FOOT_MASS_MIN_KG, foot_mass_max_kg),
        )?,
        lateral: read_lateral(&s)?,
    };
    s.finish()?;
    Ok(gear)
}

/// Keys of a leg's give across its stroke: both or neither.
const LATERAL: [&str; 2] = ["lateral_stiffness", "lateral_damping"];

fn read_lateral(s: &Section) -> Result<Option<Lateral>, ConfigError> {
    if !LATERAL.iter().any(|key| s.has(key)) {
        return Ok(None);
    }
    Ok(Some(Lateral {
        stiffness_n_m: s.number(LATERAL[0], "N/m", Limit::Positive)?,
        damping_n_s_m: s.number(LATERAL[1], "N.s/m", Limit::NotNegative)?,
    }))
}

/// Keys of the upper ends of a leg's three struts; without them pads stroke along body z.
const STRUT_TOPS: [&str; 3] = ["primary_top_b", "secondary_left_top_b", "secondary_right_top_b"];

fn read_legs(s: &Section, feet_b: &[Vector3<f64>], strut: &Strut) -> Result<Vec<Leg>, ConfigError> {
    let upright = |foot_b: &Vector3<f64>| Leg {
        foot_b: *foot_b,
        stroke_axis_b: Vector3::z(),
        strut_ratio: 1.0,
        strut: *strut,
    };
    if !STRUT_TOPS.iter().any(|key| s.has(key)) {
        return Ok(feet_b.iter().map(upright).collect());
    }
    let mut tops = Vec::new();
    for key in STRUT_TOPS {
        let points: Vec<Vector3<f64>> =
            s.points::<3>(key, "m")?.into_iter().map(Vector3::from).collect();
        if points.len() != feet_b.len() {
            let (have, need) = (points.len(), feet_b.len());
            return Err(s.error(key, format!("has {have} points, must have one a foot: {need}")));
        }
        tops.push(points);
    }
    (feet_b.iter().enumerate())
        .map(|(n, foot_b)| {
            let (axis_b, ratio) = tripod_stroke(foot_b, &tops[0][n], &tops[1][n], &tops[2][n])
                .ok_or_else(|| {
                    let need = "its pad must move upwards and its primary strut shorten by at \
                                least a fifth of that";
                    s.error(STRUT_TOPS[0], format!("leg {}: {need}", n + 1))
                })?;
            Ok(Leg {
                foot_b: *foot_b,
                stroke_axis_b: axis_b,
                strut_ratio: ratio,
                strut: strut.along_path(ratio),
            })
        })
        .collect()
}

/// Stroke axis of a pad and compression of the primary strut per stroke: the pad turns about the
/// line through the secondary struts' tops. `None` if that doesn't move it upwards against the
/// primary strut.
fn tripod_stroke(
    foot_b: &Vector3<f64>,
    primary_b: &Vector3<f64>,
    left_b: &Vector3<f64>,
    right_b: &Vector3<f64>,
) -> Option<(Vector3<f64>, f64)> {
    /// Flatter legs would multiply the strut's load and stroke beyond any gear built.
    const RATIO_MIN: f64 = 0.2;
    let normal_b = (left_b - foot_b).cross(&(right_b - foot_b)).try_normalize(1e-9)?;
    let axis_b = normal_b * normal_b.z.signum();
    let ratio = (primary_b - foot_b).try_normalize(1e-9)?.dot(&axis_b);
    (axis_b.z > RATIO_MIN && ratio > RATIO_MIN).then_some((axis_b, ratio))
}

/// Whether the polygon of feet turns left at every foot, once round: tip-over is judged per edge.
fn is_convex_counter_clockwise(feet_b: &[Vector3<f64>]) -> bool {
    let n = feet_b.len();
    let corner = |i: usize| (feet_b[i], feet_b[(i + 1) % n], feet_b[(i + 2) % n]);
    let turns_left = (0..n).all(|i| {
        let (a, b, c) = corner(i);
        (b - a).xy().perp(&(c - b).xy()) > 0.0
    });
    let turned_rad: f64 = (0..n)
        .map(|i| {
            let (a, b, c) = corner(i);
            let (into, out) = ((b - a).xy(), (c - b).xy());
            libm::atan2(into.perp(&out), into.dot(&out))
        })
        .sum();
    // One full turn, not two as in a star.
    turns_left && turned_rad < 3.0 * std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tripod_leg_moves_on_the_circle_about_its_secondary_struts_tops() {
        let foot_b = Vector3::new(1.9, 0.0, 0.0);
        let tops = [(0.7, 0.0, 1.6), (0.7, 0.4, 0.7), (0.7, -0.4, 0.7)];
        let [primary_b, left_b, right_b] = tops.map(|(x, y, z)| Vector3::new(x, y, z));
        let (axis_b, ratio) = tripod_stroke(&foot_b, &primary_b, &left_b, &right_b).unwrap();
        // To first order neither secondary strut changes its length, and the primary does by ratio.
        let h = 1e-6;
        let change =
            |top: &Vector3<f64>| ((foot_b + axis_b * h - top).norm() - (foot_b - top).norm()) / h;
        assert!(change(&left_b).abs() < 1e-6 && change(&right_b).abs() < 1e-6);
        assert!((change(&primary_b) + ratio).abs() < 1e-6);
        // The pad spreads outwards as it goes up.
        assert!(axis_b.x > 0.0 && axis_b.z > 0.0);
    }

    #[test]
    fn a_strut_along_a_path_does_the_same_work() {
        let strut = Strut {
            stiffness_n_m: 2e5,
            damping_n_s_m: 4e3,
            crush_1_n: 1500.0,
            stroke_1_m: 0.06,
            crush_2_n: 5700.0,
            stroke_max_m: 0.2,
        };
        let path = strut.along_path(0.8);
        let work =
            |s: &Strut| s.crush_1_n * s.stroke_1_m + s.crush_2_n * (s.stroke_max_m - s.stroke_1_m);
        assert!((work(&path) / work(&strut) - 1.0).abs() < 1e-12);
        assert!((path.crush_1_n / path.stiffness_n_m * 0.8 - 1500.0 / 2e5).abs() < 1e-12);
    }
}
