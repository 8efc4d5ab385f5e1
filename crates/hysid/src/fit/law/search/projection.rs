//! Weights of features by least squares, some of them not negative: `argmin_c Σ_k (Σ_i c_i φ_i,k - y_k)²`
//! (theory.md (8.1)).

use crate::law::Sample;
use crate::law::series::Series;
use crate::linear_algebra::{Symmetric, dot};
use crate::optimise::non_negative::Quadratic;
use crate::stop_check::{Pace, StopCheck};

/// Squared residual of what was not computed to its end.
pub(crate) const UNFINISHED: f64 = f64::INFINITY;

/// Ridge, as a share of each feature's own square: it only makes collinear features solvable.
const RIDGE: f64 = 1e-10;

#[derive(Debug, Clone)]
pub(crate) struct FeatureColumns<'a> {
    columns: Vec<Vec<f64>>,
    pace: Pace<'a>,
}

impl<'a> FeatureColumns<'a> {
    pub fn new(count: usize, rows: usize, stop: StopCheck<'a>) -> Self {
        Self { columns: vec![Vec::with_capacity(rows); count], pace: Pace::new(stop) }
    }

    /// A free run: `advance` gives the features at each sample. Rows without an output only drive the memory.
    pub fn run<const FEATURES: usize>(
        &mut self,
        series: &Series,
        operations_a_row: usize,
        mut advance: impl FnMut(&Sample) -> [f64; FEATURES],
    ) {
        let count = self.columns.len();
        for (sample, y) in series.samples.iter().zip(&series.output) {
            if self.is_over(operations_a_row) {
                return;
            }
            let row = advance(sample);
            if !y.is_nan() {
                self.push(&row[..count]);
            }
        }
    }

    /// Counts the operations of one more row; true once stopped, and the columns are of no use then.
    pub fn is_over(&mut self, operations: usize) -> bool {
        self.pace.is_over(operations)
    }

    /// Appends the features of one more row.
    pub fn push(&mut self, row: &[f64]) {
        debug_assert_eq!(row.len(), self.columns.len());
        for (column, &value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }

    /// The sum of the features with these weights, row by row.
    pub fn sum(&self, weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.columns.first().map_or(0, Vec::len)];
        for (column, weight) in self.columns.iter().zip(weights) {
            sum.iter_mut().zip(column).for_each(|(sum, feature)| *sum += weight * feature);
        }
        sum
    }

    /// The features, column by column.
    pub fn into_columns(self) -> Vec<Vec<f64>> {
        self.columns
    }

    /// Multiplies each row with a factor; without factors, nothing.
    pub fn scale_rows(&mut self, factors: &[f64]) {
        for column in &mut self.columns {
            column.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
        }
    }

    /// The weights that come closest to `target`; an unfinished run has the largest residual.
    pub fn project(&mut self, target: &[f64], non_negative: &[bool]) -> Projection {
        if self.pace.is_over(0) {
            return Projection::unfinished();
        }
        let n = self.columns.len();
        debug_assert!(self.columns.iter().all(|column| column.len() == target.len()));
        // Every column to length 1: features in different units are alike to the ridge.
        let scale: Vec<f64> = self
            .columns
            .iter()
            .map(|column| dot(column, column).sqrt())
            .map(|length| if length.is_finite() && length > 1e-150 { 1.0 / length } else { 0.0 })
            .collect();
        let gram = Symmetric::from_fn(n, |i, j| {
            let product = scale[i] * scale[j] * dot(&self.columns[i], &self.columns[j]);
            product + if i == j { RIDGE } else { 0.0 }
        });
        let right: Vec<f64> = (0..n).map(|i| scale[i] * dot(&self.columns[i], target)).collect();
        let normal = Quadratic { matrix: gram, right };
        let found = normal.non_negative_minimum(non_negative, &[], StopCheck::never()); // (8.1)
        let mut weights = found.unwrap_or_else(|| vec![0.0; n]);
        for (weight, scale) in weights.iter_mut().zip(&scale) {
            *weight *= scale;
        }
        let mut residual: Vec<f64> = target.iter().map(|y| -y).collect();
        for (column, &weight) in self.columns.iter().zip(&weights) {
            if weight != 0.0 {
                for (residual, feature) in residual.iter_mut().zip(column) {
                    *residual += weight * feature;
                }
            }
        }
        let square_residual = dot(&residual, &residual);
        // A point at which something overflows is worse than any other.
        let square_residual = if square_residual.is_finite() { square_residual } else { f64::MAX };
        Projection { weights, residual, square_residual }
    }
}

/// Features with their best weights.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    pub weights: Vec<f64>,
    /// Model less target.
    pub residual: Vec<f64>,
    pub square_residual: f64,
}

impl Projection {
    /// Of features that were not computed to their end.
    pub fn unfinished() -> Self {
        Self { weights: Vec::new(), residual: Vec::new(), square_residual: UNFINISHED }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(rows: &[[f64; 3]]) -> FeatureColumns<'static> {
        let mut columns = FeatureColumns::new(3, rows.len(), StopCheck::never());
        rows.iter().for_each(|row| columns.push(row));
        columns
    }

    #[test]
    fn weights_are_exact_where_they_can_be() {
        let rows = [[1.0, 0.0, 2.0], [1.0, 1.0, -1.0], [1.0, 4.0, 0.5], [1.0, -2.0, 3.0]];
        let target: Vec<f64> = rows.iter().map(|row| 2.0 * row[0] + 0.5 * row[1] + 3.0 * row[2]).collect();
        let found = columns(&rows).project(&target, &[false, true, true]);
        for (found, expected) in found.weights.iter().zip([2.0, 0.5, 3.0]) {
            approx::assert_relative_eq!(*found, expected, epsilon = 1e-6);
        }
        assert!(found.square_residual < 1e-12);
    }

    #[test]
    fn a_weight_that_would_be_negative_is_nought_and_the_others_are_best_without_it() {
        let rows = [[1.0, 0.0, 2.0], [1.0, 1.0, -1.0], [1.0, 4.0, 0.5], [1.0, -2.0, 3.0]];
        let target: Vec<f64> = rows.iter().map(|row| 2.0 - 0.5 * row[1] + 3.0 * row[2]).collect();
        let found = columns(&rows).project(&target, &[false, true, true]);
        let without = columns(&rows.map(|row| [row[0], 0.0, row[2]])).project(&target, &[false; 3]);
        assert_eq!(found.weights[1], 0.0);
        approx::assert_relative_eq!(found.square_residual, without.square_residual, max_relative = 1e-9);
        // Kuhn and Tucker: the residual falls only if the weight becomes negative.
        let slope: f64 = rows.iter().zip(&found.residual).map(|(row, r)| row[1] * r).sum();
        assert!(slope > 0.0);
    }
}
