//! `hysid simulate`: a free run over the inputs of a table.

use std::path::Path;

use anyhow::{Result, ensure};

use crate::Outcome;
use crate::arguments::Simulate;
use crate::cell::shortest;
use crate::columns::Roles;
use crate::commands::{check_band, read_model};
use crate::data::{Data, Source};
use crate::files;
use crate::identification::check_outputs;
use crate::messages::{results, warning};
use crate::table::Table;

/// Runs the command.
pub fn run(arguments: &Simulate) -> Result<Outcome> {
    let model = read_model(&arguments.model)?;
    let table = Table::read(&arguments.data)?;
    let mut names = vec![format!("{}_model", model.names().output)];
    if arguments.band.is_some() {
        check_band(&model, &arguments.model)?;
        names.extend(["low", "high"].map(|edge| format!("{}_{edge}", model.names().output)));
    }
    for name in &names {
        ensure!(
            table.column(name).is_none(),
            "{}: there is already a column \"{name}\" (rename or remove it)",
            table.file
        );
    }
    let out = arguments.out.as_deref().filter(|out| *out != Path::new("-"));
    if let Some(out) = out {
        check_outputs(&[out], &[&arguments.data, &arguments.model])?;
    }
    let roles = Roles::of_model(&model, &table, &arguments.columns, false)?;
    let data = Data::new(vec![table], roles, false)?;
    let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(data.set.rows()); names.len()];
    for record in data.set.records() {
        let of_record = match arguments.band {
            None => model.simulate(record).map(|output| vec![output]),
            Some(probability) => model
                .predict(&record.excitation(), probability)
                .map(|predicted| vec![predicted.output, predicted.low, predicted.high]),
        };
        let of_record = of_record.map_err(|error| data.explain(error))?;
        columns.iter_mut().zip(of_record).for_each(|(column, values)| column.extend(values));
    }
    model.range_warnings(&data.set).map_err(|error| data.explain(error))?.iter().for_each(warning);
    let text = with_columns(&data.source, &names, &columns)?;
    match out {
        Some(out) => files::write(out, &text)?,
        None => results(std::str::from_utf8(&text)?)?,
    }
    Ok(Outcome::Done)
}

/// The table with these columns more, in the table's own delimiter and decimal sign.
fn with_columns(source: &Source, names: &[String], columns: &[Vec<f64>]) -> Result<Vec<u8>> {
    let (table, commas) = (&source.tables[0], source.decimal_commas[0]);
    let mut writer = csv::WriterBuilder::new().delimiter(table.delimiter).from_writer(Vec::new());
    writer.write_record(table.header.iter().chain(names))?;
    let text = |value: f64| {
        let text = shortest(value);
        if commas { text.replace('.', ",") } else { text }
    };
    for row in 0..table.len() {
        let added: Vec<String> = columns.iter().map(|column| text(column[row])).collect();
        writer.write_record(table.cells(row).chain(added.iter().map(String::as_str)))?;
    }
    Ok(writer.into_inner()?)
}
