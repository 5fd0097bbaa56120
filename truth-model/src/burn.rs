//! Mass and propulsion at one instant: within a tick a matter of time alone, whatever the vehicle's
//! motion (T.4 to T.7, T.50, T.51).

use lander_models::Vehicle;
use lander_models::frames::{steiner, symmetric_inverse};
use lander_models::mass::MassProperties;
use nalgebra::{Matrix3, Vector2, Vector3};

use crate::engine::{self, Actuators};
use crate::propulsion::{Drive, Wrench};

#[derive(Clone, Copy, Debug)]
pub struct Burn {
    pub actuators: Actuators,
    pub propellant_kg: f64,
    pub mass: MassProperties,
    pub inverse_inertia_b: Matrix3<f64>,
    /// Of engine, thrusters and what the model leaves out.
    pub driven: Wrench,
    /// Propellant flow of engine, thrusters and leak, kg/s (T.7).
    pub flow_kg_s: f64,
    /// From where the engine's propellant comes to the nozzle's exit, times twice its flow: kg m/s.
    flow_path_b: Vector3<f64>,
    /// What that flow takes of a rate's spin, N m s.
    jet_damping_b: Matrix3<f64>,
}

impl Burn {
    /// Dry tanks feed neither engine nor thrusters, whatever the lag still says.
    #[inline]
    pub fn at(
        vehicle: &Vehicle,
        drive: &Drive,
        actuators: Actuators,
        engine_flow_kg_s: f64,
        propellant_kg: f64,
    ) -> Self {
        let (engine, Actuators { thrust_n, gimbal_rad }) = (&vehicle.engine, actuators);
        let mass = vehicle.mass.at(propellant_kg.max(0.0));
        let mut driven = Wrench { force_b: drive.disturbance_b, torque_b: Vector3::zeros() };
        let (mut flow_kg_s, mut flow_path_b) = (0.0, Vector3::zeros());
        let mut jet_damping_b = Matrix3::zeros();
        if propellant_kg > 0.0 {
            let nozzle_b = engine::thrust_direction_b(gimbal_rad);
            // (T.65)
            let line_b = if drive.pointing_error_rad == Vector2::zeros() {
                nozzle_b
            } else {
                engine::thrust_direction_b(gimbal_rad + drive.pointing_error_rad)
            };
            let thrust_b = line_b * (thrust_n * drive.thrust_factor);
            driven.force_b += thrust_b;
            driven.torque_b = (engine.pivot_b - mass.com_b).cross(&thrust_b) + drive.rcs_torque_b;
            flow_kg_s = engine_flow_kg_s + drive.other_flow_kg_s;
            let draw = vehicle.mass.draw(propellant_kg);
            let exit_b =
                engine.pivot_b - nozzle_b * (engine.pivot_b.z - engine.nozzle_exit_height_m);
            // Uniform flow over the disc, across the body's axis to within the gimbal's few degrees.
            let disc_m2 = 0.25 * engine.nozzle_exit_radius_m * engine.nozzle_exit_radius_m;
            let mut carried_out = steiner(&(exit_b - mass.com_b));
            carried_out.m11 += disc_m2;
            carried_out.m22 += disc_m2;
            carried_out.m33 += 2.0 * disc_m2;
            flow_path_b = (exit_b - draw.centre_b) * (2.0 * engine_flow_kg_s);
            jet_damping_b = (carried_out - draw.inertia_b) * engine_flow_kg_s;
        }
        Self {
            actuators,
            propellant_kg,
            mass,
            // A vehicle file admits only positive moments, so the tensor is invertible.
            inverse_inertia_b: symmetric_inverse(&mass.inertia_b),
            driven,
            flow_kg_s,
            flow_path_b,
            jet_damping_b,
        }
    }

    /// What the main engine's propellant does on its way from the tanks through the nozzle of a
    /// vehicle that turns at `rate_b`, about the centre of mass: Coriolis force, jet damping and the
    /// spin that it leaves behind (T.50, T.51). Other flows leave from where they are and take their
    /// own momentum along.
    #[inline]
    pub fn inside(&self, rate_b: &Vector3<f64>) -> Wrench {
        Wrench { force_b: self.flow_path_b.cross(rate_b), torque_b: -(self.jet_damping_b * rate_b) }
    }
}
