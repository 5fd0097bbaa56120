//! Soft soil: `[terrain.soil]`.

use std::f64::consts::PI;

use crate::quantity::{ConfigError, Limit, Section};

/// Bekker's pressure-sinkage law p = (k_c/b + k_phi) z^n, b the radius of a round plate (Bekker
/// 1969). The defaults are those of the lunar surface (Lunar Sourcebook 1991, chapter 9; NASA
/// NTRS 20220010732): 1.4 kN/m², 820 kN/m³, 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Soil {
    /// k_c, N/m^(n+1).
    pub cohesive_modulus_n_m2: f64,
    /// k_phi, N/m^(n+2).
    pub frictional_modulus_n_m3: f64,
    /// n.
    pub exponent: f64,
}

impl Soil {
    /// Load that presses a flat disc to a depth, N (T.48).
    pub fn pad_load_n(&self, radius_m: f64, sinkage_m: f64) -> f64 {
        self.disc_modulus(radius_m) * libm::pow(sinkage_m.max(0.0), self.exponent)
    }

    /// Depth to which a load presses a flat disc, m: the inverse of `pad_load_n`.
    pub fn pad_sinkage_m(&self, radius_m: f64, load_n: f64) -> f64 {
        libm::pow(load_n.max(0.0) / self.disc_modulus(radius_m), self.exponent.recip())
    }

    fn disc_modulus(&self, radius_m: f64) -> f64 {
        let per_area = self.cohesive_modulus_n_m2 / radius_m + self.frictional_modulus_n_m3;
        PI * radius_m * radius_m * per_area
    }
}

pub(super) fn read(s: &Section) -> Result<Soil, ConfigError> {
    Ok(Soil {
        cohesive_modulus_n_m2: s.number_or(
            "cohesive_modulus",
            "N/m^(n+1)",
            Limit::Within(0.0, 1e7),
            1.4e3,
        )?,
        frictional_modulus_n_m3: s.number_or(
            "frictional_modulus",
            "N/m^(n+2)",
            Limit::Within(1e3, 1e9),
            8.2e5,
        )?,
        // Bekker's range, which bevameter tests span.
        exponent: s.number_or("exponent", "1", Limit::Within(0.5, 1.8), 1.0)?,
    })
}
