//! The standard normal distribution, with equal bits on every host.

/// Share below `z`.
pub fn share_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

/// The number below which a share `u` lies: PPND16 of Wichura 1988, "Algorithm AS 241: The Percentage
/// Points of the Normal Distribution", Applied Statistics 37(3), good to some 1e-16 of the number.
/// Infinite at 0 and 1.
pub fn quantile(u: f64) -> f64 {
    let q = u - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * ratio(r, &CENTRE);
    }
    let tail = if q < 0.0 { u } else { 1.0 - u };
    let r = (-libm::log(tail)).sqrt();
    let z = if r.is_infinite() {
        r
    } else if r <= 5.0 {
        ratio(r - 1.6, &FLANK)
    } else {
        ratio(r - 5.0, &TAIL)
    };
    z.copysign(q)
}

/// Coefficients of numerator and denominator, highest power first.
type Rational = [[f64; 8]; 2];

fn ratio(r: f64, of: &Rational) -> f64 {
    let [above, below] =
        of.map(|c| c.into_iter().fold(0.0, |sum, coefficient| sum * r + coefficient));
    above / below
}

const CENTRE: Rational = [
    [
        2509.0809287301227,
        33430.57558358813,
        67265.7709270087,
        45921.95393154987,
        13731.69376550946,
        1971.5909503065513,
        133.14166789178438,
        3.3871328727963665,
    ],
    [
        5226.495278852854,
        28729.085735721943,
        39307.89580009271,
        21213.794301586597,
        5394.196021424751,
        687.1870074920579,
        42.31333070160091,
        1.0,
    ],
];
const FLANK: Rational = [
    [
        0.0007745450142783414,
        0.022723844989269184,
        0.2417807251774506,
        1.2704582524523684,
        3.6478483247632045,
        5.769497221460691,
        4.630337846156546,
        1.4234371107496835,
    ],
    [
        1.0507500716444169e-09,
        0.0005475938084995345,
        0.015198666563616457,
        0.14810397642748008,
        0.6897673349851,
        1.6763848301838038,
        2.053191626637759,
        1.0,
    ],
];
const TAIL: Rational = [
    [
        2.0103343992922881e-07,
        2.7115555687434876e-05,
        0.0012426609473880784,
        0.026532189526576124,
        0.29656057182850487,
        1.7848265399172913,
        5.463784911164114,
        6.657904643501103,
    ],
    [
        2.0442631033899397e-15,
        1.421511758316446e-07,
        1.8463183175100548e-05,
        0.0007868691311456133,
        0.014875361290850615,
        0.1369298809227358,
        0.599832206555888,
        1.0,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_quantiles_are_those_of_scipy() {
        // scipy.stats.norm.ppf and norm.cdf, SciPy 1.17; both are good to some 1e-15.
        for (u, z) in [
            (1e-300, -37.0470962993612),
            (2.0_f64.powi(-54), -8.292361075813597),
            (1e-9, -5.9978070150076865),
            (0.02, -2.053748910631823),
            (0.3, -0.5244005127080409),
            (0.9, 1.2815515655446004),
            (1.0 - 2.0_f64.powi(-53), 8.209536151601387),
        ] {
            assert!((quantile(u) / z - 1.0).abs() < 4e-15, "{u}: {}", quantile(u));
        }
        for (z, u) in [
            (-8.0, 6.22096057427174e-16),
            (-3.0, 0.0013498980316300933),
            (-1.0, 0.15865525393145707),
            (0.5, 0.6914624612740131),
        ] {
            // z / √2 has the rounding of √2 and its own, and a tail turns each into z² of it.
            let tolerance = 4e-15 + z * z * f64::EPSILON;
            assert!((share_below(z) / u - 1.0).abs() < tolerance, "{z}: {}", share_below(z));
        }
        assert_eq!(quantile(0.5), 0.0);
        assert_eq!([quantile(0.0), quantile(1.0)], [f64::NEG_INFINITY, f64::INFINITY]);
    }
}
