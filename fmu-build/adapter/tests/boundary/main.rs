//! Drives the exported C functions as an importer would.

mod events;
mod fmi2;
mod fuzz;
mod harness;
mod integrator;
mod lifecycle;
mod misuse;
mod panics;
mod states;

fmi_adapter::export!(integrator::Integrator);
