//! Pads that take hold of the ground at once: the blow that stops them (T.39).

use lander_models::mass::MassProperties;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use crate::flight::Motion;

/// Mass, in vehicles, of the ground that a held pad is tied to: one part in it a pad keeps of its
/// speed.
const GROUND_MASS: f64 = 1e6;
/// Share of a blow that may lift its pad for nothing: the solver's rounding, which the ground's
/// mass magnifies to 1e-4.
const LIFT_SHARE: f64 = 1e-3;

/// A held pad as the body sees it.
pub struct Hold {
    /// Where it stands, from O.
    pub point_b: Vector3<f64>,
    /// Along it the strut gives way.
    pub stroke_axis_b: Vector3<f64>,
    /// Of the ground.
    pub normal_b: Vector3<f64>,
    /// Blow along the normal that stops the foot itself, N s: as much of the vehicle's may lift it.
    pub foot_n_s: f64,
}

impl Hold {
    /// What of a velocity there is across the axis.
    fn across(&self) -> Matrix3<f64> {
        Matrix3::identity() - self.stroke_axis_b * self.stroke_axis_b.transpose()
    }
}

/// Motion after blows across the stroke axes have stopped the held pads, by the least change of
/// kinetic energy, as Gauss's principle has it; slosh goes on as it was.
///
/// Ground doesn't pull: a pad that the blow would lift takes as much of it as leaves it there, the
/// worst first, and slides. Its grip then slows it by what its strut's load allows.
pub fn stop(motion: &Motion, mass: &MassProperties, holds: impl Iterator<Item = Hold>) -> Motion {
    let body = inertia_about_origin(mass);
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let mut momentum = body * stack(&velocity_b, &motion.rate_b);
    let mut holds: Vec<_> = holds.collect();
    loop {
        let mut tied = body;
        for hold in &holds {
            // Speed across the axis by velocity of O and rate: S (v + ω × p).
            let ground = hold.across() * (GROUND_MASS * mass.mass_kg);
            let lever = -hold.point_b.cross_matrix();
            add_block(&mut tied, 0, 0, &ground);
            add_block(&mut tied, 0, 3, &(ground * lever));
            add_block(&mut tied, 3, 0, &(lever.transpose() * ground));
            add_block(&mut tied, 3, 3, &(lever.transpose() * ground * lever));
        }
        // Positive definite as the body's is; one that has become non-finite is found elsewhere.
        let Some(solver) = tied.cholesky() else { return *motion };
        let after = solver.solve(&momentum);
        let velocity_b: Vector3<f64> = after.fixed_rows::<3>(0).into();
        let rate_b: Vector3<f64> = after.fixed_rows::<3>(3).into();
        let lifted = holds.iter().map(|hold| {
            let slip_b = hold.across() * (velocity_b + rate_b.cross(&hold.point_b));
            let blow_b = slip_b * (-GROUND_MASS * mass.mass_kg);
            let lift_n_s = -blow_b.dot(&hold.normal_b);
            (lift_n_s - hold.foot_n_s - LIFT_SHARE * blow_b.norm(), blow_b / lift_n_s)
        });
        let worst = lifted.enumerate().max_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b));
        match worst {
            Some((n, (excess_n_s, blow_b))) if excess_n_s > 0.0 => {
                let hold = holds.remove(n);
                let blow_b = blow_b * hold.foot_n_s;
                momentum += stack(&blow_b, &hold.point_b.cross(&blow_b));
            }
            _ => return Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion },
        }
    }
}

fn stack(upper: &Vector3<f64>, lower: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(upper.x, upper.y, upper.z, lower.x, lower.y, lower.z)
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
