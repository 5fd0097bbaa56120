//! How fast a plan turns its thrust (G.97): from each burn interval to the next, across coasts too, and from where
//! the vehicle points at its start.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::problem::Problem;
use super::structure::Grid;
use super::trajectory::Iterate;

/// A shorter burn is no part of the chain, s: it is about to vanish, and its direction means nothing.
const BURN_MIN_S: f64 = 0.05;

/// Limit on the turn of the thrust. What is beyond it has a price, so that no plan fails for it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Largest mean rate from the middle of a burn interval to the middle of the next, rad/s, by the horizontal part of
    /// the unit vector: at a tilt θ a turn in the vertical plane is faster by 1/cos θ.
    pub rate_max_rad_s: f64,
    /// Unit vector along which the vehicle would thrust at the start.
    pub axis_w: Option<Vector3<f64>>,
}

/// Two directions that follow each other, and the time between them.
pub(super) struct Link {
    /// Burn interval of the first; `None` for the vehicle's own direction at the start.
    pub before: Option<usize>,
    /// Burn interval of the second.
    pub after: usize,
    /// How many intervals of each phase lie between the middles of the two.
    pub intervals: Vec<f64>,
}

/// The links of a flight with intervals as long as those of `iterate`; none without a limit.
pub(super) fn links(problem: &Problem, grid: &Grid, iterate: &Iterate) -> Vec<Link> {
    let Some(turn) = problem.turn else { return Vec::new() };
    let mut links = Vec::new();
    let (mut before, mut first) = (None, turn.axis_w.is_none());
    let mut intervals = vec![0.0; grid.phases.len()];
    for (j, &phase) in grid.phase_of.iter().enumerate() {
        let burn_s = iterate.step_s[phase] * grid.phases[phase].intervals as f64;
        if !grid.phases[phase].powered || burn_s < BURN_MIN_S {
            intervals[phase] += 1.0;
            continue;
        }
        intervals[phase] += 0.5;
        if !first {
            links.push(Link { before, after: j, intervals: intervals.clone() });
        }
        (before, first) = (Some(j), false);
        intervals.fill(0.0);
        intervals[phase] = 0.5;
    }
    links
}

/// Largest turn beyond the limit, rad; zero within it.
pub(super) fn excess_rad(problem: &Problem, grid: &Grid, iterate: &Iterate) -> f64 {
    let Some(turn) = problem.turn else { return 0.0 };
    let across = |interval: Option<usize>| -> Vector2<f64> {
        let w_w = interval.map_or(turn.axis_w.unwrap_or_default(), |j| iterate.w_w[j]);
        w_w.try_normalize(0.0).unwrap_or_default().xy()
    };
    let excess_rad = links(problem, grid, iterate).into_iter().map(|link| {
        let duration_s: f64 = link.intervals.iter().zip(&iterate.step_s).map(|(n, s)| n * s).sum();
        let turned = across(Some(link.after)) - across(link.before);
        turned.norm() - turn.rate_max_rad_s * duration_s
    });
    excess_rad.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::problem::Settings;
    use super::super::structure::Structure;
    use super::*;
    use crate::scenarios::descent;

    #[test]
    fn links_span_coasts_and_leave_out_burns_that_vanish() {
        let axis_w = Some(Vector3::z());
        let problem = Problem { turn: Some(Turn { rate_max_rad_s: 0.1, axis_w }), ..descent() };
        let settings =
            Settings { first_burn_intervals: 2, last_burn_intervals: 3, ..Settings::default() };
        let grid = Grid::new(Structure::OnOffOn, &problem, &settings);
        let chain = |first_s: f64| {
            let step_s = vec![first_s, 10.0, 2.0];
            let w_w = vec![Vector3::z(); grid.len()];
            let iterate = Iterate { step_s: step_s.clone(), h: vec![1.0; grid.len()], w_w };
            let links = links(&problem, &grid, &iterate).into_iter().map(|link| {
                let seconds = link.intervals.iter().zip(&step_s).map(|(n, step_s)| n * step_s);
                (link.before, link.after, seconds.sum::<f64>())
            });
            links.collect::<Vec<_>>()
        };
        let last = [(Some(3), 4, 2.0), (Some(4), 5, 2.0)];
        // Half of the first interval, a whole one, half of it with the coast and half of the next.
        let whole = [(None, 0, 0.5), (Some(0), 1, 1.0), (Some(1), 3, 0.5 + 10.0 + 1.0)];
        assert_eq!(chain(1.0), [whole.as_slice(), &last].concat());
        let vanished = [(None, 3, 0.02 + 10.0 + 1.0)];
        assert_eq!(chain(0.01), [vanished.as_slice(), &last].concat());
    }
}
