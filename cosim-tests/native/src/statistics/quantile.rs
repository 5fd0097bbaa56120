//! Quantiles and means of a sample with bootstrap bounds.

use lander_models::random;
use serde::Serialize;

use super::beta::beta_reg;

/// An estimate with two-sided 95 % bounds; an infinite one is none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounded {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// The `p` quantile of a sorted sample, by rank, and its percentile bootstrap bounds.
///
/// The bounds are those of infinitely many resamples, in closed form (Efron 1979): the quantile of a
/// resample is at most the j-th value if k = ⌈p n⌉ or more of its n draws are among the first j of n. No resample
/// has values beyond the sample's: where the sample itself lies on one side of the quantile with a probability of more
/// than 2.5 %, p^n or (1 − p)^n, that bound is infinite.
pub fn quantile(sorted: &[f64], p: f64) -> Bounded {
    let n = sorted.len();
    if n == 0 {
        return Bounded { value: f64::NAN, low: f64::NAN, high: f64::NAN };
    }
    let k = ((p * n as f64).ceil() as usize).clamp(1, n);
    // The first value with at least the share `u` of the resamples at or below it.
    let of_resamples = |u: f64| {
        let share = |j: usize| beta_reg(k as f64, (n - k + 1) as f64, j as f64 / n as f64);
        let (mut below, mut reached) = (0, n);
        while reached - below > 1 {
            let middle = (below + reached) / 2;
            if share(middle) >= u { reached = middle } else { below = middle }
        }
        sorted[reached - 1]
    };
    let beyond = |share: f64| libm::pow(share, n as f64) > 0.025;
    let low = if beyond(1.0 - p) { f64::NEG_INFINITY } else { of_resamples(0.025) };
    let high = if beyond(p) { f64::INFINITY } else { of_resamples(0.975) };
    Bounded { value: sorted[k - 1], low, high }
}

const RESAMPLES: u64 = 1000;

/// A statistic of `n` things and its percentile bootstrap bounds, over resamples drawn by `seed`.
/// The statistic takes the indices of the things.
pub fn bootstrap(n: usize, seed: u64, statistic: impl Fn(&[usize]) -> f64) -> Bounded {
    let all: Vec<usize> = (0..n).collect();
    let resample = |number: u64| {
        let draws = random::uniforms(seed, &format!("resample {number}"));
        let indices: Vec<usize> = draws.take(n).map(|u| (u * n as f64) as usize).collect();
        statistic(&indices)
    };
    let mut found: Vec<f64> = (0..RESAMPLES).map(resample).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found[(share * RESAMPLES as f64) as usize];
    Bounded { value: statistic(&all), low: at(0.025), high: at(0.975) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_ten_thousand_resamples() {
        let n = 200;
        let mut sample: Vec<f64> = (0..n).map(|i| random::normal(1, "sample", i)).collect();
        sample.sort_by(f64::total_cmp);
        for p in [0.5, 0.9] {
            let mut found: Vec<f64> = (0..10_000)
                .map(|number| {
                    let draws = random::uniforms(2, &format!("{p} {number}"));
                    let mut drawn: Vec<f64> =
                        draws.take(200).map(|u| sample[(u * 200.0) as usize]).collect();
                    drawn.sort_by(f64::total_cmp);
                    drawn[(p * 200.0) as usize - 1]
                })
                .collect();
            found.sort_by(f64::total_cmp);
            let Bounded { value, low, high } = quantile(&sample, p);
            assert_eq!(value, sample[(p * 200.0) as usize - 1]);
            // Shares of the resamples at the bounds: 2.5 and 97.5 % but for the grain of the sample, some
            // 2 % of the resamples a value, and five standard errors, 0.8 %.
            let below = |bound: f64| found.partition_point(|x| *x < bound) as f64 / 1e4;
            let up_to = |bound: f64| found.partition_point(|x| *x <= bound) as f64 / 1e4;
            assert!(below(low) < 0.033 && up_to(low) > 0.017, "{p}: {}", below(low));
            assert!(below(high) < 0.983 && up_to(high) > 0.967, "{p}: {}", up_to(high));
        }
        assert!(quantile(&[], 0.5).value.is_nan());
    }

    /// Of the maximum and minimum of n values, none but a share of p^n and (1 − p)^n lie on the far side of the quantile.
    #[test]
    fn a_sample_that_is_too_small_has_no_outer_bound() {
        let sample: Vec<f64> = (0..368).map(f64::from).collect();
        // 0.99^367 = 0.02500 + 1e-6; 0.99^368 is below.
        assert_eq!(quantile(&sample[..367], 0.99).high, f64::INFINITY);
        assert!(quantile(&sample, 0.99).high.is_finite());
        assert_eq!(quantile(&sample[..367], 0.01).low, f64::NEG_INFINITY);
        assert!(quantile(&sample, 0.01).low.is_finite());
        let few = quantile(&sample[..20], 0.5);
        assert!(few.low.is_finite() && few.high.is_finite());
    }

    #[test]
    fn a_mean_has_the_bounds_of_its_standard_error() {
        let sample: Vec<f64> = (0..400).map(|i| random::normal(3, "mean", i)).collect();
        let mean = |indices: &[usize]| {
            indices.iter().map(|i| sample[*i]).sum::<f64>() / indices.len() as f64
        };
        let found = bootstrap(sample.len(), 1, mean);
        // 1.96 / sqrt(400) either side; a bound of 1000 resamples scatters by some 5 % of it.
        for half in [found.value - found.low, found.high - found.value] {
            assert!((half / 0.098 - 1.0).abs() < 0.25, "{found:?}");
        }
    }
}
