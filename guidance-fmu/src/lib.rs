//! The guidance FMU's content: planning, tracking, attitude control, cut-off.
//!
//! [`scvx`] is the planner, usable alone; [`six_dof`] plans for the rigid body and is not flown. The
//! rest flies the plans of `scvx`. Plain library: no FMI, no output, no clock, no threads. Equations
//! (G.n) in the README.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod navigation;
pub mod scvx;
pub mod six_dof;

mod attitude;
mod descent;
mod disturbance;
mod faults;
mod guard;
mod mission;
mod model;
mod planning;

// The reference problems of the integration tests, which know this crate by its name.
#[cfg(test)]
extern crate self as guidance_fmu;
#[cfg(test)]
#[path = "../tests/scvx_scenarios/mod.rs"]
mod scenarios;

pub use mission::{Goal, Phase};
pub use model::{Guidance, State};
pub use planning::TURN_RAD_S;
