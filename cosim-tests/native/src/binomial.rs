//! How sure a share of successes is.

/// One-sided 95 % lower limit of the success probability after `k` successes in `n` trials (Clopper
/// and Pearson 1934): the p at which so many or more have the probability 0.05.
pub fn lower_limit(k: usize, n: usize) -> f64 {
    const MISTAKE: f64 = 0.05;
    if k == 0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, k as f64 / n as f64);
    // Bisection to the last bits.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(k, n, middle) < MISTAKE { low = middle } else { high = middle }
    }
    low
}

/// Probability of at least `k` successes in `n` trials.
fn tail(k: usize, n: usize, p: f64) -> f64 {
    let mut log_term = (n - k..n).map(|i| ((i + 1) as f64).ln()).sum::<f64>()
        - (1..=k).map(|i| (i as f64).ln()).sum::<f64>()
        + k as f64 * p.ln()
        + (n - k) as f64 * (-p).ln_1p();
    let mut sum = 0.0;
    for i in k..=n {
        sum += log_term.exp();
        log_term += ((n - i) as f64 / (i + 1) as f64).ln() + p.ln() - (-p).ln_1p();
    }
    sum
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
            // Sums of logarithms up to ln 1000!, 5900, in double precision: some 1e-12 of a tail.
            assert!((lower_limit(k, n) - expected).abs() < 1e-10, "{k} of {n}");
        }
    }
}
