//! Why no six-degree-of-freedom plan is returned.

use thiserror::Error;

use crate::scvx::PlanError;

/// Reason for returning no plan. Every variant names the quantity, its value and its limit.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SixDofError {
    /// An input is not finite or outside its physical range; nothing was solved.
    #[error("input {field} = {value} is outside {allowed}")]
    Input { field: &'static str, value: f64, allowed: &'static str },
    /// The start lies outside a limit that holds for the whole path.
    #[error("infeasible: start exceeds {limit} by {excess}")]
    Start { limit: &'static str, excess: f64 },
    /// The centre of mass alone, its thrust within the body's tilt limit, has no plan to start from.
    #[error("no plan for the translation alone: {0}")]
    Translation(PlanError),
    /// Virtual control is left: the dynamics and the limits don't meet.
    #[error(
        "infeasible: virtual control {left:.2e} left, limit {limit:.0e} (scaled); miss {miss_m:.3} m"
    )]
    VirtualControl { left: f64, limit: f64, miss_m: f64 },
    /// The re-propagated plan misses its end state.
    #[error(
        "target missed by {miss_m:.2e} m, {miss_m_s:.2e} m/s, {miss_rad:.2e} rad, {miss_rad_s:.2e} rad/s"
    )]
    Target { miss_m: f64, miss_m_s: f64, miss_rad: f64, miss_rad_s: f64 },
    /// A limit is exceeded at a node.
    #[error("{limit} exceeded by {excess:.2e}, allowed {allowed:.0e}")]
    Limit { limit: &'static str, excess: f64, allowed: f64 },
    /// The plan needs more propellant than is on board.
    #[error("infeasible: {needed_kg:.3} kg of propellant needed, {available_kg:.3} kg on board")]
    Fuel { needed_kg: f64, available_kg: f64 },
    /// The outer loop did not converge within its iterations.
    #[error("not converged: iteration budget spent after {solves} conic solves")]
    IterationBudget { solves: u32 },
    /// The conic solver stopped without a solution.
    #[error("conic solver: {0}")]
    Solver(PlanError),
}
