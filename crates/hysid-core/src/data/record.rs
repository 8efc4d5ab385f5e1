//! Measured data: a [`Record`] is one run of an experiment, a [`Dataset`] several of them with column names.
//!
//! A blank output is NaN: such a row advances the memory of a model, but is used neither for training nor for
//! errors. Such rows are *not scored*; the others are *scored*.

mod copies;
mod exchanged;
mod excitation;
mod fingerprint;
mod protocols;
mod speeds;
mod state;
mod thinning;
mod values;

use crate::data::initial_state::lead_in_of_period;
use crate::data::likeness::Likeness;
use crate::data::warning::Warning;
use crate::error::{Channel, DataProblem, Error, Result};
pub use copies::{RecordCopy, copies, likeness};
pub use excitation::Excitation;
pub use fingerprint::Fingerprint;
pub use protocols::{ProtocolDifference, RepeatedProtocol, protocols};
pub use speeds::SpeedEvidence;
pub use state::RecordState;
pub(crate) use state::{FadingResidual, MemberState};
pub use thinning::Thinning;
pub use values::Values;

/// One run of an experiment, in the order of time. It may begin after a
/// [lead-in](crate::data::initial_state); without one, a model is fitted to it from the virgin state, and
/// simulates it from its own initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    name: String,
    time: Option<Values>,
    inputs: Vec<Values>,
    given_rate: Option<Values>,
    output: Vec<f64>,
    lead_in: Option<Vec<f64>>,
    /// Weight of each row in the sum of squares that a fit minimises; `None` if all count alike.
    weights: Option<Vec<f64>>,
    /// Outputs of the known beginning; the same rows of `output` are blank.
    known: Vec<f64>,
}

impl Record {
    /// A record from its inputs and its output: one slice of values for each input, all of one length, in the
    /// user's units. NaN in the output is a blank.
    ///
    /// # Errors
    /// No rows, differing lengths, an input that is not finite, values beyond
    /// [`crate::error::LARGEST_VALUE`].
    pub fn new(name: impl Into<String>, inputs: Vec<Vec<f64>>, output: Vec<f64>) -> Result<Self> {
        let inputs = inputs.into_iter().map(Values::from).collect();
        let (name, known) = (name.into(), Vec::new());
        let record =
            Self { name, time: None, inputs, given_rate: None, output, lead_in: None, weights: None, known };
        Excitation::new(&record.name, columns(&record.inputs))?;
        record.excitation().check_column(Channel::Output, &record.output, true)?;
        Ok(record)
    }

    /// The same record with strictly increasing time stamps, one a row; their unit becomes the unit of time.
    ///
    /// # Errors
    /// Another length, a value that is not finite, or time stamps that do not increase.
    pub fn with_time(mut self, time: Vec<f64>) -> Result<Self> {
        self.excitation().with_time(&time)?;
        self.time = Some(time.into());
        Ok(self)
    }

    /// The same record with a given rate of the first input, one value a row, in its unit divided by that of
    /// time.
    ///
    /// # Errors
    /// Another length, or a value that is not finite.
    pub fn with_given_rate(mut self, rate: Vec<f64>) -> Result<Self> {
        self.excitation().with_given_rate(&rate)?;
        self.given_rate = Some(rate.into());
        Ok(self)
    }

    /// The same record with another output, one value a row, in which NaN is a blank.
    ///
    /// # Errors
    /// Another length, values beyond [`crate::error::LARGEST_VALUE`].
    pub fn with_output(mut self, output: Vec<f64>) -> Result<Self> {
        self.excitation().check_column(Channel::Output, &output, true)?;
        self.output = output;
        Ok(self)
    }

    /// The same record after a [lead-in](crate::data::initial_state): the turning points of the first input
    /// before the first row, in its unit; empty for the virgin state.
    ///
    /// # Errors
    /// A value that is not finite, or beyond [`crate::error::LARGEST_VALUE`].
    pub fn with_lead_in(mut self, lead_in: Vec<f64>) -> Result<Self> {
        self.excitation().with_lead_in(&lead_in)?;
        self.lead_in = Some(lead_in);
        Ok(self)
    }

    /// The same record with a weight of each row in the sum of squares that a fit minimises, one a row. Errors count all
    /// rows alike.
    ///
    /// # Errors
    /// Another length, or a weight that is not above 0 or not finite.
    pub fn with_weights(mut self, weights: Vec<f64>) -> Result<Self> {
        if weights.len() != self.len() {
            let problem = DataProblem::Length { expected: self.len(), found: weights.len() };
            return Err(self.defect(None, None, problem));
        }
        let is_valid = |weight: &f64| *weight > 0.0 && weight.is_finite();
        if let Some(row) = weights.iter().position(|weight| !is_valid(weight)) {
            return Err(self.defect(Some(row), None, DataProblem::Weight { found: weights[row] }));
        }
        self.weights = Some(weights);
        Ok(self)
    }

    /// Everything except the output, which is what a simulation needs.
    pub fn excitation(&self) -> Excitation<'_> {
        Excitation {
            name: &self.name,
            time: self.time(),
            inputs: columns(&self.inputs),
            given_rate: self.given_rate(),
            lead_in: self.lead_in(),
            known: &self.known,
            state: None,
        }
    }

    /// The same record with a known beginning: from the outputs of its first rows a model finds its state. These rows are
    /// not scored.
    pub fn with_known_beginning(mut self, rows: usize) -> Self {
        if rows == 0 && self.known.is_empty() {
            return self;
        }
        let before = std::mem::take(&mut self.known);
        self.output[..before.len()].copy_from_slice(&before);
        let known = self.output[..rows.min(self.len())].to_vec();
        self.with_known_outputs(&known)
    }

    /// The same record with these outputs known at its beginning, in the place of its own.
    fn with_known_outputs(mut self, known: &[f64]) -> Self {
        self.output[..known.len()].fill(f64::NAN);
        self.known = known.to_vec();
        self
    }

    /// Outputs of the known beginning; empty without.
    pub fn known(&self) -> &[f64] {
        &self.known
    }

    /// An error of this record at a row and a column.
    pub fn defect(&self, row: Option<usize>, channel: Option<Channel>, problem: DataProblem) -> Error {
        self.excitation().defect(row, channel, problem)
    }

    /// Name of the record.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.inputs.first().map_or(0, |input| input.len())
    }

    /// True if there is no row; no record that was made by [`Record::new`] is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The inputs, each with one value a row.
    pub fn inputs(&self) -> &[Values] {
        &self.inputs
    }

    /// Smallest and largest value of an input, in the user's unit.
    pub fn input_range(&self, input: usize) -> (f64, f64) {
        range(self.inputs[input].iter())
    }

    /// Time stamps, if there are any.
    pub fn time(&self) -> Option<&[f64]> {
        self.time.as_deref()
    }

    /// The given rate of the first input, if there is one.
    pub fn given_rate(&self) -> Option<&[f64]> {
        self.given_rate.as_deref()
    }

    /// Turning points of the first input before the first row; empty for the virgin state, `None` if not given.
    pub fn lead_in(&self) -> Option<&[f64]> {
        self.lead_in.as_deref()
    }

    /// Weight of each row in the sum of squares that a fit minimises; `None` if all count alike.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// The first input at each turning point of the lead-in and at the first row; empty without a lead-in.
    pub fn lead_in_rows(&self) -> Vec<f64> {
        self.excitation().lead_in_rows()
    }

    /// The output; NaN is a blank.
    pub fn output(&self) -> &[f64] {
        &self.output
    }

    /// Number of rows with an output.
    pub fn scored(&self) -> usize {
        self.output.iter().filter(|y| !y.is_nan()).count()
    }

    /// Root mean square of the output about `centre`; NaN without outputs.
    pub fn output_size(&self, centre: f64) -> f64 {
        let squares = self.output.iter().filter(|y| !y.is_nan()).map(|y| (y - centre) * (y - centre));
        (squares.sum::<f64>() / self.scored() as f64).sqrt()
    }

    /// A fingerprint by which the record is recognized.
    pub fn fingerprint(&self) -> Fingerprint {
        let mut fingerprint = Fingerprint::default();
        for (row, &output) in self.output.iter().enumerate() {
            let output = *self.known.get(row).unwrap_or(&output);
            fingerprint.add(self.inputs.iter().map(|input| input[row]), output);
        }
        fingerprint
    }

    /// Divides the record at a fraction of its scored rows. The first part ends there. The second part is the
    /// whole record with the outputs of the first part blanked, so its memory begins correctly.
    ///
    /// `fraction` is clamped so that both parts keep at least one scored row. `None` for a record with fewer
    /// than two scored rows.
    pub fn split_at_fraction(&self, fraction: f64) -> Option<(Record, Record)> {
        let scored: Vec<usize> = (0..self.len()).filter(|&row| !self.output[row].is_nan()).collect();
        if scored.len() < 2 {
            return None;
        }
        let kept = (fraction * scored.len() as f64).round() as usize;
        let end = scored[kept.clamp(1, scored.len() - 1)];
        Some((self.rows_up_to(end), self.clone().scored_where(|row| row >= end)))
    }

    /// The rows before `end`.
    pub fn rows_up_to(&self, end: usize) -> Record {
        let cut = |column: &Values| column.up_to(end);
        Record {
            name: self.name.clone(),
            time: self.time.as_ref().map(cut),
            inputs: self.inputs.iter().map(cut).collect(),
            given_rate: self.given_rate.as_ref().map(cut),
            output: self.output[..end].to_vec(),
            lead_in: self.lead_in.clone(),
            weights: self.weights.as_ref().map(|weights| weights[..end].to_vec()),
            known: self.known[..self.known.len().min(end)].to_vec(),
        }
    }

    /// The same record with the outputs blanked where `is_scored` is false.
    pub fn scored_where(mut self, is_scored: impl Fn(usize) -> bool) -> Record {
        for (row, y) in self.output.iter_mut().enumerate() {
            if !is_scored(row) {
                *y = f64::NAN;
            }
        }
        self
    }
}

fn columns(inputs: &[Values]) -> Vec<&[f64]> {
    inputs.iter().map(|input| &**input).collect()
}

/// Above this number of pairs, records are not compared with each other.
const MOST_COMPARED: usize = 100_000;

/// Names of the columns, as written by the user.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnNames {
    /// The time column, if there is one.
    pub time: Option<String>,
    /// The inputs, at least one.
    pub inputs: Vec<String>,
    /// The column of the given rate, if there is one.
    pub rate: Option<String>,
    /// The output.
    pub output: String,
}

impl ColumnNames {
    /// Names of these columns, without a given rate.
    pub fn of(time: Option<&str>, inputs: &[&str], output: &str) -> Self {
        let inputs = inputs.iter().copied().map(String::from).collect();
        Self { time: time.map(String::from), inputs, rate: None, output: output.into() }
    }

    /// Default names: `t`, `x` (or `x1`, `x2`, ...), `y`.
    pub fn plain(inputs: usize) -> Self {
        let name = |index| {
            if inputs == 1 { "x".into() } else { format!("x{}", index + 1) }
        };
        Self {
            time: Some("t".into()),
            inputs: (0..inputs).map(name).collect(),
            rate: None,
            output: "y".into(),
        }
    }
}

/// Records with the same columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    names: ColumnNames,
    records: Vec<Record>,
}

impl Dataset {
    /// True if rows have weights.
    pub fn is_weighted(&self) -> bool {
        self.records.iter().any(|record| record.weights.is_some())
    }

    /// A data set of one record with one input `x` and the output `y`, sample by sample, in the user's units.
    /// NaN in `y` is a blank: the row advances the memory and is not scored.
    ///
    /// ```
    /// let data = hysid_core::data::record::Dataset::from_slices(&[0.0, 1.0, 0.5], &[0.0, 0.9, 0.7])?;
    /// assert_eq!(data.rows(), 3);
    /// # Ok::<(), hysid_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// Slices that are empty or of different length, a value that is not finite or too large.
    pub fn from_slices(x: &[f64], y: &[f64]) -> Result<Self> {
        Self::from_columns(None, &[("x", x)], ("y", y))
    }

    /// A data set of one record from named columns: time stamps (optional), one or more inputs, the output.
    ///
    /// ```
    /// use hysid_core::data::record::Dataset;
    /// let (t, x, y) = ([0.0, 0.1, 0.2], [0.0, 1.0, 0.5], [0.0, 0.9, 0.7]);
    /// let data = Dataset::from_columns(Some(("t_s", &t)), &[("u_mm", &x)], ("F_kN", &y))?;
    /// assert!(data.has_time());
    /// # Ok::<(), hysid_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Dataset::from_slices`], no input, and time stamps that do not increase.
    pub fn from_columns(
        time: Option<(&str, &[f64])>,
        inputs: &[(&str, &[f64])],
        output: (&str, &[f64]),
    ) -> Result<Self> {
        let values = inputs.iter().map(|(_, values)| values.to_vec()).collect();
        let mut record = Record::new("data", values, output.1.to_vec())?;
        if let Some((_, time)) = time {
            record = record.with_time(time.to_vec())?;
        }
        let inputs: Vec<&str> = inputs.iter().map(|(name, _)| *name).collect();
        let names = ColumnNames::of(time.map(|(name, _)| name), &inputs, output.0);
        Self::new(names, vec![record])
    }

    /// A data set of records with the same columns.
    ///
    /// # Errors
    /// No record, or one whose columns are not those of `names`.
    pub fn new(names: ColumnNames, records: Vec<Record>) -> Result<Self> {
        if records.is_empty() {
            return Err(Error::NoRecords);
        }
        for record in &records {
            let (expected, found) = (names.inputs.len(), record.inputs.len());
            if expected != found {
                return Err(record.defect(None, None, DataProblem::Inputs { expected, found }));
            }
            if record.time.is_some() != records[0].time.is_some() {
                return Err(record.defect(None, Some(Channel::Time), DataProblem::NoTime));
            }
            if record.given_rate.is_some() != records[0].given_rate.is_some() {
                return Err(record.defect(None, Some(Channel::Rate), DataProblem::NoGivenRate));
            }
        }
        Ok(Self { names, records })
    }

    /// Names of the columns.
    pub fn names(&self) -> &ColumnNames {
        &self.names
    }

    /// The records.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// True if the records have time stamps.
    pub fn has_time(&self) -> bool {
        self.records[0].time.is_some()
    }

    /// True if the records have a given rate.
    pub fn has_given_rate(&self) -> bool {
        self.records[0].given_rate.is_some()
    }

    /// Number of rows of all records together.
    pub fn rows(&self) -> usize {
        self.records.iter().map(Record::len).sum()
    }

    /// Number of rows with an output.
    pub fn scored(&self) -> usize {
        self.records.iter().map(Record::scored).sum()
    }

    /// Smallest and largest value of an input over all records, in the user's unit.
    pub fn input_range(&self, input: usize) -> (f64, f64) {
        range(self.records.iter().flat_map(|record| &record.inputs[input]))
    }

    /// Mean of the outputs of all scored rows; NaN without any.
    pub fn mean_output(&self) -> f64 {
        let measured = || self.records.iter().flat_map(Record::output).filter(|y| !y.is_nan());
        measured().sum::<f64>() / measured().count() as f64
    }

    /// How many times larger the outputs of the largest record are than those of the smallest, by their root mean squares
    /// about the mean of all; 1 of one record, infinite if a record has that mean throughout.
    pub fn size_ratio(&self) -> f64 {
        let mean = self.mean_output();
        let sizes: Vec<f64> = self.records.iter().map(|record| record.output_size(mean)).collect();
        let (least, most) = range(sizes.iter());
        if most > least { most / least } else { 1.0 }
    }

    /// Smallest and largest output over all scored rows; `(inf, -inf)` if all are blank.
    pub fn output_range(&self) -> (f64, f64) {
        range(self.records.iter().flat_map(|record| &record.output))
    }

    /// The same data with at most `most` scored rows; the others only advance the memory.
    pub fn thinned(&self, most: usize) -> Dataset {
        let thinning = Thinning::new(self.scored(), most);
        let mut thinned = self.clone();
        thinning.blank(thinned.records.iter_mut().flat_map(|record| &mut record.output));
        thinned
    }

    /// The beginnings of the records, with at most `most` rows together; every row keeps its output. A record of fewer
    /// than two rows there is left out, unless all would be.
    ///
    /// # Errors
    /// None for records of two rows or more.
    pub fn beginnings(&self, most: usize) -> Result<Dataset> {
        let share = most as f64 / self.rows().max(1) as f64;
        if share >= 1.0 {
            return Ok(self.clone());
        }
        let begun = |record: &Record| record.rows_up_to((share * record.len() as f64).ceil() as usize);
        let mut records: Vec<Record> = self.records.iter().map(begun).collect();
        records.retain(|record| record.len() >= 2 && record.scored() > 0);
        if records.is_empty() { Ok(self.clone()) } else { Self::new(self.names.clone(), records) }
    }

    /// The same data with the outputs of the first `rows` rows of each record blanked.
    pub fn warmed_up(mut self, rows: usize) -> Dataset {
        for record in &mut self.records {
            let rows = rows.min(record.len());
            record.output[..rows].fill(f64::NAN);
        }
        self
    }

    /// The same data, each record after the lead-in that `lead_in` gives for it and its index.
    ///
    /// # Errors
    /// A value that is not finite, or too large.
    pub fn with_lead_ins(mut self, lead_in: impl Fn(usize, &Record) -> Vec<f64>) -> Result<Dataset> {
        let records = std::mem::take(&mut self.records).into_iter().enumerate();
        self.records = records
            .map(|(index, record)| {
                let lead_in = lead_in(index, &record);
                record.with_lead_in(lead_in)
            })
            .collect::<Result<_>>()?;
        Ok(self)
    }

    /// The same data, each record after one period of itself.
    ///
    /// # Errors
    /// None for data with an input.
    pub fn with_periodic_lead_ins(self) -> Result<Dataset> {
        self.with_lead_ins(|_, record| lead_in_of_period(&record.inputs()[0]))
    }

    /// True if each record begins after one period of itself.
    pub fn begin_periodically(&self) -> bool {
        let is_periodic = |record: &Record| {
            let own = record.lead_in().filter(|lead_in| !lead_in.is_empty());
            own.is_some_and(|own| *own == lead_in_of_period(&record.inputs()[0]))
        };
        self.records.iter().all(is_periodic)
    }

    /// The lead-in that most records with an output have; of several as frequent, that of the first of them.
    pub fn most_frequent_lead_in(&self) -> &[f64] {
        let mut counts: Vec<(&[f64], usize)> = Vec::new();
        for record in self.records.iter().filter(|record| record.scored() > 0) {
            let lead_in = record.lead_in().unwrap_or_default();
            match counts.iter_mut().find(|(known, _)| *known == lead_in) {
                Some((_, count)) => *count += 1,
                None => counts.push((lead_in, 1)),
            }
        }
        // Of equal counts `max_by_key` gives the last.
        counts.iter().rev().max_by_key(|(_, count)| *count).map_or(&[], |(lead_in, _)| lead_in)
    }

    /// Warnings of records that are copies or parts of records of `trained`, or contain them.
    pub fn copies_of(&self, trained: &Dataset) -> Vec<Warning> {
        if self.records.len().saturating_mul(trained.records.len()) > MOST_COMPARED {
            return Vec::new();
        }
        let found = |record: &Record| {
            let likeness = trained.records.iter().find_map(|other| match record.len() <= other.len() {
                true => likeness(record, other),
                false => likeness(other, record).map(|_| Likeness::Contains),
            })?;
            Some(Warning::TrainedOn { record: record.name.clone(), likeness })
        };
        self.records.iter().filter_map(found).collect()
    }

    /// The records for whose index `is_chosen` is true, and the others.
    pub fn partition(&self, is_chosen: impl Fn(usize) -> bool) -> (Dataset, Dataset) {
        let pick = |chosen: bool| {
            let records = self.records.iter().enumerate();
            let picked = records.filter(|(index, _)| is_chosen(*index) == chosen);
            Dataset { names: self.names.clone(), records: picked.map(|(_, record)| record.clone()).collect() }
        };
        (pick(true), pick(false))
    }

    /// A data set of these records, which have the same columns.
    pub fn of_records(&self, records: Vec<Record>) -> Dataset {
        Dataset { names: self.names.clone(), records }
    }

    /// A data set of this record alone, which has the same columns.
    pub fn of_record(&self, record: Record) -> Dataset {
        self.of_records(vec![record])
    }

    /// Divides the data into training and validation data. Of several protocols some are held out; the runs of a
    /// single one are divided in time at the fraction `1 - held_out`, and their second parts keep the memory of
    /// the first.
    ///
    /// The records held out are those in the middle of the order by the range of the first input, so that
    /// validation data lie between training data. `None` if there are too few data.
    pub fn split_for_validation(&self, held_out: f64) -> Option<(Dataset, Dataset)> {
        let protocols = protocols(&self.records);
        if let [alone] = protocols.as_slice() {
            let parts =
                alone.runs.iter().filter_map(|&run| self.records[run].split_at_fraction(1.0 - held_out));
            let (heads, tails): (Vec<Record>, Vec<Record>) = parts.unzip();
            return (!heads.is_empty()).then(|| (self.of_records(heads), self.of_records(tails)));
        }
        let mut order: Vec<Vec<usize>> = protocols.into_iter().map(|protocol| protocol.records).collect();
        order.retain(|records| self.records[records[0]].scored() > 0);
        if order.len() < 2 {
            return None;
        }
        let travel = |records: &[usize]| {
            let record = &self.records[records[0]];
            let (low, high) = range(record.lead_in_rows().iter().chain(&record.inputs[0]));
            high - low
        };
        order.sort_by(|a, b| travel(a).total_cmp(&travel(b)));
        let count = ((held_out * order.len() as f64).round() as usize).clamp(1, order.len() - 1);
        let first = (order.len() - count) / 2;
        let chosen = &order[first..first + count];
        let (held, kept) = self.partition(|index| chosen.iter().flatten().any(|held| *held == index));
        Some((kept, held))
    }

    /// The same data with a known beginning of these rows of each record ([`Record::with_known_beginning`]).
    pub fn with_known_beginnings(mut self, rows: impl Fn(&Record) -> usize) -> Self {
        let known = |record: Record| {
            let rows = rows(&record);
            record.with_known_beginning(rows)
        };
        self.records = self.records.into_iter().map(known).collect();
        self
    }

    /// The same data with these outputs known at the beginning of each record, in the place of its own.
    ///
    /// # Panics
    /// If there are more outputs than rows.
    pub fn with_known_outputs<'k>(mut self, known: impl Fn(&Record) -> &'k [f64]) -> Self {
        let begun = |record: Record| {
            let known = known(&record);
            record.with_known_outputs(known)
        };
        self.records = self.records.into_iter().map(begun).collect();
        self
    }

    /// Checks that some row has an output.
    ///
    /// # Errors
    /// An output that is blank throughout.
    pub fn check_scored(&self) -> Result<()> {
        let blank = || self.records[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore);
        if self.scored() > 0 { Ok(()) } else { Err(blank()) }
    }

    /// Checks that a model can be identified.
    ///
    /// # Errors
    /// A constant input, a constant or blank output, fewer than `needed` scored rows, ranges whose ratio is no slope of a
    /// model.
    pub fn check_identifiable(&self, needed: usize) -> Result<()> {
        self.check_scored()?;
        let first = &self.records[0];
        let found = self.scored();
        if found < needed {
            let problem = DataProblem::TooFewRows { found, needed };
            return Err(first.defect(None, Some(Channel::Output), problem));
        }
        let ranges: Vec<(f64, f64)> =
            (0..self.names.inputs.len()).map(|input| self.input_range(input)).collect();
        for (input, &(low, high)) in ranges.iter().enumerate() {
            if high - low <= low.abs().max(high.abs()) * 1e-12 + 1e-100 {
                let problem = DataProblem::ConstantInput(low);
                return Err(first.defect(None, Some(Channel::Input(input)), problem));
            }
        }
        let (low, high) = self.output_range();
        if high - low <= low.abs().max(high.abs()) * 1e-14 + 1e-100 {
            return Err(first.defect(None, Some(Channel::Output), DataProblem::ConstantOutput(low)));
        }
        let output = high - low;
        for (input, (low, high)) in ranges.into_iter().enumerate() {
            let range = high - low;
            if !(output / range <= LARGEST_RATIO && range / output <= LARGEST_RATIO) {
                let problem = DataProblem::Ranges { input: range, output };
                return Err(first.defect(None, Some(Channel::Input(input)), problem));
            }
        }
        Ok(())
    }
}

/// Largest ratio of the ranges of output and input, either way, so that slopes and their squares stay small.
const LARGEST_RATIO: f64 = 1e50;

fn range<'a>(values: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    values
        .filter(|v| !v.is_nan())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(output: Vec<f64>) -> Record {
        let x = (0..output.len()).map(|k| k as f64).collect();
        Record::new("r", vec![x], output).unwrap()
    }

    #[test]
    fn ranges_that_no_slope_can_have_are_refused_with_a_remedy() {
        let of = |x: f64, y: f64| {
            let column = |scale: f64| (0..20).map(|k| scale * f64::from(k)).collect::<Vec<f64>>();
            Dataset::from_columns(None, &[("x", &column(x))], ("y", &column(y)))
                .unwrap()
                .check_identifiable(10)
        };
        assert!(of(1e90, 1e90).is_ok() && of(1e-24, 1e24).is_ok());
        for (x, y) in [(1e-90, 1e90), (1e90, 1e-90)] {
            let error = of(x, y).unwrap_err().to_string();
            assert!(error.contains("(choose other units)") && error.len() < 200, "{error}");
        }
    }

    #[test]
    fn the_size_ratio_is_that_of_root_mean_squares_about_the_common_mean() {
        let whole = |outputs: Vec<Vec<f64>>| {
            Dataset::new(ColumnNames::plain(1), outputs.into_iter().map(record).collect()).unwrap()
        };
        // Mean 2, about which the sizes are 1, 3 and 7.
        let three = vec![vec![1.0, 3.0], vec![-1.0, f64::NAN, 5.0], vec![-5.0, 9.0]];
        assert_eq!(whole(three).size_ratio(), 7.0);
        assert_eq!(whole(vec![vec![1.0, 3.0]]).size_ratio(), 1.0);
        assert_eq!(whole(vec![vec![4.0, 4.0], vec![3.0, 5.0]]).size_ratio(), f64::INFINITY);
    }

    #[test]
    fn tail_carries_the_whole_input_and_blanks_what_the_head_scored() {
        let whole = record(vec![f64::NAN, 1.0, 2.0, 3.0, 4.0]);
        let (head, tail) = whole.split_at_fraction(0.5).unwrap();
        assert_eq!((head.len(), head.scored()), (3, 2));
        assert_eq!((tail.len(), tail.scored()), (5, 2));
        assert_eq!(tail.inputs(), whole.inputs());
        assert_eq!(&tail.output()[3..], &[3.0, 4.0]);
    }

    #[test]
    fn records_of_middling_range_are_held_out() {
        let scaled =
            |factor: f64, name: &str| Record::new(name, vec![vec![0.0, factor]], vec![0.0, 1.0]).unwrap();
        let records = vec![scaled(3.0, "large"), scaled(1.0, "small"), scaled(2.0, "middle")];
        let data = Dataset::new(ColumnNames::plain(1), records).unwrap();
        let (kept, held) = data.split_for_validation(0.25).unwrap();
        assert_eq!(held.records()[0].name(), "middle");
        assert_eq!(kept.records().len(), 2);
    }

    #[test]
    fn defects_name_their_place() {
        let error = record(vec![0.0; 3]).with_time(vec![0.0, 1.0, 1.0]).unwrap_err();
        let Error::Data(defect) = error else { panic!("{error}") };
        assert_eq!((defect.row, defect.channel), (Some(2), Some(Channel::Time)));
        let error = Record::new("r", vec![vec![0.0, f64::NAN]], vec![0.0; 2]).unwrap_err();
        assert_eq!(error.to_string(), "record \"r\", row 2, input: NaN is not a finite number");
    }
}
