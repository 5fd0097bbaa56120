//! Integer simulation time. Seconds exist only at the edges.

use serde::{Deserialize, Serialize};

/// One tick in seconds: the base step of flight and of contact (docs/CONVENTIONS.md).
pub const TICK_S: f64 = 1e-3;

/// Importers accumulate or subtract communication points in floating point, so a step of
/// 10 ms arrives as 0.00999999999…; after 1e5 s one double-precision ulp is 1.5e-11 s. A
/// nanosecond is far above that wobble and a million times below a tick.
const SNAP_TOLERANCE_S: f64 = 1e-9;

/// A whole number of ticks since the start of the run, or a duration.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct Ticks(pub u64);

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{seconds} s is not a whole, non-negative number of {TICK_S} s ticks")]
pub struct NotWholeTicks {
    pub seconds: f64,
}

impl Ticks {
    pub const ZERO: Self = Self(0);

    /// Nearest tick, if `seconds` lies within 1 ns of it.
    pub fn from_seconds(seconds: f64) -> Result<Self, NotWholeTicks> {
        let ticks = (seconds / TICK_S).round();
        // 2^53 ticks: beyond it an f64 can't hold every whole number.
        let representable = (0.0..9.007e15).contains(&ticks);
        if representable && (ticks * TICK_S - seconds).abs() <= SNAP_TOLERANCE_S {
            Ok(Self(ticks as u64))
        } else {
            Err(NotWholeTicks { seconds })
        }
    }

    pub fn seconds(self) -> f64 {
        // Division by 1000 rounds correctly; multiplication by 1e-3 does not.
        self.0 as f64 / 1000.0
    }
}

impl std::ops::Add for Ticks {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl std::ops::AddAssign for Ticks {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_accumulated_times_snaps_to_the_tick() {
        let mut t = 0.0;
        for n in 1..=6000 {
            let next = t + 0.01;
            assert_eq!(Ticks::from_seconds(next - t), Ok(Ticks(10)));
            assert_eq!(Ticks::from_seconds(next), Ok(Ticks(10 * n)));
            t = next;
        }
    }

    #[test]
    fn a_fraction_of_a_tick_and_nonsense_are_refused() {
        for bad in [0.0105e-1, -0.001, f64::NAN, f64::INFINITY, 1e300] {
            assert!(Ticks::from_seconds(bad).is_err(), "{bad} was taken");
        }
    }
}
