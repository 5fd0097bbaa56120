//! Spearman's rank correlation: how monotonically one column moves with another.

use super::quantile::Bounded;

/// Over the pairs in which both were measured. The bounds are two-sided, 95 %, by Fisher's transformation
/// with the variance (1 + rho²/2)/(n - 3) (Bonett and Wright 2000). `None` for fewer than ten
/// pairs or a column without spread.
pub fn rank_correlation(x: &[f64], y: &[f64]) -> Option<Bounded> {
    let pairs = x.iter().zip(y).filter(|(x, y)| !x.is_nan() && !y.is_nan());
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.map(|(x, y)| (*x, *y)).unzip();
    let n = x.len() as f64;
    if x.len() < 10 {
        return None;
    }
    let (x, y) = (ranks(&x), ranks(&y));
    // Ranks have the mean (n + 1)/2, ties or not.
    let middle = (n + 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>()
    };
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    let value = product(&x, &y) / scale;
    if !value.is_finite() {
        return None;
    }
    // A perfect correlation has no bounds but itself.
    let (z, deviation) = (libm::atanh(value), ((1.0 + value * value / 2.0) / (n - 3.0)).sqrt());
    let bound = |sign: f64| libm::tanh(z + sign * 1.959_963_985 * deviation);
    Some(Bounded { value, low: bound(-1.0), high: bound(1.0) })
}

/// From 1; equal values share the mean of their ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for group in order.chunk_by(|a, b| values[*a] == values[*b]) {
        // Ranks first + 1 to first + length.
        let rank = first as f64 + (group.len() + 1) as f64 / 2.0;
        group.iter().for_each(|index| ranks[*index] = rank);
        first += group.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_are_those_of_scipy() {
        let x: Vec<f64> = (0..12).map(|i| f64::from(i * i % 7)).collect();
        let y: Vec<f64> = (0..12).map(|i| f64::from(i * 5 % 11)).collect();
        // scipy.stats.spearmanr of the same lists, which have ties.
        let found = rank_correlation(&x, &y).unwrap();
        assert!((found.value - 0.1740055805028291).abs() < 1e-12, "{found:?}");
        assert!(found.low < found.value && found.value < found.high);
        let cubes: Vec<f64> = y.iter().map(|y| -y.powi(3)).collect();
        assert_eq!(rank_correlation(&y, &cubes).unwrap().value, -1.0);
        assert!(rank_correlation(&[1.0; 12], &y).is_none());
        let mut gaps = y.clone();
        gaps[3..].fill(f64::NAN);
        assert!(rank_correlation(&x, &gaps).is_none());
    }
}
