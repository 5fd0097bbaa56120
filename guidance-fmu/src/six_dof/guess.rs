//! First guess: the translation's plan, body z along its thrust.

use nalgebra::{UnitQuaternion, Vector3, Vector4};

use super::dynamics::{Control, Q, R, State, V};
use super::problem::{SixDofProblem, SixDofSettings};
use super::trajectory::{Grid, Iterate};
use crate::scvx::Plan;

/// Half-width of the window that averages the planned thrust direction, s: an attitude can't jump.
const SMOOTHING_S: f64 = 0.4;

/// The translation's plan, and the free fall ahead of it that leaves time to turn.
pub(super) struct Translation {
    pub plan: Plan,
    pub turn_s: f64,
}

impl Translation {
    /// Burns and coasts as (powered, start, duration); time counts from the start of the plan.
    fn phases(&self) -> Vec<(bool, f64, f64)> {
        let planned = self.plan.phases.iter().map(|p| (p.powered, p.start_s, p.duration_s));
        let mut phases: Vec<_> = planned.collect();
        if self.turn_s > 0.0 {
            if phases[0].0 {
                phases.insert(0, (false, 0.0, 0.0));
            }
            phases[0].1 -= self.turn_s;
            phases[0].2 += self.turn_s;
        }
        phases
    }

    /// Length of the flight, s.
    pub fn duration_s(&self) -> f64 {
        self.turn_s + self.plan.duration_s()
    }
}

/// Grid and guess in the phases of `translation`.
pub(super) fn from_translation(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
    translation: &Translation,
) -> (Grid, Iterate) {
    let (plan, phases) = (&translation.plan, translation.phases());
    let grid = Grid::new(phases.iter().map(|&(powered, ..)| powered), settings);
    let mut iterate = Iterate { states: Vec::new(), controls: Vec::new(), step_s: Vec::new() };
    let node_at = |t_s: f64| {
        let sample = plan.sample(t_s);
        // Before the plan the vehicle falls freely towards its start.
        let before_s = t_s.min(0.0);
        let gravity_w = Vector3::new(0.0, 0.0, -problem.gravity_m_s2);
        let r_w = sample.r_w + (sample.v_w + gravity_w * (0.5 * before_s)) * before_s;
        let mut x = State::zeros();
        x[0] = sample.mass_kg;
        x.fixed_rows_mut::<3>(R).copy_from(&r_w);
        x.fixed_rows_mut::<3>(V).copy_from(&(sample.v_w + gravity_w * before_s));
        x.fixed_rows_mut::<4>(Q).copy_from(&attitude(problem, &direction(plan, t_s)));
        x
    };
    for (n, (phase, &(powered, start_s, duration_s))) in grid.phases.iter().zip(&phases).enumerate()
    {
        let step_s = duration_s / phase.intervals as f64;
        let at = |k: usize| start_s + k as f64 * step_s;
        iterate.step_s.push(step_s.max(settings.phase_min_s / phase.intervals as f64));
        iterate.states.extend((usize::from(n > 0)..=phase.intervals).map(|k| node_at(at(k))));
        iterate.controls.extend((0..=phase.intervals).map(|k| {
            let thrust_n = problem.actuators.thrust_min_n.max(plan.sample(at(k)).thrust_n);
            let thrust_n = if powered { thrust_n } else { 0.0 };
            Control::new(0.0, 0.0, thrust_n, 0.0, 0.0, 0.0)
        }));
    }
    if let Some(attitude_wb) = problem.start.attitude_wb {
        iterate.states[0].fixed_rows_mut::<4>(Q).copy_from(&wxyz(&attitude_wb));
    }
    (grid, iterate)
}

/// Thrust direction about `t_s`; in a coast, the turn from the burn before to the burn after.
fn direction(plan: &Plan, t_s: f64) -> Vector3<f64> {
    if let Some(direction_w) = plan.smoothed_direction(t_s, SMOOTHING_S) {
        return direction_w;
    }
    let coast = plan.phases.iter().find(|p| !p.powered && t_s <= p.end_s());
    let Some(coast) = coast else { return Vector3::z() };
    let side = |at_s: f64| plan.smoothed_direction(at_s, SMOOTHING_S).unwrap_or_else(Vector3::z);
    let share = (t_s - coast.start_s) / coast.duration_s;
    let between_w = side(coast.start_s) * (1.0 - share) + side(coast.end_s()) * share;
    between_w.try_normalize(1e-9).unwrap_or_else(Vector3::z)
}

/// The smallest turn from upright that points body z along `up_w`, within the tilt limit.
fn attitude(problem: &SixDofProblem, up_w: &Vector3<f64>) -> Vector4<f64> {
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), up_w).unwrap_or_default();
    let turn = UnitQuaternion::new(turn.scaled_axis().cap_magnitude(problem.limits.tilt_max_rad));
    wxyz(&turn)
}

/// (w, x, y, z), as stored in a state.
pub(super) fn wxyz(attitude_wb: &UnitQuaternion<f64>) -> Vector4<f64> {
    Vector4::new(attitude_wb.w, attitude_wb.i, attitude_wb.j, attitude_wb.k)
}
