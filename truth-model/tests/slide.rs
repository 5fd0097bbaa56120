//! A slide down a slope with Coulomb friction, against a = g (sin β - μ cos β).
//!
//! The residual of the slides is rounding.

mod common;

use claims::{Bound, Claim};
use common::engines::{ENGINES, name};
use common::{GRAVITY_M_S2, rigid_bug, run};
use lander_models::scenario::ContactEngine;

const SLOPE_DEG: f64 = 30.0;
const FRICTION: f64 = 0.3;

#[test]
fn slide_acceleration_at_three_headings() {
    for engine in ENGINES {
        slide(engine);
    }
}

fn slide(engine: ContactEngine) {
    let mut errors_percent = Vec::new();
    let mut yaws_rad_s = Vec::new();
    for heading_deg in [0.0_f64, 22.5, 45.0] {
        let mut setup = rigid_bug(0.0).on(engine, 1);
        setup.scenario.terrain.friction = FRICTION;
        setup.stand_on_slope(SLOPE_DEG.to_radians(), heading_deg.to_radians());
        let model = setup.model();
        let mut state = model.initial_state();
        // The load settles into the struts within 0.5 s.
        run(&model, &mut state, 0.5);
        let start_m_s = model.com_velocity_w(&state.motion).norm();
        run(&model, &mut state, 3.0);
        let measured = (model.com_velocity_w(&state.motion).norm() - start_m_s) / 3.0;
        let (sin, cos) = SLOPE_DEG.to_radians().sin_cos();
        let expected = GRAVITY_M_S2 * (sin - FRICTION * cos);
        errors_percent.push(100.0 * (measured / expected - 1.0));
        yaws_rad_s.push(state.motion.rate_b.z);
    }
    let engine = name(engine);
    Claim {
        id: &format!("slide-acceleration-{engine}"),
        section: "Contact: sliding",
        claim: &format!(
            "acceleration down 30° at μ = 0.3, headings 0, 22.5 and 45°, {engine} engine"
        ),
        reference: "g (sin β − μ cos β)",
        unit: "%",
        bound: Bound::AtMost(0.5),
        origin: "acceptance list",
        noise: 1e-6,
    }
    .holds_for(errors_percent);
    Claim {
        id: &format!("slide-yaw-{engine}"),
        section: "Contact: sliding",
        claim: &format!("yaw rate that the same slides pick up in 3 s, {engine} engine"),
        reference: "none: no force has a moment",
        unit: "rad/s",
        bound: Bound::AtMost(1e-3),
        origin: "acceptance list; friction without the mass metric yaws by 0.063 rad/s",
        noise: 1e-6,
    }
    .holds_for(yaws_rad_s);
}
