//! Minimum-fuel powered descent by successive convexification: a library, no clock, no threads.
//!
//! [`solve`] starts from nothing, [`replan`] from the remainder of the last plan. Equation numbers
//! refer to the README of this package.

mod bounds;
mod conic;
mod error;
mod outer_loop;
mod plan;
mod planner;
mod problem;
mod propulsion;
mod residuals;
mod restore;
#[cfg(test)]
mod restore_tests;
mod start;
mod structure;
mod subproblem;
mod trajectory;
mod turn;
mod verify;

pub use bounds::disprove;
pub(crate) use conic::Affine;
pub use conic::{ConicSolver, Program, Solution};
pub use error::PlanError;
pub use plan::{Phase, Plan, Report, Sample};
pub use planner::{replan, solve, subproblem};
pub use problem::{FinalTilt, PathLimits, Problem, Reserve, Settings, Terminal};
pub use propulsion::{EngineState, Propulsion};
pub use residuals::LastStep;
pub use structure::Structure;
pub use trajectory::Node;
pub use turn::Turn;
pub use verify::{LOSSLESS_GAP_MAX, MISS_MAX, THRUST_EXCURSION_MAX, THRUST_RATE_EXCESS_MAX};
