//! How fast the gimbal turns while the thrust is linear in time (G.75).

use super::dynamics::Control;

/// The largest rate of tan δ = T_xy/T_z over an interval, times its length: with T_z between l and h
/// at its ends, the mean rate times h/l, met where the axial thrust is least.
pub(super) struct Swing {
    /// Controls at the low and the high end of the axial thrust.
    low: Control,
    high: Control,
    /// Whether the axial thrust falls.
    falls: bool,
}

impl Swing {
    pub fn new([start, end]: [&Control; 2]) -> Self {
        let falls = end[2] < start[2];
        let (low, high) = if falls { (*end, *start) } else { (*start, *end) };
        Self { low, high, falls }
    }

    /// About one axis of the lateral thrust.
    pub fn value(&self, axis: usize) -> f64 {
        let (x_l, z_l, x_h, z_h) = self.parts(axis);
        self.sign() * (x_h - x_l * z_h / z_l) / z_l
    }

    /// Derivatives by lateral and axial thrust at the start, then at the end, 1/N.
    pub fn slopes(&self, axis: usize) -> [f64; 4] {
        let (x_l, z_l, x_h, z_h) = self.parts(axis);
        let low = [-z_h / (z_l * z_l), (2.0 * x_l * z_h / z_l - x_h) / (z_l * z_l)];
        let high = [1.0 / z_l, -x_l / (z_l * z_l)];
        let [start, end] = if self.falls { [high, low] } else { [low, high] };
        [start[0], start[1], end[0], end[1]].map(|slope| self.sign() * slope)
    }

    /// Over both axes.
    pub fn norm(&self) -> f64 {
        self.value(0).hypot(self.value(1))
    }

    fn parts(&self, axis: usize) -> (f64, f64, f64, f64) {
        (self.low[axis], self.low[2], self.high[axis], self.high[2])
    }

    fn sign(&self) -> f64 {
        if self.falls { -1.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control(x: f64, y: f64, z: f64) -> Control {
        Control::new(x, y, z, 0.0, 0.0, 0.0)
    }

    #[test]
    fn it_is_the_fastest_turn_of_a_thrust_linear_in_time() {
        for (start, end) in [
            (control(-90.0, 40.0, 1500.0), control(200.0, -70.0, 2600.0)),
            (control(150.0, 20.0, 4000.0), control(-60.0, 90.0, 1200.0)),
        ] {
            let swing = Swing::new([&start, &end]);
            let tangent = |share: f64| {
                let u = start * (1.0 - share) + end * share;
                [u[0] / u[2], u[1] / u[2]]
            };
            let turn = |share: f64| {
                let ([a, b], [c, d]) = (tangent(share - 1e-5), tangent(share + 1e-5));
                (c - a).hypot(d - b) / 2e-5
            };
            let fastest = (0..=1000).map(|k| turn(f64::from(k) / 1000.0)).fold(0.0, f64::max);
            // Central differences of step 1e-5: truncation 1e-10, rounding 1e-11.
            assert!((swing.norm() - fastest).abs() < 1e-8, "{} {fastest}", swing.norm());
        }
    }

    #[test]
    fn slopes_are_those_of_the_value() {
        for (start, end) in [
            (control(-90.0, 40.0, 1500.0), control(200.0, -70.0, 2600.0)),
            (control(150.0, 20.0, 4000.0), control(-60.0, 90.0, 1200.0)),
        ] {
            for axis in 0..2 {
                let slopes = Swing::new([&start, &end]).slopes(axis);
                for (k, (at_end, row)) in
                    [(false, axis), (false, 2), (true, axis), (true, 2)].into_iter().enumerate()
                {
                    let shifted = |by: f64| {
                        let mut ends = [start, end];
                        ends[usize::from(at_end)][row] += by;
                        Swing::new([&ends[0], &ends[1]]).value(axis)
                    };
                    let difference = (shifted(0.1) - shifted(-0.1)) / 0.2;
                    // Truncation: (0.1 N / 1200 N)² of slopes near 1e-3 1/N.
                    assert!((slopes[k] - difference).abs() < 1e-10, "{k}");
                }
            }
        }
    }
}
