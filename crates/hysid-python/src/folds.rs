//! The folds of a cross-validation as ranges of rows.

use hysid::validation::{CrossValidator, Cut, RowsOf};
use pyo3::prelude::*;

use crate::data::Dataset;
use crate::failure::refused;

/// Record, first row, and the row after the last one.
type Rows = (usize, usize, usize);

/// The rows that are fitted to and those that are judged, fold by fold, at most `most` folds of several records. Of a
/// single record these are the folds that forecast what follows; a fold of a block is none of rows, because the outputs
/// of the block are blanked while its inputs are run.
#[pyfunction]
pub fn folds(data: &Dataset, most: usize) -> PyResult<Vec<(Vec<Rows>, Vec<Rows>)>> {
    let records = data.set.records();
    let whole = |record: usize| (record, 0, records[record].len());
    let rows = |cut: &Cut| match *cut {
        Cut::Records(ref held) => {
            let trained = (0..records.len()).filter(|record| !held.contains(record));
            Some((trained.map(whole).collect(), held.iter().copied().map(whole).collect()))
        }
        Cut::Forecast { ref judged, .. } => Some(
            judged
                .iter()
                .map(|&RowsOf { record, begin, end }| ((record, 0, begin), (record, begin, end)))
                .unzip(),
        ),
        Cut::Block { .. } => None,
    };
    let divided = CrossValidator::new(&data.set, most).map_err(refused)?;
    Ok(divided.cuts().iter().filter_map(rows).collect())
}
