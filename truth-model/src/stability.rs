//! Tip-over: energy and distance still lacking over each edge of the support polygon (T.14, T.15,
//! T.20), and the closed forms they are held to (T.16, T.17, T.24).

use nalgebra::{Matrix3, Vector3};

/// The vehicle as tip-over sees it: everything in body axes, positions from O.
#[derive(Clone, Copy, Debug)]
pub struct Tipping {
    pub mass_kg: f64,
    pub com_b: Vector3<f64>,
    /// Velocity of the centre of mass against the ground.
    pub com_velocity_b: Vector3<f64>,
    pub rate_b: Vector3<f64>,
    /// About the centre of mass.
    pub inertia_b: Matrix3<f64>,
    /// Against gravity, unit length.
    pub up_b: Vector3<f64>,
    pub gravity_m_s2: f64,
}

/// Where the vehicle stands between upright and over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipState {
    /// Least over all edges, J. Negative once the centre of mass is beyond an edge or has the
    /// energy to get there.
    pub margin_j: f64,
    /// Stability distance, m: of the centre of mass from the vertical plane through the nearest
    /// edge, negative beyond it.
    pub distance_m: f64,
}

impl TipState {
    /// The centre of mass is vertically above the support polygon.
    pub fn supported(&self) -> bool {
        self.distance_m >= 0.0
    }
}

/// `feet_b` are the points on which the pads stand, counter-clockwise seen from above.
///
/// For each edge: the height that the centre of mass must still climb to stand above the edge,
/// less the kinetic energy of the rotation about it if the pads of that edge stopped dead now.
pub fn tip_state(tipping: &Tipping, feet_b: &[Vector3<f64>]) -> TipState {
    let Tipping { mass_kg, up_b, .. } = *tipping;
    let spin_b = tipping.inertia_b * tipping.rate_b;
    let mut state = TipState { margin_j: f64::INFINITY, distance_m: f64::INFINITY };
    let next = feet_b.iter().cycle().skip(1);
    for (foot_b, next_b) in feet_b.iter().zip(next) {
        // Not of unit length: every term below is of degree zero in it.
        let edge_b = next_b - foot_b;
        let square = edge_b.norm_squared();
        if square == 0.0 {
            continue;
        }
        let arm_b = tipping.com_b - foot_b;
        // Level, out of the polygon.
        let outward_b = edge_b.cross(&up_b);
        let lever_b = edge_b.cross(&arm_b);
        let level = outward_b.norm();
        // (T.20); an upright edge has no such plane: not a number, which `min` leaves out.
        let distance_m = -arm_b.dot(&outward_b) / level;
        // (T.14)
        let height_m = arm_b.dot(&up_b) - arm_b.dot(&edge_b) * edge_b.dot(&up_b) / square;
        let climb_m = lever_b.norm() * level / square - height_m;
        let barrier_j = mass_kg * tipping.gravity_m_s2 * climb_m;
        let margin_j = if distance_m < 0.0 {
            -barrier_j
        } else {
            // (T.15): rotation about +edge carries a point above the edge outwards.
            let orbital = lever_b.dot(&tipping.com_velocity_b) * mass_kg;
            let momentum = (edge_b.dot(&spin_b) + orbital).max(0.0);
            let inertia =
                edge_b.dot(&(tipping.inertia_b * edge_b)) + mass_kg * lever_b.norm_squared();
            barrier_j - momentum * momentum / (2.0 * inertia)
        };
        state.margin_j = state.margin_j.min(margin_j);
        state.distance_m = state.distance_m.min(distance_m);
    }
    state
}

/// Static tip angle of a centre of mass `height_m` above and `distance_m` inside an edge or a
/// foot, rad (T.16).
pub fn static_tip_angle_rad(distance_m: f64, height_m: f64) -> f64 {
    libm::atan2(distance_m, height_m)
}

/// Horizontal speed at which captured pads tip a vehicle over on level ground, m/s (T.17).
///
/// `inertia_kg_m2` about the axis through the centre of mass parallel to the edge.
pub fn captured_tip_speed_m_s(
    mass_kg: f64,
    inertia_kg_m2: f64,
    distance_m: f64,
    height_m: f64,
    gravity_m_s2: f64,
) -> f64 {
    let standing = Captured {
        mass_kg,
        inertia_kg_m2,
        distance_m,
        height_m,
        pad_radius_m: 0.0,
        slope_rad: 0.0,
    };
    standing.tip_speed_m_s(gravity_m_s2)
}

/// A vehicle that stands on a slope on captured pads, which are balls that roll.
#[derive(Clone, Copy, Debug)]
pub struct Captured {
    pub mass_kg: f64,
    /// About the axis through the centre of mass parallel to the edge.
    pub inertia_kg_m2: f64,
    /// From the centre of mass to the downhill edge, along the slope.
    pub distance_m: f64,
    /// Of the centre of mass above the slope, along its normal.
    pub height_m: f64,
    pub pad_radius_m: f64,
    /// Falls across the edge.
    pub slope_rad: f64,
}

impl Captured {
    /// Speed parallel to the slope, downhill, at which the stop of the pads tips it over, m/s
    /// (T.24). Not a number beyond the static tip angle.
    pub fn tip_speed_m_s(&self, gravity_m_s2: f64) -> f64 {
        let Self { mass_kg, distance_m, height_m, pad_radius_m, .. } = *self;
        let inertia_about_edge =
            self.inertia_kg_m2 + mass_kg * (distance_m * distance_m + height_m * height_m);
        // From the balls' centres to the centre of mass, and its angle from the vertical.
        let arm_m = libm::hypot(distance_m, height_m - pad_radius_m);
        let lean_rad = libm::atan2(distance_m, height_m - pad_radius_m) - self.slope_rad;
        // Above the point of contact, the arm leans by this much.
        let top_rad = libm::asin(pad_radius_m * libm::sin(self.slope_rad) / arm_m);
        let rolled_m = pad_radius_m * (lean_rad - top_rad);
        let climb_m = arm_m * (libm::cos(top_rad) - libm::cos(lean_rad))
            - rolled_m * libm::sin(self.slope_rad);
        (2.0 * mass_kg * gravity_m_s2 * climb_m * inertia_about_edge).sqrt() / (mass_kg * height_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRY_KG: f64 = 174.0;
    const EDGE_M: f64 = 1.885 * std::f64::consts::FRAC_1_SQRT_2;

    fn square() -> Vec<Vector3<f64>> {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
            .map(|(x, y)| Vector3::new(x * EDGE_M, y * EDGE_M, 0.0))
            .to_vec()
    }

    fn sliding(speed_m_s: f64) -> Tipping {
        Tipping {
            mass_kg: DRY_KG,
            com_b: Vector3::new(0.0, 0.0, 1.38),
            com_velocity_b: Vector3::new(speed_m_s, 0.0, 0.0),
            rate_b: Vector3::zeros(),
            inertia_b: Matrix3::from_diagonal(&Vector3::new(126.0, 126.1, 86.5)),
            up_b: Vector3::z(),
            gravity_m_s2: 1.625,
        }
    }

    #[test]
    fn closed_forms_give_the_known_figures_of_the_dry_vehicle() {
        // Figures to the printed digits: the independent table in the design notes.
        let edge_deg = static_tip_angle_rad(EDGE_M, 1.38).to_degrees();
        assert!((edge_deg - 44.005).abs() < 5e-4, "{edge_deg}");
        let foot_deg = static_tip_angle_rad(1.885, 1.38).to_degrees();
        assert!((foot_deg - 53.792).abs() < 5e-4, "{foot_deg}");
        let edge_m_s = captured_tip_speed_m_s(DRY_KG, 126.1, EDGE_M, 1.38, 1.625);
        assert!((edge_m_s - 2.012).abs() < 5e-4, "{edge_m_s}");
        let foot_m_s = captured_tip_speed_m_s(DRY_KG, 126.1, 1.885, 1.38, 1.625);
        assert!((foot_m_s - 3.176).abs() < 1e-3, "{foot_m_s}");
    }

    /// On pads that are points, 12° downhill.
    const DOWNHILL: Captured = Captured {
        mass_kg: DRY_KG,
        inertia_kg_m2: 126.1,
        distance_m: EDGE_M,
        height_m: 1.38,
        pad_radius_m: 0.0,
        slope_rad: 12.0 * std::f64::consts::PI / 180.0,
    };

    #[test]
    fn downhill_and_on_ball_pads_the_captured_tip_speed_has_its_limits() {
        // To the printed digits, as above.
        let downhill_m_s = DOWNHILL.tip_speed_m_s(1.625);
        assert!((downhill_m_s - 1.48).abs() < 5e-3, "{downhill_m_s}");
        let level = Captured { slope_rad: 0.0, ..DOWNHILL };
        assert!((level.tip_speed_m_s(1.625) - 2.012).abs() < 5e-4);
        // Level, the climb of a ball of radius r: r + sqrt(d² + (h - r)²) - h.
        let radius_m: f64 = 0.1;
        let climb_m = radius_m + EDGE_M.hypot(1.38 - radius_m) - 1.38;
        let inertia = 126.1 + DRY_KG * (EDGE_M * EDGE_M + 1.38 * 1.38);
        let expected = (2.0 * 1.625 * climb_m * inertia / DRY_KG).sqrt() / 1.38;
        let ball = Captured { pad_radius_m: radius_m, ..level };
        assert!((ball.tip_speed_m_s(1.625) - expected).abs() < 1e-12);
    }

    #[test]
    fn a_ball_pad_climbs_to_the_highest_point_of_its_roll() {
        // The roll tried in steps of 1e-5 rad; the top is flat, so that this gives 1e-10 of it.
        let (radius_m, slope_rad) = (0.1, DOWNHILL.slope_rad);
        let arm_w = nalgebra::Vector2::new(-EDGE_M, 1.38 - radius_m);
        let climb_m = (0..100_000)
            .map(|step| {
                let roll_rad = 1e-5 * f64::from(step);
                // Clockwise is downhill.
                let turned = nalgebra::Rotation2::new(-roll_rad - slope_rad) * arm_w;
                let before = nalgebra::Rotation2::new(-slope_rad) * arm_w;
                turned.y - before.y - radius_m * roll_rad * slope_rad.sin()
            })
            .fold(0.0, f64::max);
        let inertia = 126.1 + DRY_KG * (EDGE_M * EDGE_M + 1.38 * 1.38);
        let expected = (2.0 * 1.625 * climb_m * inertia / DRY_KG).sqrt() / 1.38;
        let ball = Captured { pad_radius_m: radius_m, ..DOWNHILL };
        assert!((ball.tip_speed_m_s(1.625) - expected).abs() < 1e-9);
    }

    #[test]
    fn the_margin_vanishes_exactly_at_the_captured_tip_speed() {
        let speed = captured_tip_speed_m_s(DRY_KG, 126.1, EDGE_M, 1.38, 1.625);
        let at = |v| tip_state(&sliding(v), &square()).margin_j;
        // Two algebraically equal forms: rounding of terms near 150 J.
        assert!(at(speed).abs() < 1e-10, "{}", at(speed));
        assert!(at(0.99 * speed) > 1.0 && at(1.01 * speed) < -1.0);
    }

    #[test]
    fn a_vertical_touchdown_has_the_whole_barrier_left() {
        let mut drop = sliding(0.0);
        drop.com_velocity_b = Vector3::new(0.0, 0.0, -2.0);
        let barrier_j = DRY_KG * 1.625 * (EDGE_M.hypot(1.38) - 1.38);
        assert!((tip_state(&drop, &square()).margin_j - barrier_j).abs() < 1e-10);
    }

    #[test]
    fn a_centre_of_mass_beyond_an_edge_is_unsupported_with_a_negative_margin() {
        let mut over = sliding(0.0);
        over.com_b.x = EDGE_M + 0.01;
        let state = tip_state(&over, &square());
        assert!(!state.supported() && state.margin_j < 0.0, "{state:?}");
        // Rounding of lengths near 1 m.
        assert!((state.distance_m + 0.01).abs() < 1e-15);
    }

    /// Pads on a circle of 1.885 m, the first at `heading_rad`.
    fn ring(feet: usize, heading_rad: f64) -> Vec<Vector3<f64>> {
        (0..feet)
            .map(|n| {
                let angle = heading_rad + n as f64 * std::f64::consts::TAU / feet as f64;
                Vector3::new(angle.cos(), angle.sin(), 0.0) * 1.885
            })
            .collect()
    }

    #[test]
    fn on_a_slope_the_distance_shrinks_with_the_height_of_the_centre_of_mass() {
        // Three to six feet, fall line across an edge: d cos β − h sin β, zero at the static tip
        // angle (T.16). Tolerance: rounding of lengths near 2 m.
        for feet in 3..=6 {
            let apothem_m = 1.885 * (std::f64::consts::PI / feet as f64).cos();
            let half = std::f64::consts::PI / feet as f64;
            for slope_rad in [0.0, 0.2, static_tip_angle_rad(apothem_m, 1.38), 0.9] {
                let mut standing = sliding(0.0);
                standing.up_b = Vector3::new(-slope_rad.sin(), 0.0, slope_rad.cos());
                let expected_m = apothem_m * slope_rad.cos() - 1.38 * slope_rad.sin();
                // The edge that faces +x is the one from foot -half to foot +half.
                let state = tip_state(&standing, &ring(feet, half));
                assert!((state.distance_m - expected_m).abs() < 2e-15, "{feet}: {state:?}");
            }
        }
    }

    #[test]
    fn heading_and_axes_change_neither_margin_nor_distance() {
        let moving = |turn: &nalgebra::Rotation3<f64>| Tipping {
            com_b: turn * Vector3::new(0.1, -0.2, 1.38),
            com_velocity_b: turn * Vector3::new(0.7, 0.3, -0.5),
            rate_b: turn * Vector3::new(0.1, -0.2, 0.3),
            inertia_b: turn
                * Matrix3::from_diagonal(&Vector3::new(126.0, 126.1, 86.5))
                * turn.inverse(),
            up_b: turn * Vector3::new(0.1, 0.0, 0.99_f64.sqrt()),
            ..sliding(0.0)
        };
        for feet in 3..=6 {
            let here = nalgebra::Rotation3::identity();
            let expected = tip_state(&moving(&here), &ring(feet, 0.3));
            let turn = nalgebra::Rotation3::from_euler_angles(0.5, -1.1, 2.0);
            let turned: Vec<_> = ring(feet, 0.3).iter().map(|foot_b| turn * foot_b).collect();
            let state = tip_state(&moving(&turn), &turned);
            // Rounding of energies near 500 J and lengths near 2 m.
            assert!((state.margin_j - expected.margin_j).abs() < 1e-11, "{feet} feet");
            assert!((state.distance_m - expected.distance_m).abs() < 1e-14, "{feet} feet");
        }
    }

    #[test]
    fn upside_down_or_on_its_side_nothing_is_supported() {
        for up_b in [-Vector3::z(), Vector3::x(), -Vector3::y()] {
            let state = tip_state(&Tipping { up_b, ..sliding(0.0) }, &square());
            assert!(!state.supported() && state.margin_j <= 0.0, "{up_b}: {state:?}");
        }
    }
}
