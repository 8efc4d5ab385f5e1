//! Predictions of rows by models that were fitted without them.

use std::collections::HashMap;

use crate::data::record::{ColumnNames, Dataset, Record};
use crate::error::Result;
use crate::validation::Fold;

/// The held-out rows of a cross-validation, each once, and what a model gave that was fitted without it.
#[derive(Debug, Clone)]
pub struct HeldOutRows {
    /// The records of all folds, with the outputs of the held-out rows only.
    pub data: Dataset,
    /// The simulated output of each row of each record; NaN where the row is not held out.
    pub simulated: Vec<Vec<f64>>,
}

impl HeldOutRows {
    /// The rows of these folds with their predictions; `None` if there is none. A row counts in the first fold that has
    /// it.
    pub(crate) fn of<'f>(
        names: &ColumnNames,
        folds: impl IntoIterator<Item = (&'f Fold, &'f [f64])>,
    ) -> Result<Option<Self>> {
        let (mut records, mut simulated) = (Vec::<Record>::new(), Vec::new());
        let mut taken: HashMap<String, Vec<bool>> = HashMap::new();
        for (fold, predicted) in folds {
            let mut predicted = predicted.iter();
            for record in fold.held_out.records() {
                let mut run = vec![f64::NAN; record.len()];
                let taken = taken.entry(record.name().to_string()).or_default();
                taken.resize(taken.len().max(record.len()), false);
                for (row, run) in
                    run.iter_mut().enumerate().filter(|(row, _)| !record.output()[*row].is_nan())
                {
                    let value = predicted.next().copied().unwrap_or(f64::NAN);
                    if !std::mem::replace(&mut taken[row], true) {
                        *run = value;
                    }
                }
                let is_new = |row: usize| !run[row].is_nan();
                let kept = record.clone().scored_where(is_new);
                if kept.scored() > 0 {
                    records.push(kept);
                    simulated.push(run);
                }
            }
        }
        if records.is_empty() {
            return Ok(None);
        }
        Ok(Some(Self { data: Dataset::new(names.clone(), records)?, simulated }))
    }
}
