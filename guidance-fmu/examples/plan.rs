//! Plans the reference descent of the README and prints it.

use guidance_fmu::scvx::{PathLimits, PlanError, Problem, Propulsion, Settings, Terminal, solve};
use nalgebra::Vector3;

fn main() -> Result<(), PlanError> {
    let descent = Problem {
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
        propulsion: Propulsion::OnOff { on_min_s: 0.2, off_min_s: 0.2, restarts_max: 1 },
        engine: Default::default(),
        tilt_max_rad: 29_f64.to_radians(),
        final_tilt: None,
        reserve: None,
        path: PathLimits::default(),
    };
    let plan = solve(&descent, &Settings::default())?;
    println!("{:?}, {:.2} s, {:.5} kg", plan.structure, plan.duration_s(), plan.propellant_kg());
    println!("{:#?}", plan.report);
    for node in &plan.nodes {
        let (r, v, thrust_n) = (node.r_w, node.v_w, plan.sample(node.t_s).thrust_n);
        print!("{:7.3} s  r {:8.2} {:8.2} {:8.2} m", node.t_s, r.x, r.y, r.z);
        println!("  v {:7.2} {:7.2} {:7.2} m/s  T {thrust_n:6.0} N", v.x, v.y, v.z);
    }
    Ok(())
}
