//! What the failure modes do to propulsion (T.71 to T.74). Each acts from its onset on.

use lander_models::Ticks;
use lander_models::scenario::{Faults, NozzleErosion, RcsStuck, ResetCommands};
use lander_models::vehicle::Engine;
use nalgebra::Vector2;

use crate::propulsion::Command;

/// What the modes past their onset leave of propulsion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damage {
    /// Actuators have power.
    pub powered: bool,
    /// The main valves can open.
    pub engine_valves: bool,
    pub gimbal_free: bool,
    pub rcs_stuck: Option<RcsStuck>,
    /// Delivered thrust, relative.
    pub thrust_factor: f64,
    pub isp_factor: f64,
    pub pointing_rad: Vector2<f64>,
    pub leak_kg_s: f64,
}

impl Damage {
    pub const NONE: Self = Self {
        powered: true,
        engine_valves: true,
        gimbal_free: true,
        rcs_stuck: None,
        thrust_factor: 1.0,
        isp_factor: 1.0,
        pointing_rad: Vector2::new(0.0, 0.0),
        leak_kg_s: 0.0,
    };

    pub fn at(faults: &Faults, engine: &Engine, now: Ticks) -> Self {
        let mut damage = Self::NONE;
        damage.engine_valves = faults.engine_shutoff.is_none_or(|fault| now < fault.onset);
        damage.gimbal_free = faults.gimbal_seizure.is_none_or(|fault| now < fault.onset);
        damage.rcs_stuck = faults.rcs_stuck.filter(|fault| now >= fault.onset);
        if let Some(fault) = faults.power_brownout {
            damage.powered = !during(now, fault.onset, fault.duration);
        }
        if let Some(fault) = faults.thrust_degradation.filter(|fault| now >= fault.onset) {
            damage.thrust_factor *= 1.0 - fault.fraction;
        }
        if let Some(fault) = faults.propellant_leak.filter(|fault| now >= fault.onset) {
            damage.leak_kg_s = fault.flow_kg_s; // (T.71)
        }
        if let Some(fault) = faults.nozzle_erosion.filter(|fault| now >= fault.onset) {
            let elapsed_s = Ticks(now.0 - fault.onset.0).seconds();
            let factor = erosion_factor(engine, &fault, elapsed_s);
            damage.thrust_factor *= factor;
            damage.isp_factor *= factor;
            damage.pointing_rad.x += fault.pointing_rate_rad_s * elapsed_s;
        }
        damage
    }
}

/// The command that reaches the actuators: `last` is the one in force before.
pub fn command_in_force(faults: &Faults, now: Ticks, asked: &Command, last: &Command) -> Command {
    match faults.computer_reset {
        Some(fault) if faults.computer_resets(now) => match fault.commands {
            ResetCommands::Zero => Command::default(),
            ResetCommands::Held => *last,
        },
        _ => *asked,
    }
}

fn during(now: Ticks, onset: Ticks, duration: Ticks) -> bool {
    now >= onset && now < onset + duration
}

/// Thrust and I_sp of a nozzle with a widened throat, relative: flow and c* stay, so both follow
/// the thrust coefficient (T.74).
fn erosion_factor(engine: &Engine, fault: &NozzleErosion, elapsed_s: f64) -> f64 {
    let (ratio, gamma) = (engine.expansion_ratio, engine.heat_capacity_ratio);
    // The throat can't outgrow the exit.
    let eroded = (ratio / (1.0 + fault.rate_s * elapsed_s)).max(1.0);
    vacuum_thrust_coefficient(eroded, gamma) / vacuum_thrust_coefficient(ratio, gamma)
}

/// Thrust coefficient in vacuum of an ideal nozzle with area ratio `expansion_ratio` (T.73).
pub fn vacuum_thrust_coefficient(expansion_ratio: f64, gamma: f64) -> f64 {
    let mach = exit_mach(expansion_ratio, gamma);
    let stagnation = 1.0 + 0.5 * (gamma - 1.0) * mach * mach;
    expansion_ratio * (1.0 + gamma * mach * mach) * libm::pow(stagnation, -gamma / (gamma - 1.0))
}

/// Supersonic Mach number at an area ratio (T.72), by bisection.
fn exit_mach(expansion_ratio: f64, gamma: f64) -> f64 {
    let area_ratio = |mach: f64| {
        let stagnation = 1.0 + 0.5 * (gamma - 1.0) * mach * mach;
        libm::pow(2.0 / (gamma + 1.0) * stagnation, 0.5 * (gamma + 1.0) / (gamma - 1.0)) / mach
    };
    let (mut low, mut high) = (1.0, 2.0);
    while area_ratio(high) < expansion_ratio {
        high *= 2.0;
    }
    // 52 halvings reach the last bit of a number near 1.
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if area_ratio(middle) < expansion_ratio { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thrust_coefficients_are_those_of_the_textbook_s_other_form() {
        for gamma in [1.15, 1.2_f64, 1.3] {
            let ceiling_squared = 2.0 * gamma * gamma / (gamma - 1.0)
                * (2.0 / (gamma + 1.0)).powf((gamma + 1.0) / (gamma - 1.0));
            for ratio in [1.5, 5.0, 30.0, 200.0] {
                let mach = exit_mach(ratio, gamma);
                let pressure =
                    (1.0 + 0.5 * (gamma - 1.0) * mach * mach).powf(-gamma / (gamma - 1.0));
                // Sutton and Biblarz, eq. 3-30 with no pressure outside.
                let expected = (ceiling_squared * (1.0 - pressure.powf((gamma - 1.0) / gamma)))
                    .sqrt()
                    + pressure * ratio;
                let given = vacuum_thrust_coefficient(ratio, gamma);
                // The Mach number's last bit, magnified by powers up to ten.
                assert!((given / expected - 1.0).abs() < 1e-12, "{ratio}, {gamma}: {given}");
            }
        }
    }
}
