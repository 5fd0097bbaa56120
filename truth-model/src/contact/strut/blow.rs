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

/// Pads that bear shares as near to the worst slide with it.
const ALIKE: f64 = 1e-3;

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
/// kinetic energy, as Gauss's principle has it; slosh goes on as it was. `body` is the inertia of
/// velocity of O and rate, without the feet on the ground (T.37).
///
/// A pad whose blow friction can't pass on, or that it would lift, takes what it can, the worst
/// first, and slides. Its grip then slows it by what its strut's load allows.
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
        let blows: Vec<_> = (holds.iter())
            .map(|hold| {
                let slip_b = hold.across() * (velocity_b + rate_b.cross(&hold.point_b));
                let blow_b = slip_b * -ground_kg;
                (hold.share(&blow_b), blow_b)
            })
            .collect();
        let worst = blows.iter().map(|(share, _)| *share).fold(1.0, f64::min);
        if worst == 1.0 {
            return Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion };
        }
        let mut blows = blows.into_iter();
        holds.retain(|hold| {
            let Some((share, blow_b)) = blows.next() else { return true };
            let slides = share < 1.0 && share <= worst + ALIKE;
            if slides {
                let blow_b = blow_b * share;
                momentum += stack(&blow_b, &hold.point_b.cross(&blow_b));
            }
            !slides
        });
    }
}

/// Motion after pads on legs that give have met the ground: each foot stops there as far as friction
/// takes its slip, and the vehicle loses that much. What is left to stop the vehicle the leg does.
pub fn brush(
    motion: &Motion,
    body: &Matrix6<f64>,
    foot_kg: f64,
    holds: impl Iterator<Item = Hold>,
) -> Motion {
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let mut momentum = body * stack(&velocity_b, &motion.rate_b);
    for hold in holds {
        let slip_b = hold.across() * (velocity_b + motion.rate_b.cross(&hold.point_b));
        let blow_b = slip_b * -foot_kg;
        let blow_b = blow_b * hold.share(&blow_b);
        momentum += stack(&blow_b, &hold.point_b.cross(&blow_b));
    }
    let Some(solver) = body.cholesky() else { return *motion };
    let [velocity_b, rate_b] = split(&solver.solve(&momentum));
    Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion }
}

/// Motion after struts have torn feet off the ground: their momentum is the vehicle's. `before` is
/// the inertia without the feet that stood, `after` with those that it lifts (T.37).
pub fn lift(motion: &Motion, before: &Matrix6<f64>, after: &Matrix6<f64>) -> Motion {
    let velocity_b = motion.attitude_wb.inverse_transform_vector(&motion.velocity_w);
    let Some(solver) = after.cholesky() else { return *motion };
    let [velocity_b, rate_b] = split(&solver.solve(&(before * stack(&velocity_b, &motion.rate_b))));
    Motion { velocity_w: motion.attitude_wb * velocity_b, rate_b, ..*motion }
}

#[cfg(test)]
mod tests {
    use lander_models::frames::Attitude;
    use lander_models::mass::MassProperties;
    use nalgebra::Vector2;

    use super::super::inertia;
    use super::*;
    use crate::slosh::Pendulums;

    const MASS_KG: f64 = 174.0;
    const PITCH_KG_M2: f64 = 126.0;
    const HEIGHT_M: f64 = 1.38;
    const SPEED_M_S: f64 = 2.0;

    fn sliding() -> (Motion, MassProperties) {
        let motion = Motion {
            position_w: Vector3::zeros(),
            velocity_w: Vector3::new(SPEED_M_S, 0.0, -1.0),
            attitude_wb: Attitude::identity(),
            rate_b: Vector3::zeros(),
            propellant_kg: 0.0,
            thrust_n: 0.0,
            gimbal_rad: Vector2::zeros(),
            slosh: Pendulums::default(),
        };
        let inertia_b = Matrix3::from_diagonal(&Vector3::new(PITCH_KG_M2, PITCH_KG_M2, 86.0));
        let com_b = Vector3::new(0.0, 0.0, HEIGHT_M);
        (motion, MassProperties { mass_kg: MASS_KG, com_b, inertia_b })
    }

    fn holds(friction: f64, foot_n_s: f64, count: usize) -> impl Iterator<Item = Hold> {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        corners.into_iter().take(count).map(move |(x, y)| Hold {
            point_b: Vector3::new(x, y, 0.0),
            stroke_axis_b: Vector3::z(),
            normal_b: Vector3::z(),
            foot_n_s,
            friction,
        })
    }

    #[test]
    fn captured_pads_stop_the_vehicle_as_a_pendulum_on_a_level_rail() {
        let (motion, mass) = sliding();
        let after = stop(&motion, &inertia::whole(&mass), holds(f64::INFINITY, 0.0, 4));
        // J along the ground, at height 0: v - J/m - (J h/I) h = 0 there.
        let blow_n_s = SPEED_M_S / (1.0 / MASS_KG + HEIGHT_M * HEIGHT_M / PITCH_KG_M2);
        // What a pad keeps of its speed: one in the ground's mass.
        assert!((after.rate_b.y - blow_n_s * HEIGHT_M / PITCH_KG_M2).abs() < 1e-5);
        assert!(after.velocity_w.x.abs() < 1e-5 && after.velocity_w.z == -1.0);
    }

    #[test]
    fn sliding_pads_are_rubbed_by_their_feet_s_stop() {
        let (motion, mass) = sliding();
        let body = inertia::whole(&mass);
        let after = stop(&motion, &body, holds(0.5, 2.0, 4));
        let com_m_s = |motion: &Motion| motion.point_velocity_w(&mass.com_b).x;
        let lost_n_s = MASS_KG * (com_m_s(&motion) - com_m_s(&after));
        assert!((lost_n_s - 4.0 * 0.5 * 2.0).abs() < 1e-9, "{lost_n_s}");
    }

    #[test]
    fn on_legs_that_give_the_vehicle_loses_its_feet_s_slip_at_most() {
        const FOOT_KG: f64 = 2.0;
        let (motion, mass) = sliding();
        let body = inertia::whole(&mass);
        let com_m_s = |motion: &Motion| motion.point_velocity_w(&mass.com_b).x;
        // What stops a foot, and what friction passes on of it.
        for (friction, blow_n_s) in [(f64::INFINITY, FOOT_KG * SPEED_M_S), (0.5, 0.5 * 2.0)] {
            let after = brush(&motion, &body, FOOT_KG, holds(friction, 2.0, 4));
            let lost_n_s = MASS_KG * (com_m_s(&motion) - com_m_s(&after));
            assert!((lost_n_s - 4.0 * blow_n_s).abs() < 1e-9, "{lost_n_s}");
        }
    }

    #[test]
    fn the_ground_does_not_pull_a_pad_that_moves_down_a_slope() {
        let (motion, mass) = sliding();
        let normal_b = Vector3::new(0.2, 0.0, 0.96_f64.sqrt());
        let downhill = holds(f64::INFINITY, 0.0, 1).map(|hold| Hold { normal_b, ..hold });
        let after = stop(&motion, &inertia::whole(&mass), downhill);
        assert!((after.velocity_w - motion.velocity_w).norm() < 1e-12);
    }

    #[test]
    fn feet_torn_off_take_their_momentum_from_the_vehicle() {
        let (motion, mass) = sliding();
        let rising = Motion { velocity_w: Vector3::z() * 0.6, ..motion };
        let whole = inertia::whole(&mass);
        let mut without = whole;
        for hold in holds(0.5, 0.0, 4) {
            inertia::take_foot(&mut without, 2.0, &hold.point_b, &hold.stroke_axis_b);
        }
        let after = lift(&rising, &without, &whole);
        let expected_m_s = 0.6 * (MASS_KG - 4.0 * 2.0) / MASS_KG;
        assert!((after.velocity_w.z - expected_m_s).abs() < 1e-12);
    }
}
