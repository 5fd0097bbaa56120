//! A slide down a slope with Coulomb friction, against a = g (sin β - μ cos β).
//!
//! Tolerance 0.5 %: the project's acceptance list; the residual is rounding, near 1e-8 %.

mod common;

use common::{GRAVITY_M_S2, rigid_bug, run};

const SLOPE_DEG: f64 = 30.0;
const FRICTION: f64 = 0.3;

#[test]
fn slide_acceleration_at_three_headings() {
    for heading_deg in [0.0_f64, 22.5, 45.0] {
        let mut setup = rigid_bug(0.0);
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
        let error = measured / expected - 1.0;
        let yaw_rad_s = state.motion.rate_b.z.abs();
        println!(
            "heading {heading_deg}°: error {:.1e} %, yaw {yaw_rad_s:.1e} rad/s",
            100.0 * error
        );
        assert!(error.abs() < 5e-3, "heading {heading_deg}°: {measured} m/s², not {expected}");
        // Friction without the mass metric yaws by 0.063 rad/s here: two decades above.
        assert!(yaw_rad_s < 1e-3, "heading {heading_deg}°: spurious yaw {yaw_rad_s} rad/s");
    }
}
