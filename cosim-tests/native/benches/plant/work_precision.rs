//! Time at equal error: what a peer that trades time for error by its step takes for an error given.

use serde::Serialize;

/// A peer's step: the time it takes and the error it makes.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub time_ms: f64,
    pub error: f64,
}

/// How a true figure stands to the one given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Bound {
    #[serde(rename = "=")]
    Equal,
    #[serde(rename = "<")]
    Less,
    #[serde(rename = ">")]
    More,
}

/// A time over the peer's time at the same error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    pub bound: Bound,
    pub value: f64,
}

impl Ratio {
    /// `None` without a curve. Between the peer's steps time and error follow a power law; beyond its
    /// coarsest or finest step nothing is known but the bound.
    pub fn at_equal_error(ours: Point, curve: &[Point]) -> Option<Self> {
        let envelope = lower_envelope(curve);
        let ratio = |bound, peer_ms: f64| Some(Self { bound, value: ours.time_ms / peer_ms });
        let (first, last) = (envelope.first()?, envelope.last()?);
        if ours.error > first.error {
            return ratio(Bound::More, first.time_ms);
        }
        if ours.error < last.error {
            return ratio(Bound::Less, last.time_ms);
        }
        // The first point no worse than ours, and the one before it, if any, that is worse.
        let next = envelope.iter().position(|point| point.error <= ours.error)?;
        let (fine, coarse) = (envelope[next], envelope[next.saturating_sub(1)]);
        if next == 0 || fine.error == ours.error {
            return ratio(Bound::Equal, fine.time_ms);
        }
        let share = (ours.error / coarse.error).ln() / (fine.error / coarse.error).ln();
        ratio(Bound::Equal, coarse.time_ms * (fine.time_ms / coarse.time_ms).powf(share))
    }
}

/// The points that no faster one equals in error, from the fastest: time rises, error falls.
fn lower_envelope(curve: &[Point]) -> Vec<Point> {
    let mut sorted = curve.to_vec();
    sorted.sort_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
    let mut least = f64::INFINITY;
    sorted.retain(|point| {
        let better = point.error < least;
        least = least.min(point.error);
        better
    });
    sorted
}
