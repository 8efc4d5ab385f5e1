//! Known beginnings: records whose first outputs are given, from which a model finds its state.

use std::borrow::Cow;

use crate::data::known_beginning::KnownBeginning;
use crate::data::record::{Dataset, Record};
use crate::error::{Channel, DataProblem, Result};
use crate::model::Model;
use crate::model::runner::Runner;

impl Model {
    /// The same model, which takes the first outputs of each record as a [known
    /// beginning](Record::with_known_beginning): it finds its state from them, and they are not scored.
    pub fn with_known_beginning(mut self, beginning: KnownBeginning) -> Self {
        self.beginning = beginning;
        self
    }

    /// The known beginning of records that have none of their own.
    pub fn known_beginning(&self) -> KnownBeginning {
        self.beginning
    }

    /// The past of the first input that suits all outputs of a record, in its unit: up to three turning points, from which a
    /// free run of this single model has the lowest error. Empty for a model with free states of its own.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    pub fn past_before(&self, record: &Record) -> Result<Vec<f64>> {
        let excitation = record.excitation().knowing(record.output());
        Runner::of_model(self).past_before(&excitation)
    }

    /// The record with the known beginning of this model, if it has none of its own.
    ///
    /// # Errors
    /// A beginning without any output.
    pub fn begun<'r>(&self, record: &'r Record) -> Result<Cow<'r, Record>> {
        let rows = self.beginning.rows(record);
        if rows == 0 || !record.known().is_empty() {
            return Ok(Cow::Borrowed(record));
        }
        if record.output()[..rows].iter().all(|y| y.is_nan()) {
            return Err(record.defect(Some(0), Some(Channel::Output), DataProblem::NothingKnown(rows)));
        }
        Ok(Cow::Owned(record.clone().with_known_beginning(rows)))
    }
}

/// The data with this known beginning of each record that has no longer one.
pub(super) fn begun(data: &Dataset, beginning: KnownBeginning) -> Cow<'_, Dataset> {
    if beginning.is_none() {
        return Cow::Borrowed(data);
    }
    let rows = |record: &Record| beginning.rows(record).max(record.known().len());
    Cow::Owned(data.clone().with_known_beginnings(rows))
}
