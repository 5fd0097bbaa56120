//! The touchdowns that are timed, and their finer twins.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use lander_models::frames::tilt_rad;
use lander_models::scenario::{ContactEngine, Scenario};
use lander_models::time::Ticks;
use lander_models::vehicle::Vehicle;
use truth_model::{State, TruthModel};

/// A touchdown from just above the ground, engine off. Angles in degrees, speeds in m/s; the slope
/// falls towards x, the way the vehicle goes.
pub struct Case {
    pub name: &'static str,
    pub down_m_s: f64,
    pub across_m_s: f64,
    pub slope_deg: f64,
    pub friction: f64,
    pub captured: bool,
}

pub const CASES: [Case; 4] = [
    Case {
        name: "nominal, level",
        down_m_s: 1.0,
        across_m_s: 0.3,
        slope_deg: 0.0,
        friction: 0.6,
        captured: false,
    },
    Case {
        name: "12° slope",
        down_m_s: 1.5,
        across_m_s: 0.5,
        slope_deg: 12.0,
        friction: 0.6,
        captured: false,
    },
    Case {
        name: "captured, 2 m/s across",
        down_m_s: 1.0,
        across_m_s: 2.0,
        slope_deg: 0.0,
        friction: 0.6,
        captured: true,
    },
    Case {
        name: "sliding, μ 0.2",
        down_m_s: 1.5,
        across_m_s: 1.5,
        slope_deg: 0.0,
        friction: 0.2,
        captured: false,
    },
];

pub const PROPELLANT_KG: f64 = 5.0;
pub const GRAVITY_M_S2: f64 = 1.625;

/// How a touchdown ended, to be compared.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    pub place_w: nalgebra::Vector3<f64>,
    pub tilt_deg: f64,
    pub stroke_m: f64,
}

impl Rest {
    pub fn of(state: &State) -> Self {
        Self {
            place_w: state.motion.position_w,
            tilt_deg: tilt_rad(&state.motion.attitude_wb).to_degrees(),
            stroke_m: state.touchdown.peak_stroke_m,
        }
    }
}

/// The case for BUG, just clear of the ground.
pub fn model(
    vehicle: &Vehicle,
    case: &Case,
    engine: ContactEngine,
) -> Result<TruthModel, Box<dyn Error>> {
    let mut scenario = Scenario::parse(Path::new(case.name), &scenario_text(case), vehicle)?;
    scenario.contact_engine = engine;
    scenario.stop_time = Ticks(20_000);
    let probe = TruthModel::new(scenario.clone(), vehicle.clone());
    let short_m = 2e-3 - probe.lowest_m(&probe.initial_state());
    scenario.initial.position_w.z += short_m / scenario.terrain.slope_rad.cos();
    Ok(TruthModel::new(scenario, vehicle.clone()))
}

fn scenario_text(case: &Case) -> String {
    let pads = if case.captured { "captured" } else { "sliding" };
    let Case { name, down_m_s, across_m_s, slope_deg, friction, .. } = case;
    format!(
        "name = \"{name}\"\nvehicle = \"bug.toml\"\n\
         [site]\ngravity = {{ value = {GRAVITY_M_S2}, unit = \"m/s2\" }}\n\
         [terrain]\npads = \"{pads}\"\n\
         slope = {{ value = {slope_deg}, unit = \"deg\" }}\n\
         friction = {{ value = {friction}, unit = \"1\" }}\n\
         [initial]\nposition_w = {{ value = [0.0, 0.0, 0.0], unit = \"m\" }}\n\
         velocity_w = {{ value = [{across_m_s}, 0.0, {}], unit = \"m/s\" }}\n\
         roll_pitch_yaw = {{ value = [0.0, 0.0, 0.0], unit = \"deg\" }}\n\
         rate_b = {{ value = [0.0, 0.0, 0.0], unit = \"deg/s\" }}\n\
         propellant = {{ value = {PROPELLANT_KG}, unit = \"kg\" }}\n\
         [guidance]\nmode = \"off\"\ntarget_w = {{ value = [0.0, 0.0, 0.0], unit = \"m\" }}\n\
         [touchdown]\ncrash_speed = {{ value = 1000.0, unit = \"m/s\" }}\n\
         slide_limit = {{ value = 1000.0, unit = \"m\" }}\n\
         [run]\nstop_time = {{ value = 20.0, unit = \"s\" }}\n",
        -down_m_s
    )
}

/// The cases as the table that `touchdown_cosim.bench_mujoco` reads.
pub fn csv() -> String {
    let mut text = "propellant_kg,gravity_m_s2,down_m_s,across_m_s,travel_deg,roll_deg,pitch_deg,\
                    yaw_deg,rate_x_deg_s,rate_y_deg_s,rate_z_deg_s,slope_deg,downhill_deg,friction,\
                    captured\n"
        .to_owned();
    for case in &CASES {
        let Case { down_m_s, across_m_s, slope_deg, friction, captured, .. } = case;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{PROPELLANT_KG},{GRAVITY_M_S2},{down_m_s},{across_m_s},0,0,0,0,0,0,0,{slope_deg},0,\
             {friction},{}",
            u8::from(*captured)
        );
    }
    text
}

/// `scale` times as large a lander under a gravity as much smaller: speeds are equal and times
/// grow by the scale, so that a step is `scale` times as fine (Froude). What a pad's spring and a
/// foot's inertia add shrinks with it.
pub fn larger(model: &TruthModel, scale: f64) -> TruthModel {
    let (mut scenario, mut vehicle) = (model.scenario().clone(), model.vehicle().clone());
    scenario.gravity_m_s2 /= scale;
    scenario.initial.position_w *= scale;
    scenario.stop_time = Ticks((scenario.stop_time.0 as f64 * scale) as u64);
    let (dry, fuel) = (&mut vehicle.mass.dry, &mut vehicle.mass.propellant);
    // Mass is free under Froude's scaling; kept, it leaves forces smaller by the scale.
    dry.com_b *= scale;
    dry.inertia_kg_m2 *= scale * scale;
    fuel.com_b *= scale;
    fuel.gyration_radius_b *= scale;
    for length_m in [
        &mut vehicle.hull.radius_m,
        &mut vehicle.hull.bottom_height_m,
        &mut vehicle.hull.top_height_m,
        &mut vehicle.engine.nozzle_exit_radius_m,
        &mut vehicle.engine.nozzle_exit_height_m,
        &mut vehicle.engine.pivot_b.z,
        &mut vehicle.gear.pad_radius_m,
        &mut vehicle.gear.bearing_radius_m,
    ] {
        *length_m *= scale;
    }
    for leg in &mut vehicle.gear.legs {
        leg.foot_b *= scale;
        leg.strut.stiffness_n_m /= scale * scale;
        leg.strut.damping_n_s_m /= scale;
        leg.strut.crush_1_n /= scale;
        leg.strut.crush_2_n /= scale;
        leg.strut.stroke_1_m *= scale;
        leg.strut.stroke_max_m *= scale;
    }
    TruthModel::new(scenario, vehicle)
}
