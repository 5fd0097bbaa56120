//! Touchdowns from a contact state, as flight reports and drop tests give them. Guidance off.

use std::path::Path;

use lander_models::component::{Component, Settings};
use lander_models::frames::tilt_rad;
use lander_models::scenario::ContactEngine;
use lander_models::vehicle::Vehicle;
use lander_models::{Outcome, Ticks};
use nalgebra::{UnitQuaternion, Vector3};
use truth_model::{State, TruthModel};

use super::{GRAVITY_M_S2, Setup, bug, on_plane};

pub const EARTH_M_S2: f64 = 9.80665;
/// Clearance at which a run starts. The speed gained over it is taken off beforehand.
const START_GAP_M: f64 = 0.01;

pub fn vehicle(name: &str) -> Vehicle {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/vehicles/");
    Vehicle::load(Path::new(&format!("{folder}{name}.toml"))).unwrap()
}

/// A lander at the moment before contact. World x points downhill.
#[derive(Clone, Debug)]
pub struct Arrival {
    pub vehicle: Vehicle,
    pub gravity_m_s2: f64,
    pub engine: ContactEngine,
    /// Contact steps a tick.
    pub refinement: u32,
    pub propellant_kg: f64,
    pub friction: f64,
    pub slope_deg: f64,
    /// Turn of the body about its own axis: 0 has leg 1 in front (1-2-1), 45 two of four (2-2).
    pub yaw_deg: f64,
    /// Tilt of the body's axis towards world x.
    pub pitch_deg: f64,
    pub down_m_s: f64,
    /// Towards world x.
    pub across_m_s: f64,
    pub rate_b_deg_s: Vector3<f64>,
    /// Held to the end.
    pub thrust_n: f64,
}

/// What became of an arrival.
pub struct Landing {
    pub state: State,
    /// Times at which the ground was felt after no pad had felt it.
    pub contacts: Vec<Ticks>,
    /// Highest clearance of the lowest point after first contact, m.
    pub rebound_m: f64,
    /// Largest rates about the body's axes after first contact.
    pub peak_rate_b_deg_s: Vector3<f64>,
    /// Last time at which the vehicle turned faster than 1 deg/s, after first contact, s.
    pub settling_s: f64,
}

impl Arrival {
    /// Upright over level ground on the Moon, friction 0.5, engine off, not moving.
    pub fn of(vehicle: Vehicle, propellant_kg: f64) -> Self {
        Self {
            vehicle,
            gravity_m_s2: GRAVITY_M_S2,
            engine: ContactEngine::Rapier,
            refinement: 1,
            propellant_kg,
            friction: 0.5,
            slope_deg: 0.0,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            down_m_s: 0.0,
            across_m_s: 0.0,
            rate_b_deg_s: Vector3::zeros(),
            thrust_n: 0.0,
        }
    }

    pub fn setup(&self) -> Setup {
        // BUG only lends the scenario: its initial state is replaced whole.
        let mut scenario = on_plane(bug(), 0.0).scenario;
        scenario.gravity_m_s2 = self.gravity_m_s2;
        scenario.contact_engine = self.engine;
        scenario.contact_refinement = self.refinement;
        scenario.terrain.slope_rad = self.slope_deg.to_radians();
        scenario.terrain.downhill_rad = 0.0;
        scenario.terrain.friction = self.friction;
        let pitch =
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.pitch_deg.to_radians());
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians());
        let (sin, cos) = self.slope_deg.to_radians().sin_cos();
        let normal_w = Vector3::new(sin, 0.0, cos);
        let radius_m = self.vehicle.gear.pad_radius_m;
        let lowest_m = (self.vehicle.gear.feet_b())
            .map(|foot_b| normal_w.dot(&(pitch * yaw * (foot_b + Vector3::z() * radius_m))))
            .fold(f64::INFINITY, f64::min)
            - radius_m;
        let mass_kg = self.vehicle.mass.at(self.propellant_kg).mass_kg;
        let acceleration_m_s2 = self.gravity_m_s2 - self.thrust_n / mass_kg;
        let gained_m2_s2 = 2.0 * acceleration_m_s2 * START_GAP_M / cos;
        let start = &mut scenario.initial;
        start.position_w = Vector3::z() * ((START_GAP_M - lowest_m) / cos);
        let down_m_s = (self.down_m_s.powi(2) - gained_m2_s2).max(0.0).sqrt();
        start.velocity_w = Vector3::new(self.across_m_s, 0.0, -down_m_s);
        start.attitude_wb = pitch * yaw;
        start.rate_b = self.rate_b_deg_s.map(f64::to_radians);
        start.propellant_kg = self.propellant_kg;
        Setup { scenario, vehicle: self.vehicle.clone() }
    }

    /// Lands, until the verdict or for `seconds`.
    pub fn land(&self, seconds: f64) -> Landing {
        self.land_with(seconds, |_| Vector3::zeros())
    }

    /// As `land`, with attitude torques, N m.
    pub fn land_with(&self, seconds: f64, torque_b: impl Fn(&State) -> Vector3<f64>) -> Landing {
        let model = self.setup().model();
        let mut state = model.initial_state();
        state.motion.thrust_n = self.thrust_n;
        Landing::of(&model, state, seconds, |state| {
            let torque_b = torque_b(state);
            [self.thrust_n, 0.0, 0.0, torque_b.x, torque_b.y, torque_b.z]
        })
    }
}

impl Landing {
    /// Runs a scenario file of the kit without commands.
    pub fn of_scenario(name: &str) -> Self {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/scenarios/");
        let settings = Settings { scenario_file: format!("{folder}{name}.toml").into() };
        let (model, state) = TruthModel::create(&settings).unwrap();
        Self::of(&model, state, f64::INFINITY, |_| [0.0; 6])
    }

    /// Runs until the verdict or for `seconds`.
    pub fn of(
        model: &TruthModel,
        state: State,
        seconds: f64,
        command: impl Fn(&State) -> [f64; 6],
    ) -> Self {
        let mut landing = Self {
            state,
            contacts: Vec::new(),
            rebound_m: 0.0,
            peak_rate_b_deg_s: Vector3::zeros(),
            settling_s: 0.0,
        };
        let mut decided = false;
        while !decided && landing.state.now.seconds() < seconds {
            let state = &mut landing.state;
            let was_down = state.feet_down.contains(&true);
            let command = command(state);
            decided = model.step(state, &command, Ticks(1)).unwrap().terminate;
            if state.feet_down.contains(&true) && !was_down {
                landing.contacts.push(state.now);
            }
            landing.look(model);
        }
        landing
    }

    fn look(&mut self, model: &TruthModel) {
        let Some(first) = self.contacts.first() else { return };
        let rate_b_deg_s = self.state.motion.rate_b.map(f64::to_degrees);
        self.rebound_m = self.rebound_m.max(model.lowest_m(&self.state));
        self.peak_rate_b_deg_s = self.peak_rate_b_deg_s.sup(&rate_b_deg_s.abs());
        if rate_b_deg_s.norm() > 1.0 {
            self.settling_s = Ticks(self.state.now.0 - first.0).seconds();
        }
    }

    pub fn overturned(&self) -> bool {
        self.state.touchdown.outcome == Outcome::Tipped
    }

    pub fn tilt_deg(&self) -> f64 {
        tilt_rad(&self.state.motion.attitude_wb).to_degrees()
    }

    /// For tables: landed, struck or bottomed, tipped, or still settling when the time was up (on two legs
    /// across, which takes long on a level plane).
    pub fn letter(&self) -> char {
        match self.state.touchdown.outcome {
            Outcome::Landed => '.',
            Outcome::Struck | Outcome::Bottomed => 's',
            Outcome::Tipped => 'T',
            Outcome::InFlight => 'r',
            other => panic!("no such end in these tests: {other:?}"),
        }
    }
}
