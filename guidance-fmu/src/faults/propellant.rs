//! Propellant: mass told against mass spent (G.86).

use lander_models::vehicle::G0_M_S2;
use serde::{Deserialize, Serialize};

use super::Evidence;

/// Loss that declares a leak, kg/s: five deviations of the paper's I_sp error, 2 %, at the ceiling's
/// flow of 2.4 kg/s.
const LEAK_KG_S: f64 = 0.25;
/// Memory of the loss, s: the thrusters' pulses, 6 g each, average out.
const MEMORY_S: f64 = 0.5;

/// Flow that neither thrust nor torque explains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PropellantWatch {
    mass_kg: Option<f64>,
    seen_s: f64,
    loss_kg_s: f64,
    leaking: bool,
}

impl PropellantWatch {
    pub fn leaking(&self) -> bool {
        self.leaking
    }

    /// Propellant lost without thrust, kg/s.
    pub fn loss_kg_s(&self) -> f64 {
        self.loss_kg_s.max(0.0)
    }

    pub fn observe(&mut self, evidence: &Evidence) {
        let Evidence { vehicle, nav, rcs_torque_b, duration, .. } = evidence;
        if !evidence.perfect {
            return;
        }
        let mass_kg = nav.mass.mass_kg;
        let Some(before_kg) = self.mass_kg.replace(mass_kg) else { return };
        let Some(force_b) = nav.specific_force_b else { return };
        if nav.any_foot_down {
            return;
        }
        let step_s = duration.seconds();
        let rcs = &vehicle.rcs;
        let thrust_kg_s = force_b.norm() * mass_kg / (vehicle.engine.isp_s * G0_M_S2);
        let rcs_kg_s = rcs_torque_b.abs().sum() / (rcs.lever_arm_m * rcs.isp_s * G0_M_S2);
        let loss_kg_s = (before_kg - mass_kg) / step_s - thrust_kg_s - rcs_kg_s;
        self.seen_s += step_s;
        let gain = step_s / self.seen_s.min(MEMORY_S).max(step_s);
        self.loss_kg_s += gain * (loss_kg_s - self.loss_kg_s);
        self.leaking |= self.seen_s > MEMORY_S && self.loss_kg_s > LEAK_KG_S;
    }
}
