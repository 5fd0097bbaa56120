//! The conic program and its solver: the only file that names the solver crate.
//!
//! minimise ½ Σ p_i x_i² + cᵀx subject to affine expressions of x lying in zero, nonnegative or second-order cones.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT},
};

use serde::Serialize;

use super::error::PlanError;

/// Feasibility and gap tolerance in scaled units; below 1e-9 the solver stalls without refinement.
pub(super) const TOLERANCE: f64 = 1e-8;

/// An affine expression Σ coefficient·x_column + constant; each column appears at most once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Affine {
    pub terms: Vec<(usize, f64)>,
    pub constant: f64,
}

impl Affine {
    pub fn new(terms: impl Into<Vec<(usize, f64)>>, constant: f64) -> Self {
        Self { terms: terms.into(), constant }
    }

    /// Value at `x`.
    pub fn at(&self, x: &[f64]) -> f64 {
        self.terms.iter().map(|&(column, c)| c * x[column]).sum::<f64>() + self.constant
    }
}

/// A conic program assembled row by row in the solver's form b − A x ∈ K. Serialises as the diagonal
/// of P, the cost, the entries of A as (column, row, value), b, and the cones in order of the rows.
#[derive(Clone, Debug, Serialize)]
pub struct Program {
    curvature: Vec<f64>,
    cost: Vec<f64>,
    entries: Vec<(usize, usize, f64)>,
    rhs: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Program {
    pub(crate) fn new(curvature: Vec<f64>, cost: Vec<f64>) -> Self {
        Self { curvature, cost, entries: Vec::new(), rhs: Vec::new(), cones: Vec::new() }
    }

    fn push(&mut self, row: Affine) {
        let index = self.rhs.len();
        self.entries.extend(row.terms.into_iter().map(|(column, c)| (column, index, -c)));
        self.rhs.push(row.constant);
    }

    pub(crate) fn zero(&mut self, row: Affine) {
        self.push(row);
        match self.cones.last_mut() {
            Some(ZeroConeT(rows)) => *rows += 1,
            _ => self.cones.push(ZeroConeT(1)),
        }
    }

    pub(crate) fn nonnegative(&mut self, row: Affine) {
        self.push(row);
        match self.cones.last_mut() {
            Some(NonnegativeConeT(rows)) => *rows += 1,
            _ => self.cones.push(NonnegativeConeT(1)),
        }
    }

    /// ‖rows[1..]‖ ≤ rows[0].
    pub(crate) fn second_order<const N: usize>(&mut self, rows: [Affine; N]) {
        rows.into_iter().for_each(|row| self.push(row));
        self.cones.push(SecondOrderConeT(N));
    }
}

/// Solution of one program.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Scaled variables.
    pub x: Vec<f64>,
    /// Minimum in scaled units.
    pub objective: f64,
    /// Interior-point iterations.
    pub iterations: u32,
}

/// A factorisation kept for programs of one sparsity pattern; later programs update its data.
pub struct ConicSolver {
    inner: DefaultSolver<f64>,
    /// Entry order of the program → column-major order of the solver.
    order: Vec<usize>,
    /// Columns with an entry of P.
    curved: Vec<usize>,
}

impl ConicSolver {
    /// Equilibrates and orders `program`. Errors: the solver's own, as [`PlanError::Solver`].
    pub fn new(program: &Program, max_iterations: u32) -> Result<Self, PlanError> {
        let columns = program.cost.len();
        let mut order: Vec<usize> = (0..program.entries.len()).collect();
        order.sort_unstable_by_key(|&k| (program.entries[k].0, program.entries[k].1));
        let mut column_start = vec![0; columns + 1];
        for (column, ..) in &program.entries {
            column_start[column + 1] += 1;
        }
        for column in 0..columns {
            column_start[column + 1] += column_start[column];
        }
        let a = CscMatrix::new(
            program.rhs.len(),
            columns,
            column_start,
            order.iter().map(|&k| program.entries[k].1).collect(),
            order.iter().map(|&k| program.entries[k].2).collect(),
        );
        // Zeros on the diagonal of P would be carried through every product and factorisation.
        let curved: Vec<usize> = (0..columns).filter(|&i| program.curvature[i] != 0.0).collect();
        let p_start = (0..=columns).map(|column| curved.partition_point(|&i| i < column)).collect();
        let p_values = curved.iter().map(|&i| program.curvature[i]).collect();
        let p = CscMatrix::new(columns, columns, p_start, curved.clone(), p_values);
        let inner = DefaultSolver::new(
            &p,
            &program.cost,
            &a,
            &program.rhs,
            &program.cones,
            settings(max_iterations),
        )
        .map_err(|e| PlanError::Solver { status: e.to_string() })?;
        Ok(Self { inner, order, curved })
    }

    /// Whether `program` has the rows and entries that this solver was built with.
    pub(crate) fn fits(&self, program: &Program) -> bool {
        let rows = self.inner.data.m;
        self.order.len() == program.entries.len() && rows == program.rhs.len()
    }

    /// Sets what the next solves are to be accurate to; `TOLERANCE` until then. Errors: the solver's own.
    pub(super) fn set_tolerance(&mut self, tolerance: f64) -> Result<(), PlanError> {
        if self.inner.settings().tol_feas == tolerance {
            return Ok(());
        }
        let mut settings = self.inner.settings().clone();
        (settings.tol_gap_abs, settings.tol_gap_rel) = (tolerance, tolerance);
        settings.tol_feas = tolerance;
        let updated = self.inner.update_settings(settings);
        updated.map_err(|e| PlanError::Solver { status: e.to_string() })
    }

    /// Solves `program`, which must have the pattern this solver was built with. Errors: as `new`.
    pub fn solve(&mut self, program: &Program) -> Result<Solution, PlanError> {
        let values: Vec<f64> = self.order.iter().map(|&k| program.entries[k].2).collect();
        let curvature: Vec<f64> = self.curved.iter().map(|&i| program.curvature[i]).collect();
        let updated = self.inner.update_data(&curvature, &program.cost, &values, &program.rhs);
        updated.map_err(|e| PlanError::Solver { status: e.to_string() })?;
        self.inner.solve();
        let solution = &self.inner.solution;
        match solution.status {
            // A reduced-accuracy step is judged by the roll-out like any other.
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let x = solution.x.clone();
                Ok(Solution { x, objective: solution.obj_val, iterations: solution.iterations })
            }
            status => Err(PlanError::Solver { status: status.to_string() }),
        }
    }
}

/// Deterministic settings: no clock, one thread; presolve would forbid data updates.
fn settings(max_iterations: u32) -> DefaultSettings<f64> {
    DefaultSettings {
        max_iter: max_iterations,
        time_limit: f64::INFINITY,
        verbose: false,
        max_threads: 1,
        direct_solve_method: "qdldl".into(),
        presolve_enable: false,
        iterative_refinement_enable: false,
        // Without refinement it would stay in the answer; pivots that vanish are still lifted.
        static_regularization_enable: false,
        equilibrate_enable: true,
        equilibrate_max_iter: 4,
        tol_gap_abs: TOLERANCE,
        tol_gap_rel: TOLERANCE,
        tol_feas: TOLERANCE,
        ..DefaultSettings::default()
    }
}
