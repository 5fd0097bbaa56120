//! Random fields of bodies with a size-frequency law (T.42).

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

use crate::random::uniforms;

/// Bodies on a disc about the world origin, with N(>D) = density (D^-exponent - D_max^-exponent)
/// per area.
pub(super) struct PowerLaw {
    pub extent_m: f64,
    pub diameter_min_m: f64,
    pub diameter_max_m: f64,
    pub density_at_1m_m2: f64,
    pub exponent: f64,
}

/// One body of a field.
pub(super) struct Body {
    pub diameter_m: f64,
    pub centre_m: Vector2<f64>,
    /// Uniform in [0, 1), for what else is drawn.
    pub mark: f64,
}

impl PowerLaw {
    /// The bodies, widest first: the arrivals of a unit Poisson process, mapped by the law's
    /// inverse. A smaller least diameter adds bodies and changes none.
    pub fn bodies(&self, seed: u64, field: &str) -> impl Iterator<Item = Body> + use<> {
        let stream = |what: &str| uniforms(seed, &format!("terrain.{field}.{what}"));
        let (mut radii, mut azimuths) = (stream("radius"), stream("azimuth"));
        let mut marks = stream("mark");
        let Self { extent_m, diameter_min_m, exponent, .. } = *self;
        let bodies_at_1m = PI * extent_m * extent_m * self.density_at_1m_m2;
        let widest = libm::pow(self.diameter_max_m, -exponent);
        let mut arrival = 0.0;
        stream("diameter").map_while(move |draw| {
            // 1 - draw lies in (0, 1]: its logarithm is finite.
            arrival -= libm::log(1.0 - draw);
            let diameter_m = libm::pow(widest + arrival / bodies_at_1m, -exponent.recip());
            let (sin, cos) = libm::sincos(TAU * azimuths.next()?);
            // Uniform on the disc.
            let centre_m = Vector2::new(cos, sin) * (extent_m * radii.next()?.sqrt());
            let body = Body { diameter_m, centre_m, mark: marks.next()? };
            (diameter_m >= diameter_min_m).then_some(body)
        })
    }
}
