//! Base-unit exponents of a unit in FMI spelling: `N.m`, `m/s2`, `rad/s`.

/// Exponents of kg, m, s, K and rad, and the factor to those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    pub exponents: [i32; 5],
    pub factor: f64,
}

/// FMI attribute names of the exponents.
pub const BASE_NAMES: [&str; 5] = ["kg", "m", "s", "K", "rad"];

/// What a unit measures: the name of its type, and the unit in which people want to see it with
/// the factor to that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    pub name: &'static str,
    pub display: Option<(&'static str, f64)>,
}

/// `None` for a unit that is not in the table.
pub fn quantity(unit: &str) -> Option<Quantity> {
    let plain = |name| Quantity { name, display: None };
    let shown = |name, display| Quantity { name, display: Some(display) };
    let degrees = 180.0 / std::f64::consts::PI;
    Some(match unit {
        "1" => plain("Number"),
        "kg" => plain("Mass"),
        "m" => plain("Length"),
        "s" => plain("Time"),
        "m/s" => shown("Velocity", ("km/h", 3.6)),
        // Standard gravity: 9.80665 m/s2 (CGPM 1901).
        "m/s2" => shown("Acceleration", ("g", 1.0 / 9.80665)),
        "rad" => shown("Angle", ("deg", degrees)),
        "deg" => plain("AngleInDegrees"),
        "rad/s" => shown("AngularVelocity", ("deg/s", degrees)),
        "deg/s" => plain("AngularVelocityInDegrees"),
        "rad/s2" => shown("AngularAcceleration", ("deg/s2", degrees)),
        "N" => shown("Force", ("kN", 1e-3)),
        "N.m" => plain("Torque"),
        "J" => plain("Energy"),
        _ => return None,
    })
}

/// `None` for a symbol that is not in the table.
pub fn base_unit(unit: &str) -> Option<BaseUnit> {
    let mut result = BaseUnit { exponents: [0; 5], factor: 1.0 };
    // One solidus at most; all after it divides.
    let (above, below) = unit.split_once('/').unwrap_or((unit, "1"));
    for (product, sign) in [(above, 1), (below, -1)] {
        for term in product.split('.') {
            let digits = term.find(|c: char| c.is_ascii_digit()).unwrap_or(term.len());
            let (name, power) = term.split_at(digits);
            let power: i32 = if power.is_empty() { 1 } else { power.parse().ok()? };
            let (exponents, factor) = symbol(name)?;
            for (sum, exponent) in result.exponents.iter_mut().zip(exponents) {
                *sum += sign * power * exponent;
            }
            result.factor *= libm::pow(factor, f64::from(sign * power));
        }
    }
    Some(result)
}

fn symbol(name: &str) -> Option<([i32; 5], f64)> {
    Some(match name {
        // "1": the digit was split off as the power.
        "" => ([0, 0, 0, 0, 0], 1.0),
        "kg" => ([1, 0, 0, 0, 0], 1.0),
        "m" => ([0, 1, 0, 0, 0], 1.0),
        "s" => ([0, 0, 1, 0, 0], 1.0),
        "K" => ([0, 0, 0, 1, 0], 1.0),
        "rad" => ([0, 0, 0, 0, 1], 1.0),
        "deg" => ([0, 0, 0, 0, 1], std::f64::consts::PI / 180.0),
        "N" => ([1, 1, -2, 0, 0], 1.0),
        "J" => ([1, 2, -2, 0, 0], 1.0),
        "W" => ([1, 2, -3, 0, 0], 1.0),
        "Pa" => ([1, -1, -2, 0, 0], 1.0),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::MODELS;

    #[test]
    fn every_unit_of_the_tables_is_known() {
        for signal in MODELS.iter().flat_map(|m| m.inputs.iter().chain(m.outputs)) {
            let known = base_unit(signal.unit).is_some() && quantity(signal.unit).is_some();
            assert!(known, "{}: {}", signal.name, signal.unit);
        }
    }

    #[test]
    fn products_quotients_and_powers() {
        let exponents = |unit| base_unit(unit).map(|base| base.exponents);
        assert_eq!(exponents("1"), Some([0, 0, 0, 0, 0]));
        assert_eq!(exponents("m/s2"), Some([0, 1, -2, 0, 0]));
        assert_eq!(exponents("N.m"), exponents("J"));
        assert_eq!(exponents("kg.m2/s3"), exponents("W"));
        assert_eq!(base_unit("deg/s").map(|base| base.factor), Some(std::f64::consts::PI / 180.0));
        assert_eq!(base_unit("furlong"), None);
        assert_eq!(base_unit("m-1"), None);
    }
}
