use guidance_fmu::six_dof::*;
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};
fn main() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    let vehicle = Vehicle::load(file.as_ref()).unwrap();
    let structure = match std::env::args().nth(1).as_deref() { Some("offon") => Some(guidance_fmu::scvx::Structure::OffOn), _ => None };
    let free = std::env::args().nth(2).is_some();
    let problem = SixDofProblem {
        mass: vehicle.mass.clone(),
        start: Start { propellant_kg: 85.5, r_w: Vector3::new(300.0, 100.0, 500.0), v_w: Vector3::new(-15.0, -5.0, -25.0),
            attitude_wb: (!free).then(UnitQuaternion::identity), rate_b: Vector3::zeros() },
        r_f_w: Vector3::zeros(), v_f_w: Vector3::zeros(), gravity_m_s2: 1.625,
        actuators: Actuators::of(&vehicle),
        limits: Limits { tilt_max_rad: 29_f64.to_radians(), rate_max_rad_s: 0.8, glide_slope_rad: None, end_tilt_max_rad: 1_f64.to_radians(), end_rate_max_rad_s: 1_f64.to_radians() },
    };
    let p = solve(&problem, &SixDofSettings { structure, ..Default::default() }).unwrap();
    println!("{:.4} kg {:#?}", p.propellant_kg(), p.report);
}
