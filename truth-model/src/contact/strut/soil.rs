//! Soft soil under a massless pad: how much of a step's closing goes into it (T.38).

use lander_models::scenario::Soil;

/// The soil that a pad meets, at the start of a step.
#[derive(Clone, Copy, Debug)]
pub struct Bed {
    /// Depth to which the pad has pressed it, m.
    pub sinkage_m: f64,
    /// Share of the pad's further way down that presses it deeper; the strut takes the rest.
    pub share: f64,
}

impl Bed {
    /// Ground that doesn't give.
    pub const HARD: Self = Self { sinkage_m: 0.0, share: 0.0 };

    /// Soil yields as fast as keeps the strut's load at what it bears. `load_n` is the pad's normal
    /// load by the strut's rate, which rises with it up to `closing_m_s`, all of the way down.
    pub fn new(
        soil: &Soil,
        radius_m: f64,
        sinkage_m: f64,
        closing_m_s: f64,
        load_n: impl Fn(f64) -> f64,
    ) -> Self {
        /// Halvings of the rate: a millionth of it is left.
        const HALVINGS: u32 = 20;
        let bearing_n = soil.pad_load_n(radius_m, sinkage_m);
        if closing_m_s <= 0.0 || load_n(closing_m_s) <= bearing_n {
            return Self { sinkage_m, share: 0.0 };
        }
        let (mut slow_m_s, mut fast_m_s) = (0.0, closing_m_s);
        for _ in 0..HALVINGS {
            let middle_m_s = 0.5 * (slow_m_s + fast_m_s);
            if load_n(middle_m_s) > bearing_n {
                fast_m_s = middle_m_s
            } else {
                slow_m_s = middle_m_s
            }
        }
        Self { sinkage_m, share: 1.0 - slow_m_s / closing_m_s }
    }

    /// Depth after the pad would have gone `further_m` below where it was.
    pub fn depth_m(&self, further_m: f64) -> f64 {
        self.sinkage_m + self.share * further_m.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LUNAR: Soil =
        Soil { cohesive_modulus_n_m2: 1.4e3, frictional_modulus_n_m3: 8.2e5, exponent: 1.0 };

    #[test]
    fn soil_takes_all_when_untouched_and_nothing_when_it_bears_the_load() {
        let damper_n = |rate_m_s: f64| 4e3 * rate_m_s;
        let share = |sinkage_m| Bed::new(&LUNAR, 0.15, sinkage_m, 1.0, damper_n).share;
        assert!(share(0.0) > 1.0 - 1e-5);
        assert_eq!(share(0.1), 0.0);
        // 4 kN/(m/s) of strut against the soil's load: the strut takes load/4000 of 1 m/s.
        let load_n = LUNAR.pad_load_n(0.15, 0.03);
        assert!((share(0.03) - (1.0 - load_n / 4e3)).abs() < 1e-5);
    }
}
