//! Is the residual correlated with the input, its rate and their past?
//!
//! ```text
//! r_k = Σ_t (x_{t-k} - x̄)(e_t - ē) / (n s_x s_e)                               theory.md (13.6)
//! t_k = T_k/√V_kk,   T_k = Σ_t (x_{t-k} - x̄)(e_t - ē)                          theory.md (13.7)
//! u_t = e_t - ē - b (x_{t-m} - x̄),   m the lag of the largest |r_k|            theory.md (13.13)
//! ```
//!
//! `V` is the covariance (theory.md (13.1)) that the sums `T_k` have by chance. It is that of the products of the input
//! with the remainder `u`, which least squares leave beside the strongest correlation: the correlated part itself must
//! not count as scatter, or a residual that is nothing but a multiple of the input would not be found. `V` contains the
//! autocorrelation of both, as the formula of Bartlett (1946) does, and holds where the size of the residual depends on
//! the input too. The p-value is that of the largest `|t_k|` among t-distributed numbers with the correlations of `V`,
//! by simulation with a fixed seed. The input's past contains its rate, so that the rate is tested in the same row only.

use hysid_core::data::record::ColumnNames;
use hysid_core::elementary::{cos, ln, powi, sin};
use hysid_core::linear_algebra::Symmetric;
use hysid_core::random::mix;
use serde::Serialize;

use super::rows::ResidualRows;
use crate::distribution::{t_quantile, t_tail};
use crate::serial::{SerialSum, correlation_lag};

/// Lags in rows. They grow as the Fibonacci numbers: neighbouring lags of a smooth input contain the same information.
const LAGS: [usize; 15] = [0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610];

/// Lags are at most this share of the rows.
const LONGEST_LAG: f64 = 0.1;

/// Numbers that are drawn for the distribution of the largest t-value.
const DRAWS: usize = 4000;

/// Most inputs whose correlations are found.
const MOST_INPUTS: usize = 8;

/// Correlation of the residual with an input or its rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputCorrelation {
    /// Name of the input.
    pub input: String,
    /// True for its rate.
    pub of_rate: bool,
    /// Rows by which the input is earlier than the residual.
    pub lags: Vec<usize>,
    /// Correlation at each lag.
    pub correlation: Vec<f64>,
    /// Magnitude that 95 % of the correlations of an unrelated residual do not exceed, at each lag.
    pub bounds: Vec<f64>,
    /// Number of independent rows that would have this bound, at each lag.
    pub effective_rows: Vec<f64>,
    /// Probability of a larger t-value at any of the lags, of a rate in the same row, for a residual that is not related
    /// to it.
    pub p_value: f64,
}

/// Correlations with each input that varies, and with the rate of the first.
pub(super) fn correlations(
    rows: &ResidualRows,
    residual: &[Vec<f64>],
    names: &ColumnNames,
) -> Vec<InputCorrelation> {
    let input =
        |index: usize| -> Vec<&[f64]> { rows.inputs.iter().map(|inputs| inputs[index].as_slice()).collect() };
    let rate: Vec<Vec<f64>> =
        rows.records.iter().map(|rows| rows.iter().map(|row| row.rate).collect()).collect();
    let rate: Vec<&[f64]> = rate.iter().map(Vec::as_slice).collect();
    let named = names.inputs.iter().enumerate().take(MOST_INPUTS);
    let mut found: Vec<InputCorrelation> =
        named.filter_map(|(index, name)| correlation(name, false, &input(index), residual)).collect();
    found.extend(correlation(&names.inputs[0], true, &rate, residual));
    found
}

/// Correlations with one column; `None` for one that does not vary.
fn correlation(
    input: &str,
    of_rate: bool,
    column: &[&[f64]],
    residual: &[Vec<f64>],
) -> Option<InputCorrelation> {
    let rows: usize = residual.iter().map(Vec::len).sum();
    let n = rows as f64;
    let values = || column.iter().flat_map(|column| column.iter());
    let mean = values().sum::<f64>() / n;
    let deviation = (values().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n).sqrt();
    let scatter = (residual.iter().flatten().map(|e| e * e).sum::<f64>() / n).sqrt();
    if !(deviation > 1e-12 * mean.abs() && deviation > 0.0 && scatter > 0.0) {
        return None;
    }
    // Half the rows have a past so long, or more.
    let has_past = |lag: &&usize| {
        let with: usize = residual.iter().map(|record| record.len().saturating_sub(**lag)).sum();
        2 * with >= rows && **lag as f64 <= LONGEST_LAG * n
    };
    let lags: Vec<usize> = LAGS.iter().take_while(has_past).copied().collect();
    let products = |residual: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let of_record = |(residual, x): (&Vec<f64>, &&[f64])| {
            let of_row = |(row, e): (usize, &f64)| {
                let product = move |&lag: &usize| {
                    row.checked_sub(lag).map_or(0.0, |past| e / scatter * (x[past] - mean) / deviation)
                };
                lags.iter().map(product).collect::<Vec<f64>>()
            };
            residual.iter().enumerate().flat_map(of_row).collect()
        };
        residual.iter().zip(column).map(of_record).collect()
    };
    let mut sum = vec![0.0; lags.len()];
    for row in products(residual).iter().flat_map(|record| record.chunks_exact(lags.len())) {
        sum.iter_mut().zip(row).for_each(|(sum, product)| *sum += product);
    }
    // What is left beside the strongest correlation is what can make one by chance.
    let strongest = (0..lags.len()).max_by(|&a, &b| sum[a].abs().total_cmp(&sum[b].abs())).unwrap_or(0);
    let left = without(residual, column, mean, lags[strongest]);
    let lag = correlation_lag(&left);
    let mut products = products(&left);
    centre(&mut products, lags.len());
    let sums = SerialSum::of(&products, lags.len(), lag, 2);
    let spread = |k: usize| sums.covariance.diagonal(k).sqrt();
    let quantile = t_quantile(0.05, sums.degrees);
    // Without anything left there is no doubt.
    let t = |k: usize| match (sum[k].abs() / spread(k), sum[k] == 0.0) {
        (_, true) => 0.0,
        (t, false) => t,
    };
    // The past of the input is in its rate: only the rate in the same row is not the input's.
    let tested = if of_rate { 1 } else { lags.len() };
    let largest = (0..tested).map(t).fold(0.0, f64::max);
    Some(InputCorrelation {
        input: input.into(),
        of_rate,
        correlation: sum.iter().map(|sum| sum / n).collect(),
        bounds: (0..lags.len()).map(|k| quantile * spread(k) / n).collect(),
        effective_rows: (0..lags.len()).map(|k| (n * n / sums.covariance.diagonal(k)).min(n)).collect(),
        p_value: tail_of_largest(&sums.covariance, tested, sums.degrees, largest),
        lags,
    })
}

/// The residual without what is proportional to a column some rows before.
fn without(residual: &[Vec<f64>], column: &[&[f64]], mean: f64, lag: usize) -> Vec<Vec<f64>> {
    let past = |x: &[f64], row: usize| if row < lag { 0.0 } else { x[row - lag] - mean };
    let (mut product, mut square) = (0.0, 0.0);
    for (residual, x) in residual.iter().zip(column) {
        for (row, e) in residual.iter().enumerate() {
            product += e * past(x, row);
            square += past(x, row) * past(x, row);
        }
    }
    let slope = if square > 0.0 { product / square } else { 0.0 };
    let of_record = |(residual, x): (&Vec<f64>, &&[f64])| {
        residual.iter().enumerate().map(|(row, e)| e - slope * past(x, row)).collect()
    };
    residual.iter().zip(column).map(of_record).collect()
}

/// Takes its mean out of each component.
fn centre(records: &mut [Vec<f64>], width: usize) {
    let mut means = vec![0.0; width];
    let rows: usize = records.iter().map(|record| record.len() / width).sum();
    for row in records.iter().flat_map(|record| record.chunks_exact(width)) {
        means.iter_mut().zip(row).for_each(|(mean, value)| *mean += value / rows as f64);
    }
    for row in records.iter_mut().flat_map(|record| record.chunks_exact_mut(width)) {
        row.iter_mut().zip(&means).for_each(|(value, mean)| *value -= mean);
    }
}

/// The probability that the largest magnitude of t-distributed numbers with these covariances exceeds `t`.
fn tail_of_largest(covariance: &Symmetric, count: usize, degrees: f64, t: f64) -> f64 {
    let at_most = (count as f64 * t_tail(t, degrees)).min(1.0);
    let Some(factor) = factor_of_correlations(covariance, count) else { return at_most };
    let mut exceeding = 0;
    let mut draws = Draws::default();
    for _ in 0..DRAWS {
        // Wilson and Hilferty's cube for the chi-square number below the fraction.
        let share = 2.0 / (9.0 * degrees);
        let cube = powi((1.0 - share + draws.normal() * share.sqrt()).max(1e-3), 3);
        let limit = t * cube.sqrt();
        let independent: Vec<f64> = (0..count).map(|_| draws.normal()).collect();
        let exceeds = factor
            .iter()
            .any(|row| row.iter().zip(&independent).map(|(l, z)| l * z).sum::<f64>().abs() > limit);
        exceeding += usize::from(exceeds);
    }
    let drawn = (1 + exceeding) as f64 / (1 + DRAWS) as f64;
    // Draws do not reach small probabilities, the bound of Bonferroni does.
    drawn.min(at_most)
}

/// Rows of the Cholesky factor of the correlations; `None` if a variance is 0.
fn factor_of_correlations(covariance: &Symmetric, count: usize) -> Option<Vec<Vec<f64>>> {
    let scale: Vec<f64> = (0..count).map(|k| covariance.diagonal(k).sqrt()).collect();
    if scale.iter().any(|scale| scale.is_nan() || *scale <= 0.0) {
        return None;
    }
    let correlation = |i: usize, j: usize| covariance.at(i, j) / (scale[i] * scale[j]);
    let mut lower = vec![vec![0.0; count]; count];
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = correlation(i, j) - known;
            // Inputs at neighbouring lags may be all but equal: what is left of the variance is then rounding.
            lower[i][j] = if i == j { rest.max(1e-9).sqrt() } else { rest / lower[j][j] };
        }
    }
    Some(lower)
}

/// Standard normal numbers from a fixed seed.
#[derive(Debug, Default)]
struct Draws {
    count: u64,
    spare: Option<f64>,
}

impl Draws {
    fn uniform(&mut self) -> f64 {
        self.count += 1;
        ((mix(self.count) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Box and Muller: two at a time.
    fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * ln(self.uniform())).sqrt();
        let angle = std::f64::consts::TAU * self.uniform();
        self.spare = Some(radius * sin(angle));
        radius * cos(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of independent numbers the probability is known: 1 - (1 - p)^m; of equal ones it is that of one.
    #[test]
    fn the_largest_of_several_exceeds_as_often_as_it_must() {
        let degrees = 1e6;
        let t = t_quantile(0.05, degrees);
        let independent = Symmetric::from_fn(10, |i, j| if i == j { 4.0 } else { 0.0 });
        let expected = 1.0 - powi(0.95, 10);
        assert!((tail_of_largest(&independent, 10, degrees, t) - expected).abs() < 0.025);
        let equal = Symmetric::from_fn(10, |_, _| 3.0);
        assert!((tail_of_largest(&equal, 10, degrees, t) - 0.05).abs() < 0.012);
        // Few degrees of freedom have heavier tails.
        let few = tail_of_largest(&Symmetric::from_fn(1, |_, _| 1.0), 1, 10.0, t_quantile(0.05, 10.0));
        assert!((few - 0.05).abs() < 0.012, "{few}");
    }
}
