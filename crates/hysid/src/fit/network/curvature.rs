//! Curvature of the objective, as Levenberg-Marquardt needs it: the Gauss-Newton matrix, theory.md (3.4), or,
//! where a network has many more parameters than there are rows, the rows that it is made of.
//!
//! ```text
//! A = UᵀU + κ,   U = [ (J - ΦB)/√N ]     B = (ΦᵀΦ/N + Λ)⁻¹ ΦᵀJ/N
//!                    [ √Λ B         ]
//! (A + D)⁻¹ (Uᵀv + t) = q + C⁻¹Uᵀ (I + U C⁻¹Uᵀ)⁻¹ (v - Uq),   C = κ + D,  q = C⁻¹t
//! ```
//!
//! The second line (Woodbury) needs a matrix as large as there are rows and features, in place of one as
//! large as there are parameters: 50 rows of 99 inputs need 2 MB, not 500.

use crate::fit::sums::output_weights::OutputSolution;
use crate::linear_algebra::{Batch, Gram, Symmetric, dot};
use crate::optimise::levenberg_marquardt::damped_step;
use crate::stop_check::{Pace, StopCheck};

/// Parameters from which on few rows are worth a way of their own.
const MANY_PARAMETERS: usize = 1000;

/// True if the rows of the curvature take less than half the memory of its matrix.
pub(crate) fn has_few_rows(parameters: usize, features: usize, rows: usize) -> bool {
    parameters >= MANY_PARAMETERS && 2 * (rows + features) < parameters
}

/// Curvature at a point.
pub enum Curvature {
    /// The Gauss-Newton matrix with decay.
    Matrix(Symmetric),
    Rows(CurvatureRows),
}

impl Curvature {
    pub fn diagonal(&self, parameter: usize) -> f64 {
        match self {
            Self::Matrix(matrix) => matrix.diagonal(parameter),
            Self::Rows(rows) => rows.diagonal(parameter),
        }
    }

    /// The step to the minimum of the quadratic model with `damping` on the diagonal; `None` if there is none, or once
    /// stopped.
    pub fn step(&self, gradient: &[f64], damping: &[f64], stop: StopCheck<'_>) -> Option<Vec<f64>> {
        match self {
            Self::Matrix(matrix) => damped_step(matrix, gradient, damping, stop),
            Self::Rows(rows) => rows.step(damping, stop),
        }
    }
}

/// `U` with the residual `v` and the decay.
pub struct CurvatureRows {
    /// Rows of `U`: those of the data, then one for each feature.
    height: usize,
    /// `U`, parameter by parameter.
    columns: Vec<f64>,
    residual: Vec<f64>,
    /// `κ` of each parameter, and `t = κw`.
    decay: Vec<f64>,
    pull: Vec<f64>,
}

impl CurvatureRows {
    /// From the columns of features, target and Jacobian and the output weights; `None` once stopped.
    pub fn new(
        columns: Vec<Vec<f64>>,
        solution: &OutputSolution,
        decay: Vec<f64>,
        parameters: &[f64],
        stop: StopCheck<'_>,
    ) -> Option<Self> {
        let features = solution.weights.len();
        let (known, jacobian) = columns.split_at(features + 1);
        let (phi, target) = (&known[..features], &known[features]);
        let rows = target.len();
        let per_row = 1.0 / (rows as f64).sqrt();
        let ridge: Vec<f64> = solution.ridge.iter().map(|ridge| ridge.sqrt()).collect();
        let height = rows + features;
        let mut residual: Vec<f64> = target.iter().map(|y| -y).collect();
        subtract(&mut residual, phi, &solution.weights.iter().map(|w| -w).collect::<Vec<f64>>());
        residual.iter_mut().for_each(|r| *r *= per_row);
        residual.extend(ridge.iter().zip(&solution.weights).map(|(ridge, w)| -ridge * w));

        let mut all = Vec::with_capacity(height * jacobian.len());
        let mut pace = Pace::new(stop);
        for column in jacobian {
            if pace.is_over(2 * features * height) {
                return None;
            }
            let mut follows: Vec<f64> = phi.iter().map(|phi| dot(phi, column) / rows as f64).collect();
            solution.factor.solve(&mut follows);
            let mut left = column.clone();
            subtract(&mut left, phi, &follows);
            all.extend(left.iter().map(|value| value * per_row));
            all.extend(ridge.iter().zip(&follows).map(|(ridge, b)| ridge * b));
        }
        let pull = decay.iter().zip(parameters).map(|(decay, w)| decay * w).collect();
        Some(Self { height, columns: all, residual, decay, pull })
    }

    fn column(&self, parameter: usize) -> &[f64] {
        &self.columns[parameter * self.height..(parameter + 1) * self.height]
    }

    fn diagonal(&self, parameter: usize) -> f64 {
        let column = self.column(parameter);
        dot(column, column) + self.decay[parameter]
    }

    /// Gradient of the objective, `Jᵀr/N + κ θ_w` (theory.md (3.3)).
    pub fn gradient(&self) -> Vec<f64> {
        let of = |(index, pull): (usize, &f64)| dot(self.column(index), &self.residual) + pull;
        self.pull.iter().enumerate().map(of).collect()
    }

    fn step(&self, damping: &[f64], stop: StopCheck<'_>) -> Option<Vec<f64>> {
        let scale: Vec<f64> = self.decay.iter().zip(damping).map(|(decay, d)| 1.0 / (decay + d)).collect();
        let mut right = self.residual.clone();
        for (index, (&scale, &pull)) in scale.iter().zip(&self.pull).enumerate() {
            let q = scale * pull;
            right.iter_mut().zip(self.column(index)).for_each(|(right, u)| *right -= q * u);
        }
        let gram = self.gram(&scale, stop);
        let matrix = Symmetric::from_fn(self.height, |i, j| gram.at(i, j) + f64::from(u8::from(i == j)));
        drop(gram);
        matrix.cholesky(stop)?.solve(&mut right);
        let step = |(index, (&scale, &pull)): (usize, (&f64, &f64))| {
            -scale * (pull + dot(self.column(index), &right))
        };
        Some(scale.iter().zip(&self.pull).enumerate().map(step).collect())
    }

    /// `U C⁻¹ Uᵀ`
    fn gram(&self, scale: &[f64], stop: StopCheck<'_>) -> Gram {
        let (mut gram, mut batch) = (Gram::new(self.height), Batch::new(self.height));
        let mut pace = Pace::new(stop);
        let most = batch.free();
        let mut transposed = vec![Vec::with_capacity(most); self.height];
        for first in (0..scale.len()).step_by(most) {
            let count = most.min(scale.len() - first);
            transposed.iter_mut().for_each(Vec::clear);
            for (index, scale) in scale.iter().enumerate().skip(first).take(count) {
                let root = scale.sqrt();
                for (row, u) in transposed.iter_mut().zip(self.column(index)) {
                    row.push(root * u);
                }
            }
            batch.append(transposed.iter(), count);
            gram.gather(&mut batch, &mut pace);
        }
        gram
    }
}

/// `left -= Σ_i weight_i column_i`
fn subtract(left: &mut [f64], columns: &[Vec<f64>], weights: &[f64]) {
    for (column, weight) in columns.iter().zip(weights) {
        left.iter_mut().zip(column).for_each(|(left, value)| *left -= weight * value);
    }
}
