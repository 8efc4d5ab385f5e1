//! Errors over several folds together.

use std::collections::BTreeMap;

use crate::data::metrics::{ErrorSums, Errors, ScoredRow};
use crate::data::record::Dataset;

/// Held-out errors; a row that is held out more than once counts once, with the mean of its squared errors.
#[derive(Debug, Clone, Default)]
pub(crate) struct PooledErrors {
    records: BTreeMap<String, Vec<Row>>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Row {
    measured: f64,
    square_errors: f64,
    largest: f64,
    times: u32,
}

impl PooledErrors {
    /// Adds what a model predicted of data held out: of every row with an output, in their order.
    pub fn add(&mut self, held_out: &Dataset, predicted: &[f64]) {
        let mut predicted = predicted.iter();
        for record in held_out.records() {
            let rows = self.records.entry(record.name().to_string()).or_default();
            rows.resize(rows.len().max(record.len()), Row::default());
            for (row, &measured) in rows.iter_mut().zip(record.output()).filter(|(_, y)| !y.is_nan()) {
                let Some(predicted) = predicted.next() else { return };
                let error = predicted - measured;
                row.measured = measured;
                row.square_errors += error * error;
                row.largest = row.largest.max(error.abs());
                row.times += 1;
            }
        }
    }

    /// The errors so far; `None` if there are none.
    pub fn errors(&self, output: &str) -> Option<Errors> {
        let mut sums = ErrorSums::default();
        for rows in self.records.values() {
            let held_out = rows.iter().filter(|row| row.times > 0);
            held_out.for_each(|row| {
                sums.add_row(ScoredRow {
                    measured: row.measured,
                    square_error: row.square_errors / f64::from(row.times),
                    largest: row.largest,
                });
            });
            sums.end_record();
        }
        sums.errors(output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::{ColumnNames, Record};

    #[test]
    fn a_row_held_out_twice_counts_once() {
        let held_out = |output: Vec<f64>| {
            let record = Record::new("r", vec![vec![0.0, 1.0, 2.0]], output).unwrap();
            Dataset::new(ColumnNames::plain(1), vec![record]).unwrap()
        };
        let mut pooled = PooledErrors::default();
        assert_eq!(pooled.errors("y"), None);
        pooled.add(&held_out(vec![f64::NAN, 1.0, 3.0]), &[2.0, 3.0]);
        pooled.add(&held_out(vec![f64::NAN, f64::NAN, 3.0]), &[7.0]);
        let errors = pooled.errors("y").unwrap();
        // Errors of 1 in the second row, of 0 and 4 in the third.
        assert_eq!((errors.samples, errors.records), (2, 1));
        assert_eq!(errors.mse, (1.0 + 16.0 / 2.0) / 2.0);
        assert_eq!(errors.max_abs_error, 4.0);
        assert_eq!(errors.nrmse_std_percent, Some(100.0 * 4.5f64.sqrt()));
    }
}
