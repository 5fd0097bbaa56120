//! What the vehicle is, and what the two halves of the co-simulation say to each other.
//!
//! `truth-model` and `guidance-fmu` depend on this crate and never on each other.
//! Everything here is data and definitions: no physics, no guidance, no FMI.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod changes;
pub mod component;
pub mod frames;
pub mod heightmap;
pub mod mass;
pub mod math;
pub mod outcome;
pub mod quantity;
pub mod random;
mod ranges;
pub mod scenario;
pub mod signals;
pub mod time;
pub mod vehicle;

pub use component::{Component, ModelError, Settings, StepReport};
pub use outcome::Outcome;
pub use quantity::ConfigError;
pub use scenario::Scenario;
pub use time::Ticks;
pub use vehicle::Vehicle;
