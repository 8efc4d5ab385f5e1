//! Is the residual white? Autocorrelations and the statistic of Ljung and Box.
//!
//! ```text
//! r_k = Σ_t (e_t - ē)(e_{t+k} - ē) / Σ_t (e_t - ē)²                            theory.md (13.4)
//! Q   = n (n + 2) Σ_{k=1}^{m} r_k²/n_k   ~  χ²_m for white noise               theory.md (13.5)
//! ```
//!
//! `n_k` is the number of pairs of rows with lag `k` within a record; for a single record without gaps it is `n - k`
//! (Ljung and Box 1978; several records and gaps as in Stoffer and Toloi 1992). Lags count scored rows. No degree of
//! freedom is taken off: the parameters of a free run are no coefficients of an autoregression of the residual.

use hysid_core::elementary::log10;
use serde::Serialize;

use crate::distribution::chi_square_tail;
use crate::serial::autocorrelations;

const MOST_LAGS: usize = 50;

/// Normal quantile of a two-sided 95 % bound.
const BOUND: f64 = 1.959_964;

/// Autocorrelation of the residual.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Whiteness {
    /// `r_1 .. r_m`.
    pub autocorrelation: Vec<f64>,
    /// Magnitude that 95 % of the autocorrelations of white noise do not exceed.
    pub bound: f64,
    /// The statistic `Q` of Ljung and Box.
    pub ljung_box: f64,
    /// Its degrees of freedom `m`.
    pub degrees_of_freedom: usize,
    /// Probability of a larger `Q` for white noise.
    pub p_value: f64,
    /// Share of the variance that the last `m` values of the residual predict linearly, 0 to 1.
    pub predictable_share: f64,
}

impl Whiteness {
    pub(super) fn of(residual: &[Vec<f64>]) -> Self {
        let rows: usize = residual.iter().map(Vec::len).sum();
        let n = rows as f64;
        let lags = ((10.0 * log10(n)) as usize).min(rows / 5).clamp(1, MOST_LAGS);
        // A lag that few records are long enough for says little.
        let found = autocorrelations(residual, lags);
        let kept = found.iter().take_while(|(_, pairs)| 4 * pairs >= rows).count();
        let found = &found[..kept];
        let square = |&(r, pairs): &(f64, usize)| r * r / pairs as f64;
        let ljung_box = n * (n + 2.0) * found.iter().map(square).sum::<f64>();
        let autocorrelation: Vec<f64> = found.iter().map(|(r, _)| *r).collect();
        Self {
            bound: BOUND / n.sqrt(),
            ljung_box,
            degrees_of_freedom: kept,
            p_value: if kept > 0 { chi_square_tail(ljung_box, kept as f64) } else { 1.0 },
            predictable_share: predictable_share(&autocorrelation),
            autocorrelation,
        }
    }
}

/// `1 - Π (1 - φ_kk²)`, with the partial autocorrelations `φ_kk` by the recursion of Durbin and Levinson.
fn predictable_share(r: &[f64]) -> f64 {
    let mut phi: Vec<f64> = Vec::new();
    let mut left = 1.0;
    for k in 0..r.len() {
        let known: f64 = phi.iter().zip(r[..k].iter().rev()).map(|(phi, r)| phi * r).sum();
        let partial = ((r[k] - known) / left).clamp(-1.0, 1.0);
        let before = phi.clone();
        phi.iter_mut().zip(before.iter().rev()).for_each(|(phi, other)| *phi -= partial * other);
        phi.push(partial);
        left *= 1.0 - partial * partial;
        if left <= 1e-12 {
            return 1.0;
        }
    }
    1.0 - left
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{powi, square};

    use super::*;

    /// An autoregression of first order with coefficient a has the autocorrelations a^k and is predictable to a².
    #[test]
    fn the_predictable_share_of_an_autoregression_is_the_square_of_its_coefficient() {
        let r: Vec<f64> = (1..30).map(|k| powi(0.8, k)).collect();
        approx::assert_relative_eq!(predictable_share(&r), 0.64, max_relative = 1e-12);
        assert_eq!(predictable_share(&[0.0; 5]), 0.0);
    }

    /// By hand: the residual 1, -1, 1, ... of n rows has r_k = (-1)^k (n - k)/n.
    #[test]
    fn the_statistic_is_that_of_ljung_and_box() {
        let n = 100;
        let residual: Vec<f64> = (0..n).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let found = Whiteness::of(&[residual]);
        let n = f64::from(n);
        let expected: f64 =
            (1..=20).map(|k| n * (n + 2.0) * square((n - f64::from(k)) / n) / (n - f64::from(k))).sum();
        assert_eq!(found.degrees_of_freedom, 20);
        approx::assert_relative_eq!(found.ljung_box, expected, max_relative = 1e-12);
        assert!(found.p_value < 1e-100);
    }
}
