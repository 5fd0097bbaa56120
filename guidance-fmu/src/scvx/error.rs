//! Why no plan is returned.

use thiserror::Error;

use super::structure::Structure;

/// Reason for returning no plan. Every variant names the quantity, its value and its limit.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PlanError {
    /// An input is not finite or outside its physical range; nothing was solved.
    #[error("input {field} = {value} is outside {allowed}")]
    Input { field: &'static str, value: f64, allowed: &'static str },
    /// The minimum-fuel trajectory needs more propellant than is on board.
    #[error("infeasible: {needed_kg:.3} kg of propellant needed, {available_kg:.3} kg on board")]
    Fuel { needed_kg: f64, available_kg: f64 },
    /// Proven: two impulses at the ends, as good as any thrust, take more propellant than is on board (G.92).
    #[error(
        "infeasible: any flight takes {least_kg:.3} kg of propellant, {available_kg:.3} kg on board"
    )]
    FuelBound { least_kg: f64, available_kg: f64 },
    /// Proven: full thrust straight up sinks below the minimum altitude (G.93).
    #[error(
        "infeasible: full thrust straight up ends the descent {below_m:.3} m below the minimum \
         altitude, at t = {t_s:.2} s"
    )]
    AltitudeBound { below_m: f64, t_s: f64 },
    /// No trajectory found stays above the minimum altitude.
    #[error("infeasible: {below_m:.3} m below the minimum altitude at t = {t_s:.2} s")]
    Altitude { below_m: f64, t_s: f64 },
    /// No trajectory found stays inside the glide-slope cone.
    #[error("infeasible: {outside_m:.3} m outside the glide slope at t = {t_s:.2} s")]
    GlideSlope { outside_m: f64, t_s: f64 },
    /// Proven: an engine that never stops, at its floor and tilted to its limit, lifts the vehicle from above the target (G.102).
    #[error(
        "infeasible: without a coast, at tilt ≤ {tilt_max_rad:.3} rad, the descent ends {above_m:.3} m above the target \
         at t = {t_s:.2} s or higher"
    )]
    Tilt { tilt_max_rad: f64, above_m: f64, t_s: f64 },
    /// No flight at the floor of an engine that never stops was found, and none is disproven.
    #[error(
        "not found: without a coast the target is missed by {miss_m:.3} m and {miss_m_s:.3} m/s"
    )]
    Floor { miss_m: f64, miss_m_s: f64 },
    /// The order of burns and coasts that the flight needs breaks a limit of the propulsion mode,
    /// and the orders that are left, if any, fail too.
    #[error(
        "{wanted:?} breaks `{limit}`, and {}",
        instead.as_ref().map_or("no other order is allowed".into(), |e| format!("instead: {e}"))
    )]
    Structure { wanted: Structure, limit: &'static str, instead: Option<Box<PlanError>> },
    /// The thrust limits leave the target out of reach.
    #[error("infeasible: target missed by {miss_m:.4} m and {miss_m_s:.4} m/s, limit 0.01 each")]
    Target { miss_m: f64, miss_m_s: f64 },
    /// The relaxation is not tight: the planned thrust lies below its own bound variable.
    #[error("not lossless: (σ − ‖u‖)/σ = {gap:.2e}, limit {limit:.0e}")]
    NotLossless { gap: f64, limit: f64 },
    /// The planned thrust leaves its bounds.
    #[error("thrust outside its bounds by {violation_n:.3} N, limit {limit_n:.3} N")]
    Thrust { violation_n: f64, limit_n: f64 },
    /// The planned thrust changes faster than its limit.
    #[error("thrust changes by {rate_n_s:.1} N/s within a burn, limit {limit_n_s:.1} N/s")]
    ThrustRate { rate_n_s: f64, limit_n_s: f64 },
    /// The outer loop did not converge within its iterations.
    #[error("not converged: iteration budget spent after {solves} conic solves of the call")]
    IterationBudget { solves: u32 },
    /// The conic solver stopped without a solution.
    #[error("conic solver: {status}")]
    Solver { status: String },
}

impl PlanError {
    /// Whether this says that no plan exists, not that none was found.
    pub fn is_infeasible(&self) -> bool {
        match self {
            Self::Structure { instead: Some(error), .. } => error.is_infeasible(),
            Self::Fuel { .. }
            | Self::FuelBound { .. }
            | Self::Altitude { .. }
            | Self::AltitudeBound { .. }
            | Self::GlideSlope { .. }
            | Self::Tilt { .. }
            | Self::Structure { .. }
            | Self::Target { .. } => true,
            _ => false,
        }
    }
}
