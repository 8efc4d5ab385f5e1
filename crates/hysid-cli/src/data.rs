//! From tables to the library's data set, and from the library's errors back to file, line and
//! column.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use hysid::data::record::{Dataset, Record};
use hysid::error::{Channel, DataError, DataProblem};

use crate::cell::{CellReader, ThousandsWatch};
use crate::columns::Roles;
use crate::messages::Usage;
use crate::record_names::RecordNames;
use crate::table::{Head, Origin, Table};
use crate::terminal::clipped;

/// Measured data and the tables they come from.
pub struct Data {
    /// The data as the library takes them.
    pub set: Dataset,
    /// What the columns are.
    pub roles: Roles,
    /// Where each record stands.
    pub source: Source,
}

/// The tables, and which record is where.
pub struct Source {
    /// The tables, in the order of the command line.
    pub tables: Vec<Origin>,
    places: Vec<Place>,
}

/// Where a record stands.
pub struct Place {
    /// Name of the record.
    pub record: String,
    table: usize,
    /// Its rows in the table.
    pub rows: Range<usize>,
}

impl Data {
    /// Takes records from tables.
    pub fn new(tables: Vec<Table>, roles: Roles) -> Result<Self> {
        for table in &tables[1..] {
            roles.check_against(table, &tables[0])?;
        }
        let stems = stems(&tables);
        let mut source = Source { places: Vec::new(), tables: Vec::new() };
        let mut of_tables = Vec::new();
        for (index, (table, stem)) in tables.into_iter().zip(&stems).enumerate() {
            let first = source.places.len();
            source.places.extend(places(&table, index, &roles, stem, stems.len() > 1)?);
            of_tables.push((Columns::read(&table, &roles)?, first..source.places.len()));
            source.tables.push(table.into_origin());
        }
        let mut records = Vec::new();
        for (columns, places) in of_tables {
            for place in &source.places[places] {
                records.push(columns.record(place).map_err(|error| source.explain(error, &roles))?);
            }
        }
        let set = Dataset::new(roles.names(), records).map_err(|error| source.explain(error, &roles))?;
        Ok(Self { set, roles, source })
    }

    /// The data with the first input and the output exchanged. A rate that a column gives is that of the input.
    pub fn exchanged(mut self) -> Result<Self> {
        if self.roles.rate.is_some() {
            return Err(Usage(
                "--inverse: the rate would be that of the output: use a method, not a column".into(),
            )
            .into());
        }
        let exchanged = self.set.exchanged().map_err(|error| self.explain(error))?;
        for (place, record) in self.source.places.iter_mut().zip(self.set.records()) {
            // Rows without output at the ends are gone.
            let rows = record.measured_rows().unwrap_or_default();
            place.rows = place.rows.start + rows.start..place.rows.start + rows.end;
        }
        self.set = exchanged;
        std::mem::swap(&mut self.roles.inputs[0], &mut self.roles.output);
        Ok(self)
    }

    /// Puts an error of the library in the user's words: file, line, column.
    pub fn explain(&self, error: hysid::Error) -> anyhow::Error {
        self.source.explain(error, &self.roles)
    }
}

impl Source {
    fn explain(&self, error: hysid::Error, roles: &Roles) -> anyhow::Error {
        let error = match error {
            hysid::Error::Data(error) => error,
            other => return of_options(other),
        };
        let Some(place) = self.places.iter().find(|place| place.record == error.record) else {
            return error.into();
        };
        let table = &self.tables[place.table];
        let line = error.row.map(|row| table.lines[place.rows.start + row]);
        match self.tables.len() {
            n if n > 1 && line.is_none() && concerns_all(&error) => {
                let files = format!("{} and {} more", self.tables[0].file, n - 1);
                explained(&files, None, error.into(), roles)
            }
            _ => explained(&table.file, line, error.into(), roles),
        }
    }
}

/// An error of the library in the user's words: file, line, column.
pub fn explained(file: &str, line: Option<u64>, error: hysid::Error, roles: &Roles) -> anyhow::Error {
    let error = match error {
        hysid::Error::Data(error) => error,
        other => return of_options(other),
    };
    let column = error.channel.and_then(|channel| column(channel, roles));
    match (&error.problem, line, column) {
        (problem, Some(line), Some(column)) => {
            anyhow!("{file}, line {line}, column \"{}\": {problem}", clipped(column))
        }
        (DataProblem::TooFewRows { found: 1, needed }, ..) => {
            anyhow!("{file}: only 1 row has an output: at least {needed} are needed")
        }
        (DataProblem::TooFewRows { found, needed }, ..) => {
            anyhow!("{file}: only {found} rows have an output: at least {needed} are needed")
        }
        (problem @ DataProblem::TooFewForTests { .. }, ..) => anyhow!("{file}: {problem}"),
        (
            DataProblem::ConstantInput(_) | DataProblem::ConstantOutput(_) | DataProblem::NothingToScore,
            _,
            Some(column),
        ) => {
            anyhow!("{file}: column \"{}\" {}", clipped(column), error.problem)
        }
        (problem, ..) => anyhow!("{file}: {problem}{}", advice(problem)),
    }
}

/// An error that is about no row: a wrong use of the command line, or another.
fn of_options(error: hysid::Error) -> anyhow::Error {
    match error {
        hysid::Error::SeveralInputs { .. } => Usage(format!("{error} with --input")).into(),
        hysid::Error::RateNeeded(_) => Usage(format!("{error} (name a time column with --time)")).into(),
        hysid::Error::Option(_)
        | hysid::Error::Parts(_)
        | hysid::Error::UnknownName { .. }
        | hysid::Error::Probability { .. } => Usage(error.to_string()).into(),
        other => other.into(),
    }
}

/// What helps on the command line.
fn advice(problem: &DataProblem) -> &'static str {
    match problem {
        DataProblem::NoTime => " (name one with --time, or use --rate none)",
        DataProblem::NoTimeForModel => " (name it with --time)",
        _ => "",
    }
}

/// True for problems of the data set as a whole, which the library reports with its first record.
fn concerns_all(error: &DataError) -> bool {
    matches!(
        error.problem,
        DataProblem::ConstantInput(_)
            | DataProblem::ConstantOutput(_)
            | DataProblem::NothingToScore
            | DataProblem::TooFewRows { .. }
    )
}

fn column(channel: Channel, roles: &Roles) -> Option<&str> {
    match channel {
        Channel::Time => roles.time.as_deref(),
        Channel::Input(index) => roles.inputs.get(index).map(String::as_str),
        Channel::Rate => roles.rate.as_deref(),
        Channel::Output => Some(&roles.output),
    }
}

/// A name for each table: its file's stem, the whole path where two stems are the same, and a number behind it where a
/// file is given twice.
fn stems(tables: &[Table]) -> Vec<String> {
    let stem = |table: &Table| {
        let path = Path::new(&table.file);
        path.file_stem().map_or_else(|| table.file.clone(), |stem| stem.to_string_lossy().into_owned())
    };
    let all: Vec<String> = tables.iter().map(stem).collect();
    let mut count: HashMap<&str, usize> = HashMap::new();
    all.iter().for_each(|stem| *count.entry(stem).or_default() += 1);
    let name = |(stem, table): (&String, &Table)| {
        if count[stem.as_str()] == 1 { stem.clone() } else { table.file.clone() }
    };
    let mut given: HashMap<String, usize> = HashMap::new();
    let numbered = |name: String| {
        let count = given.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name} ({count})") }
    };
    all.iter().zip(tables).map(name).map(numbered).collect()
}

/// The records of one table.
pub fn places_of(table: &Table, roles: &Roles) -> Result<Vec<Place>> {
    let stems = stems(std::slice::from_ref(table));
    places(table, 0, roles, &stems[0], false)
}

/// The records of a table: runs of rows with the same name in the record column.
fn places(table: &Table, index: usize, roles: &Roles, stem: &str, several: bool) -> Result<Vec<Place>> {
    let Some(column) = &roles.record else {
        return Ok(vec![Place { record: stem.into(), table: index, rows: 0..table.len() }]);
    };
    let cell = place_of(table, column)?;
    let mut places: Vec<Place> = Vec::new();
    let mut names = RecordNames::default();
    for row in 0..table.len() {
        let at = || format!("{}, line {}, column \"{}\"", table.file, table.lines[row], clipped(column));
        let name = table.cell(row, cell);
        if !names.begins(name, at)? {
            places.last_mut().expect("a record has begun").rows.end = row + 1;
            continue;
        }
        let name = name.trim();
        let record = if several { format!("{stem}/{name}") } else { name.to_string() };
        places.push(Place { record, table: index, rows: row..row + 1 });
    }
    Ok(places)
}

/// Place of a column.
pub fn place_of(table: &Head, name: &str) -> Result<usize> {
    table.column(name).ok_or_else(|| anyhow!("{}: there is no column \"{}\"", table.file, clipped(name)))
}

/// The numbers of a table, column by column.
struct Columns {
    time: Option<Vec<f64>>,
    inputs: Vec<Vec<f64>>,
    rate: Option<Vec<f64>>,
    output: Vec<f64>,
}

impl Columns {
    fn read(table: &Table, roles: &Roles) -> Result<Self> {
        let mut cells = CellReader::new(table.delimiter);
        let mut read = |name: &String, kind: Kind| column_of(table, name, kind, &mut cells);
        let time = roles.time.as_ref().map(|name| read(name, Kind::Given)).transpose()?;
        let inputs = roles.inputs.iter().map(|name| read(name, Kind::Given)).collect::<Result<_>>()?;
        let rate = roles.rate.as_ref().map(|name| read(name, Kind::Given)).transpose()?;
        let output = read(&roles.output, Kind::Output)?;
        Ok(Self { time, inputs, rate, output })
    }

    fn record(&self, place: &Place) -> hysid::Result<Record> {
        let cut = |column: &Vec<f64>| column[place.rows.clone()].to_vec();
        let inputs = self.inputs.iter().map(cut).collect();
        let mut record = Record::new(place.record.clone(), inputs, cut(&self.output))?;
        if let Some(time) = &self.time {
            record = record.with_time(cut(time))?;
        }
        if let Some(rate) = &self.rate {
            record = record.with_given_rate(cut(rate))?;
        }
        Ok(record)
    }
}

/// What the numbers of a column are, which decides about blank cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Time, an input or its rate.
    Given,
    /// A measured output, which may be blank.
    Output,
    /// A wanted output.
    Wanted,
}

/// The numbers of a column; a blank output is NaN.
pub fn column_of(table: &Table, name: &str, kind: Kind, cells: &mut CellReader) -> Result<Vec<f64>> {
    let place = place_of(table, name)?;
    let at = |line: u64, problem: &str| {
        anyhow!("{}, line {line}, column \"{}\": {problem}", table.file, clipped(name))
    };
    let mut thousands = ThousandsWatch::default();
    let number = |(row, &line): (usize, &u64)| {
        let cell = table.cell(row, place);
        thousands.take(cell, line);
        number_in(cells, cell, line, kind, row == 0).map_err(|problem| at(line, &problem))
    };
    let numbers = table.lines.iter().enumerate().map(number).collect::<Result<_>>()?;
    thousands.problem().map_or(Ok(numbers), |(line, problem)| Err(at(line, &problem)))
}

/// The number in a cell, NaN for a blank output; or what is wrong with it and what helps.
pub fn number_in(
    cells: &mut CellReader,
    cell: &str,
    line: u64,
    kind: Kind,
    is_first: bool,
) -> Result<f64, String> {
    if cell.trim().is_empty() {
        return match kind {
            Kind::Output => Ok(f64::NAN),
            Kind::Given => Err("the cell is empty (only the output may be blank)".into()),
            Kind::Wanted => Err("the cell is empty (every row needs a wanted output)".into()),
        };
    }
    cells.number(cell, line).map_err(|problem| {
        let hint = match (kind, problem.ends_with("number")) {
            (Kind::Output, true) => " (leave the cell empty to drive the model without scoring)",
            (Kind::Given, true) if is_first => " (not an input? name the inputs with --input)",
            _ => "",
        };
        problem + hint
    })
}

/// Reads tables.
pub fn read_tables(paths: &[PathBuf]) -> Result<Vec<Table>> {
    paths.iter().map(|path| Table::read(path)).collect()
}
