//! A free run over the inputs of a table, as the table with columns for the simulation.

use std::ops::ControlFlow;
use std::path::Path;

use hysid::model::{BandLevel, Model};
use hysid_document::{Problem, Result, problem};
use hysid_records::{IN_MEMORY, Roles, UnitFactors, check_new_columns, header_line, named_after};
use hysid_tables::{CellReader, ColumnReader, DecimalSign, Head, Reading, Rows, push_shortest};

use crate::table_run::{self, KeptColumns, Simulated, TableRunEnd};

pub struct SimulateRequest<'a> {
    pub model: &'a Model,
    /// The table and how it is read: if its first rows are whole numbers, it is read a second time.
    pub table: &'a Path,
    pub reading: &'a Reading,
    pub roles: &'a Roles,
    pub factors: &'a UnitFactors,
    pub band: Option<BandLevel>,
    /// Over how many rows at the beginning of each record the first input and the output are to be zero in the mean.
    pub zero: Option<usize>,
    /// True for a model that takes the measured beginning of each record.
    pub measured: bool,
}

/// Header of the table that is written.
///
/// # Errors
/// A table that already has a column of such a name.
pub fn header(model: &Model, head: &Head, has_band: bool) -> Result<Vec<u8>> {
    let endings = if has_band { &["model", "low", "high"][..] } else { &["model"] };
    let names: Vec<String> =
        endings.iter().map(|ending| named_after(&model.names().output, ending)).collect();
    check_new_columns(&head.file, |name| head.column(name), &names)?;
    Ok(header_line(delimiter(head), head.header.iter().chain(&names).map(String::as_str)))
}

fn delimiter(head: &Head) -> u8 {
    head.delimiter().in_a_copy(head.numbers().decimal)
}

/// Runs a model over a table. Gives `take` the rows of the table with the columns of the simulation, block by block, in the
/// table's own delimiter and decimal sign; it breaks to end the run.
///
/// # Errors
/// Cells that are no numbers where the model needs them, and as `take`.
pub fn simulate<E: From<Problem>>(
    request: &SimulateRequest<'_>,
    rows: &mut Rows,
    take: &mut dyn FnMut(Vec<u8>) -> Result<ControlFlow<()>, E>,
) -> Result<TableRunEnd, E> {
    let SimulateRequest { model, roles, factors, band, zero, measured, .. } = *request;
    let delimiter = delimiter(&rows.head);
    let mut known_sign = None;
    let wanted = KeptColumns { drive: false, cells: true, measured, band, zero };
    let mut take = |simulated: &Simulated<'_>| -> Result<_, E> {
        if simulated.prediction.output.is_empty() {
            return take(Vec::new());
        }
        let sign = match known_sign {
            Some(sign) => sign,
            None => *known_sign.insert(request.sign(simulated.numbers, delimiter)?),
        };
        // A pipe cannot be read twice.
        if simulated.numbers.sign().is_some_and(|found| found != sign) {
            let words = "the first decimal comma comes after thousands of whole numbers (give a file \
                         instead of a pipe)";
            return Err(problem!("{}: {words}", request.table.display()).into());
        }
        take(written(simulated, delimiter, sign))
    };
    table_run::run(model, rows, roles, factors, wanted, &mut take)
}

/// The rows of a block.
fn written(simulated: &Simulated<'_>, delimiter: u8, sign: DecimalSign) -> Vec<u8> {
    let prediction = simulated.prediction;
    let mut writer = csv::WriterBuilder::new().delimiter(delimiter).from_writer(Vec::new());
    let mut number = String::new();
    for row in 0..prediction.output.len() {
        for cell in simulated.cells(row) {
            writer.write_field(cell).expect(IN_MEMORY);
        }
        for column in [&prediction.output, &prediction.low, &prediction.high] {
            if let Some(&value) = column.get(row) {
                number.clear();
                push_shortest(&mut number, value, sign);
                writer.write_field(&number).expect(IN_MEMORY);
            }
        }
        writer.write_record(None::<&[u8]>).expect(IN_MEMORY);
    }
    writer.into_inner().expect(IN_MEMORY)
}

impl SimulateRequest<'_> {
    /// The decimal sign of the table, whose first rows were read by this reader.
    fn sign(&self, first_rows: &CellReader, delimiter: u8) -> Result<DecimalSign> {
        if let Some(sign) = first_rows.sign() {
            return Ok(sign);
        }
        // Whole numbers so far. Where commas separate the columns there are no decimal commas.
        let is_settled = delimiter == b',' || !self.table.is_file();
        Ok(if is_settled { DecimalSign::Point } else { self.first_sign()? })
    }

    /// The decimal sign that comes first in the columns that the model needs.
    fn first_sign(&self) -> Result<DecimalSign> {
        let mut rows = Rows::open(self.table, self.reading)?;
        let used = self.roles.time.iter().chain(&self.roles.inputs).chain(&self.roles.rate);
        let places = used.filter_map(|name| rows.head.column(name));
        let mut columns: Vec<ColumnReader> =
            places.map(|place| ColumnReader::new(&rows.head, place)).collect();
        let mut numbers = CellReader::new(rows.head.numbers());
        while let Some(row) = rows.next_row()? {
            for column in columns.iter_mut().filter(|column| !column.has_stamps()) {
                // What is wrong with a cell is said where the table is read for its numbers.
                let _ = numbers.number(row.cell(column.place()), row.line);
            }
            if let Some(sign) = numbers.sign() {
                return Ok(sign);
            }
        }
        Ok(DecimalSign::Point)
    }
}
