//! A model run over a table row by row: memory does not grow with the table.

use std::mem;
use std::ops::ControlFlow;

use hysid::data::known_beginning::KnownBeginning;
use hysid::data::likeness::Likeness;
use hysid::data::record::{Fingerprint, Record};
use hysid::data::warning::Warning;
use hysid::model::{BandLevel, Model, Prediction, Simulation};
use hysid_document::{Problem, Result};
use hysid_records::{
    CellNeed, MOST_ROWS_OF_ZERO, RecordNames, Roles, UnitFactors, checked, equal_stamps, explained,
    offset_of, place_of,
};
use hysid_tables::{CellReader, ColumnReader, Head, Row, Rows, spread_equal, starts_again};

/// Rows that are simulated together.
const BLOCK: usize = MOST_ROWS_OF_ZERO;

/// Most rows of a known beginning.
const MOST_KNOWN: usize = 1_000_000;

/// Blocks that rows with one time stamp may fill.
const MOST_EQUAL: usize = 16;

/// Columns to keep of the rows, beside the outputs.
#[derive(Debug, Clone, Copy, Default)]
pub struct KeptColumns {
    pub measured: bool,
    /// Time, inputs and rate.
    pub drive: bool,
    pub cells: bool,
    pub band: Option<BandLevel>,
    /// Over how many rows at the beginning of each record the first input and the output are to be zero in the mean.
    pub zero: Option<usize>,
}

/// Rows that are simulated, in the order of the table.
pub struct Simulated<'r> {
    /// Their outputs, and their band if it is kept.
    pub prediction: &'r Prediction,
    /// Their measured outputs, NaN where they are blank; empty if these are not kept.
    pub measured: &'r [f64],
    /// Name of their record; that of the file if records have no names.
    pub record: &'r str,
    /// Rows of their record before them.
    pub before: usize,
    pub ends_record: bool,
    /// How the numbers of the table are written, as far as it is read.
    pub numbers: &'r CellReader,
    waiting: &'r Waiting,
}

impl<'r> Simulated<'r> {
    /// Their time, inputs and rate, if these are kept.
    pub fn drive(&self) -> &'r Drive {
        &self.waiting.drive
    }

    pub fn cells(&self, row: usize) -> impl Iterator<Item = &'r str> {
        self.waiting.cells(row)
    }
}

/// Time, inputs and rate of rows, column by column, of which the first are those that are simulated.
#[derive(Default)]
pub struct Drive {
    /// Time; empty if there is none.
    pub time: Vec<f64>,
    pub inputs: Vec<Vec<f64>>,
    /// Rate of the first input; empty if no column has it.
    pub rate: Vec<f64>,
}

impl Drive {
    /// Adds the rows of a block.
    fn push(&mut self, block: &RowBlock) {
        self.inputs.resize(block.inputs.len(), Vec::new());
        self.time.extend(&block.time);
        self.rate.extend(&block.rate);
        self.inputs.iter_mut().zip(&block.inputs).for_each(|(input, from)| input.extend(from));
    }

    fn drop_first(&mut self, rows: usize) {
        let columns = self.inputs.iter_mut().chain([&mut self.time, &mut self.rate]);
        columns.for_each(|column| drop(column.drain(..rows.min(column.len()))));
    }
}

/// Takes rows that are simulated; breaks to end the run.
pub type Take<'t, E> = dyn FnMut(&Simulated<'_>) -> Result<ControlFlow<()>, E> + 't;

/// How a run has ended.
pub struct TableRunEnd {
    /// True if it was ended before the end of the table.
    pub is_early: bool,
    /// What was changed in the table as it was read, in words.
    pub note: Option<String>,
    pub warnings: Vec<Warning>,
}

/// Runs a model over all rows of a table.
pub fn run<E: From<Problem>>(
    model: &Model,
    rows: &mut Rows,
    roles: &Roles,
    factors: &UnitFactors,
    wanted: KeptColumns,
    take: &mut Take<'_, E>,
) -> Result<TableRunEnd, E> {
    let mut run = TableRun::new(model, &rows.head, roles, factors, wanted)?;
    while let Some((head, row)) = rows.next_row_of()? {
        let begins = run.begins_record(head, &row)?;
        if begins || run.is_full() {
            let ends_record = begins && run.is_begun;
            if run.simulate(ends_record, take)?.is_break() {
                return Ok(TableRunEnd { is_early: true, note: None, warnings: Vec::new() });
            }
        }
        if begins {
            run.begin();
        }
        run.push(head, &row)?;
    }
    if !run.is_begun {
        return Err(rows.head.no_rows().into());
    }
    run.check_thousands(&rows.head)?;
    let is_early = run.simulate(true, take)?.is_break();
    let note = (run.spread > 0).then(|| equal_stamps(&run.file, run.spread));
    let warnings = if is_early { Vec::new() } else { run.simulation.range_warnings() };
    Ok(TableRunEnd { is_early, note, warnings: warnings.into_iter().chain(run.known).collect() })
}

struct TableRun<'r, 'm> {
    file: String,
    roles: &'r Roles,
    factors: &'r UnitFactors,
    wanted: KeptColumns,
    columns: Columns,
    names: RecordNames,
    numbers: CellReader,
    clock: Clock,
    /// Rows so far whose time stamp was that of the row before.
    spread: usize,
    /// Offsets to subtract from the first input and the output of the present record, once known.
    offsets: Option<(f64, f64)>,
    records: usize,
    /// Name of the record of the rows that are simulated; the row that was read last may begin the next one.
    name: String,
    model: &'m Model,
    simulation: Simulation<'m>,
    /// Fingerprint of the rows of the present record.
    fingerprint: Fingerprint,
    /// Records so far that the model was trained on.
    known: Vec<Warning>,
    is_begun: bool,
    /// Rows of the present record that are simulated.
    simulated: usize,
    block: RowBlock,
    waiting: Waiting,
}

struct Columns {
    record: Option<usize>,
    time: Option<ColumnReader>,
    inputs: Vec<ColumnReader>,
    rate: Option<ColumnReader>,
    output: Option<ColumnReader>,
}

/// Time stamps of the present record.
#[derive(Default)]
struct Clock {
    first: f64,
    previous: f64,
    /// Time stamp of the present row.
    now: f64,
    /// The last step between different stamps.
    step: Option<f64>,
}

/// Rows of the present record that the simulation has not taken yet.
#[derive(Default)]
struct RowBlock {
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
        factors: &'r UnitFactors,
        wanted: KeptColumns,
    ) -> Result<Self> {
        let simulation = match wanted.band {
            Some(level) => model.simulation_with_band(level)?,
            None => model.simulation(),
        };
        let reader = |name: &String| Ok(ColumnReader::new(head, place_of(head, name)?));
        let columns = Columns {
            record: roles.record.as_ref().map(|name| place_of(head, name)).transpose()?,
            time: roles.time.as_ref().map(reader).transpose()?,
            inputs: roles.inputs.iter().map(reader).collect::<Result<_>>()?,
            rate: roles.rate.as_ref().map(reader).transpose()?,
            output: wanted.measured.then(|| reader(&roles.output)).transpose()?,
        };
        Ok(Self {
            file: head.file.clone(),
            roles,
            factors,
            wanted,
            block: RowBlock::new(columns.inputs.len()),
            columns,
            names: RecordNames::default(),
            numbers: CellReader::new(head.numbers()),
            clock: Clock::default(),
            spread: 0,
            offsets: None,
            records: 0,
            name: String::new(),
            model,
            simulation,
            fingerprint: Fingerprint::default(),
            known: Vec::new(),
            is_begun: false,
            simulated: 0,
            waiting: Waiting { width: head.header.len(), ..Waiting::default() },
        })
    }

    /// True if another record begins with the row: another name, or, without names, time that starts again.
    fn begins_record(&mut self, head: &Head, row: &Row<'_>) -> Result<bool> {
        let is_first = self.waiting.lines.is_empty() && self.simulated == 0;
        if let Some((column, name)) = self.columns.time.as_mut().zip(self.roles.time.as_ref()) {
            let now = read(column, &mut self.numbers, head, row, (name, CellNeed::INPUT, is_first))?;
            self.clock.previous = self.clock.now;
            self.clock.now = self.factors.time.map_or(now, |factor| factor * now);
        }
        let Some((place, column)) = self.columns.record.zip(self.roles.record.as_ref()) else {
            let Clock { first, previous, now, .. } = self.clock;
            return Ok(!self.is_begun || self.columns.time.is_some() && starts_again(first, previous, now));
        };
        let at = |words| Problem::in_cell(&self.file, row.line, column, words);
        self.names.begins(row.cell(place), at)
    }

    /// True if the block is to be simulated before the present row: rows with one time stamp stay together, so that
    /// they can be spread.
    fn is_full(&self) -> bool {
        let rows = self.block.rows;
        let is_beginning = self.simulated == 0 && self.waiting.lines.len() == rows;
        let is_known = match self.model.known_beginning() {
            KnownBeginning::Rows(known) => rows < known,
            KnownBeginning::Time(duration) => self.clock.previous - self.clock.first <= duration,
            KnownBeginning::Share(_) => false,
        };
        if is_beginning && is_known && rows < MOST_KNOWN {
            return false;
        }
        let goes_on = self.columns.time.is_some() && self.clock.now == self.clock.previous;
        rows >= BLOCK && (!goes_on || rows >= MOST_EQUAL * BLOCK)
    }

    fn check_thousands(&self, head: &Head) -> Result<()> {
        let columns = &self.columns;
        let mut all = columns.time.iter().chain(&columns.rate).chain(&columns.output).chain(&columns.inputs);
        match all.find_map(|column| Some((column.place(), column.problem(&self.numbers)?))) {
            None => Ok(()),
            Some((place, (line, problem))) => {
                Err(Problem::in_cell(&self.file, line, &head.header[place], problem))
            }
        }
    }

    fn begin(&mut self) {
        self.is_begun = true;
        self.simulated = 0;
        self.records += 1;
        self.offsets = None;
        (self.clock.first, self.clock.step) = (self.clock.now, None);
        self.name = match self.names.present() {
            Some(name) => name.to_string(),
            None if self.records > 1 => format!("{} ({})", self.file, self.records),
            None => self.file.clone(),
        };
        self.simulation.begin(self.name.clone());
    }

    /// Takes the numbers of a row.
    fn push(&mut self, head: &Head, row: &Row<'_>) -> Result<()> {
        let is_first = self.waiting.lines.is_empty() && self.simulated == 0;
        let mut number = |column: &mut ColumnReader, name: &str, kind: CellNeed, factor: Option<f64>| {
            let number = read(column, &mut self.numbers, head, row, (name, kind, is_first))?;
            Ok::<_, Problem>(factor.map_or(number, |factor| factor * number))
        };
        let factors = self.factors;
        if self.columns.time.is_some() {
            self.block.time.push(self.clock.now);
        }
        let columns = self.columns.inputs.iter_mut().zip(&self.roles.inputs).zip(&factors.inputs);
        for (input, ((column, name), &factor)) in self.block.inputs.iter_mut().zip(columns) {
            input.push(number(column, name, CellNeed::INPUT, factor)?);
        }
        if let Some((column, name)) = self.columns.rate.as_mut().zip(self.roles.rate.as_ref()) {
            self.block.rate.push(number(column, name, CellNeed::INPUT, factors.rate)?);
        }
        let output = match &mut self.columns.output {
            Some(column) => number(column, &self.roles.output, CellNeed::OUTPUT, factors.output)?,
            None => f64::NAN,
        };
        self.block.output.push(output);
        self.block.rows += 1;
        self.waiting.push(row, self.wanted, output);
        Ok(())
    }

    /// Spreads equal time stamps of the block, and removes offsets.
    fn prepare_block(&mut self, ends_record: bool) {
        if self.columns.time.is_some() {
            let next = (!ends_record && self.clock.now > self.clock.previous).then_some(self.clock.now);
            self.spread += spread_equal(&mut self.block.time, next, &mut self.clock.step);
        }
        if let Some(rows) = self.wanted.zero {
            let block = &mut self.block;
            let (x, y) = *self
                .offsets
                .get_or_insert_with(|| (offset_of(&block.inputs[0], rows), offset_of(&block.output, rows)));
            block.inputs[0].iter_mut().for_each(|value| *value -= x);
            block.output.iter_mut().for_each(|value| *value -= y);
            let measured = self.waiting.measured.len().saturating_sub(block.rows);
            self.waiting.measured[measured..].iter_mut().for_each(|value| *value -= y);
        }
        if self.wanted.measured {
            for (row, &output) in self.block.output.iter().enumerate() {
                self.fingerprint.add(self.block.inputs.iter().map(|input| input[row]), output);
            }
        }
        if self.wanted.drive {
            self.waiting.drive.push(&self.block);
        }
    }

    /// Simulates the block, and the rest of the record if it ends.
    fn simulate<E: From<Problem>>(
        &mut self,
        ends_record: bool,
        take: &mut Take<'_, E>,
    ) -> Result<ControlFlow<()>, E> {
        if self.block.rows > 0 {
            self.prepare_block(ends_record);
            let first = self.waiting.lines.len() - self.block.rows;
            let record = self.block.record(&self.columns, &self.name);
            let mut record = record.map_err(|error| self.explain(error, first))?;
            if self.simulated == 0 && first == 0 {
                let begun = self.model.begun(&record).map_err(|error| self.explain(error, first))?;
                record = begun.into_owned();
                let known = record.known().len().min(self.waiting.measured.len());
                self.waiting.measured[..known].fill(f64::NAN);
            }
            let prediction = self.simulation.take(&record.excitation());
            if self.hand_on(prediction, false, take)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        if ends_record {
            if self.model.was_trained_on(&mem::take(&mut self.fingerprint)) {
                let record = self.name.clone();
                self.known.push(Warning::TrainedOn { record, likeness: Likeness::Equal });
            }
            let prediction = self.simulation.finish();
            return self.hand_on(prediction, true, take);
        }
        Ok(ControlFlow::Continue(()))
    }

    fn hand_on<E: From<Problem>>(
        &mut self,
        prediction: hysid::Result<Prediction>,
        ends_record: bool,
        take: &mut Take<'_, E>,
    ) -> Result<ControlFlow<()>, E> {
        let prediction = prediction.map_err(|error| self.explain_in_record(error))?;
        let rows = prediction.output.len();
        let flow = take(&Simulated {
            record: &self.name,
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
    fn explain(&self, error: hysid::Error, first: usize) -> Problem {
        let row = match &error {
            hysid::Error::Data(defect) => defect.row,
            _ => None,
        };
        let line = row.and_then(|row| self.waiting.lines.get(first + row)).copied();
        explained(&self.file, line, error, self.roles)
    }

    /// An error with its row in the present record.
    fn explain_in_record(&self, mut error: hysid::Error) -> Problem {
        if let hysid::Error::Data(defect) = &mut error {
            defect.row = defect.row.map(|row| row.saturating_sub(self.simulated));
        }
        self.explain(error, 0)
    }
}

/// The number of a column in a row; `what` is its name, its kind, and whether the row is the first of its record.
fn read(
    column: &mut ColumnReader,
    numbers: &mut CellReader,
    head: &Head,
    row: &Row<'_>,
    what: (&str, CellNeed, bool),
) -> Result<f64> {
    let (name, kind, is_first) = what;
    let cell = row.cell(column.place());
    let number = column.number(head, numbers, cell, row.line);
    let at = |words| Problem::in_cell(&head.file, row.line, name, words);
    checked(number, cell, kind, is_first).map_err(at)
}

impl RowBlock {
    fn new(inputs: usize) -> Self {
        Self { inputs: vec![Vec::new(); inputs], ..Self::default() }
    }

    /// The rows as a record, which is checked; the block is empty after it.
    fn record(&mut self, columns: &Columns, name: &str) -> hysid::Result<Record> {
        let Self { time, inputs, rate, output, .. } = mem::replace(self, Self::new(self.inputs.len()));
        let mut record = Record::new(name, inputs, output)?;
        if columns.time.is_some() {
            record = record.with_time(time)?;
        }
        if columns.rate.is_some() {
            record = record.with_given_rate(rate)?;
        }
        Ok(record)
    }
}

impl Waiting {
    fn push(&mut self, row: &Row<'_>, wanted: KeptColumns, measured: f64) {
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
