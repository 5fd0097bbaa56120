//! FMI for any [`Component`](lander_models::Component), written once.
//!
//! | file | holds |
//! |---|---|
//! | `variables` | value references, names, the interface token: from the signal table |
//! | `lifecycle` | the states of an instance and the one table of allowed calls |
//! | `instance` | life cycle and steps, free of any FMI version and of `unsafe` |
//! | `values` | its variables: get, set and their checks |
//! | `states` | its stored states |
//! | `snapshot` | an instance's changing part, and the bytes it is serialised to |
//! | `guard` | a panic becomes a message |
//! | `c_abi` | marshals C functions to `Instance`, what both versions share of it |
//! | `fmi2`, `fmi3` | the rest of each version |
//!
//! `unsafe` is in the last two rows only. A leaf cdylib makes the C symbols with [`export!`]. No
//! other crate may: two sets of `fmi3*` symbols in one binary make the linker pick one in silence.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod c_abi;
pub mod error;
pub mod fmi2;
pub mod fmi3;
pub mod guard;
pub mod instance;
pub mod lifecycle;
pub mod logger;
pub mod snapshot;
mod states;
mod values;
pub mod variables;

pub use error::Error;
pub use instance::Instance;
pub use variables::{Variable, Variant, token, variables};
