//! Craters: bowl, rim and flank, summed (T.41 to T.43).

use lander_models::scenario::Craters;
use nalgebra::{Matrix2, Vector2};

use super::Local;
use super::field::PowerLaw;
use super::index::{Index, Rectangle};
use crate::random::uniform;

/// Where a flank ends, in crater radii: Pike (1977) has flanks 0.257 diameters wide, Fassett and
/// Thomson (2014) end theirs here.
const FLANK_END: f64 = 1.5;

/// A crater about a vertical axis, over the ground as it was.
#[derive(Clone, Copy, Debug)]
pub struct Crater {
    pub centre_m: Vector2<f64>,
    /// Of the rim crest.
    pub radius_m: f64,
    /// From rim crest to floor.
    pub depth_m: f64,
    pub rim_m: f64,
}

impl Crater {
    /// Height and derivatives at a place; `None` off the flank.
    fn local(&self, x_m: f64, y_m: f64) -> Option<Local> {
        let offset = (Vector2::new(x_m, y_m) - self.centre_m) / self.radius_m;
        let rho2 = offset.norm_squared();
        if rho2 >= FLANK_END * FLANK_END {
            return None;
        }
        let outer = offset * offset.transpose();
        // f' / rho, and f'' less it over rho squared, by the scaled radius.
        let (height_m, pull, bend) = if rho2 <= 1.0 {
            let inside = 1.0 - rho2;
            let depth_m = self.depth_m;
            (self.rim_m - depth_m * inside * inside, 4.0 * depth_m * inside, -8.0 * depth_m)
        } else {
            let (rho, width) = (rho2.sqrt(), FLANK_END - 1.0);
            let s = (rho - 1.0) / width;
            let first = self.rim_m * 6.0 * s * (s - 1.0) / width;
            let second = self.rim_m * (12.0 * s - 6.0) / (width * width);
            let height_m = self.rim_m * (1.0 - s * s * (3.0 - 2.0 * s));
            (height_m, first / rho, (second - first / rho) / rho2)
        };
        Some(Local {
            height_m,
            gradient: offset * (pull / self.radius_m),
            hessian_per_m: (Matrix2::identity() * pull + outer * bend)
                / (self.radius_m * self.radius_m),
        })
    }
}

pub(super) struct CraterField {
    craters: Vec<Crater>,
    index: Index,
}

impl CraterField {
    pub fn new(of: &Craters, seed: u64) -> Self {
        let law = PowerLaw {
            extent_m: of.extent_m,
            diameter_min_m: of.diameter_min_m,
            diameter_max_m: of.diameter_max_m,
            density_at_1m_m2: of.density_at_1m_m2,
            exponent: of.exponent,
        };
        let drawn = law.diameters_m(seed, "terrain.craters.diameter");
        let craters: Vec<_> = drawn
            .map(|(index, diameter_m)| {
                let worn = uniform(seed, "terrain.craters.freshness", index);
                let freshness = of.freshness_min + (1.0 - of.freshness_min) * worn;
                let depth_m = of.depth_ratio * diameter_m * freshness;
                Crater {
                    centre_m: law.place_m(seed, "terrain.craters.place", index),
                    radius_m: 0.5 * diameter_m,
                    depth_m,
                    rim_m: of.rim_ratio * depth_m,
                }
            })
            .collect();
        let footprint = |crater: &Crater| Rectangle {
            x_m: crater.centre_m.x,
            y_m: crater.centre_m.y,
            half_m: FLANK_END * crater.radius_m,
        };
        let footprints: Vec<_> = craters.iter().map(footprint).collect();
        let index = Index::new(of.extent_m, FLANK_END * of.diameter_min_m, &footprints);
        Self { craters, index }
    }

    pub fn craters(&self) -> &[Crater] {
        &self.craters
    }

    pub fn add_to(&self, local: &mut Local, x_m: f64, y_m: f64) {
        for item in self.index.within(Rectangle { x_m, y_m, half_m: 0.0 }) {
            if let Some(crater) = self.craters[item].local(x_m, y_m) {
                local.add(crater);
            }
        }
    }
}
