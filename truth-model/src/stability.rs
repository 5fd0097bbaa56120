//! Tip-over: the energy still lacking over each edge of the support polygon (T.14, T.15), and
//! the closed forms it is held to (T.16, T.17).

use nalgebra::{Matrix3, Vector3};

/// The vehicle as tip-over sees it.
#[derive(Clone, Copy, Debug)]
pub struct Tipping {
    pub mass_kg: f64,
    pub com_w: Vector3<f64>,
    pub com_velocity_w: Vector3<f64>,
    pub rate_w: Vector3<f64>,
    /// About the centre of mass, world axes.
    pub inertia_w: Matrix3<f64>,
    pub gravity_m_s2: f64,
}

/// Where the vehicle stands between upright and over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipState {
    /// Least over all edges, J. Negative once the centre of mass is beyond an edge or has the
    /// energy to get there.
    pub margin_j: f64,
    /// The centre of mass is vertically above the support polygon.
    pub supported: bool,
}

/// `feet_w` are the pads' ground points, counter-clockwise seen from above.
///
/// For each edge: the height that the centre of mass must still climb to stand above the edge,
/// less the kinetic energy of the rotation about it if the pads of that edge stopped dead now.
pub fn tip_state(tipping: &Tipping, feet_w: &[Vector3<f64>]) -> TipState {
    let mut state = TipState { margin_j: f64::INFINITY, supported: true };
    for (n, foot_w) in feet_w.iter().enumerate() {
        let next_w = feet_w[(n + 1) % feet_w.len()];
        let Some(edge_w) = (next_w - foot_w).try_normalize(1e-9) else { continue };
        let arm_w = tipping.com_w - foot_w;
        let radius_w = arm_w - edge_w * arm_w.dot(&edge_w);
        // Rotation about +edge carries a point above the edge outwards.
        let outward_m = arm_w.dot(&edge_w.cross(&Vector3::z()));
        let horizontal = (1.0 - edge_w.z * edge_w.z).max(0.0).sqrt();
        let climb_m = radius_w.norm() * horizontal - radius_w.z;
        let barrier_j = tipping.mass_kg * tipping.gravity_m_s2 * climb_m;
        let margin_j = if outward_m > 0.0 {
            state.supported = false;
            -barrier_j
        } else {
            barrier_j - tipping_energy_j(tipping, &edge_w, &arm_w, &radius_w)
        };
        state.margin_j = state.margin_j.min(margin_j);
    }
    state
}

/// Kinetic energy of the outward rotation about an edge that captures the pads (T.15).
fn tipping_energy_j(
    tipping: &Tipping,
    edge_w: &Vector3<f64>,
    arm_w: &Vector3<f64>,
    radius_w: &Vector3<f64>,
) -> f64 {
    let spin_w = tipping.inertia_w * tipping.rate_w;
    let orbital_w = arm_w.cross(&tipping.com_velocity_w) * tipping.mass_kg;
    let momentum = edge_w.dot(&(spin_w + orbital_w)).max(0.0);
    let inertia =
        edge_w.dot(&(tipping.inertia_w * edge_w)) + tipping.mass_kg * radius_w.norm_squared();
    momentum * momentum / (2.0 * inertia)
}

/// Static tip angle of a centre of mass `height_m` above and `distance_m` inside an edge or a
/// foot, rad (T.16).
pub fn static_tip_angle_rad(distance_m: f64, height_m: f64) -> f64 {
    distance_m.atan2(height_m)
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
    let radius_m = distance_m.hypot(height_m);
    let inertia_about_edge = inertia_kg_m2 + mass_kg * radius_m * radius_m;
    let barrier_j = mass_kg * gravity_m_s2 * (radius_m - height_m);
    (2.0 * barrier_j * inertia_about_edge).sqrt() / (mass_kg * height_m)
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
            com_w: Vector3::new(0.0, 0.0, 1.38),
            com_velocity_w: Vector3::new(speed_m_s, 0.0, 0.0),
            rate_w: Vector3::zeros(),
            inertia_w: Matrix3::from_diagonal(&Vector3::new(126.0, 126.1, 86.5)),
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
        drop.com_velocity_w = Vector3::new(0.0, 0.0, -2.0);
        let barrier_j = DRY_KG * 1.625 * (EDGE_M.hypot(1.38) - 1.38);
        assert!((tip_state(&drop, &square()).margin_j - barrier_j).abs() < 1e-10);
    }

    #[test]
    fn a_centre_of_mass_beyond_an_edge_is_unsupported_with_a_negative_margin() {
        let mut over = sliding(0.0);
        over.com_w.x = EDGE_M + 0.01;
        let state = tip_state(&over, &square());
        assert!(!state.supported && state.margin_j < 0.0, "{state:?}");
    }
}
