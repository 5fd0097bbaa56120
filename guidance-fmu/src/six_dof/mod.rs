//! Minimum-fuel powered descent of a rigid body by successive convexification: attitude, body rates
//! and gimbal beside the translation. A library, no clock, no threads.
//!
//! [`solve`] starts from the translation's plan ([`crate::scvx::solve`]). Equation numbers refer to
//! the README of this package, which says what is proven and what is not.

mod dynamics;
mod error;
mod excess;
mod guess;
mod outer_loop;
mod plan;
mod planner;
mod problem;
mod shooting;
mod subproblem;
mod trajectory;
mod verify;

pub use error::SixDofError;
pub use excess::Excess;
pub use plan::{SixDofControl, SixDofNode, SixDofPlan, SixDofReport};
pub use planner::{solve, subproblem};
pub use problem::{Actuators, Limits, SixDofProblem, SixDofSettings, Start};
pub use verify::{MISS_MAX, NODE_EXCESS_MAX};
