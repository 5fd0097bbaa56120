//! Six-degree-of-freedom rigid body on a gimballed engine and its analytic Jacobian (G.70-G.73).

use lander_models::mass::MassModel;
use nalgebra::{Matrix3, Matrix3x4, Matrix4, Matrix4x3, Quaternion, SVector, Vector3, Vector4};

/// Mass, position, velocity, attitude (w, x, y, z), body rates: kg, m, m/s, 1, rad/s.
pub(super) type State = SVector<f64, 14>;
/// Tangents of the gimbal angle along body x and y, thrust, thruster torque: 1, N, N m. In these the
/// limits on angle, thrust and their rates are convex, and hold between nodes if they do at them.
pub(super) type Control = SVector<f64, 6>;

/// First rows of the parts of a [`State`].
pub(super) const R: usize = 1;
pub(super) const V: usize = 4;
pub(super) const Q: usize = 7;
pub(super) const W: usize = 11;
/// Row of the thrust, and first row of the torque, in a [`Control`].
pub(super) const THRUST: usize = 2;
pub(super) const TORQUE: usize = 3;

/// What moves and how: constant over a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dynamics<'a> {
    pub mass: &'a MassModel,
    /// Gimbal pivot from O.
    pub pivot_b: Vector3<f64>,
    pub gravity_m_s2: f64,
    /// 1/(I_sp g0), s/m.
    pub mass_flow_s_m: f64,
}

/// Nonzero blocks of ∂x'/∂x and ∂x'/∂u; r' = v is left to the caller.
pub(super) struct Jacobian {
    /// By the thrust alone.
    pub m_thrust: f64,
    pub v_m: Vector3<f64>,
    pub v_q: Matrix3x4<f64>,
    pub v_engine: Matrix3<f64>,
    pub q_q: Matrix4<f64>,
    pub q_w: Matrix4x3<f64>,
    pub w_m: Vector3<f64>,
    pub w_w: Matrix3<f64>,
    pub w_engine: Matrix3<f64>,
    pub w_torque: Matrix3<f64>,
}

impl Dynamics<'_> {
    /// x' and its Jacobian.
    pub fn rate(&self, x: &State, u: &Control) -> (State, Jacobian) {
        let m = x[0];
        let (scalar, vector) = (x[Q], x.fixed_rows::<3>(Q + 1).into_owned());
        let rate_b: Vector3<f64> = x.fixed_rows::<3>(W).into();
        let (thrust_b, thrust_by_control_b) = thrust(u);
        let torque_b: Vector3<f64> = u.fixed_rows::<3>(TORQUE).into();
        let propellant_kg = m - self.mass.dry.mass_kg;
        let (now, draw) = (self.mass.at(propellant_kg), self.mass.draw(propellant_kg));

        let mut dx = State::zeros();
        dx[0] = -self.mass_flow_s_m * u[THRUST]; // (G.70)
        dx.fixed_rows_mut::<3>(R).copy_from(&x.fixed_rows::<3>(V));
        // (G.71)
        let rotation_wb = rotation(scalar, &vector);
        let push_w = rotation_wb * thrust_b / m;
        dx.fixed_rows_mut::<3>(V).copy_from(&push_w);
        dx[V + 2] -= self.gravity_m_s2;
        // (G.72)
        let turn = Quaternion::from_parts(scalar, vector) * Quaternion::from_imag(rate_b * 0.5);
        dx[Q] = turn.w;
        dx.fixed_rows_mut::<3>(Q + 1).copy_from(&turn.imag());
        // (G.73)
        let arm_b = self.pivot_b - now.com_b;
        let spin_b = now.inertia_b * rate_b;
        let moment_b = arm_b.cross(&thrust_b) + torque_b - rate_b.cross(&spin_b);
        // The inertia of a vehicle file is positive definite at any fill.
        let inverse_b = now.inertia_b.try_inverse().unwrap_or_else(Matrix3::zeros);
        let turn_b = inverse_b * moment_b;
        dx.fixed_rows_mut::<3>(W).copy_from(&turn_b);

        let com_per_kg_b = (draw.centre_b - now.com_b) / m;
        let moment_per_kg_b = -com_per_kg_b.cross(&thrust_b)
            - rate_b.cross(&(draw.inertia_b * rate_b))
            - draw.inertia_b * turn_b;
        let mut v_q = Matrix3x4::zeros();
        v_q.set_column(0, &(vector.cross(&thrust_b) * (2.0 / m)));
        v_q.fixed_columns_mut::<3>(1).copy_from(
            &((Matrix3::identity() * vector.dot(&thrust_b) + vector * thrust_b.transpose()
                - thrust_b * vector.transpose() * 2.0
                - thrust_b.cross_matrix() * scalar)
                * (2.0 / m)),
        );
        let half_b = rate_b * 0.5;
        let mut q_q = Matrix4::zeros();
        q_q.fixed_view_mut::<1, 3>(0, 1).copy_from(&-half_b.transpose());
        q_q.fixed_view_mut::<3, 1>(1, 0).copy_from(&half_b);
        q_q.fixed_view_mut::<3, 3>(1, 1).copy_from(&-half_b.cross_matrix());
        let mut q_w = Matrix4x3::zeros();
        q_w.set_row(0, &(vector.transpose() * -0.5));
        q_w.fixed_rows_mut::<3>(1)
            .copy_from(&((Matrix3::identity() * scalar + vector.cross_matrix()) * 0.5));
        let jacobian = Jacobian {
            m_thrust: -self.mass_flow_s_m,
            v_m: -push_w / m,
            v_q,
            v_engine: rotation_wb * thrust_by_control_b / m,
            q_q,
            q_w,
            w_m: inverse_b * moment_per_kg_b,
            w_w: inverse_b * (spin_b.cross_matrix() - rate_b.cross_matrix() * now.inertia_b),
            w_engine: inverse_b * arm_b.cross_matrix() * thrust_by_control_b,
            w_torque: inverse_b,
        };
        (dx, jacobian)
    }
}

/// Thrust in body axes, and its derivatives by the two tangents and the magnitude (G.75).
pub(super) fn thrust(u: &Control) -> (Vector3<f64>, Matrix3<f64>) {
    let along_b = Vector3::new(u[0], u[1], 1.0);
    let length = along_b.norm();
    let direction_b = along_b / length;
    let turned = |axis: usize| {
        (Vector3::ith(axis, 1.0) - direction_b * direction_b[axis]) * (u[THRUST] / length)
    };
    let derivatives_b = Matrix3::from_columns(&[turned(0), turned(1), direction_b]);
    (direction_b * u[THRUST], derivatives_b)
}

/// Body to world for the quaternion (scalar, vector); on the unit sphere, where (G.72) keeps it.
fn rotation(scalar: f64, vector: &Vector3<f64>) -> Matrix3<f64> {
    let cross = vector.cross_matrix();
    Matrix3::identity() + (cross * scalar + cross * cross) * 2.0
}

/// The attitude rows of a state, as stored.
pub(super) fn quaternion(x: &State) -> Vector4<f64> {
    x.fixed_rows::<4>(Q).into()
}
