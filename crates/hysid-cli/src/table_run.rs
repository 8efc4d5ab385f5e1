//! A model run over a table row by row: memory does not grow with the table.

use std::io::Read;
use std::mem;
use std::ops::ControlFlow;

use anyhow::{Result, anyhow, bail};
use hysid::data::record::{Fingerprint, Likeness, Record};
use hysid::data::warning::Warning;
use hysid::model::{BandLevel, Model, Prediction, Simulation};

use crate::cell::{CellReader, ThousandsWatch};
use crate::columns::Roles;
use crate::data::{Kind, explained, number_in, place_of};
use crate::record_names::RecordNames;
use crate::table::{Head, Row, Rows, no_rows};
use crate::terminal::clipped;
use crate::units::Factors;

/// Rows that are simulated together.
const BLOCK: usize = 4096;

/// What is wanted of the rows beside the outputs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted {
    /// The measured outputs.
    pub measured: bool,
    /// Time, inputs and rate.
    pub drive: bool,
    /// The cells as they are.
    pub cells: bool,
    /// A band of this level.
    pub band: Option<BandLevel>,
}

/// Rows that are simulated, in the order of the table.
pub struct Simulated<'r> {
    /// Their outputs, and their band if one is wanted.
    pub prediction: &'r Prediction,
    /// Their measured outputs, NaN where they are blank; empty if these are not wanted.
    pub measured: &'r [f64],
    /// Rows of their record before them.
    pub before: usize,
    /// Their record ends with them.
    pub ends_record: bool,
    /// How the numbers of the table are written, as far as it is read.
    pub numbers: &'r CellReader,
    waiting: &'r Waiting,
}

impl<'r> Simulated<'r> {
    /// Their time, inputs and rate, if these are wanted.
    pub fn drive(&self) -> &'r Drive {
        &self.waiting.drive
    }

    /// The cells of a row, if these are wanted.
    pub fn cells(&self, row: usize) -> impl Iterator<Item = &'r str> {
        self.waiting.cells(row)
    }
}

/// Time, inputs and rate of rows, column by column, of which the first are those that are simulated.
#[derive(Default)]
pub struct Drive {
    /// Time; empty if there is none.
    pub time: Vec<f64>,
    /// Inputs.
    pub inputs: Vec<Vec<f64>>,
    /// Rate of the first input; empty if no column has it.
    pub rate: Vec<f64>,
}

impl Drive {
    /// Adds the last row of a block.
    fn push_last(&mut self, block: &Block) {
        self.inputs.resize(block.inputs.len(), Vec::new());
        self.time.extend(block.time.last());
        self.rate.extend(block.rate.last());
        self.inputs.iter_mut().zip(&block.inputs).for_each(|(input, from)| input.extend(from.last()));
    }

    fn drop_first(&mut self, rows: usize) {
        let columns = self.inputs.iter_mut().chain([&mut self.time, &mut self.rate]);
        columns.for_each(|column| drop(column.drain(..rows.min(column.len()))));
    }
}

/// Takes rows that are simulated; breaks to end the run.
pub type Take<'t> = dyn FnMut(&Simulated<'_>) -> Result<ControlFlow<()>> + 't;

/// Runs a model over all rows of a table. Gives what to warn of; `None` if the run was ended before its end.
///
/// # Errors
/// A row that cannot be read or simulated, with its line.
pub fn run(
    model: &Model,
    rows: &mut Rows<impl Read>,
    roles: &Roles,
    factors: &Factors,
    wanted: Wanted,
    take: &mut Take<'_>,
) -> Result<Option<Vec<Warning>>> {
    let mut run = TableRun::new(model, &rows.head, roles, factors, wanted)?;
    while let Some(row) = rows.next_row()? {
        let begins = run.begins_record(&row)?;
        if begins || run.block.rows == BLOCK {
            let ends_record = begins && run.is_begun;
            if run.simulate(ends_record, take)?.is_break() {
                return Ok(None);
            }
        }
        if begins {
            run.begin();
        }
        run.push(&row)?;
    }
    if !run.is_begun {
        bail!(no_rows(&run.file));
    }
    run.check_thousands(&rows.head)?;
    let end = run.simulate(true, take)?;
    Ok(end.is_continue().then(|| run.simulation.range_warnings().into_iter().chain(run.known).collect()))
}

/// A run on its way.
struct TableRun<'r, 'm> {
    file: String,
    roles: &'r Roles,
    factors: &'r Factors,
    wanted: Wanted,
    places: Places,
    names: RecordNames,
    numbers: CellReader,
    /// One for each column that is read: time, rate, output, inputs.
    thousands: Vec<(usize, ThousandsWatch)>,
    model: &'m Model,
    simulation: Simulation<'m>,
    /// Of the rows of the present record.
    fingerprint: Fingerprint,
    /// Records so far that the model was trained on.
    known: Vec<Warning>,
    is_begun: bool,
    /// Rows of the present record that are simulated.
    simulated: usize,
    block: Block,
    waiting: Waiting,
}

/// Where the columns of each role stand.
struct Places {
    record: Option<usize>,
    time: Option<usize>,
    inputs: Vec<usize>,
    rate: Option<usize>,
    output: Option<usize>,
}

/// Rows of the present record that the simulation has not taken yet.
#[derive(Default)]
struct Block {
    rows: usize,
    time: Vec<f64>,
    inputs: Vec<Vec<f64>>,
    rate: Vec<f64>,
    output: Vec<f64>,
}

/// Rows that are read and not simulated, those of the block among them.
#[derive(Default)]
struct Waiting {
    lines: Vec<u64>,
    measured: Vec<f64>,
    drive: Drive,
    width: usize,
    text: String,
    ends: Vec<usize>,
}

impl<'r, 'm> TableRun<'r, 'm> {
    fn new(
        model: &'m Model,
        head: &Head,
        roles: &'r Roles,
        factors: &'r Factors,
        wanted: Wanted,
    ) -> Result<Self> {
        let simulation = match wanted.band {
            Some(level) => model.simulation_with_band(level)?,
            None => model.simulation(),
        };
        let place = |name: &String| place_of(head, name);
        let places = Places {
            record: roles.record.as_ref().map(place).transpose()?,
            time: roles.time.as_ref().map(place).transpose()?,
            inputs: roles.inputs.iter().map(place).collect::<Result<_>>()?,
            rate: roles.rate.as_ref().map(place).transpose()?,
            output: wanted.measured.then(|| place(&roles.output)).transpose()?,
        };
        let read = places.time.iter().chain(&places.rate).chain(&places.output).chain(&places.inputs);
        Ok(Self {
            thousands: read.map(|&place| (place, ThousandsWatch::default())).collect(),
            file: head.file.clone(),
            roles,
            factors,
            wanted,
            block: Block::new(places.inputs.len()),
            places,
            names: RecordNames::default(),
            numbers: CellReader::new(head.delimiter),
            model,
            simulation,
            fingerprint: Fingerprint::default(),
            known: Vec::new(),
            is_begun: false,
            simulated: 0,
            waiting: Waiting { width: head.header.len(), ..Waiting::default() },
        })
    }
    /// True if another record begins with the row.
    fn begins_record(&mut self, row: &Row<'_>) -> Result<bool> {
        let Some((place, column)) = self.places.record.zip(self.roles.record.as_ref()) else {
            return Ok(!self.is_begun);
        };
        let at = || format!("{}, line {}, column \"{}\"", self.file, row.line, clipped(column));
        self.names.begins(row.cell(place), at)
    }

    fn check_thousands(&self, head: &Head) -> Result<()> {
        match self.thousands.iter().find_map(|(place, watch)| Some((place, watch.problem()?))) {
            None => Ok(()),
            Some((&place, (line, problem))) => {
                let name = clipped(&head.header[place]);
                bail!("{}, line {line}, column \"{name}\": {problem}", self.file)
            }
        }
    }

    fn begin(&mut self) {
        self.is_begun = true;
        self.simulated = 0;
        self.simulation.begin(self.names.present().unwrap_or(&self.file));
    }

    /// Takes the numbers of a row.
    fn push(&mut self, row: &Row<'_>) -> Result<()> {
        self.thousands.iter_mut().for_each(|(place, watch)| watch.take(row.cell(*place), row.line));
        let is_first = self.waiting.lines.is_empty() && self.simulated == 0;
        let mut number = |place: usize, name: &str, kind: Kind, factor: Option<f64>| {
            let number = number_in(&mut self.numbers, row.cell(place), row.line, kind, is_first);
            let number = number.map_err(|problem| {
                anyhow!("{}, line {}, column \"{}\": {problem}", self.file, row.line, clipped(name))
            })?;
            anyhow::Ok(factor.map_or(number, |factor| factor * number))
        };
        let factors = self.factors;
        if let Some((place, name)) = self.places.time.zip(self.roles.time.as_ref()) {
            self.block.time.push(number(place, name, Kind::Given, factors.time)?);
        }
        let columns = self.places.inputs.iter().zip(&self.roles.inputs).zip(&factors.inputs);
        for (input, ((&place, name), &factor)) in self.block.inputs.iter_mut().zip(columns) {
            input.push(number(place, name, Kind::Given, factor)?);
        }
        if let Some((place, name)) = self.places.rate.zip(self.roles.rate.as_ref()) {
            self.block.rate.push(number(place, name, Kind::Given, factors.rate)?);
        }
        let output = match self.places.output {
            Some(place) => number(place, &self.roles.output, Kind::Output, factors.output)?,
            None => f64::NAN,
        };
        if self.wanted.measured {
            let inputs = self.block.inputs.iter().filter_map(|input| input.last().copied());
            self.fingerprint.add(inputs, output);
        }
        self.block.output.push(output);
        self.block.rows += 1;
        self.waiting.push(row, self.wanted, output);
        if self.wanted.drive {
            self.waiting.drive.push_last(&self.block);
        }
        Ok(())
    }

    /// Simulates the block, and the rest of the record if it ends.
    fn simulate(&mut self, ends_record: bool, take: &mut Take<'_>) -> Result<ControlFlow<()>> {
        if self.block.rows > 0 {
            let first = self.waiting.lines.len() - self.block.rows;
            let record = self.block.record(&self.places, self.names.present().unwrap_or(&self.file));
            let record = record.map_err(|error| self.explain(error, first))?;
            let prediction = self.simulation.take(&record.excitation());
            if self.hand_on(prediction, false, take)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        if ends_record {
            if self.model.was_trained_on(&mem::take(&mut self.fingerprint)) {
                let record = self.names.present().unwrap_or(&self.file).to_string();
                self.known.push(Warning::TrainedOn { record, likeness: Likeness::Equal });
            }
            let prediction = self.simulation.finish();
            return self.hand_on(prediction, true, take);
        }
        Ok(ControlFlow::Continue(()))
    }

    fn hand_on(
        &mut self,
        prediction: hysid::Result<Prediction>,
        ends_record: bool,
        take: &mut Take<'_>,
    ) -> Result<ControlFlow<()>> {
        let prediction = prediction.map_err(|error| self.explain_in_record(error))?;
        let rows = prediction.output.len();
        let flow = take(&Simulated {
            measured: if self.wanted.measured { &self.waiting.measured[..rows] } else { &[] },
            prediction: &prediction,
            before: self.simulated,
            ends_record,
            numbers: &self.numbers,
            waiting: &self.waiting,
        })?;
        self.waiting.drop_first(rows);
        self.simulated += rows;
        Ok(flow)
    }

    /// An error of rows that wait from `first` on.
    fn explain(&self, error: hysid::Error, first: usize) -> anyhow::Error {
        let row = match &error {
            hysid::Error::Data(defect) => defect.row,
            _ => None,
        };
        let line = row.and_then(|row| self.waiting.lines.get(first + row)).copied();
        explained(&self.file, line, error, self.roles)
    }

    /// An error with its row in the present record.
    fn explain_in_record(&self, mut error: hysid::Error) -> anyhow::Error {
        if let hysid::Error::Data(defect) = &mut error {
            defect.row = defect.row.map(|row| row.saturating_sub(self.simulated));
        }
        self.explain(error, 0)
    }
}

impl Block {
    fn new(inputs: usize) -> Self {
        Self { inputs: vec![Vec::new(); inputs], ..Self::default() }
    }

    /// The rows as a record, which is checked; the block is empty after it.
    fn record(&mut self, places: &Places, name: &str) -> hysid::Result<Record> {
        let Self { time, inputs, rate, output, .. } = mem::replace(self, Self::new(self.inputs.len()));
        let mut record = Record::new(name, inputs, output)?;
        if places.time.is_some() {
            record = record.with_time(time)?;
        }
        if places.rate.is_some() {
            record = record.with_given_rate(rate)?;
        }
        Ok(record)
    }
}

impl Waiting {
    fn push(&mut self, row: &Row<'_>, wanted: Wanted, measured: f64) {
        self.lines.push(row.line);
        if wanted.measured {
            self.measured.push(measured);
        }
        if wanted.cells {
            let (text, ends) = row.parts();
            self.ends.extend(ends.iter().map(|end| self.text.len() + end));
            self.text.push_str(text);
        }
    }

    fn cells(&self, row: usize) -> impl Iterator<Item = &str> {
        let ends = &self.ends[row * self.width..(row + 1) * self.width];
        let start = if row == 0 { 0 } else { self.ends[row * self.width - 1] };
        let starts = std::iter::once(start).chain(ends.iter().copied());
        starts.zip(ends).map(|(start, &end)| &self.text[start..end])
    }

    fn drop_first(&mut self, rows: usize) {
        self.lines.drain(..rows);
        self.measured.drain(..rows.min(self.measured.len()));
        self.drive.drop_first(rows);
        let cells = (rows * self.width).min(self.ends.len());
        if cells > 0 {
            let end = self.ends[cells - 1];
            self.text.drain(..end);
            self.ends.drain(..cells);
            self.ends.iter_mut().for_each(|cell_end| *cell_end -= end);
        }
    }
}
