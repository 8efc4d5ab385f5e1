//! Linear least squares by elimination: the normal equations of a few columns, the last of which is the right side.

use std::ops::Range;

use hysid_core::linear_algebra::dot;

/// A column whose square falls below this share by the elimination of others depends on them.
const DEPENDENT: f64 = 1e-13;

/// Scalar products of columns, from which columns are eliminated one by one. Columns of one record alone are eliminated
/// before the products of records are added.
#[derive(Debug, Clone)]
pub(super) struct NormalEquations<const N: usize> {
    /// The upper triangle: row `i` is final once column `i` is eliminated.
    products: [[f64; N]; N],
    /// Squares of the columns before any elimination.
    squares: [f64; N],
}

impl<const N: usize> NormalEquations<N> {
    pub fn empty() -> Self {
        Self { products: [[0.0; N]; N], squares: [0.0; N] }
    }

    /// Of columns of equal length; the last is what the others are to explain.
    pub fn of(columns: [&[f64]; N]) -> Self {
        let mut equations = Self::empty();
        for (i, column) in columns.iter().enumerate() {
            for (j, other) in columns.iter().enumerate().skip(i) {
                equations.products[i][j] = dot(column, other);
            }
            equations.squares[i] = equations.products[i][i];
        }
        equations
    }

    pub fn add(&mut self, other: &Self) {
        let sums = self.products.as_flattened_mut().iter_mut().chain(&mut self.squares);
        let terms = other.products.as_flattened().iter().chain(&other.squares);
        sums.zip(terms).for_each(|(sum, term)| *sum += term);
    }

    /// Eliminates columns; those before them must be eliminated already. A column that depends on others is left out.
    pub fn eliminate(&mut self, columns: Range<usize>) {
        for i in columns {
            let row = self.products[i];
            if row[i] > DEPENDENT * self.squares[i] {
                for j in i + 1..N {
                    let share = row[j] / row[i];
                    self.products[j][j..].iter_mut().zip(&row[j..]).for_each(|(a, b)| *a -= share * b);
                }
            } else {
                self.products[i] = [0.0; N];
            }
        }
    }

    /// The sum of squares of the last column that the eliminated columns leave.
    pub fn remainder(&self) -> f64 {
        self.products[N - 1][N - 1].max(0.0)
    }

    /// Weights of the columns from the given one on, all of which must be eliminated; 0 for a column left out.
    pub fn weights(&self, first: usize) -> Vec<f64> {
        let mut weights = vec![0.0; N - 1];
        for i in (first..N - 1).rev() {
            let row = &self.products[i];
            let explained = dot(&row[i + 1..N - 1], &weights[i + 1..]);
            weights[i] = if row[i] > 0.0 { (row[N - 1] - explained) / row[i] } else { 0.0 };
        }
        weights.split_off(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: [f64; 4] = [1.0; 4];
    const X: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

    #[test]
    fn a_line_through_points() {
        // 1, 2, 2, 5 has the line 0.7 + 1.2 x and the remainders 0.3, 0.1, -1.1, 0.7.
        let mut equations = NormalEquations::of([&ONE, &X, &[1.0, 2.0, 2.0, 5.0]]);
        equations.eliminate(0..2);
        let weights = equations.weights(0);
        assert!((weights[0] - 0.7).abs() < 1e-12 && (weights[1] - 1.2).abs() < 1e-12, "{weights:?}");
        assert!((equations.remainder() - 1.8).abs() < 1e-12);
    }

    #[test]
    fn columns_of_one_record_alone_are_those_of_a_longer_system() {
        let (first, second) = ([1.0, 2.0, 2.0, 5.0], [3.0, 1.0, 0.0, 4.0]);
        let own = |y: &[f64]| {
            let mut equations = NormalEquations::of([&ONE, &X, y]);
            equations.eliminate(0..1);
            equations
        };
        let mut together = own(&first);
        together.add(&own(&second));
        together.eliminate(1..2);
        // Both slopes are 1.2 and 0.2, of equal weight.
        assert!((together.weights(1)[0] - 0.7).abs() < 1e-12);
    }

    #[test]
    fn a_column_twice_has_one_weight() {
        let mut equations = NormalEquations::of([&X, &X, &ONE, &X.map(|x| 2.0 * x + 1.0)]);
        equations.eliminate(0..3);
        assert!(equations.remainder() < 1e-12);
        let weights = equations.weights(0);
        assert_eq!(weights[1], 0.0);
        assert!((weights[0] - 2.0).abs() < 1e-12 && (weights[2] - 1.0).abs() < 1e-12);
    }
}
