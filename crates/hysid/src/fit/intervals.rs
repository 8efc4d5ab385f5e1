//! Confidence intervals of the parameters of a classical law.
//!
//! ```text
//! cov(z) = H⁺ V H⁺,   H = JᵀJ,   V = covariance of Σ_t J_t e_t            theory.md (13.10)
//! p_i ± t_{0.975,ν} √(G_i cov(z) G_iᵀ)                                     theory.md (13.11)
//! ```
//!
//! `J` is the derivative of the free run by the variables `z` of the fit, and `G` that of the parameters `p` of the law
//! (theory.md (13.9)). `e` is the residual. `V` is the estimate of Newey and West with the lag of Andrews (theory.md
//! (13.1), (13.2)): the sandwich estimator of White (1980) for rows that are correlated in time, of a size that may
//! depend on the input. `ν` are its degrees of freedom (theory.md (13.3)). With few independent rows it is too small;
//! beside it stands the covariance for a residual that is an autoregression and has nothing to do with the input
//! (theory.md (13.12)), and of both the larger standard error counts.
//!
//! A variable at an end of its range does not move; the intervals of the others hold for it there. A parameter is not
//! determined by the data if it changes along a direction in which the free run does not, or if its interval is as long
//! as the range of the search.
//!
//! The intervals hold for a law that can represent the specimen. If it cannot, they are those of the parameters with the
//! lowest error on data like these.

mod eigenvectors;

use serde::Serialize;

use crate::data::record::{Dataset, Record};
use crate::diagnosis::distribution::t_quantile;
use crate::diagnosis::serial::{Autoregression, SerialSum, correlation_lag};
use crate::error::{Error, Result};
use crate::fit::law::linearised as of_law;
use crate::fit::law::linearised::{FitVariable, LinearisedLaw};
use crate::linear_algebra::{Symmetric, dot};
use crate::model::input_transform::TransformedData;
use crate::model::{Model, ParameterInUnits};
use crate::options::FitSpec;
use eigenvectors::Eigenvectors;

/// Probability of the intervals.
pub const PROBABILITY: f64 = 0.95;

const MOST_VARIABLES: usize = 130;

/// Eigenvalues of `H`, of columns of length 1, below this share of the largest are 0 to the precision of the differences.
const NO_EFFECT: f64 = 1e-9;

/// A parameter changes along a direction if this share of its gradient, or more, is in it.
const CHANGES: f64 = 1e-3;

/// Whether a parameter has an interval, and why not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum IntervalStatus {
    /// It has an interval.
    #[serde(rename = "determined")]
    Determined,
    /// It has an interval, but the error has a kink there: the interval is approximate.
    #[serde(rename = "at a kink")]
    AtKink,
    /// The fit left it at an end of its range.
    #[serde(rename = "at its bound")]
    AtBound,
    /// The data do not determine it.
    #[serde(rename = "not determined by the data")]
    NotDetermined,
    /// It was given, not fitted, such as a threshold of a grid.
    #[serde(rename = "not fitted")]
    NotFitted,
}

impl IntervalStatus {
    /// The status in the words of its JSON.
    pub fn words(self) -> &'static str {
        match self {
            Self::Determined => "determined",
            Self::AtKink => "at a kink",
            Self::AtBound => "at its bound",
            Self::NotDetermined => "not determined by the data",
            Self::NotFitted => "not fitted",
        }
    }
}

/// The confidence interval of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterInterval {
    /// The field's symbol, such as `r_3`.
    pub symbol: String,
    /// Its value, in the user's units.
    pub value: f64,
    /// Whether it has an interval, and why not.
    pub status: IntervalStatus,
    /// Lower end, in the user's units; `None` without an interval.
    pub low: Option<f64>,
    /// Upper end, likewise.
    pub high: Option<f64>,
    /// Standard error, likewise.
    pub standard_error: Option<f64>,
}

/// Confidence intervals of the parameters of a law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterIntervals {
    /// Probability with which an interval contains the value of the specimen.
    pub probability: f64,
    /// Rows of the training data that they are found from.
    pub rows: usize,
    /// Root mean square of the residual over them, in the unit of the output.
    pub residual_rms: f64,
    /// Rows up to which the residual is taken as correlated with itself.
    pub correlation_lag: usize,
    /// Degrees of freedom of the estimated scatter.
    pub degrees_of_freedom: f64,
    /// One for each parameter of the law, in its order.
    pub parameters: Vec<ParameterInterval>,
}

impl ParameterIntervals {
    /// The intervals of a classical law, from the data that it was fitted to; `None` for a network, an ensemble, a model
    /// that was distilled from one or fitted with weights of rows, and laws whose parameters have no meaning of their own (`preisach`,
    /// `neuro-madelung`, `duhem-nn`) or are more than 130.
    ///
    /// # Errors
    /// Data that the model was not fitted to.
    pub fn of(model: &Model, data: &Dataset) -> Result<Option<Self>> {
        let (Some(law), FitSpec::Classical(options)) = (model.law(), &model.provenance().options) else {
            return Ok(None);
        };
        let single = model.provenance().selection.as_ref().and_then(|selection| selection.single.as_ref());
        if model.provenance().weighted || single.is_some_and(|single| single.distilled) {
            return Ok(None);
        }
        check_trained_on(model, data)?;
        let begun = as_begun(model, data)?;
        let seen = TransformedData::of(&begun, &options.shaping, options.rate, options.model.facts().origin)?;
        let options = crate::options::classical::ClassicalOptions { rate: seen.rate, ..options.clone() };
        let Some(linearised) = of_law(law, &seen.data, &options)? else { return Ok(None) };
        if linearised.variables.len() > MOST_VARIABLES {
            return Ok(None);
        }
        Ok(model.law_parameters().map(|parameters| intervals(&parameters, &linearised)))
    }
}

/// Rejects data that the model was not fitted to, as far as it remembers its records.
fn check_trained_on(model: &Model, data: &Dataset) -> Result<()> {
    if model.trained_ranges().records.is_empty() {
        return Ok(());
    }
    let is_other = |record: &&Record| {
        let fingerprint = record.fingerprint();
        fingerprint.text().is_some() && !model.was_trained_on(&fingerprint)
    };
    match data.records().iter().find(is_other) {
        Some(record) => Err(Error::NotTrainedOn(record.name().into())),
        None => Ok(()),
    }
}

/// The data in the initial states in which the model was fitted to them.
fn as_begun(model: &Model, data: &Dataset) -> Result<Dataset> {
    let begun = model.as_trained(data)?.into_owned();
    if model.lead_in().is_empty() || !model.provenance().lead_ins.is_empty() {
        return Ok(begun);
    }
    begun.with_lead_ins(|_, record| record.lead_in().unwrap_or(model.lead_in()).to_vec())
}

fn intervals(parameters: &[ParameterInUnits], linearised: &LinearisedLaw) -> ParameterIntervals {
    let spread = ParameterSpread::of(linearised);
    let named = parameters.iter().zip(&linearised.gradients);
    let of_parameter = |(in_units, gradient): (&ParameterInUnits, &Vec<f64>)| {
        let parameter = &in_units.parameter;
        let (status, standard_error) = spread.of_parameter(gradient, &linearised.variables);
        let standard_error = standard_error.map(|error| error * in_units.factor);
        let half = standard_error.map(|error| error * spread.quantile);
        let (lowest, highest) = parameter.bounds;
        ParameterInterval {
            symbol: parameter.symbol.clone(),
            value: parameter.value,
            status,
            low: half.map(|half| (parameter.value - half).max(lowest)),
            high: half.map(|half| (parameter.value + half).min(highest)),
            standard_error,
        }
    };
    ParameterIntervals {
        probability: PROBABILITY,
        rows: linearised.residual.len(),
        residual_rms: (dot(&linearised.residual, &linearised.residual) / linearised.residual.len() as f64)
            .sqrt(),
        correlation_lag: spread.lag,
        degrees_of_freedom: spread.degrees,
        parameters: named.map(of_parameter).collect(),
    }
}

struct ParameterSpread {
    free: Vec<usize>,
    /// Length of the column of each free variable.
    lengths: Vec<f64>,
    /// Covariances of the free variables times their lengths: by Newey and West, and by an autoregression.
    covariances: [Symmetric; 2],
    /// Directions in which the free run does not change, in the same variables.
    directions_without_effect: Vec<Vec<f64>>,
    lag: usize,
    degrees: f64,
    /// Quantile of the interval, in standard errors.
    quantile: f64,
}

impl ParameterSpread {
    fn of(linearised: &LinearisedLaw) -> Self {
        let LinearisedLaw { variables, residual, .. } = linearised;
        let length = |variable: &FitVariable| dot(&variable.column, &variable.column).sqrt();
        let free: Vec<usize> = (0..variables.len()).filter(|&j| !variables[j].at_bound).collect();
        let lengths: Vec<f64> = free.iter().map(|&j| length(&variables[j])).collect();
        let scale =
            |k: usize| if lengths[k] > 0.0 && lengths[k].is_finite() { 1.0 / lengths[k] } else { 0.0 };
        let column = |k: usize| variables[free[k]].column.as_slice();
        let n = free.len();
        let gram = Symmetric::from_fn(n, |i, j| scale(i) * scale(j) * dot(column(i), column(j)));
        let Eigenvectors { values, vectors } = Eigenvectors::of(&gram, n);
        let largest = values.iter().copied().fold(0.0, f64::max);
        let has_effect = |value: f64| value > NO_EFFECT * largest;
        let inverse = Symmetric::from_fn(n, |i, j| {
            let of = |(value, vector): (&f64, &Vec<f64>)| vector[i] * vector[j] / value;
            values.iter().zip(&vectors).filter(|(value, _)| has_effect(**value)).map(of).sum()
        });
        let directions = values.iter().zip(vectors).filter(|(value, _)| !has_effect(**value));
        let directions_without_effect = directions.map(|(_, vector)| vector).collect();

        let mut of_records = Vec::new();
        let (mut jacobian, mut scores) = (Vec::new(), Vec::new());
        let mut first = 0;
        for &rows in &linearised.records {
            let range = first..first + rows;
            first += rows;
            of_records.push(residual[range.clone()].to_vec());
            let of_row = |row: usize| (0..n).map(move |k| (k, row));
            let slope = |(k, row): (usize, usize)| scale(k) * column(k)[row];
            jacobian.push(range.clone().flat_map(of_row).map(slope).collect::<Vec<f64>>());
            scores.push(range.flat_map(of_row).map(|at| slope(at) * residual[at.1]).collect::<Vec<f64>>());
        }
        let lag = correlation_lag(&of_records);
        let sums = SerialSum::of(&scores, n.max(1), lag, n.max(1));
        let rows = residual.len() as f64;
        let fitted = rows / (rows - n as f64).max(1.0);
        let independent = Autoregression::of(&of_records).covariance(&jacobian, n.max(1));
        // H⁺ V H⁺, column by column; of stretches, for all rows.
        let times = |matrix: &Symmetric, j: usize| (0..n).map(|i| matrix.at(i, j)).collect::<Vec<f64>>();
        let sandwich = |middle: &Symmetric, factor: f64| {
            let columns: Vec<Vec<f64>> =
                (0..n).map(|j| inverse.times(&middle.times(&times(&inverse, j)))).collect();
            let factor = 0.5 * factor / linearised.rows_each;
            Symmetric::from_fn(n, |i, j| factor * (columns[j][i] + columns[i][j]))
        };
        Self {
            covariances: [sandwich(&sums.covariance, 1.0), sandwich(&independent, fitted)],
            free,
            lengths,
            directions_without_effect,
            lag,
            degrees: sums.degrees,
            quantile: t_quantile(1.0 - PROBABILITY, sums.degrees),
        }
    }

    /// The larger variance of a sum of the scaled variables.
    fn variance(&self, scaled: &[f64]) -> f64 {
        self.covariances.iter().map(|covariance| dot(scaled, &covariance.times(scaled))).fold(0.0, f64::max)
    }

    /// Status and standard error of a parameter with these derivatives.
    fn of_parameter(&self, gradient: &[f64], variables: &[FitVariable]) -> (IntervalStatus, Option<f64>) {
        if gradient.iter().all(|slope| *slope == 0.0) {
            return (IntervalStatus::NotFitted, None);
        }
        let depends_on = |j: usize| gradient[j] != 0.0;
        if (0..variables.len()).any(|j| variables[j].at_bound && depends_on(j)) {
            return (IntervalStatus::AtBound, None);
        }
        if self.free.iter().zip(&self.lengths).any(|(&j, &length)| depends_on(j) && length <= 0.0) {
            return (IntervalStatus::NotDetermined, None);
        }
        let scaled: Vec<f64> = self
            .free
            .iter()
            .zip(&self.lengths)
            .map(|(&j, &length)| if length > 0.0 { gradient[j] / length } else { 0.0 })
            .collect();
        let size = dot(&scaled, &scaled).sqrt();
        let along = |direction: &Vec<f64>| dot(direction, &scaled).abs() > CHANGES * size;
        if self.directions_without_effect.iter().any(along) || self.is_as_long_as_a_range(gradient, variables)
        {
            return (IntervalStatus::NotDetermined, None);
        }
        let is_kinked = self.free.iter().any(|&j| variables[j].is_kinked && depends_on(j));
        let status = if is_kinked { IntervalStatus::AtKink } else { IntervalStatus::Determined };
        (status, Some(self.variance(&scaled).sqrt()))
    }

    /// True if a variable that the parameter depends on has an interval as long as its range.
    fn is_as_long_as_a_range(&self, gradient: &[f64], variables: &[FitVariable]) -> bool {
        self.free.iter().enumerate().any(|(k, &j)| {
            let variances = self.covariances.iter().map(|covariance| covariance.diagonal(k));
            let error = variances.fold(0.0, f64::max).sqrt() / self.lengths[k];
            gradient[j] != 0.0 && variables[j].range.is_some_and(|range| 2.0 * self.quantile * error >= range)
        })
    }
}
