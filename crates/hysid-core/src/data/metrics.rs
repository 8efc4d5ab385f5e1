//! Error metrics of a free run against a measured output.
//!
//! ```text
//! MSE        = Σ e²/N                                                      theory.md (5.1)
//! RMSE       = √MSE                                                        theory.md (5.2)
//! NRMSE_std  = 100 RMSE/√(Σ (y - ȳ)²/N)      % of the standard deviation   theory.md (5.3)
//! NRMSE_rng  = 100 RMSE/(max y - min y)      % of the range                theory.md (5.4)
//! fit        = 100 (1 - ‖e‖/‖y - ȳ‖)         %, = 100 - NRMSE_std          theory.md (5.5)
//! largest    = max |e|                                                     theory.md (5.6)
//! ```
//!
//! `e = ŷ - y` is the simulated minus the measured output, over the `N` scored rows (those with a measured
//! output) of all records together; `ȳ` is the mean of `y`. The standard deviation is that of the population.
//! Errors have the unit of the output, or are in percent as stated.

use serde::{Deserialize, Serialize};

/// Error metrics over all scored rows together; the equations are those of the [module page](self).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Name of the output.
    pub output: String,
    /// Number of scored rows: those with a measured output.
    pub samples: usize,
    /// Number of records with a scored row.
    pub records: usize,
    /// Mean square error, in the output's unit squared: `Σ e²/N` (theory.md (5.1)).
    pub mse: f64,
    /// Root mean square error, in the output's unit: `√mse` (theory.md (5.2)).
    pub rmse: f64,
    /// `rmse` in percent of the standard deviation (theory.md (5.3)); `None` for a constant output.
    pub nrmse_std_percent: Option<f64>,
    /// `rmse` in percent of the range of the measured output (theory.md (5.4)). `None` as there.
    pub nrmse_range_percent: Option<f64>,
    /// `100 - nrmse_std_percent`; it may be negative (theory.md (5.5)).
    pub fit_percent: Option<f64>,
    /// Largest absolute error, in the output's unit: `max |e|` (theory.md (5.6)).
    pub max_abs_error: f64,
}

/// A scored row: its measured output and its error.
#[derive(Debug, Clone, Copy)]
pub struct ScoredRow {
    /// The measured output, in its unit.
    pub measured: f64,
    /// Squared error; the mean of several if the row was simulated more than once.
    pub square_error: f64,
    /// Largest magnitude of the error.
    pub largest: f64,
}

impl ScoredRow {
    /// A row that was simulated once.
    pub fn once(measured: f64, error: f64) -> Self {
        Self { measured, square_error: error * error, largest: error.abs() }
    }
}

/// Running sums for [`Errors`], record by record, in one pass and constant memory.
#[derive(Debug, Clone, Default)]
pub struct ErrorSums {
    samples: usize,
    records: usize,
    /// The present record has a scored row.
    is_scored: bool,
    square_error: f64,
    largest: f64,
    mean: f64,
    square_deviation: f64,
    low: f64,
    high: f64,
}

impl ErrorSums {
    /// Adds a record: measured and simulated output of each row. Rows with a NaN measured output are skipped.
    pub fn add(&mut self, measured: &[f64], simulated: &[f64]) {
        self.add_rows(measured, simulated);
        self.end_record();
    }

    /// Adds rows of a record that is processed in blocks.
    pub fn add_rows(&mut self, measured: &[f64], simulated: &[f64]) {
        let rows = measured.iter().zip(simulated).filter(|(y, _)| !y.is_nan());
        rows.for_each(|(&y, &model)| self.add_row(ScoredRow::once(y, model - y)));
    }

    /// Ends a record that was processed in blocks.
    pub fn end_record(&mut self) {
        self.records += usize::from(std::mem::take(&mut self.is_scored));
    }

    /// Adds a scored row.
    pub fn add_row(&mut self, ScoredRow { measured: y, square_error, largest }: ScoredRow) {
        if self.samples == 0 {
            (self.low, self.high) = (y, y);
        }
        self.is_scored = true;
        self.samples += 1;
        self.square_error += square_error;
        self.largest = self.largest.max(largest);
        self.low = self.low.min(y);
        self.high = self.high.max(y);
        // Welford's running variance: no cancellation for a large mean.
        let deviation = y - self.mean;
        self.mean += deviation / self.samples as f64;
        self.square_deviation += deviation * (y - self.mean);
    }

    /// The errors so far, with this name of the output; `None` if no row was scored.
    pub fn errors(&self, output: &str) -> Option<Errors> {
        if self.samples == 0 {
            return None;
        }
        let n = self.samples as f64;
        let rmse = (self.square_error / n).sqrt();
        let percent_of = |scale: f64| Some(100.0 * rmse / scale).filter(|percent| percent.is_finite());
        let nrmse_std_percent = percent_of((self.square_deviation / n).sqrt());
        Some(Errors {
            output: output.to_string(),
            samples: self.samples,
            records: self.records,
            mse: self.square_error / n,
            rmse,
            nrmse_std_percent,
            nrmse_range_percent: percent_of(self.high - self.low),
            fit_percent: nrmse_std_percent.map(|nrmse| 100.0 - nrmse),
            max_abs_error: self.largest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentage_that_overflows_is_absent() {
        let mut sums = ErrorSums::default();
        sums.add(&[0.0, 1e-310, 2e-310], &[0.5, 0.5, 0.5]);
        let errors = sums.errors("y").unwrap();
        assert_eq!(errors.rmse, 0.5);
        assert_eq!(
            (errors.nrmse_std_percent, errors.nrmse_range_percent, errors.fit_percent),
            (None, None, None)
        );
    }

    #[test]
    fn errors_of_a_hand_computed_case() {
        let mut sums = ErrorSums::default();
        sums.add(&[1e6, f64::NAN, 1e6 + 2.0], &[1e6 + 1.0, 5.0, 1e6 + 2.0]);
        sums.add(&[1e6 + 4.0, f64::NAN], &[1e6 + 1.0, 0.0]);
        sums.add(&[f64::NAN], &[0.0]);
        let errors = sums.errors("F_N").unwrap();
        assert_eq!((errors.samples, errors.records), (3, 2));
        approx::assert_relative_eq!(errors.mse, 10.0 / 3.0);
        approx::assert_relative_eq!(errors.nrmse_std_percent.unwrap(), 100.0 * (10.0f64 / 8.0).sqrt());
        approx::assert_relative_eq!(errors.nrmse_range_percent.unwrap(), 25.0 * (10.0f64 / 3.0).sqrt());
        assert_eq!(errors.max_abs_error, 3.0);
    }

    #[test]
    fn a_constant_output_has_no_relative_error() {
        let mut sums = ErrorSums::default();
        assert_eq!(sums.errors("y"), None);
        sums.add(&[2.0, 2.0], &[2.0, 3.0]);
        assert_eq!(sums.errors("y").unwrap().nrmse_std_percent, None);
    }
}
