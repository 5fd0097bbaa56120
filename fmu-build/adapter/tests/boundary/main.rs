//! Drives the exported C functions as an importer would.

mod harness;
mod integrator;
mod lifecycle;
mod misuse;
mod panics;
mod states;

fmi_adapter::export!(integrator::Integrator);
