//! Measured data.

use std::sync::Arc;

use hysid::data::record::{self, ColumnNames, Record};
use hysid::data::summary::Summary;
use hysid::data::unit::Conversion;
use hysid::diagnosis::{Diagnosis, DiagnosisOptions};
use hysid_app::diagnosis::data_text;
use hysid_app::value_warnings;
use hysid_document::Face;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::failure::refused;
use crate::interruption::interruptible;

/// A column, read where it lies.
pub type Column<'py> = PyReadonlyArray1<'py, f64>;

/// A column of its own.
pub type NewColumn<'py> = Bound<'py, PyArray1<f64>>;

/// Names of time, inputs, rate and output.
type Names = (Option<String>, Vec<String>, Option<String>, String);

/// A record: name, time, inputs, rate, output.
type Parts<C> = (String, Option<C>, Vec<C>, Option<C>, C);

/// Records of the same channels.
#[pyclass(frozen, module = "hysid._hysid")]
pub struct Dataset {
    pub set: Arc<record::Dataset>,
}

#[pymethods]
impl Dataset {
    #[new]
    #[pyo3(signature = (names, records, weights=None))]
    fn new(
        names: Names,
        records: Vec<Parts<Column<'_>>>,
        weights: Option<Vec<Column<'_>>>,
    ) -> PyResult<Self> {
        let (time, inputs, rate, output) = names;
        let mut records: Vec<Record> = records.into_iter().map(record).collect::<PyResult<_>>()?;
        if let Some(weights) = weights {
            let weighted = |(record, weights): (Record, &Column<'_>)| {
                record.with_weights(values(weights)?).map_err(refused)
            };
            records = records.into_iter().zip(&weights).map(weighted).collect::<PyResult<_>>()?;
        }
        let names = ColumnNames { time, inputs, rate, output };
        let set = record::Dataset::new(names, records).map_err(refused)?;
        Ok(Self { set: Arc::new(set) })
    }

    /// The names, as the constructor takes them.
    fn names(&self) -> Names {
        let ColumnNames { time, inputs, rate, output } = self.set.names().clone();
        (time, inputs, rate, output)
    }

    /// The records, as the constructor takes them.
    fn records<'py>(&self, py: Python<'py>) -> Vec<Parts<NewColumn<'py>>> {
        let column = |values: &[f64]| PyArray1::from_slice(py, values);
        let parts = |record: &Record| {
            let inputs = record.inputs().iter().map(|input| column(input)).collect();
            let (time, rate) = (record.time().map(column), record.given_rate().map(column));
            (record.name().to_owned(), time, inputs, rate, column(record.output()))
        };
        self.set.records().iter().map(parts).collect()
    }

    /// Warnings on these data before training.
    fn warnings(&self) -> Vec<String> {
        let summary = Summary::of(&self.set);
        summary.warnings(&self.set).iter().map(ToString::to_string).chain(self.value_warnings()).collect()
    }

    /// Warnings of values that may not be measured.
    fn value_warnings(&self) -> Vec<String> {
        value_warnings(&self.set, Face::Python)
    }

    /// Warns of records that were trained on too, or parts of them.
    fn copies_of(&self, trained: &Dataset) -> Vec<String> {
        self.set.copies_of(&trained.set).iter().map(ToString::to_string).collect()
    }
}

fn record((name, time, inputs, rate, output): Parts<Column<'_>>) -> PyResult<Record> {
    let inputs = inputs.iter().map(values).collect::<PyResult<_>>()?;
    let mut record = Record::new(name, inputs, values(&output)?).map_err(refused)?;
    if let Some(time) = time {
        record = record.with_time(values(&time)?).map_err(refused)?;
    }
    if let Some(rate) = rate {
        record = record.with_given_rate(values(&rate)?).map_err(refused)?;
    }
    Ok(record)
}

/// The values of a column, in memory of their own.
pub fn values(column: &Column<'_>) -> PyResult<Vec<f64>> {
    Ok(column.as_slice()?.to_vec())
}

/// Factor that converts the numbers of a column to the unit of the column that a model was trained on, by
/// their names; `None` for as they are.
#[pyfunction]
pub fn unit_factor(found: &str, trained: &str) -> PyResult<Option<f64>> {
    match Conversion::between(found, trained) {
        Conversion::Same => Ok(None),
        Conversion::Factor(factor) => Ok(Some(factor)),
        Conversion::Impossible => Err(refused(format!(
            "\"{found}\" has another unit than the model's \"{trained}\", and no factor between them is known (convert the \
             numbers, or take them as they are with same_units=True)"
        ))),
    }
}

/// Diagnoses data; gives the object that `hysid diagnose --json` prints of it, and its text.
#[pyfunction]
pub fn diagnose(
    py: Python<'_>,
    data: &Dataset,
    smallest_reversal: f64,
    smoothing: bool,
) -> PyResult<(String, String)> {
    let options = DiagnosisOptions { smallest_reversal, smoothing };
    let set = Arc::clone(&data.set);
    let diagnosis = interruptible(py, move || Diagnosis::of(&set, &options))?;
    let text = data_text(&data.set, &diagnosis, "model = hysid.fit(x, y)", Face::Python);
    Ok((serde_json::to_string(&diagnosis).map_err(refused)?, text))
}
