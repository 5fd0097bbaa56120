//! The truth: a lander in powered flight and in contact, and what became of it.
//!
//! Plain library: no FMI, no output, no clock, no threads. Equations (T.n) in the README.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod burn;
pub mod contact;
pub mod disturbances;
pub mod engine;
pub mod faults;
pub mod flight;
pub mod gear;
pub mod propulsion;
pub mod rcs;
pub mod sensors;
pub mod slosh;
pub mod stability;
pub mod terrain;
pub mod verdict;

mod model;
mod outputs;
mod sight;

pub use lander_models::random;
pub use model::{State, TruthModel};
