//! `hysid simulate`: a free run over the inputs of a table, row by row.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

use anyhow::Result;
use hysid_app::simulation::{self, SimulateRequest};
use hysid_files::{Destination, Kind, NewFile};
use hysid_records::Roles;
use hysid_tables::Rows;

use crate::arguments::Simulate;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::files::{self, check_outputs};
use crate::messages::{stdout_failed, warning};
use crate::{Outcome, interrupt};

/// Bytes that are written together. A table with an error in its first rows leaves nothing on stdout.
const BUFFERED: usize = 1 << 20;

pub fn run(arguments: &Simulate) -> Result<Outcome> {
    let model = arguments.known.of(arguments.beginning.of(read_model(&arguments.model)?)?)?;
    let reading = arguments.columns.reading.reading();
    let mut rows = Rows::open(&arguments.data, &reading)?;
    if arguments.band.is_some() {
        check_band(&model, &arguments.model)?;
    }
    let header = simulation::header(&model, &rows.head, arguments.band.is_some())?;
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
    let request = SimulateRequest {
        model: &model,
        table: &arguments.data,
        reading: &reading,
        roles: &roles,
        factors: &factors,
        band: arguments.data_sets.level(arguments.band),
        zero: arguments.columns.reading.zero,
        measured: is_known,
    };
    let mut output = Output { sink, text: header };
    let mut take = |rows: Vec<u8>| -> Result<_> {
        output.add(&rows)?;
        Ok(if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    let end = simulation::simulate(&request, &mut rows, &mut take)?;
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
    text: Vec<u8>,
}

impl Output<'_> {
    fn add(&mut self, rows: &[u8]) -> Result<()> {
        self.text.extend(rows);
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
