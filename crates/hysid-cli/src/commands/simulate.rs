//! `hysid simulate`: a free run over the inputs of a table, row by row.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Result, ensure};
use hysid_files::{Destination, Kind, NewFile};
use hysid_records::Roles;
use hysid_records::{header_line, named_after};
use hysid_tables::{CellReader, ColumnReader, DecimalSign, Reading, Rows, push_shortest};

use crate::arguments::Simulate;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::files::{self, check_outputs};
use crate::messages::{stdout_failed, warning};
use crate::terminal::clipped;
use crate::{Outcome, interrupt};
use hysid_app::table_run::{self, KeptColumns, Simulated};

/// Bytes that are written together. A table with an error in its first rows leaves nothing on stdout.
const BUFFERED: usize = 1 << 20;

pub fn run(arguments: &Simulate) -> Result<Outcome> {
    let model = arguments.known.of(arguments.beginning.of(read_model(&arguments.model)?)?)?;
    let reading = arguments.columns.reading.reading();
    let mut rows = Rows::open(&arguments.data, &reading)?;
    let mut names = vec![named_after(&model.names().output, "model")];
    if arguments.band.is_some() {
        check_band(&model, &arguments.model)?;
        names.extend(["low", "high"].map(|edge| named_after(&model.names().output, edge)));
    }
    for name in &names {
        ensure!(
            rows.head.column(name).is_none(),
            "{}: there is already a column \"{}\" (rename or remove it)",
            rows.head.file,
            clipped(name)
        );
    }
    let delimiter = rows.head.delimiter().in_a_copy(rows.head.numbers().decimal);
    let all = rows.head.header.iter().chain(&names).map(String::as_str);
    let header = header_line(delimiter, all);
    let out = arguments.out.as_deref().filter(|out| *out != Path::new("-"));
    let kind = Kind::Beginning(header.clone());
    let out = out.map(|out| Destination::new(out, kind, arguments.overwriting.force));
    if let Some(out) = &out {
        check_outputs([out], &[&arguments.data, &arguments.model])?;
        interrupt::listen_briefly("stopping before the end of the table")?;
    }
    let is_known = arguments.known.known.is_some();
    let roles = Roles::of_model(&model, &rows.head, &arguments.columns.choice(), is_known)?;

    let factors = factors(&model, &roles, &rows.head.file, is_known, arguments.units.same_units)?;
    let sink = out.as_ref().map(Destination::create).transpose().map_err(files::explained)?;
    let numbers = Numbers { data: &arguments.data, reading: &reading, roles: &roles, delimiter };
    let mut output = Output { sink, numbers, sign: None, delimiter, text: header };
    let wanted = KeptColumns {
        drive: false,
        cells: true,
        measured: is_known,
        band: arguments.data_sets.level(arguments.band),
        zero: arguments.columns.reading.zero,
    };
    let mut take = |simulated: &Simulated<'_>| -> Result<_> {
        output.add(simulated)?;
        Ok(if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    let end = table_run::run(&model, &mut rows, &roles, &factors, wanted, &mut take)?;
    end.note.iter().for_each(warning);
    if end.is_early {
        return Ok(Outcome::Interrupted);
    }
    end.warnings.iter().for_each(warning);
    output.finish()?;
    Ok(Outcome::Done)
}

/// The table with the columns of the simulation, on its way to a file or to stdout.
struct Output<'o> {
    sink: Option<NewFile<'o>>,
    numbers: Numbers<'o>,
    /// Decimal sign of the columns that are added, once it is known.
    sign: Option<DecimalSign>,
    delimiter: u8,
    text: Vec<u8>,
}

impl Output<'_> {
    /// Adds rows, in the table's own delimiter and decimal sign.
    fn add(&mut self, simulated: &Simulated<'_>) -> Result<()> {
        let prediction = simulated.prediction;
        if prediction.output.is_empty() {
            return Ok(());
        }
        let sign = match self.sign {
            Some(sign) => sign,
            None => *self.sign.insert(self.numbers.sign(simulated.numbers)?),
        };
        self.numbers.check(sign, simulated.numbers)?;
        let mut writer = csv::WriterBuilder::new().delimiter(self.delimiter).from_writer(&mut self.text);
        let mut number = String::new();
        for row in 0..prediction.output.len() {
            for cell in simulated.cells(row) {
                writer.write_field(cell)?;
            }
            for column in [&prediction.output, &prediction.low, &prediction.high] {
                if let Some(&value) = column.get(row) {
                    number.clear();
                    push_shortest(&mut number, value, sign);
                    writer.write_field(&number)?;
                }
            }
            writer.write_record(None::<&[u8]>)?;
        }
        writer.flush()?;
        drop(writer);
        if self.text.len() >= BUFFERED { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<()> {
        match &mut self.sink {
            Some(file) => {
                file.write_all(&self.text).map_err(|error| file.failed(error)).map_err(files::explained)?
            }
            None => std::io::stdout().lock().write_all(&self.text).map_err(stdout_failed)?,
        }
        self.text.clear();
        Ok(())
    }

    /// Writes what is left, and puts the file in its place.
    fn finish(mut self) -> Result<()> {
        self.write()?;
        match self.sink {
            Some(file) => {
                let path = file.path().to_path_buf();
                let kept = file.commit().map_err(files::explained)?;
                files::say_kept(&path, kept.as_deref());
                Ok(())
            }
            None => std::io::stdout().lock().flush().map_err(stdout_failed),
        }
    }
}

/// How numbers are written in a table.
struct Numbers<'n> {
    data: &'n Path,
    reading: &'n Reading,
    roles: &'n Roles,
    delimiter: u8,
}

impl Numbers<'_> {
    /// The decimal sign of a table whose first rows were read by this reader.
    fn sign(&self, first_rows: &CellReader) -> Result<DecimalSign> {
        if let Some(sign) = first_rows.sign() {
            return Ok(sign);
        }
        // Whole numbers so far. Where commas separate the columns there are no decimal commas.
        let is_settled = self.delimiter == b',' || !self.data.is_file();
        Ok(if is_settled { DecimalSign::Point } else { self.first_sign()? })
    }

    /// The decimal sign that comes first in the columns that the model needs.
    fn first_sign(&self) -> Result<DecimalSign> {
        let mut rows = Rows::open(self.data, self.reading)?;
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

    /// Refuses a decimal comma behind rows that are written with decimal points: a pipe cannot be read twice.
    fn check(&self, sign: DecimalSign, so_far: &CellReader) -> Result<()> {
        ensure!(
            so_far.sign().is_none_or(|found| found == sign),
            "{}: the first decimal comma comes after thousands of whole numbers (give a file instead of a \
             pipe)",
            self.data.display()
        );
        Ok(())
    }
}
