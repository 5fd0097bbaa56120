//! Flight against closed forms and conservation laws.

#[path = "../common/mod.rs"]
mod common;
mod jet;
mod powered;
mod slosh;
mod torque_free;

use common::{bug, on_plane};
use lander_models::Vehicle;
use nalgebra::Vector3;
use truth_model::flight::{Motion, advance, free};
use truth_model::propulsion::Drive;

/// BUG at rest 10 km up.
fn aloft(propellant_kg: f64) -> Motion {
    let mut motion = on_plane(bug(), propellant_kg).model().initial_state().motion;
    motion.position_w.z = 1e4;
    motion
}

/// `motion` after `steps` steps under uniform gravity.
fn fly(
    vehicle: &Vehicle,
    motion: &Motion,
    drive: &Drive,
    gravity_m_s2: f64,
    step_s: f64,
    steps: usize,
) -> Motion {
    let gravity_w = Vector3::z() * -gravity_m_s2;
    (0..steps).fold(*motion, |m, _| advance(vehicle, &gravity_w, &m, drive, step_s, free))
}

/// A drive that holds a thrust, and a motion that already has it.
fn burning(motion: &Motion, thrust_n: f64) -> (Motion, Drive) {
    let drive = Drive { thrust_target_n: thrust_n, ..Drive::default() };
    (Motion { thrust_n, ..*motion }, drive)
}
