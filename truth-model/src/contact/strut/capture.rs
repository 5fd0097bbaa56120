//! Pads that take hold of the ground at once: the blow that stops them (T.39).

use lander_models::mass::MassProperties;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use crate::flight::Motion;

/// Mass, in vehicles, of the ground that a held pad is tied to: what a pad keeps of its speed.
const GROUND_MASS: f64 = 1e9;

/// A held pad as the body sees it.
pub struct Hold {
    /// Where it stands, from O.
    pub point_b: Vector3<f64>,
    /// Along it the strut gives way.
    pub stroke_axis_b: Vector3<f64>,
}

/// Motion after blows across the stroke axes have stopped all held pads; slosh goes on as it was.
/// It has the least kinetic energy of change: the pads share the blow as Gauss's principle says.
pub fn stop(motion: &Motion, mass: &MassProperties, holds: impl Iterator<Item = Hold>) -> Motion {
    let body = inertia_about_origin(mass);
    let mut tied = body;
    for Hold { point_b, stroke_axis_b } in holds {
        // Speed across the axis by velocity of O and rate: S (v + ω × p).
        let across = Matrix3::identity() - stroke_axis_b * stroke_axis_b.transpose();
        let lever = -point_b.cross_matrix();
        let ground = across * (GROUND_MASS * mass.mass_kg);
        add_block(&mut tied, 0, 0, &ground);
        add_block(&mut tied, 0, 3, &(ground * lever));
        add_block(&mut tied, 3, 0, &(lever.transpose() * ground));
        add_block(&mut tied, 3, 3, &(lever.transpose() * ground * lever));
    }
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let mut speeds = Vector6::zeros();
    speeds.fixed_rows_mut::<3>(0).copy_from(&velocity_b);
    speeds.fixed_rows_mut::<3>(3).copy_from(&motion.rate_b);
    // Positive definite as the body's is; a body that has become non-finite moves on and is found.
    let Some(solver) = tied.cholesky() else { return *motion };
    let after = solver.solve(&(body * speeds));
    let velocity_b: Vector3<f64> = after.fixed_rows::<3>(0).into();
    Motion {
        velocity_w: motion.attitude_wb * velocity_b,
        rate_b: after.fixed_rows::<3>(3).into(),
        ..*motion
    }
}

/// Kinetic energy's matrix for velocity of O and rate, body frame.
fn inertia_about_origin(mass: &MassProperties) -> Matrix6<f64> {
    let (mass_kg, lever) = (mass.mass_kg, mass.com_b.cross_matrix());
    let mut body = Matrix6::zeros();
    add_block(&mut body, 0, 0, &(Matrix3::identity() * mass_kg));
    add_block(&mut body, 0, 3, &(lever * -mass_kg));
    add_block(&mut body, 3, 0, &(lever * mass_kg));
    add_block(&mut body, 3, 3, &(mass.inertia_b - lever * lever * mass_kg));
    body
}

fn add_block(matrix: &mut Matrix6<f64>, row: usize, column: usize, block: &Matrix3<f64>) {
    let mut view = matrix.fixed_view_mut::<3, 3>(row, column);
    view += block;
}
