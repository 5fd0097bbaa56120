//! Geometry of a state against the ground, and what the verdict gets to see of it.

use lander_models::mass::MassProperties;
use lander_models::signals::FOOT_SLOTS;
use lander_models::time::TICK_S;
use lander_models::vehicle::Vehicle;
use nalgebra::Vector3;

use crate::contact::{Structure, Touch};
use crate::flight::Motion;
use crate::model::{State, TruthModel};
use crate::stability::{TipState, Tipping, tip_state};
use crate::terrain::Cylinder;
use crate::verdict::{FootImpact, Impact, Sight};

/// A strut within this of its stop has no stroke left, m: the stop gives by as much under load.
const BOTTOMED_GAP_M: f64 = 1e-4;

/// Distance from O of the farthest point of pads, hull and nozzle at any stroke, m.
pub(crate) fn reach_m(vehicle: &Vehicle) -> f64 {
    let Vehicle { gear, hull, engine, .. } = vehicle;
    let pads_m = gear.legs.iter().flat_map(|leg| {
        let crushed_b = leg.foot_b + leg.stroke_axis_b * leg.strut.stroke_max_m;
        [leg.foot_b, crushed_b].map(|foot_b| foot_b.norm() + 2.0 * gear.pad_radius_m)
    });
    let rims_m = [
        (hull.radius_m, hull.bottom_height_m),
        (hull.radius_m, hull.top_height_m),
        (engine.nozzle_exit_radius_m, engine.nozzle_exit_height_m),
        (engine.nozzle_exit_radius_m, engine.pivot_b.z),
    ];
    let rims_m = rims_m.map(|(radius_m, height_m)| libm::hypot(radius_m, height_m));
    pads_m.chain(rims_m).fold(0.0, f64::max)
}

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
            self.ground().ball_clearance_m(&centre_w, radius_m)
        })
    }

    /// Clearance of hull and nozzle, m; negative below ground.
    pub fn structure_clearance_m(&self, motion: &Motion) -> Structure<f64> {
        let (hull, engine) = (&self.vehicle().hull, &self.vehicle().engine);
        let nozzle_top_m = engine.pivot_b.z.max(engine.nozzle_exit_height_m + 0.01);
        let clearance_m = |bottom_m: f64, top_m: f64, radius_m: f64| {
            let at_w = |height_m: f64| motion.point_position_w(&(Vector3::z() * height_m));
            let part = Cylinder { bottom_w: at_w(bottom_m), top_w: at_w(top_m), radius_m };
            self.ground().cylinder_clearance_m(&part)
        };
        Structure {
            hull: clearance_m(hull.bottom_height_m, hull.top_height_m, hull.radius_m),
            nozzle: clearance_m(
                engine.nozzle_exit_height_m,
                nozzle_top_m,
                engine.nozzle_exit_radius_m,
            ),
        }
    }

    /// Clearance of the lowest point of pads, hull and nozzle, m.
    pub fn lowest_m(&self, state: &State) -> f64 {
        let structure = self.structure_clearance_m(&state.motion);
        self.foot_clearances_m(state).fold(structure.hull.min(structure.nozzle), f64::min)
    }

    /// Normal of the ground on the scale of the footprint: of the polygon of ground points below
    /// the pads (T.23).
    pub fn footprint_normal_w(&self, state: &State) -> Vector3<f64> {
        let origin_w = state.motion.position_w;
        let mut below_w = [Vector3::zeros(); FOOT_SLOTS];
        for (slot, foot_b) in below_w.iter_mut().zip(self.feet_b(state)) {
            let mut foot_w = state.motion.point_position_w(&foot_b);
            foot_w.z = self.ground().height_m(foot_w.x, foot_w.y);
            *slot = foot_w - origin_w;
        }
        let below_w = &below_w[..state.legs.len()];
        let next_w = below_w.iter().cycle().skip(1);
        let area_w: Vector3<f64> = below_w.iter().zip(next_w).map(|(a, b)| a.cross(b)).sum();
        // A vehicle on its head goes round the other way.
        area_w.try_normalize(1e-9).map_or(Vector3::z(), |normal_w| normal_w * normal_w.z.signum())
    }

    /// Velocity of the centre of mass, world frame.
    pub fn com_velocity_w(&self, motion: &Motion) -> Vector3<f64> {
        motion.point_velocity_w(&self.vehicle().mass.at(motion.propellant_kg).com_b)
    }

    /// Tip-over margin and stability distance of this moment.
    pub fn tip_state(&self, state: &State, mass: &MassProperties) -> TipState {
        let motion = &state.motion;
        let to_body = motion.attitude_wb.inverse();
        let tipping = Tipping {
            mass_kg: mass.mass_kg,
            com_b: mass.com_b,
            com_velocity_b: to_body * motion.velocity_w + motion.rate_b.cross(&mass.com_b),
            rate_b: motion.rate_b,
            inertia_b: mass.inertia_b,
            up_b: to_body * Vector3::z(),
            gravity_m_s2: self.scenario().gravity_m_s2,
        };
        // Pads are balls: a vehicle that leans stands on another point of them.
        let (radius_m, normal_b) =
            (self.vehicle().gear.pad_radius_m, to_body * self.footprint_normal_w(state));
        let roll_b = (Vector3::z() - normal_b) * radius_m;
        let mut points_b = [Vector3::zeros(); FOOT_SLOTS];
        for (slot, foot_b) in points_b.iter_mut().zip(self.feet_b(state)) {
            *slot = foot_b + roll_b;
        }
        tip_state(&tipping, &points_b[..state.legs.len()])
    }

    /// `before` is the motion before the tick that led to `state` and `touch`.
    pub(crate) fn sight(&self, state: &State, before: &Motion, touch: &Touch) -> Sight {
        let motion = &state.motion;
        let vehicle = self.vehicle();
        let mass = vehicle.mass.at(motion.propellant_kg);
        let (mut feet_b, mut bottomed) = (Vector3::zeros(), false);
        let (mut stroke_m, mut load_n) = (0.0_f64, 0.0_f64);
        for (leg, now) in vehicle.gear.legs.iter().zip(&state.legs) {
            feet_b += leg.foot_b + leg.stroke_axis_b * now.stroke_m;
            bottomed |= now.stroke_m > leg.strut.stroke_max_m - BOTTOMED_GAP_M;
            stroke_m = stroke_m.max(now.stroke_m * leg.strut_ratio);
            load_n = load_n.max(now.load_n / leg.strut_ratio);
        }
        let footprint_w = motion.point_position_w(&(feet_b / state.legs.len() as f64));
        let com_velocity_w = motion.point_velocity_w(&mass.com_b);
        let gained_w = com_velocity_w - before.point_velocity_w(&mass.com_b);
        let specific_force_w = gained_w / TICK_S + Vector3::z() * self.scenario().gravity_m_s2;
        let felt = touch.structure.any() || touch.feet.contains(&true);
        // `state.feet_down` still is the last tick's.
        let new = felt && state.airborne && !state.feet_down.contains(&true);
        let impact = new.then(|| Impact {
            time: state.now,
            com_velocity_w: self.com_velocity_w(before),
            attitude_wb: before.attitude_wb,
            rate_rad_s: before.rate_b.norm(),
            footprint_w,
        });
        Sight {
            now: state.now,
            impact,
            foot_impacts: self.foot_impacts(state, before, touch),
            tip: self.tip_state(state, &mass),
            feet_down: touch.feet,
            structure_down: touch.structure,
            clearance_m: self.structure_clearance_m(motion),
            bottomed,
            stroke_m,
            load_n,
            acceleration_m_s2: specific_force_w.norm(),
            angular_acceleration_rad_s2: (motion.rate_b - before.rate_b).norm() / TICK_S,
            speed_m_s: com_velocity_w.norm(),
            rate_rad_s: motion.rate_b.norm(),
            attitude_wb: motion.attitude_wb,
            footprint_w,
        }
    }

    /// What the verdict gets to see of a tick of free flight.
    pub(crate) fn watch_flight(&self, state: &mut State) {
        if state.touchdown.first.is_some() {
            let mass = self.vehicle().mass.at(state.motion.propellant_kg);
            let supported = self.tip_state(state, &mass).supported();
            state.touchdown.look_in_flight(state.now, supported, &state.motion.attitude_wb);
        }
    }

    /// Pads that touch for the first time since the flight. Until then a strut is unloaded, at the
    /// length to which it is crushed, so its pad moves with the body.
    fn foot_impacts(
        &self,
        state: &State,
        before: &Motion,
        touch: &Touch,
    ) -> [Option<FootImpact>; FOOT_SLOTS] {
        let mut impacts = [None; FOOT_SLOTS];
        if !state.airborne {
            return impacts;
        }
        let legs = self.vehicle().gear.legs.iter().zip(&state.legs);
        for (n, (leg, now)) in legs.enumerate() {
            if touch.feet[n] && state.touchdown.feet[n].is_none() {
                let foot_b = leg.foot_b + leg.stroke_axis_b * now.crushed_m;
                let normal_w = self.ground().nearest(&before.point_position_w(&foot_b)).normal_w;
                let velocity_w = before.point_velocity_w(&foot_b);
                let normal_m_s = -velocity_w.dot(&normal_w);
                let along_w = velocity_w + normal_w * normal_m_s;
                let tangential_m_s = along_w.norm();
                impacts[n] = Some(FootImpact { time: state.now, normal_m_s, tangential_m_s });
            }
        }
        impacts
    }
}

#[cfg(test)]
mod tests {
    use lander_models::Scenario;
    use lander_models::random::{normal, normal3};
    use lander_models::scenario::RockLaw;
    use nalgebra::UnitQuaternion;

    use super::*;

    /// The shortcut may not know, but it never errs: attitudes and places a standard deviation of 10 m about the origin,
    /// above the ground and below it, and every other time on the toes of one leg, over a rock if there is one.
    #[test]
    fn what_is_surely_clear_is_clear() {
        for file in ["slope-10", "crater-field"] {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios");
            let path = format!("{folder}/{file}.toml");
            let (mut scenario, vehicle) = Scenario::load(path.as_ref()).unwrap();
            // Of the crater field the rocks alone: over craters nothing is known.
            scenario.terrain.craters = None;
            // Rocks that stand higher than the shortcut is cautious.
            if let Some(rocks) = &mut scenario.terrain.rocks {
                rocks.diameter_min_m = 1.0;
                rocks.law = RockLaw::Exponential { abundance: 0.2 };
            }
            let rocky = scenario.terrain.rocks.is_some();
            let truth = TruthModel::new(scenario, vehicle);
            assert_eq!(!truth.ground().rocks().is_empty(), rocky, "{file}");
            let mut state = truth.initial_state();
            let mut known = 0;
            for index in 0..2000 {
                let turn = normal3(1, "turn", index) * 2.0;
                state.motion.attitude_wb = UnitQuaternion::from_scaled_axis(turn);
                state.motion.position_w = normal3(1, "place", index) * 10.0;
                if index % 2 == 1 {
                    let legs = &truth.vehicle().gear.legs;
                    let foot_b = legs[index as usize % legs.len()].foot_b;
                    let rocks = truth.ground().rocks();
                    let rock = (!rocks.is_empty()).then(|| &rocks[index as usize % rocks.len()]);
                    let top_w = rock.map(|rock| rock.centre_w + Vector3::z() * rock.radius_m);
                    let foot_m = foot_b.norm() + normal(1, "rise", index).abs();
                    let down_w = -Vector3::z();
                    state.motion.attitude_wb =
                        UnitQuaternion::rotation_between(&foot_b, &down_w).unwrap();
                    state.motion.position_w = top_w.unwrap_or_default() - down_w * foot_m;
                }
                let gap_m = normal(1, "gap", index).abs();
                if truth.surely_clear(&state.motion, gap_m) {
                    known += 1;
                    assert!(truth.lowest_m(&state) > gap_m, "{file} {index}");
                }
            }
            assert!(known > 100, "{file}: {known}");
        }
    }
}
