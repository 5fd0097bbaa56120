//! What a list of results comes to.

use serde::Serialize;

/// Mean, quantiles and greatest of what was measured; all NaN of nothing.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    pub mean: f64,
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

impl Spread {
    /// Over the values that are no NaN; a quantile is the value of its rank, not interpolated.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let rank = |q: f64| {
            let rank = (q * n).ceil().max(1.0) as usize;
            values.get(rank - 1).copied().unwrap_or(f64::NAN)
        };
        Self {
            mean: values.iter().sum::<f64>() / n,
            p50: rank(0.5),
            p99: rank(0.99),
            max: rank(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_takes_values_by_rank_and_leaves_out_what_was_not_measured() {
        let spread = Spread::of((1..=200).rev().map(f64::from).chain([f64::NAN]));
        assert_eq!((spread.mean, spread.p50), (100.5, 100.0));
        assert_eq!((spread.p99, spread.max), (198.0, 200.0));
        assert!(Spread::of(std::iter::empty()).max.is_nan());
    }
}
