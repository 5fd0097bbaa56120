//! How sure a share of successes is.

use super::beta::beta_reg;

/// One-sided 95 % lower limit of the success probability after `k` successes in `n` trials.
pub fn lower_limit(k: usize, n: usize) -> f64 {
    lower(k, n, 0.05)
}

/// Two-sided 95 % limits of the success probability after `k` successes in `n` trials.
pub fn limits(k: usize, n: usize) -> [f64; 2] {
    [lower(k, n, 0.025), 1.0 - lower(n - k, n, 0.025)]
}

/// Two-sided 95 % limits by Wilson's score (1927): approximate, for what is made of two shares.
pub fn wilson(k: usize, n: usize) -> [f64; 2] {
    const Z: f64 = 1.959_963_984_540_054;
    let (share, n) = (k as f64 / n as f64, n as f64);
    let middle = share + Z * Z / (2.0 * n);
    let reach = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    [middle - reach, middle + reach].map(|limit| limit / (1.0 + Z * Z / n))
}

/// Clopper and Pearson 1934: the p at which `k` or more of `n` have the probability `mistake`.
fn lower(k: usize, n: usize, mistake: f64) -> f64 {
    if k == 0 {
        return 0.0;
    }
    // Of at least k successes: a regularised incomplete beta function.
    let tail = |p: f64| beta_reg(k as f64, (n - k + 1) as f64, p);
    let (mut low, mut high) = (0.0, k as f64 / n as f64);
    // Bisection to the last bits.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) < mistake { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_the_closed_forms_and_of_scipy() {
        // All: p^n = 0.05. One: 1 - (1 - p)^n = 0.05. Else scipy.stats.beta.ppf(0.05, k, n - k + 1).
        for (k, n, expected) in [
            (0, 10, 0.0),
            (1000, 1000, 0.05_f64.powf(1e-3)),
            (1, 20, 1.0 - 0.95_f64.powf(0.05)),
            (58, 60, 0.8987641050758384),
            (995, 1000, 0.9895159230885844),
        ] {
            // The incomplete beta function is good to some 1e-12 of a tail.
            assert!((lower_limit(k, n) - expected).abs() < 1e-10, "{k} of {n}");
        }
        // scipy.stats.binomtest(k, n).proportion_ci(0.95, "exact").
        for (k, n, low, high) in [
            (0, 1000, 0.0, 1.0 - 0.025_f64.powf(1e-3)),
            (58, 60, 0.8847189555807479, 0.9959373753579681),
            (1, 100_000, 2.5317842743932826e-07, 5.571516034432556e-05),
        ] {
            let found = limits(k, n);
            assert!((found[0] - low).abs() < 1e-10 && (found[1] - high).abs() < 1e-10, "{found:?}");
        }
        // scipy.stats.binomtest(k, n).proportion_ci(0.95, "wilson").
        for (k, n, low, high) in [
            (0, 50, 0.0, 0.07134759913335872),
            (14, 20, 0.4810271816464766, 0.8545227551323957),
            (3, 1000, 0.0010207838811386186, 0.008783014053503173),
        ] {
            let found = wilson(k, n);
            assert!((found[0] - low).abs() < 1e-12 && (found[1] - high).abs() < 1e-12, "{found:?}");
        }
    }
}
