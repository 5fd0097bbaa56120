//! One shooting interval: Runge-Kutta 4 under controls linear in time, differentiated exactly (G.76).

use nalgebra::SMatrix;

use super::dynamics::{Control, Dynamics, Jacobian, Q, R, State, THRUST, TORQUE, V, W};

/// Columns of [`Sensitivity`]: the state and control at the start, the control at the end, the
/// length of the interval.
pub(super) const START_CONTROL: usize = 14;
pub(super) const END_CONTROL: usize = 20;
pub(super) const LENGTH: usize = 26;

/// ∂(end state)/∂(start state, start control, end control, length).
pub(super) type Sensitivity = SMatrix<f64, 14, 27>;

/// State at the end of an interval of `length_s` in `steps` steps, and its derivatives: those of
/// the Runge-Kutta map itself, to rounding.
pub(super) fn shoot(
    dynamics: &Dynamics,
    start: &State,
    controls: [&Control; 2],
    length_s: f64,
    steps: usize,
) -> (State, Sensitivity) {
    let step = 1.0 / steps as f64;
    let mut x = *start;
    let mut s = Sensitivity::identity();
    let stage = |share: f64, x: &State, s: &Sensitivity| {
        let u = controls[0] * (1.0 - share) + controls[1] * share;
        let (rate, jacobian) = dynamics.rate(x, &u);
        let mut slope = chain(&jacobian, s, share) * length_s;
        let mut by_length = slope.column_mut(LENGTH);
        by_length += rate;
        (rate * length_s, slope)
    };
    for k in 0..steps {
        let share = k as f64 * step;
        let half = 0.5 * step;
        let (k1, s1) = stage(share, &x, &s);
        let (k2, s2) = stage(share + half, &(x + k1 * half), &(s + s1 * half));
        let (k3, s3) = stage(share + half, &(x + k2 * half), &(s + s2 * half));
        let (k4, s4) = stage(share + step, &(x + k3 * step), &(s + s3 * step));
        x += (k1 + (k2 + k3) * 2.0 + k4) * (step / 6.0);
        s += (s1 + (s2 + s3) * 2.0 + s4) * (step / 6.0);
    }
    (x, s)
}

/// ∂x'/∂x S + ∂x'/∂u U, with the control at `share` of the interval.
fn chain(jacobian: &Jacobian, s: &Sensitivity, share: f64) -> Sensitivity {
    let j = jacobian;
    let (mass, attitude, rates) =
        (s.fixed_rows::<1>(0), s.fixed_rows::<4>(Q), s.fixed_rows::<3>(W));
    let mut out = Sensitivity::zeros();
    out.fixed_rows_mut::<3>(R).copy_from(&s.fixed_rows::<3>(V));
    out.fixed_rows_mut::<3>(V).copy_from(&(j.v_q * attitude + j.v_m * mass));
    out.fixed_rows_mut::<4>(Q).copy_from(&(j.q_q * attitude + j.q_w * rates));
    out.fixed_rows_mut::<3>(W).copy_from(&(j.w_w * rates + j.w_m * mass));
    for (first, weight) in [(START_CONTROL, 1.0 - share), (END_CONTROL, share)] {
        out[(0, first + THRUST)] += j.m_thrust * weight;
        let mut push = out.fixed_view_mut::<3, 3>(V, first);
        push += j.v_engine * weight;
        let mut gimbal = out.fixed_view_mut::<3, 3>(W, first);
        gimbal += j.w_engine * weight;
        let mut torque = out.fixed_view_mut::<3, 3>(W, first + TORQUE);
        torque += j.w_torque * weight;
    }
    out
}

#[cfg(test)]
mod tests {
    use claims::{Bound, Claim};
    use lander_models::vehicle::Vehicle;
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn sensitivities_are_those_of_the_map() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
        let vehicle = Vehicle::load(file.as_ref()).unwrap();
        let dynamics = Dynamics {
            mass: &vehicle.mass,
            pivot_b: Vector3::new(0.02, -0.01, 0.8),
            gravity_m_s2: 1.625,
            mass_flow_s_m: 1.0 / (225.0 * 9.80665),
        };
        let q: Vector3<f64> = Vector3::new(0.2, -0.15, 0.3);
        let q = [(1.0 - q.norm_squared()).sqrt(), q.x, q.y, q.z];
        let start = State::from_column_slice(&[
            240.0, 30.0, -10.0, 60.0, -8.0, 3.0, -20.0, q[0], q[1], q[2], q[3], 0.2, -0.3, 0.1,
        ]);
        let controls = [
            Control::from_column_slice(&[0.06, -0.04, 2600.0, 12.0, -20.0, 9.0]),
            Control::from_column_slice(&[-0.05, 0.02, 4100.0, -5.0, 30.0, -11.0]),
        ];
        let (length_s, steps) = (0.4, 4);
        let (_, exact) = shoot(&dynamics, &start, [&controls[0], &controls[1]], length_s, steps);
        let shifted = |column: usize, by: f64| {
            let (mut x, mut u, mut d) = (start, controls, length_s);
            match column {
                0..START_CONTROL => x[column] += by,
                START_CONTROL..END_CONTROL => u[0][column - START_CONTROL] += by,
                END_CONTROL..LENGTH => u[1][column - END_CONTROL] += by,
                _ => d += by,
            }
            shoot(&dynamics, &x, [&u[0], &u[1]], d, steps).0
        };
        let errors = (0..27).map(|column| {
            let unit = match column {
                0 => 100.0,
                START_CONTROL..LENGTH if (column - START_CONTROL) % 6 >= THRUST => 1e3,
                _ => 1.0,
            };
            let by = 1e-5 * unit;
            let difference = (shifted(column, by) - shifted(column, -by)) / (2.0 * by);
            let error = (exact.column(column) - difference).amax();
            error / difference.amax().max(1.0 / unit)
        });
        Claim {
            id: "six-dof-sensitivities",
            section: "Guidance",
            claim: "analytic sensitivities of a 6-DoF shooting interval, worst of 27 columns",
            reference: "central differences of the map",
            unit: "",
            bound: Bound::AtMost(1e-8),
            origin: "truncation near 1e-10 and rounding near 1e-11 of the largest entry",
            noise: 0.0,
        }
        .holds_for(errors);
    }
}
