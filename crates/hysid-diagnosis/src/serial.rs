//! Sums of numbers that are correlated in time: how much they scatter, and what their autocorrelation is.
//!
//! ```text
//! V  = Σ_{|h| ≤ L} (1 - |h|/(L+1)) Σ_t v_t v_{t+h}ᵀ                            theory.md (13.1)
//!    = 1/(L+1) Σ_s S_s S_sᵀ,   S_s = v_s + ... + v_{s+L}
//! L  = 1.1447 (α n)^{1/3},     α = 4 ρ²/(1 - ρ²)²                              theory.md (13.2)
//! ν  = 3 n/(2 (L+1))                                                           theory.md (13.3)
//! C  = σ² Σ_s c_s c_sᵀ,   c_s = J_s + φ_1 c_{s+1} + ... + φ_p c_{s+p}          theory.md (13.12)
//! ```
//!
//! `C` is the covariance of `Σ_t J_t e_t` for given `J` if `e` is an autoregression that has nothing to do with them
//! ([`Autoregression`]).
//!
//! `V` estimates the covariance of the sum of the `n` vectors `v_t`, whose mean is 0: the estimator of Newey and West
//! (1987), here as sums over windows of `L+1` rows, so that the cost does not depend on `L`. Windows do not reach from
//! one record into the next. `L` is the lag of Andrews (1991) for this kernel, `ρ` the first autocorrelation, `ν` the
//! equivalent degrees of freedom of the estimate (Priestley 1981, table 6.2).

use hysid_core::elementary::{cbrt, ln, square};
use hysid_core::linear_algebra::Symmetric;

/// Windows are at most this share of the rows.
const LONGEST_WINDOW: f64 = 0.25;

/// Blocks whose means are looked at for slow parts are longer by this factor each time.
const LONGER: usize = 4;

/// Fewest blocks in which a slow part can show.
const FEWEST_BLOCKS: usize = 32;

/// Autocorrelations 1 to `lags` of a residual about its mean, over pairs within a record, as shares of its variance;
/// and the number of pairs of each.
pub fn autocorrelations(records: &[Vec<f64>], lags: usize) -> Vec<(f64, usize)> {
    let rows: usize = records.iter().map(Vec::len).sum();
    let mean = records.iter().flatten().sum::<f64>() / rows.max(1) as f64;
    let square: f64 = records.iter().flatten().map(|e| (e - mean) * (e - mean)).sum();
    let of_lag = |lag: usize| {
        let (mut sum, mut pairs) = (0.0, 0);
        for record in records.iter().filter(|record| record.len() > lag) {
            let products = record.iter().zip(&record[lag..]).map(|(a, b)| (a - mean) * (b - mean));
            sum += products.sum::<f64>();
            pairs += record.len() - lag;
        }
        (if square > 0.0 { sum / square } else { 0.0 }, pairs)
    };
    (1..=lags).map(of_lag).collect()
}

/// The lag `L` up to which rows are taken as correlated (theory.md (13.2)). A slow part beside faster noise hardly
/// shows in neighbouring rows, so the means of longer and longer blocks are looked at too; the largest lag counts.
pub fn correlation_lag(records: &[Vec<f64>]) -> usize {
    let rows: usize = records.iter().map(Vec::len).sum();
    let mut lag = 0.0f64;
    let mut block = 1;
    while rows / block >= FEWEST_BLOCKS {
        let means: Vec<Vec<f64>> = records.iter().map(|record| block_means(record, block)).collect();
        let count: usize = means.iter().map(Vec::len).sum();
        let first = autocorrelations(&means, 1)[0].0;
        // What white noise shows too is no slow part.
        if count >= FEWEST_BLOCKS && (block == 1 || first > 3.0 / (count as f64).sqrt()) {
            let rho = first.clamp(-0.999_999, 0.999_999);
            let alpha = 4.0 * rho * rho / square(1.0 - rho * rho);
            lag = lag.max(block as f64 * 1.1447 * cbrt(alpha * count as f64));
        }
        block *= LONGER;
    }
    (lag.floor() as usize).min((LONGEST_WINDOW * rows as f64) as usize)
}

fn block_means(record: &[f64], block: usize) -> Vec<f64> {
    let mean = |rows: &[f64]| rows.iter().sum::<f64>() / rows.len() as f64;
    record.chunks_exact(block).map(mean).collect()
}

/// A sum of vectors that are correlated in time.
#[derive(Debug, Clone)]
pub struct SerialSum {
    /// The sum of each component.
    pub sum: Vec<f64>,
    /// Estimated covariance of the sums.
    pub covariance: Symmetric,
    /// Degrees of freedom of that estimate.
    pub degrees: f64,
}

impl SerialSum {
    /// The sum of the rows of records, each a vector of `width` numbers one after another; `lag` as of
    /// [`correlation_lag`]. `fitted` is the number of means or parameters that were fitted to the same rows.
    pub fn of(records: &[Vec<f64>], width: usize, lag: usize, fitted: usize) -> Self {
        let mut sum = vec![0.0; width];
        let mut products = vec![0.0; width * (width + 1) / 2];
        let mut rows = 0;
        for record in records {
            rows += record.len() / width;
            record.chunks_exact(width).for_each(|row| add(&mut sum, row, 1.0));
            windows(record, width, lag, |window| {
                let mut at = 0;
                for i in 0..width {
                    for j in 0..=i {
                        products[at + j] += window[i] * window[j];
                    }
                    at += i + 1;
                }
            });
        }
        let window = (lag + 1) as f64;
        let n = rows.max(1) as f64;
        // Expectation of the estimate where a mean was taken out of the rows, for a share b of the rows in a window:
        // 1 - b + b²/3 (Kiefer and Vogelsang 2005).
        let share = window / n;
        let bias = if fitted > 0 { (1.0 - share + share * share / 3.0).max(0.1) } else { 1.0 };
        let free = n / (n - fitted as f64).max(1.0);
        let factor = free / (window * bias);
        Self {
            sum,
            covariance: Symmetric::from_fn(width, |i, j| {
                let (i, j) = (i.max(j), i.min(j));
                factor * products[i * (i + 1) / 2 + j]
            }),
            degrees: (1.5 * n / window).min(n - fitted as f64).max(1.0),
        }
    }
}

fn add(sum: &mut [f64], row: &[f64], factor: f64) {
    sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += factor * value);
}

/// Calls a function with the sum of every window of `lag + 1` rows that has a row of the record in it.
fn windows(record: &[f64], width: usize, lag: usize, mut take: impl FnMut(&[f64])) {
    let rows = record.len() / width;
    let row = |at: usize| &record[at * width..(at + 1) * width];
    let mut window = vec![0.0; width];
    for end in 0..rows + lag {
        if end < rows {
            add(&mut window, row(end), 1.0);
        }
        if end > lag {
            add(&mut window, row(end - lag - 1), -1.0);
        }
        take(&window);
    }
}

const HIGHEST_ORDER: usize = 12;

/// An autoregression of a residual, `e_t = φ_1 e_{t-1} + ... + φ_p e_{t-p} + ε_t` with independent `ε`.
///
/// The coefficients follow from the autocorrelations by the recursion of Durbin and Levinson, the order `p` from the
/// criterion of Schwarz (1978).
#[derive(Debug, Clone, PartialEq)]
pub struct Autoregression {
    /// `φ_1 .. φ_p`.
    pub coefficients: Vec<f64>,
    /// Variance of `ε`.
    pub variance: f64,
}

impl Autoregression {
    /// Of the residuals of records.
    pub fn of(records: &[Vec<f64>]) -> Self {
        let rows: usize = records.iter().map(Vec::len).sum();
        let n = rows.max(1) as f64;
        let mean = records.iter().flatten().sum::<f64>() / n;
        let variance = records.iter().flatten().map(|e| (e - mean) * (e - mean)).sum::<f64>() / n;
        let r: Vec<f64> =
            autocorrelations(records, HIGHEST_ORDER.min(rows / 10)).into_iter().map(|(r, _)| r).collect();
        let (mut phi, mut left) = (Vec::<f64>::new(), 1.0f64);
        let mut best = (0.0, Self { coefficients: Vec::new(), variance });
        for k in 0..r.len() {
            let known: f64 = phi.iter().zip(r[..k].iter().rev()).map(|(phi, r)| phi * r).sum();
            let partial = ((r[k] - known) / left).clamp(-0.9999, 0.9999);
            let before = phi.clone();
            phi.iter_mut().zip(before.iter().rev()).for_each(|(phi, other)| *phi -= partial * other);
            phi.push(partial);
            left *= 1.0 - partial * partial;
            let criterion = n * ln(left) + (k + 1) as f64 * ln(n);
            if criterion < best.0 {
                best = (criterion, Self { coefficients: phi.clone(), variance: variance * left });
            }
        }
        best.1
    }

    /// Covariance of `Σ_t J_t e_t` for given vectors `J_t`, each of `width` numbers, in records one after another
    /// (theory.md (13.12)).
    pub fn covariance(&self, records: &[Vec<f64>], width: usize) -> Symmetric {
        let order = self.coefficients.len();
        let mut products = vec![0.0; width * width];
        for record in records {
            let rows = record.len() / width;
            // Effect of a shock on the sum: J_s and, by the recursion, what follows. Shocks before the record act on it
            // too, until they have faded.
            let mut after: Vec<Vec<f64>> = vec![vec![0.0; width]; order];
            let mut largest = 0.0f64;
            for step in 0..2 * rows + 10 {
                let mut effect = match rows.checked_sub(step + 1) {
                    Some(row) => record[row * width..(row + 1) * width].to_vec(),
                    None => vec![0.0; width],
                };
                for (phi, later) in self.coefficients.iter().zip(&after) {
                    add(&mut effect, later, *phi);
                }
                let size = effect.iter().fold(0.0f64, |size, v| size.max(v.abs()));
                largest = largest.max(size);
                for i in 0..width {
                    for j in 0..=i {
                        products[i * width + j] += effect[i] * effect[j];
                    }
                }
                if step >= rows && size < 1e-4 * largest {
                    break;
                }
                if order > 0 {
                    after.rotate_right(1);
                    after[0] = effect;
                }
            }
        }
        Symmetric::from_fn(width, |i, j| self.variance * products[i.max(j) * width + i.min(j)])
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::{powi, sin};

    use super::*;

    fn record(rows: usize) -> Vec<f64> {
        (0..rows).map(|k| sin((k * k) as f64 * 0.37)).collect()
    }

    /// Against the sum over lags as Newey and West write it.
    #[test]
    fn windows_give_the_estimator_of_newey_and_west() {
        let records = [record(40), record(7)];
        for lag in [0, 1, 5, 12] {
            let mut expected = 0.0;
            for record in &records {
                for (s, a) in record.iter().enumerate() {
                    for (t, b) in record.iter().enumerate().filter(|(t, _)| t.abs_diff(s) <= lag) {
                        expected += (1.0 - s.abs_diff(t) as f64 / (lag + 1) as f64) * a * b;
                    }
                }
            }
            let found = SerialSum::of(&records, 1, lag, 0);
            approx::assert_relative_eq!(found.covariance.at(0, 0), expected, max_relative = 1e-10);
        }
    }

    #[test]
    fn components_have_their_covariances() {
        let rows: Vec<f64> = record(60).iter().flat_map(|&v| [v, 2.0 * v, 1.0]).collect();
        let found = SerialSum::of(&[rows], 3, 4, 0);
        let alone = SerialSum::of(&[record(60)], 1, 4, 0);
        approx::assert_relative_eq!(
            found.covariance.at(1, 0),
            2.0 * alone.covariance.at(0, 0),
            max_relative = 1e-10
        );
        approx::assert_relative_eq!(found.sum[1], 2.0 * alone.sum[0], max_relative = 1e-12);
        assert_eq!(found.sum[2], 60.0);
    }

    #[test]
    fn autocorrelations_are_those_of_the_definition() {
        let found = autocorrelations(&[vec![1.0, 2.0, 4.0], vec![1.0, 2.0]], 2);
        // Mean 2, squares 1 + 0 + 4 + 1 + 0 = 6; lag 1: 0 + 0 + 0; lag 2: -1 * 2.
        assert_eq!(found, [(0.0, 3), (-2.0 / 6.0, 1)]);
    }

    /// Against the double sum over the autocovariances a^|s-t|.
    #[test]
    fn the_covariance_of_an_autoregression_is_the_double_sum() {
        let a = 0.7;
        let rows: Vec<f64> = record(50).into_iter().flat_map(|v| [v, 1.0]).collect();
        let known = Autoregression { coefficients: vec![a], variance: 1.0 - a * a };
        let found = known.covariance(std::slice::from_ref(&rows), 2);
        for (i, j) in [(0, 0), (1, 0), (1, 1)] {
            let mut expected = 0.0;
            for s in 0..50 {
                for t in 0..50 {
                    expected += rows[2 * s + i] * rows[2 * t + j] * powi(a, i32::abs(s as i32 - t as i32));
                }
            }
            assert!((found.at(i, j) - expected).abs() < 1e-4 * expected.abs().max(1.0), "{i} {j}");
        }
    }

    #[test]
    fn an_autoregression_is_recognised() {
        let uniform =
            |k: u64| f64::from((hysid_core::random::mix(k) >> 40) as u32) / f64::from(1u32 << 24) - 0.5;
        let (mut before, mut last) = (0.0, 0.0);
        let rows: Vec<f64> = (0..50_000)
            .map(|k| {
                (before, last) = (last, 1.2 * last - 0.5 * before + uniform(k));
                last
            })
            .collect();
        let found = Autoregression::of(&[rows]);
        assert!((found.coefficients[0] - 1.2).abs() < 0.02 && (found.coefficients[1] + 0.5).abs() < 0.02);
        approx::assert_relative_eq!(found.variance, 1.0 / 12.0, max_relative = 0.03);
    }

    #[test]
    fn a_slow_part_beside_noise_is_seen() {
        let noise = |k: usize| {
            f64::from((hysid_core::random::mix(k as u64) >> 40) as u32) / f64::from(1u32 << 23) - 1.0
        };
        let white: Vec<f64> = (0..20_000).map(noise).collect();
        let slow: Vec<f64> = white.iter().enumerate().map(|(k, e)| e + 0.3 * sin(k as f64 * 0.002)).collect();
        assert!(correlation_lag(&[white]) < 10);
        assert!(correlation_lag(&[slow]) > 200);
    }
}
