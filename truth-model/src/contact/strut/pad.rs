//! One massless pad: where it stands on the ground and what it passes on to the body.

use lander_models::scenario::Soil;
use lander_models::vehicle::{Gear, Leg};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::super::{Footing, Site};
use super::TOUCH_TIME_MIN_S;
use super::capture::Hold;
use super::soil::Bed;
use crate::flight::Motion;
use crate::gear::{LegState, crush_load_n, crushed_after, strut_load_n};

/// A pad so near and no faster away is on the ground: rounding of a start on it, m and m/s.
const MEET_GAP_M: f64 = 1e-9;
const MEET_SPEED_M_S: f64 = 1e-9;
/// A leg flatter to the ground than this carries nothing along its axis (cosine).
const FLAT: f64 = 0.05;

/// Friction spring of a pad that stands (Cundall and Strack 1979): how far its touching point was
/// carried along the ground since it took hold.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Grip {
    slip_w: Option<Vector3<f64>>,
}

impl Grip {
    /// Of a pad that takes hold here.
    pub fn fresh() -> Self {
        Self { slip_w: Some(Vector3::zeros()) }
    }

    pub fn holds(&self) -> bool {
        self.slip_w.is_some()
    }
}

/// How the vehicle bears on each of its pads.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// Of its mass on one leg.
    pub share_kg: f64,
    /// What a strut's load counts for the whole vehicle: feet on the ground are not braked by it.
    pub sprung: f64,
    pub stiffest: Stiffest,
}

/// Natural frequencies of that share on the two springs that stand for rigid contact.
#[derive(Clone, Copy, Debug)]
pub struct Stiffest {
    /// Along the ground, on a gripping pad.
    pub grip_rad_s: f64,
    /// Along a strut without stroke left.
    pub stop_rad_s: f64,
}

/// A pad at the start of a step.
pub struct Pad<'a> {
    leg: &'a Leg,
    centre_b: Vector3<f64>,
    radius_m: f64,
    start: LegState,
    /// Ground under the pad: its tangent plane, held for the step.
    footing: Footing,
    /// Of the pad that touched at the start of the step: where it is on the body, at no stroke, and
    /// where it was in the world, less the slip until then. Pads roll without slip.
    touch_b: Vector3<f64>,
    anchor_w: Vector3<f64>,
    standing: bool,
    grip_n_m: f64,
    /// Critical: a pad that grips stops dead, as on a rigid hold.
    grip_n_s_m: f64,
    stop_n_m: f64,
    stop_n_s_m: f64,
    /// What a strut's load counts for the whole vehicle: feet on the ground are not braked by it.
    sprung: f64,
    bed: Bed,
    /// Of the pad at no stroke.
    start_clearance_m: f64,
}

/// A pad's force at one instant.
pub struct PadForce {
    /// Of the ground on the pad.
    pub ground_w: Vector3<f64>,
    /// Where it acts, from O.
    pub point_b: Vector3<f64>,
    stroke_m: f64,
    stroke_rate_m_s: f64,
    sinkage_m: f64,
    load_n: f64,
    slip_w: Vector3<f64>,
    normal_n: f64,
}

impl<'a> Pad<'a> {
    pub fn new(
        site: &Site<'a>,
        leg: &'a Leg,
        motion: &Motion,
        start: LegState,
        grip: &Grip,
        Shares { share_kg, sprung, stiffest }: Shares,
    ) -> Self {
        let gear: &Gear = &site.vehicle.gear;
        let centre_b = gear.pad_centre_b(leg);
        let centre_w = motion.point_position_w(&(centre_b + leg.stroke_axis_b * start.stroke_m));
        let (footing, on_rock) = site.pad_footing(&centre_w);
        let touch_w = centre_w - footing.normal_w * gear.pad_radius_m;
        let normal_b = motion.attitude_wb.inverse_transform_vector(&footing.normal_w);
        let slip_w = grip.slip_w.unwrap_or_default();
        let Stiffest { grip_rad_s, stop_rad_s } = stiffest;
        let mut pad = Self {
            leg,
            centre_b,
            radius_m: gear.pad_radius_m,
            start,
            footing,
            touch_b: centre_b - normal_b * gear.pad_radius_m,
            anchor_w: touch_w - tangential(&slip_w, &footing.normal_w),
            standing: grip.slip_w.is_some(),
            grip_n_m: share_kg * grip_rad_s * grip_rad_s,
            grip_n_s_m: 2.0 * share_kg * grip_rad_s,
            stop_n_m: share_kg * stop_rad_s * stop_rad_s,
            stop_n_s_m: 2.0 * share_kg * stop_rad_s,
            sprung,
            bed: Bed::HARD,
            start_clearance_m: footing.clearance_m(&motion.point_position_w(&centre_b)),
        };
        if let (Some(soil), false) = (&site.terrain.soil, on_rock) {
            pad.bed = pad.bed(soil, gear.bearing_radius_m, motion);
        }
        pad
    }

    /// Soil under the pad (T.38).
    fn bed(&self, soil: &Soil, radius_m: f64, motion: &Motion) -> Bed {
        let normal_w = self.footing.normal_w;
        let rise = normal_w.dot(&(motion.attitude_wb * self.leg.stroke_axis_b)).max(FLAT);
        let pad_b = self.centre_b + self.leg.stroke_axis_b * self.start.stroke_m;
        let closing_m_s = -normal_w.dot(&motion.point_velocity_w(&pad_b));
        let load_n =
            |rate_m_s: f64| self.axial_n(self.start.stroke_m, rate_m_s / rise) * self.sprung / rise;
        Bed::new(soil, radius_m, self.start.sinkage_m, closing_m_s, load_n)
    }

    /// Time until the pad reaches the ground as it moves now, s; infinite if it stands already or
    /// moves away.
    pub fn time_to_touch_s(&self, motion: &Motion) -> f64 {
        let (gap_m, closing_m_s) = self.approach(motion);
        if self.standing || closing_m_s <= 0.0 || gap_m <= 0.0 {
            f64::INFINITY
        } else {
            gap_m / closing_m_s
        }
    }

    /// Whether a pad off the ground comes down on it now.
    pub fn meets_ground(&self, motion: &Motion) -> bool {
        let (gap_m, closing_m_s) = self.approach(motion);
        !self.standing
            && closing_m_s > -MEET_SPEED_M_S
            && gap_m <= MEET_GAP_M.max(closing_m_s * TOUCH_TIME_MIN_S)
    }

    /// As the body sees a pad that holds.
    pub fn hold(&self, motion: &Motion) -> Hold {
        let normal_b = motion.attitude_wb.inverse_transform_vector(&self.footing.normal_w);
        let stroke_axis_b = self.leg.stroke_axis_b;
        let pad_b = self.centre_b + stroke_axis_b * self.start.stroke_m;
        Hold { point_b: pad_b - normal_b * self.radius_m, stroke_axis_b }
    }

    /// Gap between pad and ground, m, and the speed at which it closes, m/s.
    fn approach(&self, motion: &Motion) -> (f64, f64) {
        let pad_b = self.centre_b + self.leg.stroke_axis_b * self.start.stroke_m;
        let gap_m = self.footing.clearance_m(&motion.point_position_w(&pad_b)) - self.radius_m
            + self.bed.sinkage_m;
        (gap_m, -self.footing.normal_w.dot(&motion.point_velocity_w(&pad_b)))
    }

    /// Force in a given motion; `None` while the pad is off the ground (T.30 to T.34).
    pub fn force(&self, site: &Site, motion: &Motion) -> Option<PadForce> {
        let normal_w = self.footing.normal_w;
        let axis_w = motion.attitude_wb * self.leg.stroke_axis_b;
        let rise = normal_w.dot(&axis_w);
        let free_w = motion.point_position_w(&self.centre_b);
        // (T.30) The pad stays on the ground: its stroke is geometry.
        let clearance_m = self.footing.clearance_m(&free_w);
        let sinkage_m = self.bed.depth_m(self.start_clearance_m - clearance_m);
        let stroke_m = (self.radius_m - sinkage_m - clearance_m) / rise;
        if rise < FLAT || (!self.standing && stroke_m <= self.start.stroke_m) {
            return None;
        }
        let point_w = free_w + axis_w * stroke_m - normal_w * self.radius_m;
        let point_b = motion.attitude_wb.inverse_transform_vector(&(point_w - motion.position_w));
        let body_w = motion.point_velocity_w(&point_b);
        // What the soil takes of the way down the strut does not.
        let stroke_rate_m_s = -body_w.dot(&normal_w) / rise * (1.0 - self.bed.share);
        let load_n = self.axial_n(stroke_m, stroke_rate_m_s);
        if load_n <= 0.0 {
            return None;
        }
        // (T.37) The feet on the ground have stopped already.
        let axial_n = load_n * self.sprung;
        // (T.32) Spring and damper along the ground.
        let touch_w = motion.point_position_w(&self.touch_b) + axis_w * stroke_m;
        let slip_w = tangential(&(touch_w - self.anchor_w), &normal_w);
        let slip_m_s = tangential(&(body_w + axis_w * stroke_rate_m_s), &normal_w);
        let hold_w = slip_w * -self.grip_n_m - slip_m_s * self.grip_n_s_m;
        // (T.33) Along the strut's axis ground force and strut balance on the massless pad.
        let sticking_n = (axial_n - hold_w.dot(&axis_w)) / rise;
        let hold_n = hold_w.norm();
        let friction = site.pad_friction();
        let (normal_n, friction_w) = if hold_n <= friction * sticking_n {
            (sticking_n, hold_w)
        } else {
            let direction_w = hold_w / hold_n;
            let normal_n = axial_n / (rise + friction * direction_w.dot(&axis_w)).max(FLAT);
            (normal_n, direction_w * (friction * normal_n))
        };
        let ground_w = normal_w * normal_n + friction_w;
        Some(PadForce {
            ground_w,
            point_b,
            stroke_m,
            stroke_rate_m_s,
            sinkage_m,
            load_n,
            slip_w,
            normal_n,
        })
    }

    /// State of leg and grip after a step that ended in `motion`.
    pub fn settle(&self, site: &Site, motion: &Motion, step_s: f64, grip: &mut Grip) -> LegState {
        let strut = &self.leg.strut;
        let Some(force) = self.force(site, motion) else {
            grip.slip_w = None;
            // (T.35) Off the ground the damper lets the strut spring back to its crushed length.
            let decay = if strut.damping_n_s_m > 0.0 {
                (-step_s * strut.stiffness_n_m / strut.damping_n_s_m).exp()
            } else {
                0.0
            };
            let crushed_m = self.start.crushed_m;
            let stroke_m = crushed_m + (self.start.stroke_m - crushed_m) * decay;
            // A pad clear of its hole comes down on fresh soil.
            let pad_b = self.centre_b + self.leg.stroke_axis_b * stroke_m;
            let clear = self.footing.clearance_m(&motion.point_position_w(&pad_b)) > self.radius_m;
            let sinkage_m = if clear { 0.0 } else { self.bed.sinkage_m };
            return LegState { stroke_m, crushed_m, sinkage_m, ..LegState::default() };
        };
        // (T.34) Friction holds no more than this; the rest was a slide.
        let most_m = site.pad_friction() * force.normal_n / self.grip_n_m;
        grip.slip_w = Some(force.slip_w.cap_magnitude(most_m));
        LegState {
            stroke_m: force.stroke_m,
            stroke_rate_m_s: force.stroke_rate_m_s,
            crushed_m: crushed_after(strut, self.cap_n(), self.start.crushed_m, force.stroke_m),
            load_n: force.load_n,
            ground_force_w: force.ground_w,
            sinkage_m: force.sinkage_m,
        }
    }

    /// Crush load of the stage in which the step began.
    fn cap_n(&self) -> f64 {
        crush_load_n(&self.leg.strut, self.start.stroke_m)
    }

    /// (T.31) Strut law with its stop.
    fn axial_n(&self, stroke_m: f64, rate_m_s: f64) -> f64 {
        let strut = &self.leg.strut;
        let over_m = stroke_m - strut.stroke_max_m;
        let stop_n = if over_m > 0.0 {
            (self.stop_n_m * over_m + self.stop_n_s_m * rate_m_s).max(0.0)
        } else {
            0.0
        };
        strut_load_n(strut, self.cap_n(), self.start.crushed_m, stroke_m, rate_m_s) + stop_n
    }
}

fn tangential(vector_w: &Vector3<f64>, normal_w: &Vector3<f64>) -> Vector3<f64> {
    vector_w - normal_w * normal_w.dot(vector_w)
}
