//! The landing problem and the planner's settings.

use lander_models::vehicle::G0_M_S2;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::error::PlanError;
use super::propulsion::{EngineState, Propulsion};
use super::turn::Turn;

/// A minimum-fuel powered descent (G.1-G.7) in a site-fixed frame with z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Problem {
    /// Initial position, m.
    pub r0_w: Vector3<f64>,
    /// Initial velocity, m/s.
    pub v0_w: Vector3<f64>,
    /// Target position, m.
    pub r_f_w: Vector3<f64>,
    /// Target velocity, m/s.
    pub v_f_w: Vector3<f64>,
    /// How much of the target is asked for.
    pub terminal: Terminal,
    /// Initial mass, kg.
    pub mass_kg: f64,
    /// Mass without usable propellant, kg.
    pub dry_mass_kg: f64,
    /// Gravity along −z, m/s².
    pub gravity_m_s2: f64,
    /// Specific impulse, s.
    pub isp_s: f64,
    /// Thrust floor of a running engine, N.
    pub thrust_min_n: f64,
    /// Thrust ceiling, N.
    pub thrust_max_n: f64,
    /// Largest change of the thrust vector between neighbouring intervals of a burn, N/s.
    pub thrust_rate_max_n_s: Option<f64>,
    /// How fast the thrust may turn, so that the vehicle can follow (G.97).
    pub turn: Option<Turn>,
    /// Whether and how often the engine may be switched.
    pub propulsion: Propulsion,
    /// What the engine has done before the start.
    pub engine: EngineState,
    /// Largest angle of the thrust from the vertical, rad.
    pub tilt_max_rad: f64,
    /// Smaller tilt limit at the end of the last burn, so that the vehicle arrives upright.
    pub final_tilt: Option<FinalTilt>,
    /// Wider limits that a plan may use, at a price, only where the ones above miss the target.
    pub reserve: Option<Reserve>,
    /// Limits on the path.
    pub path: PathLimits,
}

/// How much of the target a plan must meet: each is the fall-back of the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Terminal {
    /// Position and velocity (G.1-G.18).
    #[default]
    Point,
    /// Height and velocity; lands wherever that costs least propellant (G.43).
    Anywhere,
    /// Height only, at the speed nearest to the target velocity that the propellant allows (G.44).
    SoftestImpact,
}

/// Limits beyond the nominal ones that keep a disturbed flight plannable (G.14).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reserve {
    /// Thrust ceiling, N; not below the nominal one.
    pub thrust_max_n: f64,
    /// Largest angle of the thrust from the vertical, rad; not below the nominal one.
    pub tilt_max_rad: f64,
}

/// Tilt limit for the last intervals of the last phase.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinalTilt {
    /// Largest angle of the thrust from the vertical, rad.
    pub tilt_max_rad: f64,
    /// Number of intervals it holds for.
    pub intervals: usize,
}

/// Limits that hold at every node of the plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathLimits {
    /// Glide-slope cone above the target, half-angle from the vertical, rad.
    pub glide_slope_rad: Option<f64>,
    /// Minimum z, m.
    pub altitude_min_m: Option<f64>,
}

impl Problem {
    /// Mass flow per newton, 1/(I_sp g0), s/m.
    pub fn mass_flow_s_m(&self) -> f64 {
        1.0 / (self.isp_s * G0_M_S2)
    }

    /// Gravity vector, m/s².
    pub fn gravity_w(&self) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, -self.gravity_m_s2)
    }

    /// Thrust that no plan exceeds, N.
    pub fn thrust_ceiling_n(&self) -> f64 {
        self.reserve.map_or(self.thrust_max_n, |reserve| reserve.thrust_max_n)
    }

    /// Angle from the vertical that no plan's thrust exceeds, rad.
    pub(super) fn tilt_ceiling_rad(&self) -> f64 {
        self.reserve.map_or(self.tilt_max_rad, |reserve| reserve.tilt_max_rad)
    }

    /// Errors of an end state in what the target asks for; zero in what it leaves free.
    pub(super) fn miss(
        &self,
        r_w: &Vector3<f64>,
        v_w: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (r_error_w, v_error_w) = (r_w - self.r_f_w, v_w - self.v_f_w);
        match self.terminal {
            Terminal::Point => (r_error_w, v_error_w),
            Terminal::Anywhere => (Vector3::z() * r_error_w.z, v_error_w),
            Terminal::SoftestImpact => (Vector3::z() * r_error_w.z, Vector3::zeros()),
        }
    }

    /// Speed error that the softest impact minimises, m/s; zero where the velocity is met.
    pub(super) fn impact_m_s(&self, v_w: &Vector3<f64>) -> f64 {
        match self.terminal {
            Terminal::SoftestImpact => (v_w - self.v_f_w).norm(),
            Terminal::Point | Terminal::Anywhere => 0.0,
        }
    }

    /// Velocity that the propellant on board can give, m/s.
    pub(super) fn delta_v_max_m_s(&self) -> f64 {
        libm::log(self.mass_kg / self.dry_mass_kg) / self.mass_flow_s_m()
    }

    /// Nominal tilt limit in `interval` of `intervals`, rad.
    pub(super) fn tilt_limit_rad(&self, interval: usize, intervals: usize) -> f64 {
        match self.final_tilt {
            Some(end) if interval + end.intervals >= intervals => end.tilt_max_rad,
            _ => self.tilt_max_rad,
        }
    }

    /// Names the first input that is not finite or not physical.
    pub fn validate(&self) -> Result<(), PlanError> {
        const POSITION: &str = "±1e5 m";
        const VELOCITY: &str = "±3e3 m/s";
        const ANGLE: &str = "(0, π/2) rad";
        let right_angle = std::f64::consts::FRAC_PI_2;
        for (field, vector, limit, allowed) in [
            ("r0_w", &self.r0_w, 1e5, POSITION),
            ("v0_w", &self.v0_w, 3e3, VELOCITY),
            ("r_f_w", &self.r_f_w, 1e5, POSITION),
            ("v_f_w", &self.v_f_w, 3e3, VELOCITY),
        ] {
            for &value in vector {
                within(field, value, -limit, limit, allowed)?;
            }
        }
        within("dry_mass_kg", self.dry_mass_kg, 1.0, 1e5, "[1, 1e5] kg")?;
        within("mass_kg", self.mass_kg, self.dry_mass_kg, 1e5, "[dry_mass_kg, 1e5] kg")?;
        within("gravity_m_s2", self.gravity_m_s2, 0.1, 30.0, "[0.1, 30] m/s²")?;
        within("isp_s", self.isp_s, 10.0, 1e4, "[10, 1e4] s")?;
        within("thrust_max_n", self.thrust_max_n, 1e-3, 1e7, "[1e-3, 1e7] N")?;
        within("thrust_min_n", self.thrust_min_n, 0.0, self.thrust_max_n, "[0, thrust_max_n] N")?;
        within("tilt_max_rad", self.tilt_max_rad, 1e-3, right_angle, ANGLE)?;
        if let Some(reserve) = self.reserve {
            let Reserve { thrust_max_n: thrust_n, tilt_max_rad: tilt_rad } = reserve;
            let (low_n, low_rad) = (self.thrust_max_n, self.tilt_max_rad);
            within("reserve.thrust_max_n", thrust_n, low_n, 1e7, "[thrust_max_n, 1e7] N")?;
            within(
                "reserve.tilt_max_rad",
                tilt_rad,
                low_rad,
                right_angle,
                "[tilt_max_rad, π/2] rad",
            )?;
        }
        if let Some(end) = self.final_tilt {
            within("final_tilt.tilt_max_rad", end.tilt_max_rad, 1e-3, right_angle, ANGLE)?;
        }
        if let Some(rate_n_s) = self.thrust_rate_max_n_s {
            within("thrust_rate_max_n_s", rate_n_s, 1e-3, 1e9, "[1e-3, 1e9] N/s")?;
        }
        if let Some(turn) = self.turn {
            within("turn.rate_max_rad_s", turn.rate_max_rad_s, 1e-3, 1e3, "[1e-3, 1e3] rad/s")?;
            let norm = turn.axis_w.map_or(1.0, |axis_w| axis_w.norm());
            within("turn.axis_w", norm, 1.0 - 1e-6, 1.0 + 1e-6, "a unit vector")?;
        }
        if let Propulsion::OnOff { on_min_s, off_min_s, .. } = self.propulsion {
            within("propulsion.on_min_s", on_min_s, 0.01, 100.0, "[0.01, 100] s")?;
            within("propulsion.off_min_s", off_min_s, 0.01, 100.0, "[0.01, 100] s")?;
        }
        within("engine.for_s", self.engine.for_s, 0.0, f64::MAX, "[0, ∞) s")?;
        if let Some(angle_rad) = self.path.glide_slope_rad {
            if self.terminal != Terminal::Point {
                let allowed = "none: the cone stands on a target point";
                return Err(PlanError::Input {
                    field: "path.glide_slope_rad",
                    value: angle_rad,
                    allowed,
                });
            }
            within("path.glide_slope_rad", angle_rad, 1e-3, right_angle - 1e-3, ANGLE)?;
        }
        if let Some(z_m) = self.path.altitude_min_m {
            within("path.altitude_min_m", z_m, -1e5, self.r_f_w.z, "[-1e5, r_f_w.z] m")?;
        }
        Ok(())
    }
}

/// Fails, naming `field`, unless low ≤ value ≤ high; a NaN is outside.
pub(super) fn within(
    field: &'static str,
    value: f64,
    low: f64,
    high: f64,
    allowed: &'static str,
) -> Result<(), PlanError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(PlanError::Input { field, value, allowed })
    }
}

/// Discretisation, budgets and acceptance limits of the planner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Intervals of the relaxed solve.
    pub relaxed_intervals: usize,
    /// Intervals of a burn that a coast follows.
    pub first_burn_intervals: usize,
    /// Intervals of the burn that ends the flight after a coast.
    pub last_burn_intervals: usize,
    /// Intervals of a flight that is one burn.
    pub single_burn_intervals: usize,
    /// Outer iterations of one loop.
    pub outer_max: u32,
    /// Conic solves of one call, over all attempts; what is tried last, free fall or (G.100), has as many again.
    pub solves_max: u32,
    /// Interior-point iterations of one conic solve.
    pub solver_iterations_max: u32,
    /// Whether bounds in closed form may refuse a problem before a solve (G.92, G.93).
    pub bounds: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relaxed_intervals: 25,
            first_burn_intervals: 6,
            last_burn_intervals: 8,
            single_burn_intervals: 12,
            outer_max: 20,
            solves_max: 60,
            solver_iterations_max: 60,
            bounds: true,
        }
    }
}

impl Settings {
    /// Names the first setting outside its range.
    pub fn validate(&self) -> Result<(), PlanError> {
        for (field, intervals) in [
            ("relaxed_intervals", self.relaxed_intervals),
            ("first_burn_intervals", self.first_burn_intervals),
            ("last_burn_intervals", self.last_burn_intervals),
            ("single_burn_intervals", self.single_burn_intervals),
        ] {
            within(field, intervals as f64, 1.0, 100.0, "[1, 100]")?;
        }
        Ok(())
    }
}
