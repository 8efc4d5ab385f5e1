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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_output_at_the_ends_are_left_out() {
        let record =
            Record::new("r", vec![vec![1.0, 2.0, 3.0], vec![7.0, 8.0, 9.0]], vec![f64::NAN, 5.0, f64::NAN]);
        let record = record.unwrap().with_time(vec![0.0, 0.1, 0.2]).unwrap().exchanged().unwrap();
        assert_eq!((&record.inputs()[0][..], &record.inputs()[1][..]), (&[5.0][..], &[8.0][..]));
        assert_eq!((record.output(), record.time()), (&[2.0][..], Some(&[0.1][..])));
    }

    #[test]
    fn rows_without_output_between_others_are_refused() {
        let record = Record::new("r", vec![vec![1.0, 2.0, 3.0]], vec![4.0, f64::NAN, 5.0]).unwrap();
        let error = record.exchanged().unwrap_err().to_string();
        assert!(error.contains("row 2, output") && error.contains("blank"), "{error}");
        let record = Record::new("r", vec![vec![1.0]], vec![f64::NAN]).unwrap();
        record.exchanged().unwrap_err();
    }
}
