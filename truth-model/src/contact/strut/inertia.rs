//! Inertia of a vehicle whose feet on the ground have stopped (T.37): velocity of O and rate, body
//! frame, stacked.

use lander_models::mass::MassProperties;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

pub fn stack(upper: &Vector3<f64>, lower: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(upper.x, upper.y, upper.z, lower.x, lower.y, lower.z)
}

/// Upper and lower half.
pub fn split(stacked: &Vector6<f64>) -> [Vector3<f64>; 2] {
    [stacked.fixed_rows::<3>(0).into(), stacked.fixed_rows::<3>(3).into()]
}

/// Kinetic energy's matrix of the whole vehicle.
pub fn whole(mass: &MassProperties) -> Matrix6<f64> {
    let (mass_kg, lever) = (mass.mass_kg, mass.com_b.cross_matrix());
    let mut body = Matrix6::zeros();
    add_block(&mut body, 0, 0, &(Matrix3::identity() * mass_kg));
    add_block(&mut body, 0, 3, &(lever * -mass_kg));
    add_block(&mut body, 3, 0, &(lever * mass_kg));
    add_block(&mut body, 3, 3, &(mass.inertia_b - lever * lever * mass_kg));
    body
}

/// Less a foot along its stroke axis, in which it no longer moves with the vehicle.
pub fn take_foot(
    body: &mut Matrix6<f64>,
    foot_kg: f64,
    point_b: &Vector3<f64>,
    axis_b: &Vector3<f64>,
) {
    let along = stack(axis_b, &point_b.cross(axis_b));
    *body -= along * along.transpose() * foot_kg;
}

/// More of what ties a point to the ground: `tie` against its velocity.
pub fn add_tie(body: &mut Matrix6<f64>, tie: &Matrix3<f64>, point_b: &Vector3<f64>) {
    let lever = -point_b.cross_matrix();
    add_block(body, 0, 0, tie);
    add_block(body, 0, 3, &(tie * lever));
    add_block(body, 3, 0, &(lever.transpose() * tie));
    add_block(body, 3, 3, &(lever.transpose() * tie * lever));
}

fn add_block(matrix: &mut Matrix6<f64>, row: usize, column: usize, block: &Matrix3<f64>) {
    let mut view = matrix.fixed_view_mut::<3, 3>(row, column);
    view += block;
}
