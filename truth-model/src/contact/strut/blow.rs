//! Blows: along the ground as pads meet it (T.39), where captured ones stop the vehicle and sliding
//! ones rub it by the weight of their own stop; and along the struts that lift feet off it.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::inertia::{add_tie, split, stack};
use crate::flight::Motion;

/// Mass, in vehicles, of the ground that a held pad is tied to: one part in it a pad keeps of its
/// speed.
const GROUND_MASS: f64 = 1e6;
/// Share of a blow that needs nothing to press its pad: the solver's rounding, which the ground's
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
    /// Blow along the normal that stops the foot itself, N s.
    pub foot_n_s: f64,
    /// Coulomb's coefficient, infinite for a captured pad.
    pub friction: f64,
}

impl Hold {
    /// What of a velocity there is across the axis.
    fn across(&self) -> Matrix3<f64> {
        Matrix3::identity() - self.stroke_axis_b * self.stroke_axis_b.transpose()
    }

    /// Most of a blow across the axis that friction passes on, as a share of it: Coulomb's law for
    /// its part along the ground, by the foot's blow and its own part along the normal.
    fn share(&self, blow_b: &Vector3<f64>) -> f64 {
        let press_n_s = blow_b.dot(&self.normal_b);
        let along_n_s = (blow_b - self.normal_b * press_n_s).norm();
        let short_n_s = along_n_s / self.friction - press_n_s;
        let rounding_n_s = LIFT_SHARE * along_n_s;
        if short_n_s <= self.foot_n_s + rounding_n_s { 1.0 } else { self.foot_n_s / short_n_s }
    }
}

/// Motion after blows across the stroke axes have stopped the held pads, by the least change of
/// kinetic energy, as Gauss's principle has it; slosh goes on as it was.
///
/// A pad whose blow friction can't pass on, or that it would lift, takes what it can, the worst
/// first, and slides. `body` is the inertia (T.37). Its grip then slows it by what its strut's load allows.
pub fn stop(motion: &Motion, body: &Matrix6<f64>, holds: impl Iterator<Item = Hold>) -> Motion {
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let mut momentum = body * stack(&velocity_b, &motion.rate_b);
    let ground_kg = GROUND_MASS * body[(0, 0)];
    let mut holds: Vec<_> = holds.collect();
    loop {
        let mut tied = *body;
        for hold in &holds {
            add_tie(&mut tied, &(hold.across() * ground_kg), &hold.point_b);
        }
        // Positive definite as the body's is; one that has become non-finite is found elsewhere.
        let Some(solver) = tied.cholesky() else { return *motion };
        let [velocity_b, rate_b] = split(&solver.solve(&momentum));
        let shares = holds.iter().map(|hold| {
            let slip_b = hold.across() * (velocity_b + rate_b.cross(&hold.point_b));
            let blow_b = slip_b * -ground_kg;
            (hold.share(&blow_b), blow_b)
        });
        let worst = shares.enumerate().min_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b));
        match worst {
            Some((n, (share, blow_b))) if share < 1.0 => {
                let hold = holds.remove(n);
                let blow_b = blow_b * share;
                momentum += stack(&blow_b, &hold.point_b.cross(&blow_b));
            }
            _ => return Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion },
        }
    }
}

/// Motion after struts have torn feet off the ground: their momentum is the vehicle's. `before` is
/// the inertia without the feet that stood, `after` with those that it lifts (T.37).
pub fn lift(motion: &Motion, before: &Matrix6<f64>, after: &Matrix6<f64>) -> Motion {
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let Some(solver) = after.cholesky() else { return *motion };
    let [velocity_b, rate_b] = split(&solver.solve(&(before * stack(&velocity_b, &motion.rate_b))));
    Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion }
}
