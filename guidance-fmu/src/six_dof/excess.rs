//! How far a plan leaves its limits.

use serde::{Deserialize, Serialize};

use super::plan::{SixDofControl, SixDofNode};
use super::problem::SixDofProblem;

/// How far a plan leaves its limits at worst; zero or less inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Excess {
    /// Tilt of body z, rad.
    pub tilt_rad: f64,
    /// Body rate, rad/s.
    pub rate_rad_s: f64,
    /// Horizontal distance outside the glide slope, m.
    pub glide_slope_m: f64,
    /// Thrust beyond its ceiling or under its floor, N.
    pub thrust_n: f64,
    /// Gimbal angle, rad.
    pub gimbal_rad: f64,
    /// Rate of the thrust, N/s.
    pub thrust_rate_n_s: f64,
    /// Rate of the gimbal's tangents, rad/s; that of the angle is no larger.
    pub gimbal_rate_rad_s: f64,
    /// Thruster torque about an axis, N m.
    pub torque_nm: f64,
}

impl Default for Excess {
    /// Of a plan of which nothing has been seen.
    fn default() -> Self {
        let unseen = f64::NEG_INFINITY;
        Self {
            tilt_rad: unseen,
            rate_rad_s: unseen,
            glide_slope_m: unseen,
            thrust_n: unseen,
            gimbal_rad: unseen,
            thrust_rate_n_s: unseen,
            gimbal_rate_rad_s: unseen,
            torque_nm: unseen,
        }
    }
}

impl Excess {
    /// The worse of two, limit by limit.
    pub(super) fn worse(self, other: &Self) -> Self {
        Self {
            tilt_rad: self.tilt_rad.max(other.tilt_rad),
            rate_rad_s: self.rate_rad_s.max(other.rate_rad_s),
            glide_slope_m: self.glide_slope_m.max(other.glide_slope_m),
            thrust_n: self.thrust_n.max(other.thrust_n),
            gimbal_rad: self.gimbal_rad.max(other.gimbal_rad),
            thrust_rate_n_s: self.thrust_rate_n_s.max(other.thrust_rate_n_s),
            gimbal_rate_rad_s: self.gimbal_rate_rad_s.max(other.gimbal_rate_rad_s),
            torque_nm: self.torque_nm.max(other.torque_nm),
        }
    }

    /// Takes in one state of the path.
    pub(super) fn see_state(&mut self, problem: &SixDofProblem, node: &SixDofNode) {
        let limits = &problem.limits;
        self.tilt_rad = self.tilt_rad.max(node.tilt_rad() - limits.tilt_max_rad);
        self.rate_rad_s = self.rate_rad_s.max(node.rate_b.norm() - limits.rate_max_rad_s);
        if let Some(angle_rad) = limits.glide_slope_rad {
            let off_w = node.r_w - problem.r_f_w;
            let outside_m = off_w.xy().norm() - off_w.z * libm::tan(angle_rad);
            self.glide_slope_m = self.glide_slope_m.max(outside_m);
        }
    }

    /// Takes in one control.
    pub(super) fn see_control(
        &mut self,
        problem: &SixDofProblem,
        u: &SixDofControl,
        powered: bool,
    ) {
        let actuators = &problem.actuators;
        let torque = u.torque_b.abs() - actuators.torque_max_b;
        self.torque_nm = self.torque_nm.max(torque.max());
        if powered {
            let out_n =
                (u.thrust_n - actuators.thrust_max_n).max(actuators.thrust_min_n - u.thrust_n);
            self.thrust_n = self.thrust_n.max(out_n);
            let gimbal_rad = libm::atan(u.gimbal_tan.norm());
            self.gimbal_rad = self.gimbal_rad.max(gimbal_rad - actuators.gimbal_max_rad);
        }
    }

    /// Takes in a powered interval of `length_s`, over which the controls change at a constant rate.
    pub(super) fn see_rates(
        &mut self,
        problem: &SixDofProblem,
        [start, end]: [&SixDofControl; 2],
        length_s: f64,
    ) {
        let actuators = &problem.actuators;
        let thrust_n_s = (end.thrust_n - start.thrust_n).abs() / length_s;
        let gimbal_rad_s = (end.gimbal_tan - start.gimbal_tan).norm() / length_s;
        self.thrust_rate_n_s = self.thrust_rate_n_s.max(thrust_n_s - actuators.thrust_rate_max_n_s);
        self.gimbal_rate_rad_s =
            self.gimbal_rate_rad_s.max(gimbal_rad_s - actuators.gimbal_rate_max_rad_s);
    }
}
