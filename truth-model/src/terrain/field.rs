//! Random fields of bodies with a size-frequency law (T.42).

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use crate::random::uniform;

/// Bodies on a disc about the world origin, with N(>D) = density (D^-exponent - D_max^-exponent)
/// per area.
pub(super) struct PowerLaw {
    pub extent_m: f64,
    pub diameter_min_m: f64,
    pub diameter_max_m: f64,
    pub density_at_1m_m2: f64,
    pub exponent: f64,
}

impl PowerLaw {
    /// Number and diameter of each body, widest first: the arrivals of a unit Poisson process,
    /// mapped by the law's inverse. A smaller least diameter adds bodies and changes none.
    pub fn diameters_m(&self, seed: u64, stream: &'static str) -> impl Iterator<Item = (u64, f64)> {
        let bodies_at_1m = PI * self.extent_m * self.extent_m * self.density_at_1m_m2;
        let (least_m, exponent) = (self.diameter_min_m, self.exponent);
        let widest = self.diameter_max_m.powf(-exponent);
        let mut arrival = 0.0;
        (0..).map_while(move |index| {
            // 1 - u lies in (0, 1]: its logarithm is finite.
            arrival -= (1.0 - uniform(seed, stream, index)).ln();
            let diameter_m = (widest + arrival / bodies_at_1m).powf(-exponent.recip());
            (diameter_m >= least_m).then_some((index, diameter_m))
        })
    }

    /// Where a body lies: uniform on the disc.
    pub fn place_m(&self, seed: u64, stream: &str, index: u64) -> Vector2<f64> {
        let radius_m = self.extent_m * uniform(seed, stream, 2 * index).sqrt();
        let (sin, cos) = (TAU * uniform(seed, stream, 2 * index + 1)).sin_cos();
        Vector2::new(radius_m * cos, radius_m * sin)
    }
}
