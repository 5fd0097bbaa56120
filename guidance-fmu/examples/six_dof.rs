//! Plans the reference descent in six degrees of freedom, from upright to upright, and prints it.

use std::error::Error;

use guidance_fmu::six_dof::{Actuators, Limits, SixDofProblem, SixDofSettings, Start, solve};
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};

fn main() -> Result<(), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref())?;
    let problem = SixDofProblem {
        start: Start {
            propellant_kg: 85.5,
            r_w: Vector3::new(300.0, 100.0, 500.0),
            v_w: Vector3::new(-15.0, -5.0, -25.0),
            attitude_wb: Some(UnitQuaternion::identity()),
            rate_b: Vector3::zeros(),
        },
        r_f_w: Vector3::zeros(),
        v_f_w: Vector3::zeros(),
        gravity_m_s2: 1.625,
        actuators: Actuators::of(&vehicle),
        limits: Limits {
            tilt_max_rad: 29_f64.to_radians(),
            rate_max_rad_s: 0.8,
            glide_slope_rad: None,
            end_tilt_max_rad: 1_f64.to_radians(),
            end_rate_max_rad_s: 1_f64.to_radians(),
        },
        mass: vehicle.mass,
    };
    let plan = solve(&problem, &SixDofSettings::default())?;
    println!("{:.2} s, {:.4} kg, {:#?}", plan.duration_s(), plan.propellant_kg(), plan.report);
    for node in &plan.nodes {
        let (r, v, w) = (node.r_w, node.v_w, node.rate_b.map(f64::to_degrees));
        let control = plan.control(node.t_s);
        print!("{:6.2} s  r {:7.2} {:7.2} {:7.2} m", node.t_s, r.x, r.y, r.z);
        print!("  v {:6.2} {:6.2} {:6.2} m/s", v.x, v.y, v.z);
        print!("  tilt {:5.2}°", node.tilt_rad().to_degrees());
        print!("  rates {:6.2} {:6.2} {:6.2} °/s", w.x, w.y, w.z);
        print!("  T {:5.0} N", control.thrust_n);
        println!("  gimbal {:5.2}°", control.gimbal_tan.norm().atan().to_degrees());
    }
    Ok(())
}
