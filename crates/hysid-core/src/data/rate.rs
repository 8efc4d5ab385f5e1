//! Rate (time derivative) of an input, from its samples and time stamps.
//!
//! ```text
//! central         x'_k = [h_-² x_{k+1} + (h_+² - h_-²) x_k - h_+² x_{k-1}]/(h_- h_+ (h_- + h_+))    theory.md (4.1)
//! at the ends     x'_0 = (x_1 - x_0)/(t_1 - t_0),  and likewise at the last row                   theory.md (4.2)
//! backward        x'_k = (x_k - x_{k-1})/h_-,   x'_0 = 0                                          theory.md (4.3)
//! Savitzky-Golay  x'_k = α_1 of the least                                                         theory.md (4.4)
//!                 Σ_i (x_i - α_0 - α_1 (t_i - t_k) - α_2 (t_i - t_k)²)²
//! ```
//!
//! `x_k` is the input at the time `t_k`; the steps `h_- = t_k - t_{k-1}` and `h_+ = t_{k+1} - t_k` need not
//! be equal. The sum of the last line is over the rows `i` of a window around `k`.

use serde::{Deserialize, Serialize};

use crate::data::record::{Excitation, Record};
use crate::error::{Channel, DataProblem, LARGEST_VALUE, Result};
use crate::named;

/// Method by which the rate of the first input is found. A model stores the method of its training.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RateMethod {
    /// The rate is a column of the record.
    Given,
    /// Central difference: the slope at `t_k` of the parabola through three samples (theory.md (4.1));
    /// one-sided difference `(x_1 - x_0)/(t_1 - t_0)` at the ends of a record (theory.md (4.2)).
    Central,
    /// Backward difference, `(x_k - x_{k-1})/(t_k - t_{k-1})`, which needs no later sample and is therefore
    /// available in real time (theory.md (4.3)).
    Backward,
    /// Savitzky-Golay: slope of the least-squares parabola through the neighbours, which smooths noise
    /// (theory.md (4.4)).
    SavitzkyGolay,
}

/// Neighbours on each side of a Savitzky-Golay window.
const HALF_WINDOW: usize = 5;

named!(
    RateMethod, "rate":
    Given = "given", Central = "central", Backward = "backward", SavitzkyGolay = "savitzky-golay"
);

impl RateMethod {
    /// Numbers of rows before and after a row from which its rate follows.
    pub(crate) fn rows_around(self) -> (usize, usize) {
        match self {
            RateMethod::Given => (0, 0),
            RateMethod::Central => (1, 1),
            RateMethod::Backward => (1, 0),
            RateMethod::SavitzkyGolay => (HALF_WINDOW, HALF_WINDOW),
        }
    }

    /// Rate of the record's first input, in its unit divided by that of time, one value a row.
    ///
    /// # Errors
    /// No time stamps (or no given rate), or a rate beyond [`LARGEST_VALUE`].
    pub fn rate(self, record: &Record) -> Result<Vec<f64>> {
        let mut rate = vec![0.0; record.len()];
        self.fill(&record.excitation(), 0, &mut rate)?;
        Ok(rate)
    }

    /// Rates of the rows from `first` on, one for each element of `rate`.
    pub(crate) fn fill(self, excitation: &Excitation<'_>, first: usize, rate: &mut [f64]) -> Result<()> {
        let rows = first..first + rate.len();
        match (self, excitation.time()) {
            (RateMethod::Given, _) => {
                let missing = || excitation.defect(None, Some(Channel::Rate), DataProblem::NoGivenRate);
                rate.copy_from_slice(&excitation.given_rate().ok_or_else(missing)?[rows]);
            }
            (_, None) => return Err(excitation.defect(None, Some(Channel::Time), DataProblem::NoTime)),
            (RateMethod::Central, Some(time)) => central(time, excitation.inputs()[0], rows, rate),
            (RateMethod::Backward, Some(time)) => {
                each(rows, rate, |row| backward_at(time, excitation.inputs()[0], row));
            }
            (RateMethod::SavitzkyGolay, Some(time)) => {
                each(rows, rate, |row| savitzky_golay_at(time, excitation.inputs()[0], row));
            }
        }
        match rate.iter().position(|rate| rate.is_nan() || rate.abs() > LARGEST_VALUE) {
            Some(row) => {
                let problem = DataProblem::RateTooLarge(rate[row]);
                Err(excitation.defect(Some(first + row), Some(Channel::Time), problem))
            }
            None => Ok(()),
        }
    }
}

fn each(rows: std::ops::Range<usize>, rate: &mut [f64], value: impl Fn(usize) -> f64) {
    for (rate, row) in rate.iter_mut().zip(rows) {
        *rate = value(row);
    }
}

/// Backward difference `(x_k - x_{k-1})/(t_k - t_{k-1})` at `row`, 0 at the first (theory.md (4.3)).
fn backward_at(time: &[f64], x: &[f64], row: usize) -> f64 {
    if row == 0 { 0.0 } else { (x[row] - x[row - 1]) / (time[row] - time[row - 1]) }
}

/// Central differences inside, one-sided at the ends.
fn central(time: &[f64], x: &[f64], rows: std::ops::Range<usize>, rate: &mut [f64]) {
    let last = x.len() - 1;
    let inner = rows.start.max(1)..rows.end.min(last);
    if inner.start < inner.end {
        let around = inner.start - 1..inner.end + 1;
        let points = time[around.clone()].windows(3).zip(x[around].windows(3));
        for (rate, (t, x)) in rate[inner.start - rows.start..].iter_mut().zip(points) {
            // theory.md (4.1) as a weighted mean of both one-sided slopes: no squares of tiny steps.
            let (before, after) = (t[1] - t[0], t[2] - t[1]);
            let share = before / (before + after);
            *rate = share * ((x[2] - x[1]) / after) + (1.0 - share) * ((x[1] - x[0]) / before);
        }
    }
    for row in [0, last] {
        if rows.contains(&row) {
            rate[row - rows.start] = backward_at(time, x, if row == 0 { last.min(1) } else { row });
        }
    }
}

fn savitzky_golay_at(time: &[f64], x: &[f64], row: usize) -> f64 {
    let first = row.saturating_sub(HALF_WINDOW);
    let last = (row + HALF_WINDOW).min(x.len() - 1);
    slope_of_parabola(&time[first..=last], &x[first..=last], row - first)
}

/// Slope at `centre` of the parabola that fits best; of a line or 0 for fewer than three points.
fn slope_of_parabola(time: &[f64], x: &[f64], centre: usize) -> f64 {
    let n = time.len() as f64;
    let unit = time[time.len() - 1] - time[0];
    if time.len() < 2 {
        return 0.0;
    }
    let t: Vec<f64> = time.iter().map(|t| (t - time[centre]) / unit).collect();
    let mean = |f: &dyn Fn(usize) -> f64| (0..t.len()).map(f).sum::<f64>() / n;
    let (t1, t2) = (mean(&|i| t[i]), mean(&|i| t[i] * t[i]));
    let x1 = mean(&|i| x[i]);
    // Orthogonal polynomials 1, p = t - t1, q = t² - t2 - s p: their coefficients are projections.
    let spread = t2 - t1 * t1;
    let s = mean(&|i| (t[i] * t[i] - t2) * (t[i] - t1)) / spread;
    let q = |i: usize| t[i] * t[i] - t2 - s * (t[i] - t1);
    let linear = mean(&|i| (x[i] - x1) * (t[i] - t1)) / spread;
    let q_norm = mean(&|i| q(i) * q(i));
    let quadratic = if time.len() < 3 { 0.0 } else { mean(&|i| (x[i] - x1) * q(i)) / q_norm };
    // d/dt at t = 0 of linear p + quadratic q
    (linear - quadratic * s) / unit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elementary::{sin, square};

    fn uneven(n: usize) -> Vec<f64> {
        (0..n).map(|k| k as f64 + 0.3 * sin(1.7 * k as f64)).collect()
    }

    /// Central differences and Savitzky-Golay are exact for a parabola, whatever the steps.
    fn rate(method: RateMethod, time: &[f64], x: &[f64]) -> Vec<f64> {
        let record = Record::new("r", vec![x.to_vec()], vec![0.0; x.len()]).unwrap();
        let record = record.with_time(time.to_vec()).unwrap();
        let whole = method.rate(&record).unwrap();
        // Row by row gives the same.
        for (row, &expected) in whole.iter().enumerate() {
            let mut one = [f64::NAN];
            method.fill(&record.excitation(), row, &mut one).unwrap();
            assert_eq!(one[0], expected, "row {row}");
        }
        whole
    }

    #[test]
    fn a_parabola_has_its_exact_rate() {
        let time = uneven(40);
        let x: Vec<f64> = time.iter().map(|t| 1.0 - 2.0 * t + 0.25 * t * t).collect();
        for k in 1..39 {
            let exact = -2.0 + 0.5 * time[k];
            approx::assert_relative_eq!(rate(RateMethod::Central, &time, &x)[k], exact, epsilon = 1e-10);
            approx::assert_relative_eq!(rate(RateMethod::SavitzkyGolay, &time, &x)[k], exact, epsilon = 1e-9);
        }
        assert_eq!(rate(RateMethod::Central, &time, &x)[0], (x[1] - x[0]) / (time[1] - time[0]));
        assert_eq!(rate(RateMethod::Backward, &time, &x)[0], 0.0);
        assert_eq!(rate(RateMethod::Backward, &time, &x)[7], (x[7] - x[6]) / (time[7] - time[6]));
    }

    #[test]
    fn savitzky_golay_averages_noise_away() {
        let time = uneven(400);
        let noise = |k: usize| ((k * 7919 % 101) as f64 / 101.0 - 0.5) * 0.1;
        let x: Vec<f64> = time.iter().enumerate().map(|(k, t)| 3.0 * t + noise(k)).collect();
        let error = |rate: Vec<f64>| rate[10..390].iter().map(|r| square(r - 3.0f64)).sum::<f64>();
        assert!(
            error(rate(RateMethod::SavitzkyGolay, &time, &x))
                < 0.1 * error(rate(RateMethod::Central, &time, &x))
        );
    }

    #[test]
    fn short_records_have_a_rate() {
        assert_eq!(rate(RateMethod::Central, &[0.0], &[1.0]), [0.0]);
        assert_eq!(rate(RateMethod::SavitzkyGolay, &[0.0], &[1.0]), [0.0]);
        approx::assert_relative_eq!(
            rate(RateMethod::SavitzkyGolay, &[0.0, 2.0], &[1.0, 5.0])[1],
            2.0,
            epsilon = 1e-12
        );
    }
}
