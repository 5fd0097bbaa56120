//! Touchdowns from a contact state: what flight reports and drop tests give. Guidance off.
#![allow(dead_code)] // Each test binary uses its own part.

use std::path::Path;

use lander_models::Ticks;
use lander_models::component::Component;
use lander_models::scenario::Scenario;
use lander_models::vehicle::Vehicle;
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::{State, TruthModel};

pub const MOON_M_S2: f64 = 1.625;
pub const EARTH_M_S2: f64 = 9.80665;

/// Clearance at which a run starts, m: at 0.5 m/s 20 ms before contact, which adds 3 % of speed on
/// the Moon and is put right by starting slower.
const START_GAP_M: f64 = 0.01;

pub fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/");
    Vehicle::load(Path::new(&format!("{folder}{name}.toml"))).unwrap()
}

/// A lander just above the ground.
#[derive(Clone, Debug)]
pub struct Contact {
    pub vehicle: Vehicle,
    pub gravity_m_s2: f64,
    pub propellant_kg: f64,
    pub friction: f64,
    pub captured: bool,
    /// Falls towards world x.
    pub slope_deg: f64,
    /// Leg 1's direction from world x.
    pub yaw_deg: f64,
    /// Nose-down (towards world x) tilt of the body.
    pub pitch_deg: f64,
    pub down_m_s: f64,
    /// Along world x: downhill on a slope.
    pub across_m_s: f64,
    pub rate_b_deg_s: Vector3<f64>,
    /// Engine's command, held.
    pub thrust_n: f64,
}

impl Contact {
    /// Upright over level ground on the Moon with friction 0.5 and nothing moving.
    pub fn of(vehicle: Vehicle, propellant_kg: f64) -> Self {
        Self {
            vehicle,
            gravity_m_s2: MOON_M_S2,
            propellant_kg,
            friction: 0.5,
            captured: false,
            slope_deg: 0.0,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            down_m_s: 0.0,
            across_m_s: 0.0,
            rate_b_deg_s: Vector3::zeros(),
            thrust_n: 0.0,
        }
    }

    pub fn model(&self) -> TruthModel {
        let bug = vehicle("bug");
        let text = include_str!("../../../models/scenarios/tip-over.toml");
        let mut scenario = Scenario::parse("tip-over.toml".as_ref(), text, &bug).unwrap();
        scenario.gravity_m_s2 = self.gravity_m_s2;
        scenario.terrain.slope_rad = self.slope_deg.to_radians();
        scenario.terrain.friction = self.friction;
        scenario.terrain.pads_captured = self.captured;
        let pitch =
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.pitch_deg.to_radians());
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians());
        let attitude_wb = pitch * yaw;
        let normal_w = scenario.terrain.normal_w();
        let gear = &self.vehicle.gear;
        let lowest_m = gear
            .feet_b
            .iter()
            .map(|foot_b| {
                let centre_b = foot_b + Vector3::z() * gear.pad_radius_m;
                normal_w.dot(&(attitude_wb * centre_b)) - gear.pad_radius_m
            })
            .fold(f64::INFINITY, f64::min);
        let fall_m = START_GAP_M / normal_w.z;
        // The engine is off during the fall, or has its thrust: either way it is short.
        let down_m_s = (self.down_m_s.powi(2) - 2.0 * self.gravity_m_s2 * fall_m).max(0.0).sqrt();
        scenario.initial.position_w = Vector3::z() * ((START_GAP_M - lowest_m) / normal_w.z);
        scenario.initial.velocity_w = Vector3::new(self.across_m_s, 0.0, -down_m_s);
        scenario.initial.attitude_wb = attitude_wb;
        scenario.initial.rate_b = self.rate_b_deg_s.map(f64::to_radians);
        scenario.initial.propellant_kg = self.propellant_kg;
        scenario.touchdown.crash_speed_m_s = 1e3;
        scenario.touchdown.slide_limit_m = 1e3;
        scenario.stop_time = Ticks(1_000_000);
        TruthModel::new(scenario, self.vehicle.clone())
    }

    /// Runs until the verdict or for `seconds`, `each` looking after every tick.
    pub fn run(&self, seconds: f64, mut each: impl FnMut(&TruthModel, &State)) -> State {
        let model = self.model();
        let mut state = model.initial_state();
        state.motion.thrust_n = self.thrust_n;
        let commands = [self.thrust_n, 0.0, 0.0, 0.0, 0.0, 0.0];
        for _ in 0..(seconds * 1000.0).round() as u64 {
            let report = model.step(&mut state, &commands, Ticks(1)).unwrap();
            each(&model, &state);
            if report.terminate {
                break;
            }
        }
        state
    }
}
