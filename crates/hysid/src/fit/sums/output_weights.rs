//! Output weights by ridge least squares, from the Gram matrix of features `Φ`, target and optionally
//! Jacobian.
//!
//! ```text
//! (ΦᵀΦ/N + λI) c = Φᵀy/N                                                   theory.md (3.2)
//! ```

use crate::linear_algebra::{Cholesky, Gram, Symmetric};
use crate::optimise::ridge::factor_with_ridge;
use crate::stop_check::{Pace, StopCheck};

/// The linear least-squares problem inside the objective.
pub struct OutputProblem<'a> {
    pub gram: &'a Gram,
    /// Number of features.
    pub features: usize,
    /// Rows that went into the Gram matrix.
    pub rows: f64,
    /// λ: ridge on the output weights, `½ λ ‖c‖²` (theory.md (3.1)).
    pub ridge: f64,
    /// The first feature is the constant, which bears no penalty.
    pub constant: bool,
    pub stop: StopCheck<'a>,
}

/// Output weights and what they reach.
#[derive(Debug, Clone)]
pub struct OutputSolution {
    pub weights: Vec<f64>,
    /// Mean square residual, in scaled units.
    pub mean_square: f64,
    /// Half the mean square residual plus half the ridge penalty.
    pub objective: f64,
    /// `Λ`: what each weight's own ridge came to.
    pub ridge: Vec<f64>,
    /// Factor of `PᵀP/N + Λ`.
    pub factor: Cholesky,
}

impl OutputSolution {
    /// Stands for a solution that was broken off: worse than any other.
    pub fn broken_off(features: usize) -> Self {
        Self {
            weights: vec![0.0; features],
            mean_square: f64::INFINITY,
            objective: f64::INFINITY,
            ridge: vec![0.0; features],
            factor: Cholesky::empty(),
        }
    }
}

impl OutputProblem<'_> {
    /// Solves `(ΦᵀΦ/N + λI) c = Φᵀy/N` (theory.md (3.2)). Where rounding makes the matrix indefinite (more
    /// features than rows, or nearly equal features), the ridge is raised until it is definite. Once stopped,
    /// and for features that are not finite, the objective is infinite.
    pub fn solve(&self) -> OutputSolution {
        let m = self.features;
        let matrix = Symmetric::from_fn(m, |i, j| self.gram.at(i, j) / self.rows);
        let unpenalised = usize::from(self.constant);
        let solvable = factor_with_ridge(&matrix, m, self.ridge, unpenalised, self.stop);
        let Ok((factor, added)) = solvable else { return OutputSolution::broken_off(m) };
        let target = |i: usize| self.gram.at(m, i) / self.rows;
        let mut weights: Vec<f64> = (0..m).map(target).collect();
        factor.solve(&mut weights);
        let mut mean_square = self.gram.at(m, m) / self.rows;
        let mut penalty = 0.0;
        for i in 0..m {
            let product: f64 = (0..m).map(|j| self.gram.at(i, j) * weights[j]).sum();
            mean_square += weights[i] * (product / self.rows - 2.0 * target(i));
            if i > 0 || !self.constant {
                penalty += self.ridge * weights[i] * weights[i];
            }
        }
        let mean_square = mean_square.max(0.0);
        if self.stop.is_asked() {
            return OutputSolution::broken_off(m);
        }
        let objective = 0.5 * (mean_square + penalty);
        OutputSolution { objective, weights, mean_square, ridge: added, factor }
    }

    /// Gradient `Jᵀr/N`, theory.md (3.3), and Gauss-Newton matrix (3.4) without decay; the Gram matrix ends with `p`
    /// columns of `J`.
    pub fn linearise(&self, solution: &OutputSolution, p: usize) -> (Vec<f64>, Symmetric) {
        let m = self.features;
        let first = m + 1;
        let gradient = (0..p)
            .map(|k| {
                let predicted: f64 = (0..m).map(|i| self.gram.at(first + k, i) * solution.weights[i]).sum();
                (predicted - self.gram.at(first + k, m)) / self.rows
            })
            .collect();
        let mut projected = vec![0.0; p * m];
        let mut pace = Pace::new(self.stop);
        for (k, row) in projected.chunks_exact_mut(m).enumerate() {
            if pace.is_over(m * m) {
                break;
            }
            for (i, value) in row.iter_mut().enumerate() {
                *value = self.gram.at(first + k, i) / self.rows;
            }
            solution.factor.solve_lower(row);
        }
        let mut matrix = Symmetric::from_fn(p, |i, j| self.gram.at(first + i, first + j) / self.rows);
        matrix.subtract_product(&projected, m, self.stop);
        (gradient, matrix)
    }
}
