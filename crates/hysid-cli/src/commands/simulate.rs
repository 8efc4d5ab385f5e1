//! `hysid simulate`: a free run over the inputs of a table.

use std::path::Path;

use anyhow::{Result, ensure};

use crate::Outcome;
use crate::arguments::Simulate;
use crate::cell::shortest;
use crate::columns::Roles;
use crate::commands::read_model;
use crate::data::{Data, Source};
use crate::files;
use crate::identification::check_outputs;
use crate::messages::{results, warning};
use crate::table::Table;

/// Runs the command.
pub fn run(arguments: &Simulate) -> Result<Outcome> {
    let model = read_model(&arguments.model)?;
    let table = Table::read(&arguments.data)?;
    let name = format!("{}_model", model.names().output);
    ensure!(
        table.column(&name).is_none(),
        "{}: there is already a column \"{name}\" (rename or remove it)",
        table.file
    );
    let out = arguments.out.as_deref().filter(|out| *out != Path::new("-"));
    if let Some(out) = out {
        check_outputs(&[out], &[&arguments.data, &arguments.model])?;
    }
    let roles = Roles::of_model(&model, &table, &arguments.columns, false)?;
    let data = Data::new(vec![table], roles, false)?;
    let mut simulated = Vec::with_capacity(data.set.rows());
    for record in data.set.records() {
        simulated.extend(model.simulate(record).map_err(|error| data.explain(error))?);
    }
    model.range_warnings(&data.set).map_err(|error| data.explain(error))?.iter().for_each(warning);
    let text = with_column(&data.source, &name, &simulated)?;
    match out {
        Some(out) => files::write(out, &text)?,
        None => results(std::str::from_utf8(&text)?)?,
    }
    Ok(Outcome::Done)
}

/// The table with one column more, in the table's own delimiter and decimal sign.
fn with_column(source: &Source, name: &str, values: &[f64]) -> Result<Vec<u8>> {
    let (table, commas) = (&source.tables[0], source.decimal_commas[0]);
    let mut writer = csv::WriterBuilder::new().delimiter(table.delimiter).from_writer(Vec::new());
    writer.write_record(table.header.iter().map(String::as_str).chain([name]))?;
    for (row, value) in values.iter().enumerate() {
        let mut text = shortest(*value);
        if commas {
            text = text.replace('.', ",");
        }
        writer.write_record(table.cells(row).chain([text.as_str()]))?;
    }
    Ok(writer.into_inner()?)
}
