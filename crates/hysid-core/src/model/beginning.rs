//! Known beginnings: records whose first outputs are given, from which a model finds its state.

use std::borrow::Cow;

use crate::data::known_beginning::KnownBeginning;
use crate::data::record::{Dataset, Excitation, Fingerprint, Record, RecordState};
use crate::error::{Channel, DataProblem, Error, Result};
use crate::model::{Ensemble, Model, Runner};

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

    /// State before the first row of a record, from the outputs of its [known beginning](Excitation::with_known_beginning).
    ///
    /// A free run [from it](Excitation::with_state) has the outputs of a run with this known beginning, and a stepper may
    /// [begin in it](crate::model::Stepper::reset_to_record). If the rate of a row depends on rows behind it, the excitation
    /// needs the rows behind the known ones too.
    ///
    /// # Errors
    /// As [`Model::simulate`], and a known beginning without any output.
    pub fn find_state(&self, excitation: &Excitation<'_>) -> Result<RecordState> {
        self.check(excitation)?;
        let known = excitation.known();
        if known.iter().all(|y| y.is_nan()) {
            let problem = DataProblem::NothingKnown(known.len());
            return Err(excitation.defect(Some(0), Some(Channel::Output), problem));
        }
        let state = Runner::of_model(self).find_state(excitation, 0)?;
        Ok(RecordState { model: self.fingerprint(), ..state })
    }

    /// Checks that this model has found the state.
    pub(super) fn check_state(&self, state: &RecordState) -> Result<()> {
        if state.model == self.fingerprint() { Ok(()) } else { Err(Error::StateOfOtherModel) }
    }

    /// Hash of the trained ranges and of the training errors of the model and its members.
    fn fingerprint(&self) -> Fingerprint {
        let mut fingerprint = Fingerprint::default();
        let members = self.ensemble().map_or(&[][..], Ensemble::members);
        for model in members.iter().chain([self]) {
            let ranges = model.trained.inputs.iter().chain([&model.trained.output]);
            let train = &model.provenance.train;
            let numbers = ranges.flat_map(|&(low, high)| [low, high]).chain([train.mse]);
            fingerprint.add(numbers, train.max_abs_error);
        }
        fingerprint
    }

    /// The data with the known beginning with which the model was judged in its fit, where their records have no longer one:
    /// on its training data, its errors are then those of its [`Provenance`](crate::model::Provenance).
    ///
    /// # Errors
    /// A duration in another unit than the time.
    pub fn as_judged<'d>(&self, data: &'d Dataset) -> Result<Cow<'d, Dataset>> {
        Ok(begun(data, self.provenance.options.judged_beginning(&self.names)?))
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
