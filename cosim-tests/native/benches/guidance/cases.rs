//! The descents that are planned, for this planner and for its peers alike.

use guidance_fmu::scvx::{EngineState, PathLimits, Problem, Propulsion, Settings, Terminal};
use nalgebra::Vector3;

/// Intervals of a flight on one grid.
pub const INTERVALS: usize = 30;

/// One problem and the planner's mode.
pub struct Case {
    pub scenario: &'static str,
    pub mode: Mode,
    pub problem: Problem,
}

impl Case {
    pub fn name(&self) -> String {
        let tilt_deg = self.problem.tilt_max_rad.to_degrees();
        format!("{} {tilt_deg:.0}° {}", self.scenario, self.mode.name())
    }
}

/// What the engine may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Never off, above its floor.
    AlwaysOn,
    /// No floor, on the same grid.
    Relaxed,
    /// Off or above its floor, switching when it wants.
    OnOff,
}

impl Mode {
    pub fn name(self) -> &'static str {
        match self {
            Self::AlwaysOn => "always on",
            Self::Relaxed => "relaxed",
            Self::OnOff => "on/off",
        }
    }

    pub fn settings(self) -> Settings {
        let one_burn = Settings {
            relaxed_intervals: INTERVALS,
            single_burn_intervals: INTERVALS,
            ..Settings::default()
        };
        match self {
            Self::AlwaysOn | Self::Relaxed => one_burn,
            Self::OnOff => Settings::default(),
        }
    }
}

/// A from 500 m in flight, B a hop from rest; 259.5 kg, 225 s, 800 to 5200 N, lunar gravity.
fn problem(hop: bool, mode: Mode, tilt_max_deg: f64) -> Problem {
    let (r0_w, v0_w, slope_deg) = if hop {
        // The hop starts 1.4° above the horizon of its target.
        (Vector3::new(200.0, 0.0, 5.0), Vector3::zeros(), 89.5_f64)
    } else {
        (Vector3::new(300.0, 100.0, 500.0), Vector3::new(-15.0, -5.0, -25.0), 60.0)
    };
    Problem {
        r0_w,
        v0_w,
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        terminal: Terminal::Point,
        mass_kg: 259.5,
        dry_mass_kg: 174.0,
        gravity_m_s2: 1.625,
        isp_s: 225.0,
        thrust_min_n: if mode == Mode::Relaxed { 0.0 } else { 800.0 },
        thrust_max_n: 5200.0,
        thrust_rate_max_n_s: None,
        turn: None,
        propulsion: if mode == Mode::OnOff { Propulsion::default() } else { Propulsion::AlwaysOn },
        engine: EngineState::default(),
        tilt_max_rad: tilt_max_deg.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits { glide_slope_rad: Some(slope_deg.to_radians()), altitude_min_m: None },
    }
}

pub fn all() -> Vec<Case> {
    let case = |hop, mode, tilt_max_deg| Case {
        scenario: if hop { "B" } else { "A" },
        mode,
        problem: problem(hop, mode, tilt_max_deg),
    };
    let modes = [(Mode::AlwaysOn, 60.0), (Mode::Relaxed, 29.0), (Mode::OnOff, 29.0)];
    modes.iter().flat_map(|&(mode, tilt)| [false, true].map(|hop| case(hop, mode, tilt))).collect()
}
