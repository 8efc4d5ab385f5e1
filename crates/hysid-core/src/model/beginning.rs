//! Known beginnings: records whose first outputs are given, from which a model finds its state.

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::record::{Dataset, KnownBeginning, Record};
use crate::model::Model;
use crate::options::FitSpec;

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
    pub(super) fn begun<'r>(&self, record: &'r Record) -> Cow<'r, Record> {
        match self.beginning.rows(record) {
            rows if rows > 0 && record.known().is_empty() => {
                Cow::Owned(record.clone().with_known_beginning(rows))
            }
            _ => Cow::Borrowed(record),
        }
    }

    /// As [`Model::begun`], of all records.
    pub(super) fn begun_all<'d>(&self, data: &'d Dataset) -> Cow<'d, Dataset> {
        if self.beginning.is_none() {
            return Cow::Borrowed(data);
        }
        let rows = |record: &Record| self.beginning.rows(record).max(record.known().len());
        Cow::Owned(data.clone().with_known_beginnings(rows))
    }
}

/// The data as a model with these options is judged on them: with known beginnings if its initial states are free.
pub(super) fn judged<'d>(data: &'d Dataset, options: &FitSpec) -> Cow<'d, Dataset> {
    if options.initial_state() != Some(InitialState::Free) {
        return Cow::Borrowed(data);
    }
    Cow::Owned(data.clone().with_known_beginnings(|record| KnownBeginning::JUDGED.rows(record)))
}
