//! The rows of runs over tables, gathered as data. They are kept: memory grows with the tables.

use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::model::Prediction;

use crate::table_run::Simulated;

/// Gathers the rows of runs, record by record. Each run must keep its drive.
#[derive(Default)]
pub struct Gatherer {
    records: Vec<RecordRows>,
    has_ended: bool,
}

#[derive(Default)]
struct RecordRows {
    name: String,
    time: Vec<f64>,
    inputs: Vec<Vec<f64>>,
    rate: Vec<f64>,
    measured: Vec<f64>,
    predicted: Prediction,
}

/// Data, and what a model makes of them.
pub struct Gathered {
    /// The data; the output is NaN where it was not measured or not read.
    pub data: Dataset,
    /// Output of the model, and its band if there is one, for each record.
    pub predicted: Vec<Prediction>,
}

impl Gatherer {
    pub fn take(&mut self, rows: &Simulated<'_>) {
        if self.records.is_empty() || self.has_ended {
            self.records.push(RecordRows { name: rows.record.to_string(), ..RecordRows::default() });
        }
        self.has_ended = rows.ends_record;
        let Some(record) = self.records.last_mut() else { return };
        let (drive, count) = (rows.drive(), rows.prediction.output.len());
        let some = |column: &Vec<f64>| column.iter().take(count).copied().collect::<Vec<f64>>();
        record.time.extend(some(&drive.time));
        record.rate.extend(some(&drive.rate));
        record.inputs.resize(drive.inputs.len(), Vec::new());
        record.inputs.iter_mut().zip(&drive.inputs).for_each(|(input, from)| input.extend(some(from)));
        record.measured.extend(rows.measured);
        record.measured.resize(record.predicted.output.len() + count, f64::NAN);
        record.predicted.output.extend(&rows.prediction.output);
        record.predicted.low.extend(&rows.prediction.low);
        record.predicted.high.extend(&rows.prediction.high);
    }

    /// All records, with these names of the columns.
    pub fn gathered(self, names: ColumnNames) -> hysid::Result<Gathered> {
        let (mut records, mut all) = (Vec::new(), Vec::new());
        for rows in self.records.into_iter().filter(|rows| !rows.measured.is_empty()) {
            let RecordRows { name, time, inputs, rate, measured, predicted } = rows;
            let mut record = Record::new(name, inputs, measured)?;
            if !time.is_empty() {
                record = record.with_time(time)?;
            }
            if !rate.is_empty() {
                record = record.with_given_rate(rate)?;
            }
            records.push(record);
            all.push(predicted);
        }
        Ok(Gathered { data: Dataset::new(names, records)?, predicted: all })
    }
}
