//! A tabulated property, linear between its rows.

use crate::quantity::{ConfigError, Section};

/// y(x), linear between rows and constant beyond the ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// At least two (x, y), x rising.
    rows: Vec<[f64; 2]>,
}

impl Curve {
    /// `None` unless there are two rows or more, x rises, and every y is greater than 0.
    pub fn new(rows: Vec<[f64; 2]>) -> Option<Self> {
        let rises = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        (rows.len() > 1 && rises && rows.iter().all(|row| row[1] > 0.0)).then_some(Self { rows })
    }

    pub fn at(&self, x: f64) -> f64 {
        let above = self.rows.partition_point(|row| row[0] <= x);
        let right = above.clamp(1, self.rows.len() - 1);
        let ([x0, y0], [x1, y1]) = (self.rows[right - 1], self.rows[right]);
        y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).clamp(0.0, 1.0)
    }
}

/// The curve under `key`, if it is there.
pub(super) fn read(s: &Section, key: &str, unit: &str) -> Result<Option<Curve>, ConfigError> {
    if !s.has(key) {
        return Ok(None);
    }
    let need = "needs two rows or more with rising first and positive second numbers";
    Curve::new(s.points::<2>(key, unit)?).map(Some).ok_or_else(|| s.error(key, need))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_passes_its_rows_and_stays_at_its_ends() {
        let curve = Curve::new(vec![[0.2, 210.0], [0.6, 230.0], [1.0, 240.0]]).unwrap();
        for (x, y) in [(0.0, 210.0), (0.2, 210.0), (0.4, 220.0), (0.6, 230.0), (0.8, 235.0)] {
            assert!((curve.at(x) - y).abs() < 1e-12, "{x}"); // rounding of numbers near 200
        }
        assert_eq!((curve.at(1.0), curve.at(7.0)), (240.0, 240.0));
        assert_eq!(Curve::new(vec![[0.0, 1.0]]), None);
        assert_eq!(Curve::new(vec![[1.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(Curve::new(vec![[0.0, 0.0], [1.0, 2.0]]), None);
    }
}
