//! Hull and nozzle against the ground: three discs whose lowest points press back (T.36).

use lander_models::Vehicle;
use nalgebra::{Unit, Vector3};

use super::super::{Footing, Site, Structure};
use super::{Forces, Stance};
use crate::flight::Motion;

/// Natural frequency of the vehicle on a point of its structure, rad/s: stiff, yet resolved by 1 ms.
const STRUCTURE_RAD_S: f64 = 200.0;
/// Damping ratio: a thin wall gives plastically and hardly springs back.
const STRUCTURE_DAMPING: f64 = 0.7;
/// Friction reaches its Coulomb value at this sliding speed, m/s.
const SLIDE_SPEED_M_S: f64 = 0.01;

struct Disc {
    height_m: f64,
    radius_m: f64,
    footing: Footing,
}

/// Discs near enough to the ground to touch it within a tick.
pub struct Bumpers {
    discs: [Option<Disc>; 3],
    stiffness_n_m: f64,
    damping_n_s_m: f64,
}

/// The discs' heights above O and radii: hull bottom, hull top, nozzle exit.
fn discs(vehicle: &Vehicle) -> [(f64, f64); 3] {
    let (hull, engine) = (&vehicle.hull, &vehicle.engine);
    [
        (hull.bottom_height_m, hull.radius_m),
        (hull.top_height_m, hull.radius_m),
        (engine.nozzle_exit_height_m, engine.nozzle_exit_radius_m),
    ]
}

impl Bumpers {
    pub fn new(site: &Site, motion: &Motion, mass_kg: f64) -> Self {
        /// Fastest approach that a tick may bring, m: 1 ms at 100 m/s.
        const REACH_M: f64 = 0.1;
        let discs = discs(site.vehicle).map(|(height_m, radius_m)| {
            let centre_w = motion.point_position_w(&(Vector3::z() * height_m));
            let footing = site.footing(&centre_w);
            (footing.clearance_m(&centre_w) < radius_m + REACH_M).then_some(Disc {
                height_m,
                radius_m,
                footing,
            })
        });
        let stiffness_n_m = mass_kg * STRUCTURE_RAD_S * STRUCTURE_RAD_S;
        let damping_n_s_m = 2.0 * STRUCTURE_DAMPING * mass_kg * STRUCTURE_RAD_S;
        Self { discs, stiffness_n_m, damping_n_s_m }
    }

    /// Whether hull and nozzle touch.
    pub fn touch(&self, motion: &Motion) -> Structure<bool> {
        let stance = Stance::of(motion);
        let [bottom, top, nozzle] = self
            .discs
            .each_ref()
            .map(|disc| disc.as_ref().is_some_and(|d| d.depth_m(&stance).0 > 0.0));
        Structure { hull: bottom || top, nozzle }
    }

    pub fn press(&self, site: &Site, stance: &Stance, forces: &mut Forces) {
        for disc in self.discs.iter().flatten() {
            let (depth_m, point_b) = disc.depth_m(stance);
            if depth_m <= 0.0 {
                continue;
            }
            let normal_b = stance.to_body * disc.footing.normal_w;
            let velocity_b = stance.velocity_b + stance.rate_b.cross(&point_b);
            let sinking_m_s = -velocity_b.dot(&normal_b);
            let normal_n =
                (self.stiffness_n_m * depth_m + self.damping_n_s_m * sinking_m_s).max(0.0);
            let slide_b = velocity_b + normal_b * sinking_m_s;
            let friction_b =
                slide_b * (-site.terrain.friction * normal_n / slide_b.norm().max(SLIDE_SPEED_M_S));
            forces.add(&(normal_b * normal_n + friction_b), &point_b);
        }
    }
}

impl Disc {
    /// Depth of the lowest point of the rim below ground, m, and the point from O.
    fn depth_m(&self, stance: &Stance) -> (f64, Vector3<f64>) {
        let normal_b = stance.to_body * self.footing.normal_w;
        let down_b = Vector3::new(-normal_b.x, -normal_b.y, 0.0);
        let rim_b = Unit::try_new(down_b, 1e-12).map_or(Vector3::zeros(), Unit::into_inner);
        let point_b = Vector3::z() * self.height_m + rim_b * self.radius_m;
        (-self.footing.clearance_m(&stance.origin_w) - normal_b.dot(&point_b), point_b)
    }
}
