//! Frames and attitude (docs/CONVENTIONS.md has the pictures and the reasons).
//!
//! `_w`: world, fixed to the site: origin at the target, x east, y north, z up. Inertial here.
//! `_b`: body, fixed to the structure: origin O in the footpad plane on the vehicle's axis,
//! z up along the axis. The paper's vehicle tables have their vertical axis along y;
//! `from_paper_axes` is the only place that knows.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// World axes of a body vector: `attitude_wb * v_b`.
pub type Attitude = UnitQuaternion<f64>;

/// Paper vehicle axes (x, y up, z) to body axes (x, y, z up): a cyclic, right-handed relabelling.
pub fn from_paper_axes(v_paper: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = v_paper;
    [z, x, y]
}

/// Attitude from the scalar-first quaternion on the wire; normalised.
pub fn attitude_from_wxyz(q: [f64; 4]) -> Attitude {
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// Scalar-first quaternion for the wire.
pub fn attitude_to_wxyz(attitude_wb: &Attitude) -> [f64; 4] {
    [attitude_wb.w, attitude_wb.i, attitude_wb.j, attitude_wb.k]
}

/// Attitude from roll, pitch, yaw in degrees: turns about x, then y, then z, world axes.
pub fn attitude_from_roll_pitch_yaw_deg(angles_deg: [f64; 3]) -> Attitude {
    let [roll, pitch, yaw] = angles_deg.map(f64::to_radians);
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// Angle between the body's axis and the vertical, rad.
pub fn tilt_rad(attitude_wb: &Attitude) -> f64 {
    let up_w = attitude_wb * Vector3::z();
    // atan2 keeps full precision near zero, where acos(z) loses half the digits.
    libm::atan2(up_w.xy().norm(), up_w.z)
}

/// Turn about the vertical that leads from one attitude to the other, rad, in (-π, π]: the twist
/// about world z of the rotation between them.
pub fn heading_change_rad(from_wb: &Attitude, to_wb: &Attitude) -> f64 {
    let turn = to_wb * from_wb.inverse();
    libm::atan2(2.0 * turn.w * turn.k, turn.w * turn.w - turn.k * turn.k)
}

/// Symmetric tensor from its moments and its elements xy, xz, yz.
#[inline]
pub fn symmetric(moments: &Vector3<f64>, products: &Vector3<f64>) -> Matrix3<f64> {
    let (m, p) = (moments, products);
    Matrix3::new(m.x, p.x, p.y, p.x, m.y, p.z, p.y, p.z, m.z)
}

/// Inverse of a symmetric tensor by its cofactors; not finite if there is none.
#[inline]
pub fn symmetric_inverse(m: &Matrix3<f64>) -> Matrix3<f64> {
    let (a, b, c) = (
        m.m22 * m.m33 - m.m23 * m.m23,
        m.m13 * m.m23 - m.m12 * m.m33,
        m.m12 * m.m23 - m.m13 * m.m22,
    );
    let scale = 1.0 / (m.m11 * a + m.m12 * b + m.m13 * c);
    let moments = Vector3::new(a, m.m11 * m.m33 - m.m13 * m.m13, m.m11 * m.m22 - m.m12 * m.m12);
    let products = Vector3::new(b, c, m.m12 * m.m13 - m.m11 * m.m23);
    symmetric(&(moments * scale), &(products * scale))
}

/// `(r·r) I - r rᵀ`: times a mass, the parallel-axis (Steiner) term of an inertia tensor.
#[inline]
pub fn steiner(r: &Vector3<f64>) -> Matrix3<f64> {
    let squares = r.component_mul(r);
    let moments = Vector3::new(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y);
    symmetric(&moments, &-Vector3::new(r.x * r.y, r.x * r.z, r.y * r.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symmetric_inverse_is_the_inverse() {
        let tensor = symmetric(&Vector3::new(126.0, 118.0, 86.5), &Vector3::new(3.0, -4.0, 1.0));
        let product = tensor * symmetric_inverse(&tensor);
        // A condition of 1.5 and a dozen roundings.
        assert!((product - Matrix3::identity()).abs().max() < 1e-15);
    }

    #[test]
    fn paper_axes_stay_right_handed() {
        let x = Vector3::from(from_paper_axes([1.0, 0.0, 0.0]));
        let y = Vector3::from(from_paper_axes([0.0, 1.0, 0.0]));
        let z = Vector3::from(from_paper_axes([0.0, 0.0, 1.0]));
        assert_eq!(x.cross(&y), z);
        assert_eq!(y, Vector3::z(), "the paper's vertical axis must become body z");
    }

    #[test]
    fn a_heading_change_is_the_turn_about_the_vertical_alone() {
        let from = Attitude::from_euler_angles(0.2, -0.1, 3.0);
        for turn_rad in [-3.1, -0.4, 0.0, 1.0, 3.1] {
            let turned = Attitude::from_axis_angle(&Vector3::z_axis(), turn_rad) * from;
            // Rounding of quaternion products.
            assert!((heading_change_rad(&from, &turned) - turn_rad).abs() < 1e-14, "{turn_rad}");
        }
        let pitched = Attitude::from_axis_angle(&Vector3::y_axis(), 0.5) * from;
        assert!(heading_change_rad(&from, &pitched).abs() < 1e-15);
    }

    #[test]
    fn tilt_is_exact_for_small_and_large_angles() {
        for angle in [1e-9, 0.1, 1.5, 3.0] {
            let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
            // Origin: a few roundings of the quaternion.
            assert!((tilt_rad(&attitude) - angle).abs() < 4e-16 + 4e-15 * angle);
        }
    }
}
