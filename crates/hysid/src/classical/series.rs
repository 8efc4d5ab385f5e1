//! Records as classical models are fitted to them: rows of samples and outputs in the user's units.

use crate::classical::{Law, Sample};
use crate::error::Result;
use crate::rate::RateMethod;
use crate::record::{Dataset, Record};

/// The samples of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What a law is told, row by row.
    pub samples: Vec<Sample>,
    /// The measured output; NaN where it is blank.
    pub output: Vec<f64>,
}

impl Series {
    /// The samples of a record; rates are 0 without a method, time steps are 0 without time.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn of(record: &Record, rate: Option<RateMethod>) -> Result<Self> {
        let rates = rate.map(|method| method.rate(record)).transpose()?;
        let time = record.time();
        let sample = |(row, &x): (usize, &f64)| Sample {
            x,
            rate: rates.as_ref().map_or(0.0, |rates| rates[row]),
            step: time.filter(|_| row > 0).map_or(0.0, |time| time[row] - time[row - 1]),
        };
        Ok(Self {
            samples: record.inputs()[0].iter().enumerate().map(sample).collect(),
            output: record.output().to_vec(),
        })
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

/// Free run of a law from its virgin state.
pub fn run<L: Law>(law: &L, samples: &[Sample]) -> Vec<f64> {
    let mut state = law.virgin();
    samples.iter().map(|sample| law.step(&mut state, *sample)).collect()
}
