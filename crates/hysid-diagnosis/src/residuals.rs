//! Structure that a model leaves unexplained: tests of its residual, measured minus simulated output of a free run.
//!
//! A residual that contains structure can be predicted, so a better model exists. Three questions are asked, each with
//! a p-value that respects the autocorrelation of the residual (theory.md section 13):
//!
//! | question | test |
//! |---|---|
//! | is it white? | autocorrelations with a 95 % bound, Ljung-Box statistic |
//! | is it correlated with the input, its rate and their past? | correlations at several lags, largest t-value |
//! | where is it large or biased? | root mean square and mean by place: after turning points, by rate, amplitude, distance from the mean, direction and time |
//!
//! p-values are corrected for the number of tests by the method of Holm (1979): over all tests of a data set, the
//! probability of any false finding is at most [`LEVEL`] if the residual is white noise.
//!
//! ```
//! use hysid_core::data::record::Dataset;
//! use hysid_diagnosis::residuals::{Residuals, ResidualOptions, ResidualTest};
//! // The measured output has a viscous part, the simulated one does not.
//! let x: Vec<f64> = (0..4000).map(|k| (0.1 * k as f64).sin() * (1.0 + 0.3 * (0.007 * k as f64).sin())).collect();
//! let rate = |k: usize| if k == 0 { 0.0 } else { x[k] - x[k - 1] };
//! let noise = |k: usize| 0.1 * (7.3 * (k * k) as f64).sin();
//! let y: Vec<f64> = x.iter().enumerate().map(|(k, x)| x + 2.0 * rate(k) + noise(k)).collect();
//! let residuals = Residuals::of(&Dataset::from_slices(&x, &y)?, &[x.clone()], &ResidualOptions::default())?;
//! assert!(residuals.is_found(ResidualTest::Rate));
//! # Ok::<(), hysid_core::Error>(())
//! ```

mod groups;
mod input;
mod rows;
mod whiteness;
mod words;

use hysid_core::data::record::Dataset;
use hysid_core::data::unit;
use hysid_core::error::{Channel, DataProblem, Result};
use hysid_core::model::Model;
use serde::Serialize;

use crate::serial::{SerialSum, correlation_lag};
pub use groups::{GroupedResiduals, ResidualGroup};
pub use input::InputCorrelation;
use rows::ResidualRows;
pub use whiteness::Whiteness;

/// Probability of any false finding over all tests of a data set, for white noise.
pub const LEVEL: f64 = 0.05;

/// Fewest scored rows that are tested.
pub const FEWEST_ROWS: usize = 50;

/// Most rows that are tested; of more, evenly spaced stretches.
pub const MOST_ROWS: usize = 200_000;

/// Options that the words of findings depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualOptions {
    /// True if the model already uses the rate of the input.
    pub uses_rate: bool,
    /// True for rows that the model was fitted to.
    pub is_training: bool,
    /// Reversals of the input below this share of its range are no turning points.
    pub smallest_reversal: f64,
}

impl Default for ResidualOptions {
    fn default() -> Self {
        Self { uses_rate: false, is_training: false, smallest_reversal: 0.02 }
    }
}

/// A test of the residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ResidualTest {
    /// Its mean is 0.
    Bias,
    /// It is white noise.
    Whiteness,
    /// It is not correlated with an input and its past.
    Input,
    /// It is not correlated with the rate of the first input and its past.
    Rate,
    /// It is the same after turning points as elsewhere.
    TurningPoints,
    /// It is the same for slow and fast inputs.
    Speed,
    /// It is the same in small and large half cycles.
    Amplitude,
    /// It is the same near the mean of the input as far from it.
    Distance,
    /// It is the same for a rising and a falling input.
    Direction,
    /// It is the same at the beginning, in the middle and at the end of the records.
    Time,
}

impl ResidualTest {
    /// Its name in tables, in JSON and in Python, in words joined by hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bias => "mean",
            Self::Whiteness => "whiteness",
            Self::Input => "input-correlation",
            Self::Rate => "rate-correlation",
            Self::TurningPoints => "after-turning-points",
            Self::Speed => "by-speed",
            Self::Amplitude => "by-amplitude",
            Self::Distance => "by-distance",
            Self::Direction => "by-direction",
            Self::Time => "over-time",
        }
    }
}

impl Serialize for ResidualTest {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Verdict of a test of the residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub enum ResidualVerdict {
    /// There is structure.
    #[serde(rename = "found")]
    Found,
    /// No structure was found.
    #[serde(rename = "not found")]
    NotFound,
    /// The data do not decide.
    #[serde(rename = "not testable")]
    NotTestable,
}

/// The result of a test of the residual.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualFinding {
    /// The test.
    pub test: ResidualTest,
    /// The input that it is about, for [`ResidualTest::Input`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// Verdict at [`LEVEL`], after the correction for the number of tests.
    pub verdict: ResidualVerdict,
    /// Probability of a statistic as large without structure; `None` if not testable.
    pub p_value: Option<f64>,
    /// The same, corrected for the number of tests.
    pub adjusted_p_value: Option<f64>,
    /// Result in a sentence.
    pub statement: String,
    /// Remedy in a sentence; `None` if nothing was found.
    pub advice: Option<String>,
}

/// The tests of the residual of a model on a data set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Residuals {
    /// Rows that were tested.
    pub rows: usize,
    /// Scored rows of the data: more than were tested for long data, of which evenly spaced stretches are taken.
    pub scored: usize,
    /// Records with a scored row.
    pub records: usize,
    /// Name of the output, with its unit.
    pub output: String,
    /// Root mean square of the residual, in the unit of the output.
    pub rms: f64,
    /// Mean of the residual, measured minus simulated, in the unit of the output.
    pub bias: f64,
    /// Number of independent rows whose mean would scatter as much as that of the residual; at most `rows`.
    pub effective_rows: f64,
    /// Rows up to which the residual is taken as correlated with itself in the other tests.
    pub correlation_lag: usize,
    /// Autocorrelation.
    pub whiteness: Whiteness,
    /// Correlation with each input and with the rate of the first.
    pub inputs: Vec<InputCorrelation>,
    /// Size and bias by place.
    pub places: Vec<GroupedResiduals>,
    /// Limitation of all tests, in a sentence; `None` if there is none.
    pub caution: Option<String>,
    /// Results of the tests, in the order of [`ResidualTest`].
    pub findings: Vec<ResidualFinding>,
}

impl Residuals {
    /// Tests the residual of a model in free run.
    ///
    /// # Errors
    /// As [`Model::simulate`], and fewer than [`FEWEST_ROWS`] scored rows.
    pub fn of_model(model: &Model, data: &Dataset, options: &ResidualOptions) -> Result<Self> {
        let simulated: Vec<Vec<f64>> =
            data.records().iter().map(|record| model.simulate(record)).collect::<Result<_>>()?;
        let uses_rate = options.uses_rate || model.rate().is_some();
        Self::of(data, &simulated, &ResidualOptions { uses_rate, ..options.clone() })
    }

    /// Tests the measured minus the simulated output; `simulated` has the simulated output of each row of each record.
    ///
    /// # Errors
    /// Fewer than [`FEWEST_ROWS`] scored rows.
    pub fn of(data: &Dataset, simulated: &[Vec<f64>], options: &ResidualOptions) -> Result<Self> {
        let all = ResidualRows::of(data, simulated, options.smallest_reversal);
        let scored = all.len();
        if scored < FEWEST_ROWS {
            let problem = DataProblem::TooFewForTests { found: scored, needed: FEWEST_ROWS };
            return Err(data.records()[0].defect(None, Some(Channel::Output), problem));
        }
        let rows = all.stretches(MOST_ROWS);
        let residual = rows.residual();
        let n = rows.len() as f64;
        let bias = residual.iter().flatten().sum::<f64>() / n;
        let rms = (residual.iter().flatten().map(|e| e * e).sum::<f64>() / n).sqrt();
        let lag = correlation_lag(&residual);
        let about_mean: Vec<Vec<f64>> =
            residual.iter().map(|record| record.iter().map(|e| e - bias).collect()).collect();
        let total = SerialSum::of(&about_mean, 1, lag, 1);
        let variance = rms * rms - bias * bias;
        let effective_rows = (n * n * variance / total.covariance.at(0, 0)).min(n);
        let names = data.names();
        let mut residuals = Self {
            rows: rows.len(),
            scored,
            records: data.records().iter().filter(|record| record.scored() > 0).count(),
            output: names.output.clone(),
            rms,
            bias,
            effective_rows: if effective_rows.is_finite() { effective_rows } else { n },
            correlation_lag: lag,
            whiteness: Whiteness::of(&residual),
            inputs: input::correlations(&rows, &about_mean, names),
            places: groups::places(&rows),
            caution: None,
            findings: Vec::new(),
        };
        residuals.caution = words::caution(&residuals, options);
        let unit = unit::of_column(&names.output);
        residuals.findings = words::findings(&residuals, &total, unit.as_deref(), options, data);
        Ok(residuals)
    }

    /// True if a test found structure.
    pub fn is_found(&self, test: ResidualTest) -> bool {
        self.findings.iter().any(|finding| finding.test == test && finding.verdict == ResidualVerdict::Found)
    }

    /// Findings of structure.
    pub fn found(&self) -> impl Iterator<Item = &ResidualFinding> {
        self.findings.iter().filter(|finding| finding.verdict == ResidualVerdict::Found)
    }
}

#[cfg(test)]
mod tests;
