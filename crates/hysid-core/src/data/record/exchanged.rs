//! Data with input and output exchanged, for a model of the inverse.

use crate::data::record::{Dataset, Record};
use crate::error::{Channel, DataProblem, Result};

impl Record {
    /// Rows from the first with an output to the last; `None` if no row has one.
    pub fn measured_rows(&self) -> Option<std::ops::Range<usize>> {
        let first = self.output().iter().position(|y| !y.is_nan())?;
        let last = self.output().iter().rposition(|y| !y.is_nan())?;
        Some(first..last + 1)
    }

    /// The record with its first input and its output exchanged. Rows before the first output and after the last one are
    /// left out. Further inputs and time stay. A given rate and a lead-in belong to the input, and are left out too.
    ///
    /// # Errors
    /// A row without output between others, or no output at all.
    pub fn exchanged(&self) -> Result<Record> {
        let nothing = || self.defect(None, Some(Channel::Output), DataProblem::NothingToScore);
        let rows = self.measured_rows().ok_or_else(nothing)?;
        let output = self.output()[rows.clone()].to_vec();
        if let Some(row) = output.iter().position(|y| y.is_nan()) {
            return Err(self.defect(Some(rows.start + row), Some(Channel::Output), DataProblem::BlankWithin));
        }
        let mut inputs: Vec<Vec<f64>> =
            self.inputs().iter().map(|input| input[rows.clone()].to_vec()).collect();
        let drive = std::mem::replace(&mut inputs[0], output);
        let record = Record::new(self.name(), inputs, drive)?;
        match self.time() {
            Some(time) => record.with_time(time[rows].to_vec()),
            None => Ok(record),
        }
    }
}

impl Dataset {
    /// The data with the first input and the output of each record exchanged ([`Record::exchanged`]): a model of them is
    /// a model of the inverse.
    ///
    /// ```
    /// use hysid_core::data::record::Dataset;
    /// let inverse = Dataset::from_slices(&[0.0, 1.0, 0.5], &[f64::NAN, 0.9, 0.7])?.exchanged()?;
    /// assert_eq!(inverse.records()[0].inputs()[0][..], [0.9, 0.7]);
    /// assert_eq!(inverse.records()[0].output(), [1.0, 0.5]);
    /// # Ok::<(), hysid_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Record::exchanged`].
    pub fn exchanged(&self) -> Result<Dataset> {
        let mut names = self.names().clone();
        std::mem::swap(&mut names.inputs[0], &mut names.output);
        names.rate = None;
        Dataset::new(names, self.records().iter().map(Record::exchanged).collect::<Result<_>>()?)
    }
}
