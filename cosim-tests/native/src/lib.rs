//! The co-simulation's native side: one master, one recorder, one verdict.
//!
//! The FMPy master sends its rows to the same recorder through `lander record`, so two runs
//! with equal rows leave equal files whoever produced them.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod csv;
pub mod descents;
pub mod failures;
pub mod flight;
pub mod landing;
pub mod layout;
pub mod map;
pub mod master;
pub mod paper;
pub mod progress;
pub mod recorder;
pub mod relief;
pub mod replay;
pub mod report;
pub mod results;
pub mod scene;
pub mod schedule;
pub mod statistics;
pub mod study;
pub mod svg;
pub mod telemetry;
pub mod touchdowns;
pub mod urdf;
pub mod verdict;
pub mod whole_file;
