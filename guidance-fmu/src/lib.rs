//! The guidance FMU's content: planning, tracking, attitude control, cut-off.
//!
//! [`scvx`] is the planner, usable alone. The rest flies its plans. Plain library: no FMI, no
//! output, no clock, no threads. Equations (G.n) in the README.

pub mod scvx;

mod attitude;
mod descent;
mod disturbance;
mod guard;
mod mission;
mod model;
mod navigation;
mod planning;

pub use mission::Phase;
pub use model::{Guidance, State};
