//! Two samples of the same draws: how much more often something happens in one than in the other.

use super::beta::beta_reg;
use serde::Serialize;

use super::binomial::wilson;
use super::quantile::Bounded;

/// Pairs of runs by whether it happened in each of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Pairs {
    pub both: usize,
    pub only_first: usize,
    pub only_second: usize,
    pub neither: usize,
}

impl FromIterator<(bool, bool)> for Pairs {
    fn from_iter<I: IntoIterator<Item = (bool, bool)>>(pairs: I) -> Self {
        let mut all = Self::default();
        for pair in pairs {
            *match pair {
                (true, true) => &mut all.both,
                (true, false) => &mut all.only_first,
                (false, true) => &mut all.only_second,
                (false, false) => &mut all.neither,
            } += 1;
        }
        all
    }
}

impl Pairs {
    /// Share in the first less share in the second, with two-sided 95 % limits: method 10 of Newcombe (1998b,
    /// Statistics in Medicine 17, 2635-2650), Wilson's limits of both shares joined by their correlation.
    pub fn difference(&self) -> Bounded {
        let Self { both, only_first, only_second, neither } = *self;
        let n = both + only_first + only_second + neither;
        let (first, second) = (both + only_first, both + only_second);
        let share = |count: usize| count as f64 / n as f64;
        let (p, q) = (share(first), share(second));
        let ([p_low, p_high], [q_low, q_high]) = (wilson(first, n), wilson(second, n));
        let phi = self.correlation();
        let reach = |a: f64, b: f64| (a * a - 2.0 * phi * a * b + b * b).max(0.0).sqrt();
        Bounded {
            value: p - q,
            low: p - q - reach(p - p_low, q_high - q),
            high: p - q + reach(q - q_low, p_high - p),
        }
    }

    /// Between the two, with a positive one corrected for continuity, as method 10 has it.
    fn correlation(&self) -> f64 {
        let [a, b, c, d] =
            [self.both, self.only_first, self.only_second, self.neither].map(|count| count as f64);
        let scale = ((a + b) * (c + d) * (a + c) * (b + d)).sqrt();
        let odds = a * d - b * c;
        let corrected = if odds > 0.0 { (odds - (a + b + c + d) / 2.0).max(0.0) } else { odds };
        if scale > 0.0 { corrected / scale } else { 0.0 }
    }

    /// Two-sided probability that pairs which differ split at least as unevenly, were both shares the same
    /// (McNemar 1947, exact).
    pub fn p_value(&self) -> f64 {
        let (less, more) = (
            self.only_first.min(self.only_second) as f64,
            self.only_first.max(self.only_second) as f64,
        );
        if more == less {
            return 1.0;
        }
        // At most `less` of the `less + more` fair coins.
        2.0 * beta_reg(more, less + 1.0, 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lander_models::random::uniform;

    fn pairs(both: usize, only_first: usize, only_second: usize, neither: usize) -> Pairs {
        Pairs { both, only_first, only_second, neither }
    }

    #[test]
    fn p_values_are_those_of_the_binomial_test() {
        // 2 P(X ≤ 1), X of 10 fair coins; 2 P(X ≤ 1) of 8; scipy.stats.binomtest(30, 100).
        for (found, expected) in [
            (pairs(3, 9, 1, 5).p_value(), 2.0 * 11.0 / 1024.0),
            (pairs(1, 1, 7, 12).p_value(), 2.0 * 9.0 / 256.0),
            (pairs(0, 30, 70, 0).p_value(), 7.85013964559367e-05),
            (pairs(5, 4, 4, 9).p_value(), 1.0),
            (pairs(5, 0, 0, 9).p_value(), 1.0),
        ] {
            // The incomplete beta function is good to some 1e-12.
            assert!((found - expected).abs() < 1e-11, "{found}, {expected}");
        }
    }

    #[test]
    fn limits_are_those_of_a_published_table() {
        // Complete response before and after therapy (Cavo et al. 2012) in Fagerland, Lydersen and Laake, Statistical
        // Analysis of Contingency Tables (2017), chapter 8; and two pairs alike, from their package contingencytables.
        for (pairs, expected) in [
            (pairs(59, 6, 16, 80), [-0.0621, -0.1186, -0.0046]),
            (pairs(1, 0, 0, 1), [0.0, -0.5734, 0.5734]),
        ] {
            let Bounded { value, low, high } = pairs.difference();
            // Printed to four decimals.
            let off = [value, low, high].into_iter().zip(expected).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 0.5e-4, "{value} {low} {high}");
        }
    }

    #[test]
    fn limits_hold_the_difference_in_95_of_100_samples() {
        // Shares 0.06 and 0.10, often together: a tip-over at one design is likely one at its neighbour.
        let (n, samples) = (300, 4000);
        let held = (0..samples).filter(|sample| {
            let pair = |index: u64| {
                let u = uniform(1, &sample.to_string(), index);
                (u < 0.06, (0.01..0.11).contains(&u))
            };
            let found = (0..n).map(pair).collect::<Pairs>().difference();
            (found.low..=found.high).contains(&-0.04)
        });
        let share = held.count() as f64 / f64::from(samples);
        // Nominal 0.95; Newcombe found coverages of method 10 of 0.95 ± 0.01; five standard errors, 0.017.
        assert!((share - 0.95).abs() < 0.027, "{share}");
    }
}
