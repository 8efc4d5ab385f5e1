//! From tables to the library's data set, and from the library's errors back to file, line and
//! column.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use hysid_core::data::column::correlation;
use hysid_core::data::record::{ColumnNames, Dataset, Record};
use hysid_core::data::usual_role::Domain;
use hysid_core::error::{Channel, DataError, DataProblem};
use hysid_core::model::Model;
use hysid_core::significant::Significant;
use hysid_core::words::{Hint, Words};

use hysid_tables::{
    CellProblem, CellReader, ColumnReader, Head, Problem, Reading, Result, Table, TableOrigin, is_record,
    spread_equal, starts_again,
};

use crate::columns::kind::ColumnKind;
use crate::columns::values::{changes, numbers, plateaus};
use crate::columns::{ColumnChoice, Roles, time_or_no_rate};
use crate::record_names::RecordNames;
use crate::units::UnitFactors;
use hysid_document::shell::quoted;
use hysid_document::unit;
use hysid_document::visible::{clipped, listed};

/// Correlation of a force with a displacement below which it is a reaction.
const LEAST_FALL: f64 = -0.5;

/// Measured data and the tables they come from.
pub struct Data {
    /// The data as the library takes them.
    pub set: Dataset,
    pub roles: Roles,
    /// Where each record stands.
    pub source: DataSource,
    /// Changes made to the data while reading, in words.
    pub warnings: Vec<Words>,
}

/// The tables, and which record is where.
pub struct DataSource {
    /// The tables, in the order of the command line.
    pub tables: Vec<TableOrigin>,
    places: Vec<RecordPlace>,
    /// The roles in each table, if tables name their columns differently.
    own_roles: Vec<Roles>,
}

/// Where a record stands.
pub struct RecordPlace {
    pub record: String,
    /// Place of its table among all.
    pub table: usize,
    pub rows: Range<usize>,
}

impl Data {
    /// The data in tables whose roles a choice and the names give. `zero` is as in [`Data::new`].
    pub fn of_tables(tables: Vec<Table>, columns: &ColumnChoice, zero: Option<usize>) -> Result<Self> {
        let roles = Roles::detect(&tables[0], columns)?;
        Self::new(tables, roles, zero)
    }

    /// Takes records from tables. `zero` is over how many rows at the beginning of each record the first input and the
    /// output are to be zero in the mean.
    pub fn new(tables: Vec<Table>, roles: Roles, zero: Option<usize>) -> Result<Self> {
        let names = roles.names();
        for table in &tables[1..] {
            roles.check_against(table, &tables[0].file)?;
        }
        let mut data = Self::converted(tables, roles, names, &[], Vec::new(), zero)?;
        data.warnings.extend(data.reaction());
        Ok(data)
    }

    /// A warning of a force that falls while the displacement rises, as reactions of finite elements do.
    fn reaction(&self) -> Option<Words> {
        let (input, output) = (&self.roles.inputs[0], &self.roles.output);
        let is_force = ColumnKind::of(input) == ColumnKind::Drives(Domain::Mechanics)
            && ColumnKind::of(output) == ColumnKind::Follows(Domain::Mechanics);
        let records = || self.set.records().iter().filter(|_| is_force);
        let x: Vec<f64> = records().flat_map(|record| record.inputs()[0].iter().copied()).collect();
        let y: Vec<f64> = records().flat_map(|record| record.output().iter().copied()).collect();
        let falls = correlation(&x, &y).is_some_and(|correlation| correlation < LEAST_FALL);
        let words = format!(
            "{} falls while {} rises, as a reaction does, whose sign is opposite to that of the force on the specimen",
            clipped(output),
            clipped(input)
        );
        let advice = "if it is one, multiply the column by -1 in the file; no option does this";
        falls.then(|| Words::from(words).advised(advice))
    }

    /// Takes records from tables that have columns of the roles `like`, each by its own roles, in the units of `like`.
    pub fn of_files(files: Vec<(Table, Roles)>, like: Roles, zero: Option<usize>) -> Result<Self> {
        let names = like.names();
        let factors = |(table, roles): &(Table, Roles)| {
            UnitFactors::between(roles, (&names, "the first file's"), &table.file, true, false)
        };
        let factors: Vec<UnitFactors> = files.iter().map(factors).collect::<Result<_>>()?;
        let (tables, own): (Vec<Table>, Vec<Roles>) = files.into_iter().unzip();
        let data = Self::converted(tables, like, names, &factors, own, zero)?;
        let conversions = factors.into_iter().flat_map(|factors| factors.conversions).map(Words::from);
        Ok(Self { warnings: data.warnings.into_iter().chain(conversions).collect(), ..data })
    }

    /// `factors` and `own_roles` are of each table; empty if all have the units and names of `roles`.
    fn converted(
        tables: Vec<Table>,
        roles: Roles,
        names: ColumnNames,
        factors: &[UnitFactors],
        own_roles: Vec<Roles>,
        zero: Option<usize>,
    ) -> Result<Self> {
        refuse_parts_of_a_test(&tables, &roles)?;
        let stems = stems(&tables);
        let mut source = DataSource { places: Vec::new(), tables: Vec::new(), own_roles };
        let mut of_tables = Vec::new();
        for (index, (table, stem)) in tables.into_iter().zip(&stems).enumerate() {
            let first = source.places.len();
            let of_table = source.own_roles.get(index).unwrap_or(&roles);
            let mut columns = NumberColumns::read(&table, of_table)?;
            factors.get(index).into_iter().for_each(|factors| columns.convert(factors));
            let naming = Naming { table: index, stem, has_others: stems.len() > 1 };
            source.places.extend(places(&table, of_table, &naming, columns.time.as_deref())?);
            of_tables.push((columns, first..source.places.len()));
            source.tables.push(table.into_origin());
        }
        let (mut records, mut warnings) = (Vec::new(), Vec::from_iter(roles.note.clone()));
        warnings.extend(source.tables.iter().filter_map(|table| table.left_out.warning(&table.file)));
        for (mut columns, places) in of_tables {
            let places = &source.places[places];
            warnings.extend(columns.spread_equal_stamps(places, &source).map(Words::from));
            zero.iter().for_each(|&rows| columns.remove_offsets(places, rows));
            for place in places {
                records.push(columns.record(place).map_err(|error| source.explain(error, &roles))?);
            }
        }
        let set = Dataset::new(names, records).map_err(|error| source.explain(error, &roles))?;
        Ok(Self { set, roles, source, warnings })
    }

    /// Takes records from tables for a model: its columns, in its units. `zero` is as in [`Data::new`].
    pub fn of_model(
        tables: Vec<Table>,
        model: &Model,
        columns: &ColumnChoice,
        zero: Option<usize>,
    ) -> Result<Self> {
        let roles = Roles::of_model(model, &tables[0], columns, true)?;
        let factors = UnitFactors::of(model, &roles, &tables[0].file, true, false)?;
        let names = factors.names(model, &roles);
        let of_tables = vec![factors.clone(); tables.len()];
        let data = Self::converted(tables, roles, names, &of_tables, Vec::new(), zero)?;
        let warnings =
            data.warnings.into_iter().chain(factors.conversions.into_iter().map(Words::from)).collect();
        Ok(Self { warnings, ..data })
    }

    /// A warning of inputs after the first, which something does not use; `None` if there are none. `what` is what it does
    /// with the output, `used` what it does with inputs.
    pub fn unused_inputs(&self, what: &str, used: &str) -> Option<Words> {
        let [first, further @ ..] = self.roles.inputs.as_slice() else { return None };
        (!further.is_empty()).then(|| {
            let words = Words::from(format!(
                "{what} {} over {}; {} {} not {used}",
                clipped(&self.roles.output),
                clipped(first),
                listed(further),
                if further.len() == 1 { "is" } else { "are" },
            ));
            words.advised(Words::from("choose with ") + Hint::Option("input"))
        })
    }

    /// The data with the first input and the output exchanged. A rate that a column gives is that of the input.
    pub fn exchanged(mut self) -> Result<Self> {
        if self.roles.rate.is_some() {
            let needed = "the rate would be that of the output: use a method, not a column";
            return Err(Problem::option("inverse", needed));
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
    pub fn explain(&self, error: hysid_core::Error) -> Problem {
        self.source.explain(error, &self.roles)
    }
}

impl DataSource {
    /// Where each record stands.
    pub fn places(&self) -> &[RecordPlace] {
        &self.places
    }

    fn explain(&self, error: hysid_core::Error, roles: &Roles) -> Problem {
        let error = match error {
            hysid_core::Error::Data(error) => error,
            other => return of_options(other),
        };
        let Some(place) = self.places.iter().find(|place| place.record == error.record) else {
            return Problem::Library(error.into());
        };
        let table = &self.tables[place.table];
        let roles = self.own_roles.get(place.table).unwrap_or(roles);
        let line = error.row.map(|row| table.lines[place.rows.start + row]);
        match line {
            None if concerns_all(&error) => explained(&self.files(), None, error.into(), roles),
            _ => explained(&table.file, line, error.into(), roles),
        }
    }

    /// The only file, or the first and the number of the others.
    pub fn files(&self) -> String {
        let [first, others @ ..] = self.tables.as_slice() else { return String::new() };
        let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
        format!("{}{more}", first.file)
    }
}

/// An error of the library in the user's words: file, line, column.
pub fn explained(file: &str, line: Option<u64>, error: hysid_core::Error, roles: &Roles) -> Problem {
    let error = match error {
        hysid_core::Error::Data(error) => error,
        other => return of_options(other),
    };
    let column = error.channel.and_then(|channel| column(channel, roles));
    let words: Words = match (&error.problem, line, column) {
        (problem, Some(line), Some(column)) => {
            let words = match (problem, &roles.record) {
                (DataProblem::TimeNotIncreasing { before, now }, Some(record)) => {
                    restarts(*before, *now, record)
                }
                _ => data_words(problem),
            };
            return Problem::in_cell(file, line, column, words);
        }
        (DataProblem::TooFewRows { found, needed }, ..) => {
            let rows = if *found == 1 { "1 row has".into() } else { format!("{found} rows have") };
            format!("only {rows} an output: at least {needed} are needed").into()
        }
        (problem, _, Some(column)) if problem.is_of_whole_column() => {
            format!("column \"{}\" {problem}", clipped(column)).into()
        }
        (problem, ..) => data_words(problem),
    };
    Problem::in_file(file, words)
}

/// Message on time that does not go on within a record that a column names.
fn restarts(before: f64, now: f64, record: &str) -> Words {
    let words =
        format!("time {now} does not come after {before}, and \"{}\" keeps its value", clipped(record));
    let sort = Words::from("sort the rows, or ");
    Words::from(words).advised(match is_record(record) {
        true => sort + "give each run a name of its own",
        false => {
            let record = Hint::Option("record");
            sort + "number the runs in another column for "
                + record
                + ", or leave it out: a run begins where time starts again"
        }
    })
}

/// An error that is about no row: a wrong use of the command line, or another.
fn of_options(error: hysid_core::Error) -> Problem {
    let words = Words::from(error.to_string());
    match error {
        hysid_core::Error::SeveralInputs { .. } => Problem::Request(words + " with " + Hint::Option("input")),
        hysid_core::Error::RateNeeded(_) | hysid_core::Error::TimeNeeded(_) => {
            Problem::Request(words.advised(Words::from("name a time column with ") + Hint::Option("time")))
        }
        hysid_core::Error::Option(_)
        | hysid_core::Error::Parts(_)
        | hysid_core::Error::UnknownName { .. }
        | hysid_core::Error::Probability { .. } => Problem::Request(words),
        other => Problem::Library(other),
    }
}

/// A problem of the data, with the options that help.
pub fn data_words(problem: &DataProblem) -> Words {
    let words = Words::from(problem.to_string());
    match problem {
        DataProblem::NoTime => words.advised(time_or_no_rate()),
        DataProblem::NoTimeForModel => words.advised(Words::from("name it with ") + Hint::Option("time")),
        DataProblem::NotFinite(_) | DataProblem::BlankWithin => words,
        // The others say what helps.
        _ => words.helpful(),
    }
}

/// True for problems of the data set as a whole, which the library reports with its first record.
fn concerns_all(error: &DataError) -> bool {
    error.problem.is_of_whole_column() || matches!(error.problem, DataProblem::TooFewRows { .. })
}

fn column(channel: Channel, roles: &Roles) -> Option<&str> {
    match channel {
        Channel::Time => roles.time.as_deref(),
        Channel::Input(index) => roles.inputs.get(index).map(String::as_str),
        Channel::Rate => roles.rate.as_deref(),
        Channel::Output => Some(&roles.output),
    }
}

/// The data in a table of this text, with columns by their names: the way of every file that is read.
pub fn data_of_text(text: &[u8]) -> Result<Dataset> {
    let table = Table::from_bytes(Path::new("text"), text.to_vec(), &Reading::default())?;
    Ok(Data::of_tables(vec![table], &ColumnChoice::default(), None)?.set)
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

/// Refuses files without names that have one growing column in common: time, beside the input in one and the output in
/// another.
fn refuse_parts_of_a_test(tables: &[Table], roles: &Roles) -> Result<()> {
    let ([first, second, ..], [input]) = (tables, roles.inputs.as_slice()) else { return Ok(()) };
    let is_nameless = |table: &Table| table.layout.header_lines.is_empty() && table.header.len() == 2;
    if roles.time.is_some() || !is_nameless(first) || !is_nameless(second) {
        return Ok(());
    }
    let values = numbers(first, input);
    let grows = values.as_ref().is_some_and(|values| values.windows(2).all(|pair| pair[0] < pair[1]));
    if !grows || values != numbers(second, input) {
        return Ok(());
    }
    let words =
        format!("has the same growing column \"{}\" as {}: time?", clipped(input), clipped(&first.file));
    let join = format!(
        "hysid look {} {} --join -o both.csv joins input and output of two files",
        quoted(&first.file),
        quoted(&second.file)
    );
    Err(Problem::in_file(&second.file, Words::from(words).advised(join)))
}

/// The records of one table, by its time stamps if it has any.
pub fn places_of(table: &Table, roles: &Roles, time: Option<&[f64]>) -> Result<Vec<RecordPlace>> {
    let stems = stems(std::slice::from_ref(table));
    places(table, roles, &Naming { table: 0, stem: &stems[0], has_others: false }, time)
}

/// Source of the names of a table's records.
struct Naming<'n> {
    /// Place of the table among all.
    table: usize,
    stem: &'n str,
    has_others: bool,
}

/// The records of a table: runs of rows with the same name in the record column; without such a column, a record begins
/// where time starts again or a condition of the test takes another value, which a record column of measured numbers is too.
fn places(
    table: &Table,
    roles: &Roles,
    naming: &Naming<'_>,
    time: Option<&[f64]>,
) -> Result<Vec<RecordPlace>> {
    let plateaus = roles.record.as_ref().and_then(|name| plateaus(table, name));
    let column = roles.record.as_ref().filter(|_| plateaus.is_none());
    let Some(column) = column else {
        let mut ends = ends_by_time(time.unwrap_or_default(), table.rows());
        ends.extend(ends_by_condition(table, roles));
        ends.extend(plateaus.iter().flatten().map(|rows| rows.end));
        ends.sort_unstable();
        ends.dedup();
        // What divides the rows tells the records apart.
        let divider = if plateaus.is_some() { &roles.record } else { &roles.condition };
        let values = divider.as_ref().and_then(|name| Some((name, numbers(table, name)?)));
        let name = |number: usize, rows: &Range<usize>| match (ends.len(), &values) {
            (1, _) => naming.stem.to_string(),
            (_, None) => format!("{} ({})", naming.stem, number + 1),
            (_, Some((column, values))) => {
                let mean = values[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
                let value = unit::with(&format!("{:.3}", Significant(mean)), column);
                format!("{} ({}: {value})", naming.stem, number + 1)
            }
        };
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let rows = starts.zip(&ends).map(|(start, &end)| start..end);
        let place = |(number, rows): (usize, Range<usize>)| RecordPlace {
            record: name(number, &rows),
            table: naming.table,
            rows,
        };
        return Ok(rows.enumerate().map(place).collect());
    };
    let cell = place_of(table, column)?;
    let mut places: Vec<RecordPlace> = Vec::new();
    let mut names = RecordNames::default();
    for row in 0..table.rows() {
        let at = |words| Problem::in_cell(&table.file, table.lines[row], column, words);
        let name = table.cell(row, cell);
        if !names.begins(name, at)? {
            places.last_mut().expect("a record has begun").rows.end = row + 1;
            continue;
        }
        let name = name.trim();
        let record = if naming.has_others { format!("{}/{name}", naming.stem) } else { name.to_string() };
        places.push(RecordPlace { record, table: naming.table, rows: row..row + 1 });
    }
    Ok(places)
}

/// Where records end because a condition of the test takes another value.
fn ends_by_condition(table: &Table, roles: &Roles) -> Vec<usize> {
    let values = roles.condition.as_ref().and_then(|name| numbers(table, name));
    values.map_or_else(Vec::new, |values| changes(&values).split_off(1))
}

/// Ends of records, where the time does not go on.
fn ends_by_time(time: &[f64], rows: usize) -> Vec<usize> {
    let mut first = 0;
    let mut ends = Vec::new();
    for row in 1..time.len() {
        if starts_again(time[first], time[row - 1], time[row]) {
            ends.push(row);
            first = row;
        }
    }
    ends.push(rows);
    ends
}

pub fn place_of(table: &Head, name: &str) -> Result<usize> {
    let words = || format!("there is no column \"{}\"", clipped(name));
    table.column(name).ok_or_else(|| Problem::in_file(&table.file, words()))
}

/// The numbers of a table, column by column.
struct NumberColumns {
    time: Option<Vec<f64>>,
    inputs: Vec<Vec<f64>>,
    rate: Option<Vec<f64>>,
    output: Vec<f64>,
}

impl NumberColumns {
    fn read(table: &Table, roles: &Roles) -> Result<Self> {
        let mut cells = CellReader::new(table.numbers());
        let mut read = |name: &String, kind: CellNeed| column_of(table, name, kind, &mut cells);
        let time = roles.time.as_ref().map(|name| read(name, CellNeed::INPUT)).transpose()?;
        let inputs = roles.inputs.iter().map(|name| read(name, CellNeed::INPUT)).collect::<Result<_>>()?;
        let rate = roles.rate.as_ref().map(|name| read(name, CellNeed::INPUT)).transpose()?;
        let output = read(&roles.output, CellNeed::OUTPUT)?;
        Ok(Self { time, inputs, rate, output })
    }

    /// Multiplies each column by its factor.
    fn convert(&mut self, factors: &UnitFactors) {
        let convert = |column: &mut Vec<f64>, factor: Option<f64>| {
            let Some(factor) = factor else { return };
            column.iter_mut().for_each(|value| *value *= factor);
        };
        self.time.iter_mut().for_each(|time| convert(time, factors.time));
        self.inputs.iter_mut().zip(&factors.inputs).for_each(|(input, factor)| convert(input, *factor));
        self.rate.iter_mut().for_each(|rate| convert(rate, factors.rate));
        convert(&mut self.output, factors.output);
    }

    /// Spreads equal time stamps; returns whether there were any.
    fn spread_equal_stamps(&mut self, places: &[RecordPlace], source: &DataSource) -> Option<String> {
        let time = self.time.as_mut()?;
        let spread: usize =
            places.iter().map(|place| spread_equal(&mut time[place.rows.clone()], None, &mut None)).sum();
        (spread > 0).then(|| equal_stamps(&source.tables[places[0].table].file, spread))
    }

    /// Subtracts from the first input and from the output their means over the first rows of each record.
    fn remove_offsets(&mut self, places: &[RecordPlace], rows: usize) {
        for place in places {
            for column in [&mut self.inputs[0], &mut self.output] {
                remove_offset(&mut column[place.rows.clone()], rows);
            }
        }
    }

    fn record(&self, place: &RecordPlace) -> hysid_core::Result<Record> {
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

/// Cells that a command needs in a column, with its advice where one is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellNeed {
    /// A cell may be blank where nothing was measured.
    Optional,
    /// Every row needs a number.
    Required {
        /// Advice where a cell is blank, and an option at its end.
        if_blank: (&'static str, Option<&'static str>),
        /// Advice where the first cell is no number, so that the column may be the wrong one, and the option at its end.
        if_no_number: Option<(&'static str, &'static str)>,
    },
}

impl CellNeed {
    /// Time, an input or its rate.
    pub const INPUT: Self = Self::Required {
        if_blank: ("only the output may be blank; choose rows with ", Some("rows")),
        if_no_number: Some(("not an input? name the inputs with ", "input")),
    };
    pub const OUTPUT: Self = Self::Optional;
    pub const WANTED: Self =
        Self::Required { if_blank: ("every row needs a wanted output", None), if_no_number: None };
}

/// Rows at the end of a table that may be a summary.
const MOST_AT_END: usize = 5;

/// The numbers of a column; a cell that is blank and may be is NaN.
pub fn column_of(table: &Table, name: &str, kind: CellNeed, cells: &mut CellReader) -> Result<Vec<f64>> {
    let place = place_of(table, name)?;
    let at = |line: u64, words: Words| Problem::in_cell(&table.file, line, name, words);
    let mut column = ColumnReader::new(table, place);
    let mut numbers = Vec::with_capacity(table.rows());
    for (row, &line) in table.lines.iter().enumerate() {
        let number = column.number(table, cells, table.cell(row, place), line);
        let number = checked(number, table.cell(row, place), kind, row == 0).map_err(|words| {
            let is_at_end = row > 0 && table.rows() - row <= MOST_AT_END && table.reading.rows.is_all();
            let before =
                || Words::from("use the rows before it with ") + Hint::Value("rows", format!("1:{row}"));
            at(line, if is_at_end && !words.helps() { words.advised(before()) } else { words })
        });
        numbers.push(number?);
    }
    column.problem(cells).map_or(Ok(numbers), |(line, problem)| Err(at(line, problem)))
}

/// The number of a cell, NaN for one that is blank and may be; or what is wrong with it and what helps.
pub fn checked(
    number: Result<f64, CellProblem>,
    cell: &str,
    kind: CellNeed,
    is_first: bool,
) -> Result<f64, Words> {
    match number {
        Ok(number) if number.is_nan() => match kind {
            CellNeed::Optional => Ok(f64::NAN),
            CellNeed::Required { if_blank: (advice, option), .. } => {
                let advice = Words::from(advice);
                let advice = option.into_iter().fold(advice, |advice, name| advice + Hint::Option(name));
                Err(missing(cell).advised(advice))
            }
        },
        Ok(number) => Ok(number),
        Err(CellProblem::Other(words)) => Err(words),
        Err(CellProblem::NoNumber(text)) => {
            let words = Words::from(text);
            Err(match kind {
                CellNeed::Optional if cell.trim().len() <= LONGEST_WORD => {
                    let hint = Hint::MissingWord(cell.trim().into());
                    words.advised(Words::from("if it stands for a missing value: ") + hint)
                }
                CellNeed::Required { if_no_number: Some((advice, option)), .. } if is_first => {
                    words.advised(Words::from(advice) + Hint::Option(option))
                }
                _ => words,
            })
        }
    }
}

/// Longest word that may stand for a missing value.
const LONGEST_WORD: usize = 20;

fn missing(cell: &str) -> Words {
    match cell.trim() {
        "" => "the cell is empty".into(),
        cell => format!("\"{}\" is a missing value", clipped(cell)).into(),
    }
}

/// Says that equal time stamps were spread.
pub fn equal_stamps(file: &str, rows: usize) -> String {
    let rows = if rows == 1 { "1 row has".to_string() } else { format!("{rows} rows have") };
    format!(
        "{file}: {rows} the time stamp of the row before: equal time stamps were spread evenly up to the next one"
    )
}

/// Subtracts from a record's values their mean over the first rows; those that are missing do not count.
fn remove_offset(values: &mut [f64], rows: usize) {
    let offset = offset_of(values, rows);
    values.iter_mut().for_each(|value| *value -= offset);
}

/// The mean over the first rows, 0 if all are missing.
pub fn offset_of(values: &[f64], rows: usize) -> f64 {
    let first = || values.iter().take(rows).filter(|value| value.is_finite());
    match first().count() {
        0 => 0.0,
        count => first().sum::<f64>() / count as f64,
    }
}
