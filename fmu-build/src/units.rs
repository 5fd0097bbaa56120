//! Base-unit exponents of a unit in FMI spelling: `N.m`, `m/s2`, `rad/s`.

/// Exponents of kg, m, s, K and rad, and the factor to those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    pub exponents: [i32; 5],
    pub factor: f64,
}

/// FMI attribute names of the exponents.
pub const BASE_NAMES: [&str; 5] = ["kg", "m", "s", "K", "rad"];

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
            result.factor *= f64::powi(factor, sign * power);
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
            assert!(base_unit(signal.unit).is_some(), "{}: {}", signal.name, signal.unit);
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
