//! `hysid look`: how tables are read, without a fit.

use std::path::Path;

use anyhow::Result;
use hysid::data::summary::Summary;
use hysid_app::data_warnings;
use hysid_document::{Face, object};
use hysid_files::{Destination, Kind};
use hysid_records::csv_text;
use hysid_records::{Data, Roles, TableOverview, understanding};
use hysid_tables::Table;
use serde::Serialize;

use crate::Outcome;
use crate::arguments::Look;
use crate::data::{data_with, read_tables};
use crate::files::{self, check_outputs};
use crate::messages::{Usage, json_results, note, raw_results, results, warning};

/// Lines about the data as a whole that are shown below the tables.
const OF_THE_DATA: [&str; 3] = ["samples", "guessed", "turning"];

pub fn run(arguments: &Look) -> Result<Outcome> {
    let to_stdout = arguments.out.as_deref() == Some(Path::new("-"));
    if arguments.json && to_stdout {
        return Err(Usage("--json prints to stdout: name a file for the table with -o".into()).into());
    }
    let tables = read_tables(&arguments.files, &arguments.columns.reading)?;
    let tables = if arguments.join { vec![Table::joined(&tables)?] } else { tables };
    let roles = Roles::detect(&tables[0], &arguments.columns.choice());
    let looked: Vec<TableOverview> =
        tables.iter().map(|table| TableOverview::of(table, roles.as_ref().ok(), Face::Terminal)).collect();
    let data = roles
        .map_err(anyhow::Error::from)
        .and_then(|roles| data_with(tables, roles, arguments.columns.reading.zero));
    let (warnings, understood) = match &data {
        Ok(data) => {
            let summary = Summary::of(&data.set);
            (
                data_warnings(data, &summary, Face::Terminal),
                understanding::of_data(data, &summary, Face::Terminal),
            )
        }
        Err(_) => Default::default(),
    };
    match (arguments.json, to_stdout) {
        (true, _) => json_results(&printed(&looked, &data, &warnings))?,
        (false, true) => text(&looked, &understood).lines().for_each(|line| note(format_args!("{line}"))),
        (false, false) => results(&text(&looked, &understood))?,
    }
    warnings.iter().for_each(warning);
    let data = data?;
    match &arguments.out {
        Some(_) if to_stdout => raw_results(&csv_text(&data.set))?,
        Some(out) => write(out, &data, arguments)?,
        None => {}
    }
    Ok(Outcome::Done)
}

/// The object that `--json` prints.
fn printed(files: &[TableOverview], data: &Result<Data>, warnings: &[String]) -> impl Serialize {
    object! {
        files: files,
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        records: data.as_ref().ok().map(|data| data.set.records().len()),
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        guessed: data.as_ref().ok().and_then(|data| data.roles.guessed.as_ref()).map(|words| Face::Terminal.told(words)),
        /// Doubts about the data.
        warnings: warnings,
        /// Why the data cannot be used as they are.
        #[serde(skip_serializing_if = "hysid_document::is_nothing")]
        problem: data.as_ref().err().map(|problem| format!("{problem:#}")),
    }
}

/// The tables, and what was understood of the data as a whole.
fn text(looked: &[TableOverview], understood: &[(String, String)]) -> String {
    let mut text = looked.iter().map(TableOverview::text).collect::<Vec<_>>().join("\n");
    if !understood.is_empty() {
        text.push('\n');
    }
    for (label, line) in understood.iter().filter(|(label, _)| OF_THE_DATA.contains(&label.as_str())) {
        text += &understanding::labelled(label, line);
    }
    text
}

/// Writes the columns that have a role as a plain table.
fn write(out: &Path, data: &Data, arguments: &Look) -> Result<()> {
    let text = csv_text(&data.set);
    let header = text.lines().next().unwrap_or_default().as_bytes().to_vec();
    let out = Destination::new(out, Kind::Beginning(header), arguments.overwriting.force);
    check_outputs([&out], &arguments.files)?;
    files::write(&out, text.as_bytes())?;
    note(format_args!("table   {}", files::shown(out.path())));
    Ok(())
}
