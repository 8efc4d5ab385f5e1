//! Records in the form in which laws are fitted to them: samples and outputs, row by row, in the user's
//! units.

use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Excitation, Record, Values};
use crate::error::Result;
use crate::law::{Law, Sample};

/// The samples of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The sample of each row, those of a [lead-in](crate::data::initial_state) first.
    pub samples: Vec<Sample>,
    /// The measured output; NaN where it is blank, as in a lead-in.
    pub output: Vec<f64>,
    /// Weight of each row in the sum of squares; empty if all count alike.
    pub weights: Vec<f64>,
    /// Columns of the inputs beside the first.
    pub further: Vec<Vec<f64>>,
}

impl Series {
    /// The samples of a record; rates are 0 without a method, time steps are 0 without time.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn of(record: &Record, rate: Option<RateMethod>) -> Result<Self> {
        let mut all: Vec<Sample> = lead_in_samples(&record.lead_in_rows()).collect();
        let lead_in = all.len();
        let mut output = vec![f64::NAN; lead_in];
        all.extend(samples(&record.excitation(), rate)?);
        output.extend(record.output());
        let column = |values: &Values| [&vec![values[0]; lead_in], &values[..]].concat();
        let further = record.inputs()[1..].iter().map(column).collect();
        let padded = |weights: &[f64]| [&vec![1.0; lead_in], weights].concat();
        let weights = record.weights().map_or_else(Vec::new, padded);
        Ok(Self { samples: all, output, weights, further })
    }

    /// Weight of a row in the sum of squares.
    pub fn weight(&self, row: usize) -> f64 {
        self.weights.get(row).copied().unwrap_or(1.0)
    }

    /// All records of a data set that have an output.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn all(data: &Dataset, rate: Option<RateMethod>) -> Result<Vec<Self>> {
        let used = data.records().iter().filter(|record| record.scored() > 0);
        used.map(|record| Self::of(record, rate)).collect()
    }
}

/// The sample of each row; rates are 0 without a method, time steps are 0 without time stamps.
///
/// # Errors
/// A rate that cannot be computed.
pub fn samples(excitation: &Excitation<'_>, rate: Option<RateMethod>) -> Result<Vec<Sample>> {
    let mut rates = vec![0.0; excitation.len()];
    if let Some(method) = rate {
        method.fill(excitation, 0, &mut rates)?;
    }
    let time = excitation.time();
    let step = |row: usize| time.filter(|_| row > 0).map_or(0.0, |time| time[row] - time[row - 1]);
    let rows = excitation.inputs()[0].iter().zip(rates).enumerate();
    Ok(rows.map(|(row, (&x, rate))| Sample { x, rate, step: step(row) }).collect())
}

/// Samples of the rows of a lead-in, in which nothing has a rate and relaxation is complete.
pub(crate) fn lead_in_samples(rows: &[f64]) -> impl Iterator<Item = Sample> + '_ {
    rows.iter().map(|&x| Sample { x, rate: 0.0, step: f64::INFINITY })
}

/// Samples of an input without rate and time.
pub fn samples_of(x: &[f64]) -> Vec<Sample> {
    x.iter().map(|&x| Sample { x, rate: 0.0, step: 0.0 }).collect()
}

/// Free run of a law from its virgin state.
pub fn run<L: Law>(law: &L, samples: &[Sample]) -> Vec<f64> {
    let mut outputs = vec![0.0; samples.len()];
    run_on(law, &mut law.virgin(), samples, &[], &mut outputs);
    outputs
}

/// Free run of a law from a given state, with the columns of the inputs beside the first.
pub(crate) fn run_on<L: Law>(
    law: &L,
    state: &mut L::State,
    samples: &[Sample],
    further: &[&[f64]],
    outputs: &mut [f64],
) {
    if further.is_empty() {
        outputs.iter_mut().zip(samples).for_each(|(output, sample)| *output = law.step(state, *sample));
        return;
    }
    let mut values = vec![0.0; further.len()];
    for (row, (output, sample)) in outputs.iter_mut().zip(samples).enumerate() {
        values.iter_mut().zip(further).for_each(|(value, column)| *value = column[row]);
        *output = law.step_with(state, *sample, &values);
    }
}

/// The work of all loops, `∮ y dx`, in the unit of the output times that of the input: positive for an output
/// that leads, as friction does, negative for one that lags behind its input, as a play does.
///
/// Each measured row counts with half the path of the input from the previous to the next row. This is the
/// trapezoidal rule if all rows are measured, and has the right sign if only some are.
pub fn work(series: &[Series]) -> f64 {
    let slope = slope(series);
    let of_one = |series: &Series| -> f64 {
        let x = |row: usize| series.samples[row].x;
        let last = series.samples.len().saturating_sub(1);
        let measured = || series.output.iter().enumerate().filter(|(_, y)| !y.is_nan());
        // Without a straight line through the first row, which has no loop but leaves an area where the
        // ends of the record lie apart.
        let Some((first, y_first)) = measured().next() else { return 0.0 };
        let bent = |row: usize, y: f64| y - y_first - slope * (x(row) - x(first));
        let way = |row: usize| 0.5 * (x((row + 1).min(last)) - x(row.saturating_sub(1)));
        measured().map(|(row, y)| bent(row, *y) * way(row)).sum()
    };
    series.iter().map(of_one).sum()
}

/// Slope of the straight line through the rows with an output, by least squares.
pub fn slope(series: &[Series]) -> f64 {
    let rows = || {
        let all = series.iter().flat_map(|series| series.samples.iter().zip(&series.output));
        all.filter(|(_, y)| !y.is_nan()).map(|(sample, &y)| (sample.x, y))
    };
    let n = rows().count().max(1) as f64;
    let x_mean = rows().map(|(x, _)| x).sum::<f64>() / n;
    let y_mean = rows().map(|(_, y)| y).sum::<f64>() / n;
    let product = rows().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>();
    let square = rows().map(|(x, _)| (x - x_mean) * (x - x_mean)).sum::<f64>();
    if square > 0.0 { product / square } else { 0.0 }
}
