//! One massless pad: where it stands on the ground and what it passes on to the body.

use lander_models::scenario::Soil;
use lander_models::vehicle::{Gear, Leg};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::super::{Footing, Site};
use super::blow::Hold;
use super::soil::Bed;
use super::{BLOW_TIME_MIN_S, Stance};
use crate::flight::Motion;
use crate::gear::{LegState, crush_load_n, crushed_after, strut_load_n};

/// A pad so near and no faster away is on the ground: rounding of a start on it, m and m/s.
const MEET_GAP_M: f64 = 1e-9;
const MEET_SPEED_M_S: f64 = 1e-9;
/// A pad just torn off follows the ground as its strut springs back; pressed deeper it stands, m.
const PUSH_GAP_M: f64 = 1e-4;
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

    /// How far the pad was carried, m; 0 off the ground.
    pub fn slip_m(&self) -> f64 {
        self.slip_w.map_or(0.0, |slip_w| slip_w.norm())
    }

    pub fn scale(&mut self, by: f64) {
        self.slip_w = self.slip_w.map(|slip_w| slip_w * by);
    }

    pub fn holds(&self) -> bool {
        self.slip_w.is_some()
    }
}

/// A spring with its damper.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
}

/// What a pad bears on where its strut does not give.
#[derive(Clone, Copy, Debug)]
pub struct Holds {
    /// Along the ground, while the pad grips.
    pub grip: Spring,
    /// Along a strut without stroke left.
    pub stop: Spring,
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
    holds: Holds,
    /// Of the foot, along the strut, unless it is on its head.
    foot_weight_n: f64,
    bed: Bed,
    /// Of the pad at no stroke.
    start_clearance_m: f64,
}

/// A pad's force at one instant.
pub struct PadForce {
    pub on_vehicle_b: Vector3<f64>,
    /// Of the ground on the pad.
    ground_b: Vector3<f64>,
    /// Where both act, from O.
    pub point_b: Vector3<f64>,
    stroke_m: f64,
    stroke_rate_m_s: f64,
    sinkage_m: f64,
    load_n: f64,
    slip_b: Vector3<f64>,
    normal_n: f64,
}

impl<'a> Pad<'a> {
    pub fn new(
        site: &Site<'a>,
        leg: &'a Leg,
        motion: &Motion,
        start: LegState,
        grip: &Grip,
        holds: Holds,
    ) -> Self {
        let gear: &Gear = &site.vehicle.gear;
        let centre_b = gear.pad_centre_b(leg);
        let centre_w = motion.point_position_w(&(centre_b + leg.stroke_axis_b * start.stroke_m));
        let (footing, on_rock) = site.pad_footing(&centre_w);
        let touch_w = centre_w - footing.normal_w * gear.pad_radius_m;
        let normal_b = motion.attitude_wb.inverse_transform_vector(&footing.normal_w);
        let slip_w = grip.slip_w.unwrap_or_default();
        let mut pad = Self {
            leg,
            centre_b,
            radius_m: gear.pad_radius_m,
            start,
            footing,
            touch_b: centre_b - normal_b * gear.pad_radius_m,
            anchor_w: touch_w - tangential(&slip_w, &footing.normal_w),
            standing: grip.slip_w.is_some(),
            holds,
            foot_weight_n: -gear.foot_mass_kg
                * site.gravity_w.dot(&(motion.attitude_wb * leg.stroke_axis_b)).min(0.0),
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
        let pad_b = self.centre_b();
        let closing_m_s = -normal_w.dot(&motion.point_velocity_w(&pad_b));
        let load_n = |rate_m_s: f64| self.axial_n(self.start.stroke_m, rate_m_s / rise) / rise;
        Bed::new(soil, radius_m, self.start.sinkage_m, closing_m_s, load_n)
    }

    /// Time until a force of the pad's jumps as it moves now, s: it reaches the ground, or its strut
    /// the stop; infinite if neither comes.
    pub fn time_to_blow_s(&self, motion: &Motion) -> f64 {
        let (gap_m, speed_m_s) = if self.standing {
            let left_m = self.leg.strut.stroke_max_m - self.start.stroke_m;
            (left_m, self.start.stroke_rate_m_s)
        } else {
            self.approach(motion)
        };
        if gap_m > 0.0 && speed_m_s > 0.0 { gap_m / speed_m_s } else { f64::INFINITY }
    }

    /// Whether a pad off the ground stands on it from now on: the body brings it down, or its strut
    /// pushes it there as it springs back.
    pub fn meets_ground(&self, motion: &Motion) -> bool {
        let (gap_m, closing_m_s) = self.approach(motion);
        let near = gap_m <= MEET_GAP_M.max(closing_m_s * BLOW_TIME_MIN_S);
        let pushes =
            || gap_m < -PUSH_GAP_M && self.axial_n(self.start.stroke_m - gap_m, closing_m_s) > 0.0;
        !self.standing && near && (closing_m_s > -MEET_SPEED_M_S || pushes())
    }

    pub fn stroke_axis_b(&self) -> Vector3<f64> {
        self.leg.stroke_axis_b
    }

    /// Its centre, from O.
    pub fn centre_b(&self) -> Vector3<f64> {
        self.centre_b + self.leg.stroke_axis_b * self.start.stroke_m
    }

    /// As the body sees a pad that holds; the foot of one that stands has stopped already.
    pub fn hold(&self, motion: &Motion, foot_kg: f64, friction: f64) -> Hold {
        let normal_b = motion.attitude_wb.inverse_transform_vector(&self.footing.normal_w);
        let stroke_axis_b = self.leg.stroke_axis_b;
        let point_b = self.centre_b() - normal_b * self.radius_m;
        let velocity_b =
            motion.attitude_wb.inverse_transform_vector(&motion.point_velocity_w(&point_b));
        let down_m_s = if self.standing { 0.0 } else { -velocity_b.dot(&stroke_axis_b).min(0.0) };
        let foot_n_s = foot_kg * down_m_s * normal_b.dot(&stroke_axis_b).max(0.0);
        Hold { point_b, stroke_axis_b, normal_b, foot_n_s, friction }
    }

    /// Gap between pad and ground, m, and the speed at which it closes, m/s.
    fn approach(&self, motion: &Motion) -> (f64, f64) {
        let pad_b = self.centre_b();
        let gap_m = self.footing.clearance_m(&motion.point_position_w(&pad_b)) - self.radius_m
            + self.bed.sinkage_m;
        (gap_m, -self.footing.normal_w.dot(&motion.point_velocity_w(&pad_b)))
    }

    /// Force in a given motion; `None` while the pad is off the ground (T.30 to T.34).
    pub fn force(&self, site: &Site, stance: &Stance) -> Option<PadForce> {
        if !self.standing {
            return None;
        }
        let axis_b = &self.leg.stroke_axis_b;
        let normal_b = stance.to_body * self.footing.normal_w;
        let rise = normal_b.dot(axis_b);
        // (T.30) The pad stays on the ground: its stroke is geometry.
        let clearance_m = self.footing.clearance_m(&stance.origin_w) + normal_b.dot(&self.centre_b);
        let sinkage_m = self.bed.depth_m(self.start_clearance_m - clearance_m);
        let stroke_m = (self.radius_m - sinkage_m - clearance_m) / rise;
        if rise < FLAT {
            return None;
        }
        let point_b = self.centre_b + axis_b * stroke_m - normal_b * self.radius_m;
        let body_b = stance.velocity_b + stance.rate_b.cross(&point_b);
        // What the soil takes of the way down the strut does not.
        let stroke_rate_m_s = -body_b.dot(&normal_b) / rise * (1.0 - self.bed.share);
        let load_n = self.axial_n(stroke_m, stroke_rate_m_s);
        // The ground bears strut and foot.
        let borne_n = load_n + self.foot_weight_n;
        if borne_n <= 0.0 {
            return None;
        }
        // (T.32) Spring and damper along the ground.
        let anchor_b = stance.to_body * (self.anchor_w - stance.origin_w);
        let slip_b = tangential(&(self.touch_b + axis_b * stroke_m - anchor_b), &normal_b);
        let slip_m_s = tangential(&(body_b + axis_b * stroke_rate_m_s), &normal_b);
        let grip = &self.holds.grip;
        let hold_b = slip_b * -grip.stiffness_n_m - slip_m_s * grip.damping_n_s_m;
        // (T.33) Along the strut's axis ground, foot and strut balance.
        let hold_n = hold_b.norm();
        let friction = site.pad_friction();
        let sticking_n = (borne_n - hold_b.dot(axis_b)) / rise;
        let (normal_n, friction_b) = if hold_n <= friction * sticking_n {
            (sticking_n, hold_b)
        } else {
            let direction_b = hold_b / hold_n;
            let normal_n = borne_n / (rise + friction * direction_b.dot(axis_b)).max(FLAT);
            (normal_n, direction_b * (friction * normal_n))
        };
        let ground_b = normal_b * normal_n + friction_b;
        Some(PadForce {
            on_vehicle_b: ground_b - axis_b * self.foot_weight_n,
            ground_b,
            point_b,
            stroke_m,
            stroke_rate_m_s,
            sinkage_m,
            load_n,
            slip_b,
            normal_n,
        })
    }

    /// State of leg and grip after a step that ended in `motion`.
    pub fn settle(&self, site: &Site, motion: &Motion, step_s: f64, grip: &mut Grip) -> LegState {
        let strut = &self.leg.strut;
        let Some(force) = self.force(site, &Stance::of(motion)) else {
            grip.slip_w = None;
            // (T.35) Off the ground the damper lets the strut spring back to its crushed length.
            let decay = if strut.damping_n_s_m > 0.0 {
                libm::exp(-step_s * strut.stiffness_n_m / strut.damping_n_s_m)
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
        let most_m = site.pad_friction() * force.normal_n / self.holds.grip.stiffness_n_m;
        grip.slip_w = Some(motion.attitude_wb * force.slip_b.cap_magnitude(most_m));
        LegState {
            stroke_m: force.stroke_m,
            stroke_rate_m_s: force.stroke_rate_m_s,
            crushed_m: crushed_after(strut, self.cap_n(), self.start.crushed_m, force.stroke_m),
            load_n: force.load_n.max(0.0),
            ground_force_w: motion.attitude_wb * force.ground_b,
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
            let stop = &self.holds.stop;
            (stop.stiffness_n_m * over_m + stop.damping_n_s_m * rate_m_s).max(0.0)
        } else {
            0.0
        };
        let (cap_n, crushed_m) = (self.cap_n(), self.start.crushed_m);
        strut_load_n(strut, cap_n, crushed_m, stroke_m, rate_m_s, self.foot_weight_n) + stop_n
    }
}

fn tangential(vector: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    vector - normal * normal.dot(vector)
}
