//! First guess: the translation's plan, body z along its thrust.

use nalgebra::{UnitQuaternion, Vector3};

use super::dynamics::{Control, Q, R, State, V};
use super::problem::{SixDofProblem, SixDofSettings};
use super::trajectory::{Grid, Iterate};
use crate::scvx::Plan;

/// Half-width of the window that averages the planned thrust direction, s: an attitude can't jump.
const SMOOTHING_S: f64 = 0.4;

/// Grid and guess in the phases of `plan`.
pub(super) fn from_translation(
    problem: &SixDofProblem,
    settings: &SixDofSettings,
    plan: &Plan,
) -> (Grid, Iterate) {
    let grid = Grid::new(plan.phases.iter().map(|phase| phase.powered), settings);
    let step_s: Vec<f64> = plan
        .phases
        .iter()
        .zip(&grid.phases)
        .map(|(phase, grid)| phase.duration_s.max(settings.phase_min_s) / grid.intervals as f64)
        .collect();
    let mut iterate = Iterate { states: Vec::new(), controls: Vec::new(), step_s };
    let node_at = |t_s: f64| {
        let sample = plan.sample(t_s);
        let mut x = State::zeros();
        x[0] = sample.mass_kg;
        x.fixed_rows_mut::<3>(R).copy_from(&sample.r_w);
        x.fixed_rows_mut::<3>(V).copy_from(&sample.v_w);
        x.fixed_rows_mut::<4>(Q).copy_from(&attitude(problem, &direction(plan, t_s)));
        x
    };
    for (n, phase) in grid.phases.iter().enumerate() {
        let planned = &plan.phases[n];
        let at = |k: usize| planned.start_s + planned.duration_s * k as f64 / phase.intervals as f64;
        iterate.states.extend((usize::from(n > 0)..=phase.intervals).map(|k| node_at(at(k))));
        iterate.controls.extend((0..=phase.intervals).map(|k| {
            let thrust_n = problem.actuators.thrust_min_n.max(plan.sample(at(k)).thrust_n);
            let axial_n = if planned.powered { thrust_n } else { 0.0 };
            Control::new(0.0, 0.0, axial_n, 0.0, 0.0, 0.0)
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
fn attitude(problem: &SixDofProblem, up_w: &Vector3<f64>) -> nalgebra::Vector4<f64> {
    let turn = UnitQuaternion::rotation_between(&Vector3::z(), up_w).unwrap_or_default();
    let turn = UnitQuaternion::new(turn.scaled_axis().cap_magnitude(problem.limits.tilt_max_rad));
    wxyz(&turn)
}

/// (w, x, y, z), as stored in a state.
pub(super) fn wxyz(attitude_wb: &UnitQuaternion<f64>) -> nalgebra::Vector4<f64> {
    nalgebra::Vector4::new(attitude_wb.w, attitude_wb.i, attitude_wb.j, attitude_wb.k)
}
