//! Known beginnings: records whose first outputs are given, from which a model finds its state.

use std::borrow::Cow;

use crate::data::known_beginning::KnownBeginning;
use crate::data::record::{Dataset, Record};
use crate::error::Result;
use crate::model::Model;

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

    /// The record with the known beginning of this model, if it has none of its own.
    ///
    /// # Errors
    /// A beginning without any output.
    pub fn begun<'r>(&self, record: &'r Record) -> Result<Cow<'r, Record>> {
        self.beginning.of(record)
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
