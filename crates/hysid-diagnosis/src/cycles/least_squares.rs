//! Weighted linear least squares with the deviations and intervals of the coefficients.

use hysid_core::elementary::square;
use hysid_core::linear_algebra::{Symmetric, dot};
use hysid_core::stop_check::StopCheck;

/// Coefficients of a fit.
#[derive(Debug, Clone)]
pub(super) struct LinearFit<const N: usize> {
    pub coefficients: [f64; N],
    /// Standard deviations of the coefficients from the scatter of the residuals.
    pub deviations: [f64; N],
    /// Degrees of freedom of the residuals.
    pub degrees: f64,
    /// Root mean square of the residuals.
    pub rms: f64,
}

/// The fit `y ≈ Σ_j c_j row_j`; `None` if the rows do not determine the coefficients or leave no residual.
pub(super) fn fit<const N: usize>(rows: &[[f64; N]], y: &[f64]) -> Option<LinearFit<N>> {
    let degrees = rows.len().checked_sub(N).filter(|degrees| *degrees > 0)? as f64;
    let scale: [f64; N] = std::array::from_fn(|j| rows.iter().map(|row| square(row[j])).sum::<f64>().sqrt());
    if scale.iter().any(|scale| !(*scale > 0.0 && scale.is_finite())) {
        return None;
    }
    let scaled: Vec<[f64; N]> = rows.iter().map(|row| std::array::from_fn(|j| row[j] / scale[j])).collect();
    let gram = Symmetric::from_fn(N, |i, j| scaled.iter().map(|row| row[i] * row[j]).sum());
    let factor = gram.cholesky(StopCheck::never())?;
    let mut solution: [f64; N] =
        std::array::from_fn(|j| scaled.iter().zip(y).map(|(row, y)| row[j] * y).sum());
    factor.solve(&mut solution);
    let squares: f64 = scaled.iter().zip(y).map(|(row, y)| square(y - dot(row, &solution))).sum();
    let mut deviations = [0.0; N];
    for (j, deviation) in deviations.iter_mut().enumerate() {
        let mut unit = [0.0; N];
        unit[j] = 1.0;
        factor.solve(&mut unit);
        *deviation = (squares / degrees * unit[j]).sqrt() / scale[j];
    }
    let coefficients = std::array::from_fn(|j| solution[j] / scale[j]);
    let is_finite = |values: &[f64; N]| values.iter().all(|value| value.is_finite());
    let rms = (squares / rows.len() as f64).sqrt();
    (is_finite(&coefficients) && is_finite(&deviations)).then_some(LinearFit {
        coefficients,
        deviations,
        degrees,
        rms,
    })
}
