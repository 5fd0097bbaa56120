//! Rocks: spheres partly buried in the relief (T.44).

use std::f64::consts::PI;

use lander_models::math::square;
use lander_models::scenario::{RockLaw, Rocks};
use nalgebra::Vector3;

use super::field::{Body, PowerLaw};
use super::index::{Index, Rectangle};
use super::{Ground, Surface};

/// How far from a point its nearest rock is looked for, m: beyond all gaps at which contact is
/// taken over and handed back.
pub const ROCK_REACH_M: f64 = 1.0;

#[derive(Clone, Copy, Debug)]
pub struct Rock {
    pub centre_w: Vector3<f64>,
    pub radius_m: f64,
}

impl Rock {
    /// The rock's surface nearest to a point.
    pub fn surface(&self, point_w: &Vector3<f64>) -> Surface {
        let out_w = point_w - self.centre_w;
        let distance_m = out_w.norm();
        let normal_w = if distance_m > 0.0 { out_w / distance_m } else { Vector3::z() };
        Surface { clearance_m: distance_m - self.radius_m, normal_w }
    }
}

pub(super) struct RockField {
    rocks: Vec<Rock>,
    /// By centre.
    index: Index,
    widest_m: f64,
    /// Highest point of all rocks, world z: above it a query ends at once.
    top_m: f64,
}

impl RockField {
    /// `relief` is the ground without rocks.
    pub fn new(of: &Rocks, seed: u64, relief: &Ground) -> Self {
        let law = power_law(of);
        let keep = |body: &Body| match of.law {
            RockLaw::Power { .. } => true,
            RockLaw::Exponential { abundance } => {
                let beyond_m = body.diameter_m - of.diameter_min_m;
                body.mark < libm::exp(-RockLaw::decay_per_m(abundance) * beyond_m)
            }
        };
        let rocks: Vec<_> = law
            .bodies(seed, "rocks")
            .filter(keep)
            .map(|Body { diameter_m, centre_m, .. }| {
                let rise_m = diameter_m * (0.5 - of.burial);
                let height_m = relief.height_m(centre_m.x, centre_m.y) + rise_m;
                Rock { centre_w: centre_m.push(height_m), radius_m: 0.5 * diameter_m }
            })
            .collect();
        let centre =
            |rock: &Rock| Rectangle { x_m: rock.centre_w.x, y_m: rock.centre_w.y, half_m: 0.0 };
        let centres: Vec<_> = rocks.iter().map(centre).collect();
        Self {
            index: Index::new(of.extent_m, ROCK_REACH_M, &centres),
            widest_m: rocks.first().map_or(0.0, |rock| rock.radius_m),
            top_m: rocks
                .iter()
                .map(|rock| rock.centre_w.z + rock.radius_m)
                .fold(f64::NEG_INFINITY, f64::max),
            rocks,
        }
    }

    pub fn rocks(&self) -> &[Rock] {
        &self.rocks
    }

    pub fn top_m(&self) -> f64 {
        self.top_m
    }

    pub fn near(&self, point_w: Vector3<f64>, reach_m: f64) -> impl Iterator<Item = &Rock> {
        let above = point_w.z > self.top_m + reach_m;
        let about = Rectangle { x_m: point_w.x, y_m: point_w.y, half_m: reach_m + self.widest_m };
        let candidates = (!above).then(|| self.index.within(about));
        let rocks = candidates.into_iter().flatten().map(|item| &self.rocks[item]);
        rocks.filter(move |rock| {
            (point_w - rock.centre_w).norm_squared() <= square(reach_m + rock.radius_m)
        })
    }
}

/// The law itself, or the power law that bounds the exponential one from above: from the area
/// covered, -dF/dD = k q exp(-q D), the rocks are 4/(pi D²) times as many, and the exponential is
/// at most its value at the least diameter.
fn power_law(of: &Rocks) -> PowerLaw {
    let (density_at_1m_m2, exponent) = match of.law {
        RockLaw::Power { density_at_1m_m2, exponent } => (density_at_1m_m2, exponent),
        RockLaw::Exponential { abundance } => {
            let q_per_m = RockLaw::decay_per_m(abundance);
            let most = libm::exp(-q_per_m * of.diameter_min_m);
            (4.0 / PI * abundance * q_per_m * most, 1.0)
        }
    };
    PowerLaw {
        extent_m: of.extent_m,
        diameter_min_m: of.diameter_min_m,
        diameter_max_m: of.diameter_max_m,
        density_at_1m_m2,
        exponent,
    }
}
