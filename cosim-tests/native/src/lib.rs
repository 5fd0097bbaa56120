//! The co-simulation's native side: one master, one recorder, one verdict.
//!
//! The FMPy master sends its rows to the same recorder through `lander record`, so two runs
//! with equal rows leave equal files whoever produced them.

pub mod binomial;
pub mod descents;
pub mod failures;
pub mod landing;
pub mod layout;
pub mod master;
pub mod progress;
pub mod recorder;
pub mod results;
pub mod scene;
pub mod schedule;
pub mod telemetry;
pub mod touchdowns;
pub mod verdict;
