//! Geometry of a state against the ground, and what the verdict gets to see of it.

use lander_models::frames::tilt_rad;
use nalgebra::Vector3;

use crate::contact::Touch;
use crate::flight::Motion;
use crate::model::{State, TruthModel};
use crate::stability::{Tipping, tip_state};
use crate::verdict::{Impact, Sight};

/// A strut within this of its stop has no stroke left, m: the stop gives by as much under load.
const BOTTOMED_GAP_M: f64 = 1e-4;

impl TruthModel {
    /// Pads' ground points from O at the struts' present length.
    pub fn feet_b<'a>(&'a self, state: &'a State) -> impl Iterator<Item = Vector3<f64>> + 'a {
        let legs = self.vehicle().gear.legs.iter().zip(&state.legs);
        legs.map(|(leg, now)| leg.foot_b + leg.stroke_axis_b * now.stroke_m)
    }

    /// Compression and axial load of each primary strut, m and N.
    pub fn struts<'a>(&'a self, state: &'a State) -> impl Iterator<Item = (f64, f64)> + 'a {
        let legs = self.vehicle().gear.legs.iter().zip(&state.legs);
        legs.map(|(leg, now)| (now.stroke_m * leg.strut_ratio, now.load_n / leg.strut_ratio))
    }

    /// Clearance of each pad, m.
    pub fn foot_clearances_m<'a>(&'a self, state: &'a State) -> impl Iterator<Item = f64> + 'a {
        let radius_m = self.vehicle().gear.pad_radius_m;
        self.feet_b(state).map(move |foot_b| {
            let centre_w = state.motion.point_position_w(&(foot_b + Vector3::z() * radius_m));
            self.ground().nearest(&centre_w).clearance_m - radius_m
        })
    }

    /// Clearance of the lowest point of pads, hull and nozzle, m.
    pub fn lowest_m(&self, state: &State) -> f64 {
        let (hull, engine) = (&self.vehicle().hull, &self.vehicle().engine);
        let rims = [
            (hull.bottom_height_m, hull.radius_m),
            (hull.top_height_m, hull.radius_m),
            (engine.nozzle_exit_height_m, engine.nozzle_exit_radius_m),
        ]
        .map(|(height_m, radius_m)| {
            let centre_w = state.motion.point_position_w(&(Vector3::z() * height_m));
            let under = self.ground().nearest(&centre_w);
            // The lowest point of a disc across the body's axis.
            let normal_b = state.motion.attitude_wb.inverse() * under.normal_w;
            under.clearance_m - radius_m * normal_b.xy().norm()
        });
        self.foot_clearances_m(state).chain(rims).fold(f64::INFINITY, f64::min)
    }

    /// Velocity of the centre of mass, world frame.
    pub fn com_velocity_w(&self, motion: &Motion) -> Vector3<f64> {
        motion.point_velocity_w(&self.vehicle().mass.at(motion.propellant_kg).com_b)
    }

    /// `before` is the motion before the tick that led to `state` and `touch`.
    pub(crate) fn sight(&self, state: &State, before: &Motion, touch: &Touch) -> Sight {
        let motion = &state.motion;
        let feet_w: Vec<_> =
            self.feet_b(state).map(|foot_b| motion.point_position_w(&foot_b)).collect();
        let footprint_w = feet_w.iter().sum::<Vector3<f64>>() / feet_w.len() as f64;
        let felt = touch.structure || touch.feet.contains(&true);
        // `state.feet_down` still is the last tick's.
        let new = felt && state.airborne && !state.feet_down.contains(&true);
        let impact = new.then(|| Impact {
            time: state.now,
            com_velocity_w: self.com_velocity_w(before),
            tilt_rad: tilt_rad(&before.attitude_wb),
            rate_rad_s: before.rate_b.norm(),
            footprint_w,
        });
        let mass = self.vehicle().mass.at(motion.propellant_kg);
        let rotation = motion.attitude_wb.to_rotation_matrix();
        let tipping = Tipping {
            mass_kg: mass.mass_kg,
            com_w: motion.point_position_w(&mass.com_b),
            com_velocity_w: self.com_velocity_w(motion),
            rate_w: motion.attitude_wb * motion.rate_b,
            inertia_w: rotation * mass.inertia_b * rotation.inverse(),
            gravity_m_s2: self.scenario().gravity_m_s2,
        };
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        Sight {
            now: state.now,
            impact,
            tip: tip_state(&tipping, &feet_w),
            feet_down: touch.feet.iter().filter(|down| **down).count(),
            structure_down: touch.structure,
            bottomed: (self.vehicle().gear.legs.iter().zip(&state.legs))
                .any(|(leg, now)| now.stroke_m > leg.strut.stroke_max_m - BOTTOMED_GAP_M),
            stroke_m: most(&mut self.struts(state).map(|(stroke_m, _)| stroke_m)),
            load_n: most(&mut self.struts(state).map(|(_, load_n)| load_n)),
            speed_m_s: tipping.com_velocity_w.norm(),
            rate_rad_s: motion.rate_b.norm(),
            footprint_w,
        }
    }
}
