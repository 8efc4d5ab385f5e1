//! Scale factors between the user's units and those of a network.
//!
//! ```text
//! u = [x/X, x'/X', further inputs/their X],   y_scaled = (y - mean)/deviation      theory.md (2.1)
//! ```
//!
//! `x` is the first input and `x'` its rate. `X` and `X'` are their largest magnitudes in the training data;
//! mean and standard deviation are those of the measured output there.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Excitation, Record};
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::network::{Architecture, NetworkDrive};

/// Scale factors, found on the training data and stored in the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// Largest magnitude of each input in training, in its unit. It becomes 1 in scaled units.
    pub inputs: Vec<f64>,
    /// Largest magnitude of the rate in training, in its unit; `None` without rate.
    pub rate: Option<f64>,
    /// Mean of the output in training, in its unit. It becomes 0 in scaled units.
    pub output_mean: f64,
    /// Standard deviation of the output in training, in its unit. It becomes 1 in scaled units.
    pub output_deviation: f64,
}

/// Scales by which a value in the user's units can be divided and the quotient be squared.
pub(crate) const SCALES: RangeInclusive<f64> = 1e-150..=1e150;

impl Scaling {
    /// Rejects factors that are no usable divisors, and a mean beyond the largest value of a record.
    pub(crate) fn check(&self) -> Result<()> {
        let factors = self.inputs.iter().chain(&self.rate).chain([&self.output_deviation]);
        if let Some(factor) = factors.into_iter().find(|factor| !SCALES.contains(factor)) {
            return Err(Error::Parts(format!("its scaling has the factor {factor}")));
        }
        if self.output_mean.abs() <= LARGEST_VALUE {
            return Ok(());
        }
        Err(Error::Parts(format!("its scaling has the mean output {}", self.output_mean)))
    }

    /// The factors of a data set. `rate` is the method by which the rate is found; `None` for no rate.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn of(data: &Dataset, rate: Option<RateMethod>) -> Result<Self> {
        let inputs = (0..data.names().inputs.len()).map(|input| {
            let (low, high) = data.input_range(input);
            usable(low.abs().max(high.abs()))
        });
        let mut largest_rate: f64 = 0.0;
        if let Some(method) = rate {
            for record in data.records() {
                largest_rate =
                    method.rate(record)?.iter().fold(largest_rate, |most, rate| most.max(rate.abs()));
            }
        }
        let outputs = || data.records().iter().flat_map(|record| record.output()).filter(|y| !y.is_nan());
        let n = outputs().count().max(1) as f64;
        let mean = outputs().map(|y| y / n).sum::<f64>();
        let variance = outputs().map(|y| (y - mean) * ((y - mean) / n)).sum::<f64>();
        Ok(Self {
            inputs: inputs.collect(),
            rate: rate.map(|_| usable(largest_rate)),
            output_mean: mean,
            output_deviation: usable(variance.sqrt()),
        })
    }

    /// A record as scaled inputs of a network of this architecture, the rows of its lead-in first.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn drive(
        &self,
        record: &Record,
        architecture: &Architecture,
        rate: Option<RateMethod>,
    ) -> Result<NetworkDrive> {
        let rate = rate.filter(|_| architecture.rate);
        let lead_in = record.lead_in_rows();
        let rows = lead_in.len() + record.len();
        let mut channels = vec![vec![0.0; rows]; architecture.channels()];
        let excitation = record.excitation();
        let mut behind: Vec<&mut [f64]> =
            channels.iter_mut().map(|channel| &mut channel[lead_in.len()..]).collect();
        self.fill_channels(&excitation, rate, 0, record.len(), &mut behind)?;
        self.fill_lead_in(&lead_in, &excitation.others_at_first_row(), &mut channels);
        let mut steps = vec![f64::INFINITY; if architecture.relaxation > 0 { rows } else { 0 }];
        if let Some(behind) = steps.get_mut(lead_in.len()..) {
            behind.fill(0.0);
            Self::fill_steps(&excitation, 0, behind);
        }
        Ok(NetworkDrive { channels, steps })
    }

    /// Fills the channels of the rows of a lead-in: first input, rate 0, further inputs as at the first row.
    pub(crate) fn fill_lead_in(&self, first: &[f64], others: &[f64], channels: &mut [impl AsMut<[f64]>]) {
        let has_rate = channels.len() > self.inputs.len();
        let mut channels = channels.iter_mut().map(|channel| &mut channel.as_mut()[..first.len()]);
        let Some(channel) = channels.next() else { return };
        let factor = 1.0 / self.inputs[0];
        channel.iter_mut().zip(first).for_each(|(u, x)| *u = x * factor);
        if let Some(rate) = has_rate.then(|| channels.next()).flatten() {
            rate.fill(0.0);
        }
        for ((channel, value), scale) in channels.zip(others).zip(&self.inputs[1..]) {
            channel.fill(value * (1.0 / scale));
        }
    }

    /// Fills the channels (first input, its rate, further inputs) of `rows` rows from `first` on.
    pub(crate) fn fill_channels(
        &self,
        excitation: &Excitation<'_>,
        rate: Option<RateMethod>,
        first: usize,
        rows: usize,
        channels: &mut [impl AsMut<[f64]>],
    ) -> Result<()> {
        let mut channels = channels.iter_mut().map(|channel| &mut channel.as_mut()[..rows]);
        for (input, (x, &scale)) in excitation.inputs().iter().zip(&self.inputs).enumerate() {
            let Some(channel) = channels.next() else { break };
            let factor = 1.0 / scale;
            for (u, &x) in channel.iter_mut().zip(&x[first..]) {
                *u = x * factor;
            }
            if let (0, Some(method), Some(scale)) = (input, rate, self.rate)
                && let Some(channel) = channels.next()
            {
                method.fill(excitation, first, channel)?;
                let factor = 1.0 / scale;
                channel.iter_mut().for_each(|rate| *rate *= factor);
            }
        }
        Ok(())
    }

    /// Fills the time steps before each row from `first` on, 0 at the first row of the record.
    pub(crate) fn fill_steps(excitation: &Excitation<'_>, first: usize, steps: &mut [f64]) {
        let Some(time) = excitation.time() else { return };
        for (row, step) in (first..).zip(steps) {
            *step = if row == 0 { 0.0 } else { time[row] - time[row - 1] };
        }
    }

    /// Measured outputs of the rows of [`Scaling::drive`] in scaled units: those of a lead-in are blank.
    pub fn target(&self, record: &Record) -> Vec<f64> {
        let mut target = vec![f64::NAN; record.lead_in_rows().len()];
        target.extend(self.scaled_output(record.output()));
        target
    }

    /// Measured outputs in scaled units; blanks stay NaN.
    pub fn scaled_output(&self, output: &[f64]) -> Vec<f64> {
        output.iter().map(|y| (y - self.output_mean) / self.output_deviation).collect()
    }

    /// A scaled output in the user's unit.
    pub fn output(&self, scaled: f64) -> f64 {
        self.output_mean + self.output_deviation * scaled
    }
}

/// A scale that can be divided by: 1 for a channel that is always 0, or as good as that.
fn usable(scale: f64) -> f64 {
    if SCALES.contains(&scale) { scale } else { 1.0 }
}
