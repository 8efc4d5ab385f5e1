//! Cholesky factors of matrices that rounding may have made indefinite: more features than rows, or features all but
//! equal.

use crate::linear_algebra::{Cholesky, Symmetric};
use crate::stop_check::{Pace, StopCheck};

/// Largest ridge, as a multiple of the largest diagonal entry: beyond it entries are no numbers.
const LARGEST: f64 = 1e12;

/// Smallest ridge that is tried, as a share of the largest diagonal entry.
const SMALLEST: f64 = 1e-14;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoFactor {
    Stopped,
    NotFinite,
}

/// The factor of a matrix of `n` rows with a ridge, which is raised until the matrix is definite, and what was added to
/// each diagonal entry. To the first `unpenalised` entries only the smallest ridge is added, whatever the others need.
pub(crate) fn factor_with_ridge(
    matrix: &Symmetric,
    n: usize,
    ridge: f64,
    unpenalised: usize,
    stop: StopCheck<'_>,
) -> Result<(Cholesky, Vec<f64>), NoFactor> {
    let mut pace = Pace::new(stop);
    let largest = (0..n).map(|i| matrix.diagonal(i)).fold(1e-300, f64::max);
    let mut ridge = ridge;
    loop {
        if pace.is_over(n * n * n / 6) {
            return Err(NoFactor::Stopped);
        }
        let mut added = vec![ridge; n];
        added.iter_mut().take(unpenalised).for_each(|added| *added = SMALLEST * largest);
        let mut raised = matrix.clone();
        added.iter().enumerate().for_each(|(i, &value)| raised.add_to_diagonal(i, value));
        match raised.cholesky(stop) {
            Some(factor) => return Ok((factor, added)),
            None if stop.is_asked() => return Err(NoFactor::Stopped),
            None if ridge > LARGEST * largest => return Err(NoFactor::NotFinite),
            None => ridge = (ridge * 10.0).max(SMALLEST * largest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the same feature, beside one that bears no penalty.
    #[test]
    fn the_ridge_is_raised_until_the_matrix_is_definite() {
        let rows = [[1.0, 2.0, 2.0], [1.0, -1.0, -1.0], [1.0, 0.3, 0.3]];
        let matrix = Symmetric::from_fn(3, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
        let (factor, added) = factor_with_ridge(&matrix, 3, 0.0, 1, StopCheck::never()).unwrap();
        assert!(added[1] > 0.0 && added[1] < 1e-10 && added[1] == added[2], "{added:?}");
        assert_eq!(added[0], SMALLEST * matrix.diagonal(1));
        let mut weights: Vec<f64> = (0..3).map(|i| rows.iter().map(|row| row[i] * row[1]).sum()).collect();
        factor.solve(&mut weights);
        assert!(weights[0].abs() < 1e-3 && (weights[1] + weights[2] - 1.0).abs() < 1e-3, "{weights:?}");
    }

    #[test]
    fn a_matrix_that_is_not_finite_and_a_stop_have_no_factor() {
        let mut matrix = Symmetric::from_fn(3, |i, j| f64::from(u8::from(i == j)));
        assert!(factor_with_ridge(&matrix, 3, 0.0, 0, StopCheck::never()).is_ok());
        matrix.add_at(2, 1, f64::NAN);
        let found = |stop| factor_with_ridge(&matrix, 3, 0.0, 0, stop).unwrap_err();
        assert_eq!(found(StopCheck::never()), NoFactor::NotFinite);
        assert_eq!(found(StopCheck::new(&|| true)), NoFactor::Stopped);
    }
}
