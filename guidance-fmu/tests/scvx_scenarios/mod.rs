//! Reference descents of the planner tests: lunar gravity, a 259.5 kg lander, I_sp 225 s.

// Each test takes what it needs.
#![allow(dead_code)]

pub mod envelope;
pub mod random;

use guidance_fmu::scvx::{EngineState, PathLimits, Problem, Propulsion, Terminal};
use nalgebra::Vector3;

/// From (300, 100, 500) m at (-15, -5, -25) m/s to rest at the origin.
pub fn descent() -> Problem {
    Problem {
        r0_w: Vector3::new(300.0, 100.0, 500.0),
        v0_w: Vector3::new(-15.0, -5.0, -25.0),
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        terminal: Terminal::Point,
        mass_kg: 259.5,
        dry_mass_kg: 174.0,
        gravity_m_s2: 1.625,
        isp_s: 225.0,
        thrust_min_n: 800.0,
        thrust_max_n: 5200.0,
        thrust_rate_max_n_s: None,
        turn: None,
        propulsion: Propulsion::default(),
        engine: EngineState::default(),
        tilt_max_rad: 29_f64.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    }
}

/// The hop: from rest at (200, 0, 5) m to rest at the origin.
pub fn hop() -> Problem {
    Problem { r0_w: Vector3::new(200.0, 0.0, 5.0), v0_w: Vector3::zeros(), ..descent() }
}

/// The descent with limits that leave tracking a margin, to the start of a terminal law.
pub fn flown_descent() -> Problem {
    Problem {
        r_f_w: Vector3::new(0.0, 0.0, 12.0),
        v_f_w: Vector3::new(0.0, 0.0, -8.0),
        thrust_min_n: 900.0,
        thrust_max_n: 2500.0,
        ..descent()
    }
}
