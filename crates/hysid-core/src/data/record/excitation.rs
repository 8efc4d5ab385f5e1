//! The inputs of a simulation, borrowed: no column is copied.

use crate::data::record::state::RecordState;
use crate::error::{Channel, DataError, DataProblem, Error, LARGEST_VALUE, MOST_TURNS, Result};

/// Rows that are checked together, without a branch for each.
const CHUNK: usize = 1024;

/// The inputs of a record with time stamps and given rate, borrowed.
#[derive(Debug, Clone)]
pub struct Excitation<'a> {
    pub(super) name: &'a str,
    pub(super) time: Option<&'a [f64]>,
    pub(super) inputs: Vec<&'a [f64]>,
    pub(super) given_rate: Option<&'a [f64]>,
    pub(super) lead_in: Option<&'a [f64]>,
    pub(super) known: &'a [f64],
    pub(super) state: Option<&'a RecordState>,
}

impl<'a> Excitation<'a> {
    /// An excitation from its inputs: one slice of values for each, all of one length, in the user's units.
    ///
    /// # Errors
    /// No rows, differing lengths, an input that is not finite, values beyond [`LARGEST_VALUE`].
    pub fn new(name: &'a str, inputs: Vec<&'a [f64]>) -> Result<Self> {
        let excitation = Self::unchecked(name, None, inputs, None);
        if excitation.inputs.is_empty() {
            return Err(excitation.defect(None, None, DataProblem::Inputs { expected: 1, found: 0 }));
        }
        if excitation.is_empty() {
            return Err(excitation.defect(None, None, DataProblem::Empty));
        }
        for (index, input) in excitation.inputs.iter().enumerate() {
            excitation.check_column(Channel::Input(index), input, false)?;
        }
        Ok(excitation)
    }

    /// An excitation of columns that were checked before, each of the same length.
    pub(crate) fn unchecked(
        name: &'a str,
        time: Option<&'a [f64]>,
        inputs: Vec<&'a [f64]>,
        given_rate: Option<&'a [f64]>,
    ) -> Self {
        Self { name, time, inputs, given_rate, lead_in: None, known: &[], state: None }
    }

    /// The same with strictly increasing time stamps, one a row.
    ///
    /// # Errors
    /// Another length, a value that is not finite, or time stamps that do not increase.
    pub fn with_time(mut self, time: &'a [f64]) -> Result<Self> {
        self.check_column(Channel::Time, time, false)?;
        let (before, after) = (&time[..time.len() - 1], &time[1..]);
        let falls = |(chunk, next): (&[f64], &[f64])| {
            !chunk.iter().zip(next).fold(true, |rises, (a, b)| rises & (a < b))
        };
        if before.chunks(CHUNK).zip(after.chunks(CHUNK)).any(falls)
            && let Some(index) = time.windows(2).position(|pair| pair[1] <= pair[0])
        {
            let problem = DataProblem::TimeNotIncreasing { before: time[index], now: time[index + 1] };
            return Err(self.defect(Some(index + 1), Some(Channel::Time), problem));
        }
        self.time = Some(time);
        Ok(self)
    }

    /// The same with a given rate of the first input, one value a row, in its unit divided by that of time.
    ///
    /// # Errors
    /// Another length, or a value that is not finite.
    pub fn with_given_rate(mut self, rate: &'a [f64]) -> Result<Self> {
        self.check_column(Channel::Rate, rate, false)?;
        self.given_rate = Some(rate);
        Ok(self)
    }

    /// The same after a [lead-in](crate::data::initial_state): the turning points of the first input before
    /// the first row, in its unit. Without rows it is the virgin state, whatever the model was trained with.
    ///
    /// # Errors
    /// A value that is not finite or beyond [`LARGEST_VALUE`]; more than [`MOST_TURNS`] turning points.
    pub fn with_lead_in(mut self, lead_in: &'a [f64]) -> Result<Self> {
        if lead_in.len() > MOST_TURNS {
            return Err(self.defect(None, Some(Channel::Input(0)), DataProblem::LongLeadIn(lead_in.len())));
        }
        if let Some(&value) = lead_in.iter().find(|value| value.is_nan() || value.abs() > LARGEST_VALUE) {
            return Err(self.defect(None, Some(Channel::Input(0)), DataProblem::LeadIn(value)));
        }
        self.lead_in = Some(lead_in);
        Ok(self)
    }

    /// The same with the outputs of a known beginning, from which a model finds its state: those of the first rows, NaN where
    /// they are not known.
    ///
    /// # Errors
    /// More rows than there are, values beyond [`LARGEST_VALUE`].
    pub fn with_known_beginning(mut self, known: &'a [f64]) -> Result<Self> {
        if known.len() > self.len() {
            let problem = DataProblem::Length { expected: self.len(), found: known.len() };
            return Err(self.defect(None, Some(Channel::Output), problem));
        }
        if let Some(row) = known.iter().position(|value| value.abs() > LARGEST_VALUE) {
            return Err(self.defect(Some(row), Some(Channel::Output), DataProblem::TooLarge(known[row])));
        }
        self.known = known;
        Ok(self)
    }

    /// The same with outputs of a known beginning that were checked before.
    pub(crate) fn knowing(self, known: &'a [f64]) -> Self {
        Self { known, ..self }
    }

    /// The same from a state that the model has found ([`Model::find_state`](crate::model::Model::find_state)), in the place
    /// of a lead-in and a known beginning. The first row is that of the record in which the state was found.
    pub fn with_state(self, state: impl Into<Option<&'a RecordState>>) -> Self {
        Self { state: state.into(), ..self }
    }

    /// The state before the first row, if a model has found it.
    pub fn state(&self) -> Option<&'a RecordState> {
        self.state
    }

    /// Outputs of the known beginning; empty without.
    pub fn known(&self) -> &'a [f64] {
        self.known
    }

    /// The same after a lead-in that was checked before; `None` for the initial state of the model.
    pub(crate) fn after(self, lead_in: Option<&'a [f64]>) -> Self {
        Self { lead_in, ..self }
    }

    pub(super) fn check_column(&self, channel: Channel, values: &[f64], may_be_blank: bool) -> Result<()> {
        if values.len() != self.len() {
            let problem = DataProblem::Length { expected: self.len(), found: values.len() };
            return Err(self.defect(None, Some(channel), problem));
        }
        let is_sound = |value: f64| (value.abs() <= LARGEST_VALUE) | (value.is_nan() & may_be_blank);
        let all_sound = |chunk: &[f64]| chunk.iter().fold(true, |sound, &value| sound & is_sound(value));
        if values.chunks(CHUNK).all(all_sound) {
            return Ok(());
        }
        let Some(row) = values.iter().position(|&value| !is_sound(value)) else { return Ok(()) };
        let problem = match values[row] {
            value if value.is_finite() => DataProblem::TooLarge(value),
            value => DataProblem::NotFinite(value),
        };
        Err(self.defect(Some(row), Some(channel), problem))
    }

    pub(crate) fn defect(&self, row: Option<usize>, channel: Option<Channel>, problem: DataProblem) -> Error {
        Error::Data(DataError { record: self.name.to_owned(), row, channel, problem })
    }

    /// Name of the record.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.inputs.first().map_or(0, |input| input.len())
    }

    /// True if there is no row; none that was made by [`Excitation::new`] is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The inputs, each with one value a row.
    pub fn inputs(&self) -> &[&'a [f64]] {
        &self.inputs
    }

    /// Time stamps, if there are any.
    pub fn time(&self) -> Option<&'a [f64]> {
        self.time
    }

    /// The given rate of the first input, if there is one.
    pub fn given_rate(&self) -> Option<&'a [f64]> {
        self.given_rate
    }

    /// Turning points of the first input before the first row; empty for virgin, `None` for the model's initial state.
    pub fn lead_in(&self) -> Option<&'a [f64]> {
        self.lead_in
    }

    /// As [`Record::lead_in_rows`](super::Record::lead_in_rows).
    pub fn lead_in_rows(&self) -> Vec<f64> {
        match self.lead_in {
            None | Some([]) => Vec::new(),
            Some(turns) => turns.iter().chain(self.inputs[0].first()).copied().collect(),
        }
    }

    /// The further inputs at the first row, which they have throughout a lead-in.
    pub(crate) fn others_at_first_row(&self) -> Vec<f64> {
        self.inputs[1..].iter().map(|input| input[0]).collect()
    }
}
