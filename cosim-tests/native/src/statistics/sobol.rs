//! Sobol' indices: the shares of an output's variance that inputs cause, alone and together.
//!
//! Of n rows there are two independent samples A and B and, per input i, AB_i: A with that input from
//! B. First-order index by Saltelli et al. (2010), total by Jansen (1999).

use serde::Serialize;

use super::quantile::{Bounded, bootstrap};
use lander_models::math::square;

/// Of one input.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Index {
    /// Share of the variance that it causes by itself.
    pub first: Bounded,
    /// Share in which it takes part.
    pub total: Bounded,
}

/// Outputs of the rows of A, of B, and of each AB_i.
pub struct Design {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub mixed: Vec<Vec<f64>>,
}

impl Design {
    /// Indices of each input, with bounds over resampled rows. Rows in which any output was not
    /// measured are left out.
    pub fn indices(&self, seed: u64) -> Vec<Index> {
        let whole = |row: &usize| {
            let of_row = self.mixed.iter().map(|outputs| outputs[*row]);
            of_row.chain([self.a[*row], self.b[*row]]).all(f64::is_finite)
        };
        let rows: Vec<usize> = (0..self.a.len()).filter(whole).collect();
        let index = |mixed: &Vec<f64>| {
            let over = |statistic: &dyn Fn(&[usize]) -> f64| {
                bootstrap(rows.len(), seed, |picked| {
                    let picked: Vec<usize> = picked.iter().map(|index| rows[*index]).collect();
                    statistic(&picked)
                })
            };
            Index {
                first: over(&|picked| self.first(mixed, picked)),
                total: over(&|picked| self.total(mixed, picked)),
            }
        };
        self.mixed.iter().map(index).collect()
    }

    fn first(&self, mixed: &[f64], rows: &[usize]) -> f64 {
        // About the mean: the product's variance is least there.
        let (mean, variance) = self.moments(rows);
        let product = |row: &usize| (self.b[*row] - mean) * (mixed[*row] - self.a[*row]);
        rows.iter().map(product).sum::<f64>() / rows.len() as f64 / variance
    }

    fn total(&self, mixed: &[f64], rows: &[usize]) -> f64 {
        let (_, variance) = self.moments(rows);
        let apart = |row: &usize| square(self.a[*row] - mixed[*row]);
        rows.iter().map(apart).sum::<f64>() / (2 * rows.len()) as f64 / variance
    }

    /// Mean and variance over A and B.
    fn moments(&self, rows: &[usize]) -> (f64, f64) {
        let values = || rows.iter().flat_map(|row| [self.a[*row], self.b[*row]]);
        let n = 2.0 * rows.len() as f64;
        let mean = values().sum::<f64>() / n;
        (mean, values().map(|value| square(value - mean)).sum::<f64>() / n)
    }
}

#[cfg(test)]
mod tests {
    use lander_models::random;
    use std::f64::consts::PI;

    use super::*;

    /// Ishigami and Homma (1990), a = 7, b = 0.1, inputs uniform in [-pi, pi].
    fn ishigami(x: [f64; 3]) -> f64 {
        x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
    }

    #[test]
    fn indices_of_ishigami_s_function_are_its_closed_forms() {
        let input = |sample: &str, row: u64| -> [f64; 3] {
            std::array::from_fn(|i| {
                PI * (2.0 * random::uniform(5, &format!("{sample} {i}"), row) - 1.0)
            })
        };
        let rows = 0..4000;
        let mixed = |i: usize| {
            let one = |row: u64| {
                let mut x = input("a", row);
                x[i] = input("b", row)[i];
                ishigami(x)
            };
            rows.clone().map(one).collect()
        };
        let design = Design {
            a: rows.clone().map(|row| ishigami(input("a", row))).collect(),
            b: rows.clone().map(|row| ishigami(input("b", row))).collect(),
            mixed: (0..3).map(mixed).collect(),
        };
        let (a, b) = (7.0_f64, 0.1_f64);
        let alone = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let together = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let variance = alone + a * a / 8.0 + together;
        let expected = [
            [alone, alone + together].map(|part| part / variance),
            [a * a / 8.0 / variance; 2],
            [0.0, together / variance],
        ];
        for (index, expected) in design.indices(1).iter().zip(expected) {
            for (found, expected) in [index.first, index.total].into_iter().zip(expected) {
                // Twice the half width of the 95 % bounds: four standard errors.
                let half = 0.5 * (found.high - found.low);
                assert!((found.value - expected).abs() < 2.0 * half, "{found:?}, {expected}");
                assert!(half < 0.1, "{found:?}");
            }
        }
    }
}
