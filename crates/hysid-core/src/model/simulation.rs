//! Simulation of records that are processed in blocks: the storage needed does not grow with the record.

use std::mem;

use crate::data::record::{Excitation, RecordState};
use crate::data::warning::Warning;
use crate::error::{Channel, DataProblem, Error, Result};
use crate::model::runner::{OutputSpread, Runner};
use crate::model::{Band, BandLevel, Model, Prediction};

/// A simulation that takes the rows of a record in blocks. The outputs are those of [`Model::response`] or
/// [`Model::predict`] to the last bit, for any division into blocks.
///
/// If the rate of a row depends on later rows, its output is returned with a later block. A record that begins after one
/// period of itself ([`Model::is_periodic`]) is simulated when it ends.
#[derive(Debug, Clone)]
pub struct Simulation<'m> {
    model: &'m Model,
    runner: Runner<'m>,
    band: Option<(&'m Band, BandLevel)>,
    record: String,
    window: RowWindow,
}

/// The rows that are still needed: some that are simulated, and those behind them that are not.
#[derive(Debug, Clone, Default)]
struct RowWindow {
    time: Option<Vec<f64>>,
    inputs: Vec<Vec<f64>>,
    rate: Option<Vec<f64>>,
    /// Lead-in of the record, if it has one of its own.
    lead_in: Option<Vec<f64>>,
    /// Outputs of the known beginning of the record.
    known: Vec<f64>,
    /// State before its first row, if it was found before.
    state: Option<RecordState>,
    /// Rows of the record before the window.
    before: usize,
    simulated: usize,
}

impl<'m> Simulation<'m> {
    pub(super) fn new(model: &'m Model, band: Option<(&'m Band, BandLevel)>) -> Self {
        let runner = Runner::of_model(model).watching(model);
        Self { model, runner, band, record: String::new(), window: RowWindow::default() }
    }

    /// Begins a record of this name, from the model's initial state or its own lead-in; drops pending rows.
    pub fn begin(&mut self, record: impl Into<String>) {
        self.runner.reset();
        self.record = record.into();
        self.window = RowWindow::default();
    }

    /// Simulates the next rows of the record. Returns the outputs of all rows so far whose rates are known
    /// and that have not been returned before. Without a band, its limits are empty.
    ///
    /// # Errors
    /// As [`Model::simulate`], with the row in the record; time that does not increase from block to block.
    pub fn take(&mut self, rows: &Excitation<'_>) -> Result<Prediction> {
        self.model.check(rows)?;
        self.window.append(rows)?;
        let is_in_beginning = self.window.simulated == 0 && self.window.before == 0;
        let waits = self.model.is_periodic() && self.window.lead_in.is_none()
            || is_in_beginning && self.window.len() < self.window.known.len() + self.runner.rows_around().1;
        let behind = if waits { usize::MAX } else { self.runner.rows_around().1 };
        self.simulate(self.window.len().saturating_sub(behind))
    }

    /// Ends the record and returns the outputs of the remaining rows.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn finish(&mut self) -> Result<Prediction> {
        self.simulate(self.window.len())
    }

    /// Warnings of inputs and rates, of all records so far, outside the range of the training data.
    pub fn range_warnings(&self) -> Vec<Warning> {
        self.runner.ranges().map_or_else(Vec::new, |ranges| ranges.warnings())
    }

    /// Simulates the rows of the window up to `end`.
    fn simulate(&mut self, end: usize) -> Result<Prediction> {
        let first = self.window.simulated;
        let rows = end.saturating_sub(first);
        let mut output = vec![0.0; rows];
        let mut spreads = vec![OutputSpread::default(); if self.band.is_some() { rows } else { 0 }];
        if rows > 0 {
            let excitation = self.window.excitation(&self.record);
            let spreads = self.band.is_some().then_some(spreads.as_mut_slice());
            let done = self.runner.rows(&excitation, first, &mut output, spreads);
            done.map_err(|error| behind(error, self.window.before))?;
            self.window.simulated = end;
            self.window.drop_all_but(self.runner.rows_around().0);
        }
        Ok(Prediction::of(self.band, output, &spreads))
    }
}

impl Prediction {
    /// Outputs with their band, if there is one.
    pub(super) fn of(band: Option<(&Band, BandLevel)>, output: Vec<f64>, spreads: &[OutputSpread]) -> Self {
        let half = |spread: &OutputSpread| {
            band.map(|(band, level)| band.half_width(level, spread.disagreement, spread.outside))
        };
        let halves: Vec<f64> = spreads.iter().filter_map(half).collect();
        Self {
            low: output.iter().zip(&halves).map(|(output, half)| output - half).collect(),
            high: output.iter().zip(&halves).map(|(output, half)| output + half).collect(),
            output,
        }
    }
}

/// An error of the rows behind others.
fn behind(error: Error, rows: usize) -> Error {
    match error {
        Error::Data(mut defect) => {
            defect.row = defect.row.map(|row| row + rows);
            Error::Data(defect)
        }
        other => other,
    }
}

impl RowWindow {
    fn len(&self) -> usize {
        self.inputs.first().map_or(0, Vec::len)
    }

    fn append(&mut self, rows: &Excitation<'_>) -> Result<()> {
        let row = self.before + self.len();
        let is_first = row == 0;
        if is_first {
            self.inputs = vec![Vec::new(); rows.inputs().len()];
            self.time = rows.time().map(|_| Vec::new());
            self.rate = rows.given_rate().map(|_| Vec::new());
            self.lead_in = rows.lead_in().map(<[f64]>::to_vec);
            self.known = rows.known().to_vec();
            self.state = rows.state().cloned();
        }
        let (expected, found) = (self.inputs.len(), rows.inputs().len());
        if expected != found {
            return Err(rows.defect(None, None, DataProblem::Inputs { expected, found }));
        }
        if self.time.is_some() != rows.time().is_some() {
            return Err(rows.defect(None, Some(Channel::Time), DataProblem::NoTime));
        }
        if self.rate.is_some() != rows.given_rate().is_some() {
            return Err(rows.defect(None, Some(Channel::Rate), DataProblem::NoGivenRate));
        }
        if let Some((time, more)) = self.time.as_mut().zip(rows.time()) {
            if let (Some(&before), Some(&now)) = (time.last(), more.first())
                && now <= before
            {
                let problem = DataProblem::TimeNotIncreasing { before, now };
                return Err(rows.defect(Some(row), Some(Channel::Time), problem));
            }
            time.extend_from_slice(more);
        }
        self.inputs.iter_mut().zip(rows.inputs()).for_each(|(input, more)| input.extend_from_slice(more));
        if let Some((rate, more)) = self.rate.as_mut().zip(rows.given_rate()) {
            rate.extend_from_slice(more);
        }
        Ok(())
    }

    fn excitation<'a>(&'a self, name: &'a str) -> Excitation<'a> {
        let inputs = self.inputs.iter().map(Vec::as_slice).collect();
        let excitation = Excitation::unchecked(name, self.time.as_deref(), inputs, self.rate.as_deref());
        excitation.after(self.lead_in.as_deref()).knowing(&self.known).with_state(&self.state)
    }

    /// Drops all rows that are simulated but so many, the last ones.
    fn drop_all_but(&mut self, kept: usize) {
        let dropped = self.simulated.saturating_sub(kept);
        let columns = self.inputs.iter_mut().chain(&mut self.time).chain(&mut self.rate);
        columns.for_each(|column| mem::drop(column.drain(..dropped)));
        self.before += dropped;
        self.simulated -= dropped;
    }
}
