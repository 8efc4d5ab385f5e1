//! `hysid restoring-force`: the restoring force of an element from the measured motion of a mass and the force on it.

use std::path::Path;

use anyhow::{Result, anyhow};
use hysid_app::restoring_force::{ForceTable, MeasuredMotion, PrintedForce, summary, understood, warnings};
use hysid_document::Face;
use hysid_files::{Destination, Kind};
use hysid_tables::Table;

use crate::Outcome;
use crate::arguments::RestoringForce;
use crate::files::{self, check_outputs};
use crate::help;
use crate::messages::{note_labelled, raw_results, told, warning};

pub fn run(arguments: &RestoringForce) -> Result<Outcome> {
    let path = arguments.out.clone().unwrap_or_else(|| files::named_after(&arguments.data, ".force.csv"));
    let to_stdout = path == Path::new("-");
    files::check_stdout(to_stdout, arguments.json)?;
    let table = table(arguments)?;
    let request = arguments.request();
    let motion = MeasuredMotion::of(&table, &request)?;
    let written = ForceTable::of(&table, &motion)?;
    let header = written.header();
    let out = (!to_stdout)
        .then(|| Destination::new(path, Kind::Beginning(header.clone()), arguments.overwriting.force));
    check_outputs(&out, &[&arguments.data])?;

    let found = motion.restoring_force(&request)?;
    note_labelled(&understood(&table, &motion, &request.mass, &found, Face::Terminal));
    warnings(&motion, &found, request.window, Face::Terminal).iter().for_each(warning);
    let text = [header, written.rows(&table, &motion, &found, request.zero)].concat();
    let Some(out) = &out else {
        raw_results(&String::from_utf8(text)?)?;
        return Ok(Outcome::Done);
    };
    files::write(out, &text)?;
    let path = Some(out.path());
    told(arguments.json, || Ok(PrintedForce::of(&motion, &found, path)), || summary(&motion, &found, path))?;
    files::say_written([("table", path)]);
    Ok(Outcome::Done)
}

/// Reads the table of the motion. A column name typed after `--force` is parsed as its file, which is missing.
fn table(arguments: &RestoringForce) -> Result<Table> {
    let RestoringForce { data, reading, .. } = arguments;
    let table = Table::read(data, &reading.reading());
    match help::hint_of_force().filter(|_| !data.exists()) {
        Some(hint) => table.map_err(|error| anyhow!("{error:#} ({hint})")),
        None => Ok(table?),
    }
}
