//! Truth models for tests: BUG on a plane, guidance off, one thing changed at a time.
#![allow(dead_code)] // Each test binary uses its own part.

pub mod arrival;
pub mod engines;
pub mod relief;

use lander_models::scenario::Scenario;
use lander_models::vehicle::{Strut, Vehicle};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::{State, TruthModel};

pub const GRAVITY_M_S2: f64 = 1.625;

pub fn bug() -> Vehicle {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/bug.toml");
    Vehicle::load(file.as_ref()).unwrap()
}

/// What a truth model is made from, free to be changed until then.
#[derive(Clone)]
pub struct Setup {
    pub scenario: Scenario,
    pub vehicle: Vehicle,
}

impl Setup {
    pub fn model(&self) -> TruthModel {
        TruthModel::new(self.scenario.clone(), self.vehicle.clone())
    }

    /// Changes the struts of all legs.
    pub fn with_struts(mut self, change: impl Fn(&mut Strut)) -> Self {
        self.vehicle.gear.legs.iter_mut().for_each(|leg| change(&mut leg.strut));
        self
    }

    /// Puts the vehicle on a slope that falls towards world x, standing on it, turned by
    /// `heading_rad` about the slope's normal.
    pub fn stand_on_slope(&mut self, slope_rad: f64, heading_rad: f64) {
        let lean = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope_rad);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
        self.scenario.terrain.slope_rad = slope_rad;
        self.scenario.terrain.downhill_rad = 0.0;
        self.scenario.initial.attitude_wb = lean * turn;
    }
}

/// BUG with its centre of mass on the axis, as the closed forms assume it.
pub fn symmetric_bug() -> Vehicle {
    let mut vehicle = bug();
    vehicle.mass.dry.com_b.x = 0.0;
    vehicle.mass.propellant.com_b.x = 0.0;
    vehicle
}

/// Symmetric BUG on gear that neither crushes nor gives: 1e6 N/m gives 0.1 mm under the whole
/// weight.
pub fn rigid_bug(propellant_kg: f64) -> Setup {
    let mut vehicle = symmetric_bug();
    vehicle.gear.lateral = None;
    on_plane(vehicle, propellant_kg).with_struts(|strut| {
        *strut = Strut {
            stiffness_n_m: 1e6,
            damping_n_s_m: 2e4,
            crush_1_n: 1e9,
            crush_2_n: 1e9,
            ..*strut
        };
    })
}

/// A vehicle at the origin of a level plane, at rest, engine off.
pub fn on_plane(vehicle: Vehicle, propellant_kg: f64) -> Setup {
    let text = include_str!("../../../models/scenarios/tip-over.toml");
    let mut scenario = Scenario::parse("tip-over.toml".as_ref(), text, &vehicle).unwrap();
    scenario.terrain.slope_rad = 0.0;
    scenario.terrain.pads_captured = false;
    scenario.initial.position_w = Vector3::zeros();
    scenario.initial.velocity_w = Vector3::zeros();
    scenario.initial.attitude_wb = UnitQuaternion::identity();
    scenario.initial.propellant_kg = propellant_kg;
    scenario.touchdown.slide_limit_m = 1e3;
    scenario.touchdown.crash_speed_m_s = 1e3;
    scenario.stop_time = lander_models::Ticks(1_000_000);
    Setup { scenario, vehicle }
}

pub fn run(model: &TruthModel, state: &mut State, seconds: f64) {
    for _ in 0..(seconds * 1000.0).round() as u64 {
        model.tick(state).unwrap();
    }
}

/// Runs until the verdict, or at most `seconds`.
pub fn run_to_verdict(model: &TruthModel, state: &mut State, seconds: f64) {
    for _ in 0..(seconds * 1000.0).round() as u64 {
        if model.tick(state).unwrap().terminate {
            return;
        }
    }
}
