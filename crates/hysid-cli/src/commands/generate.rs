//! `hysid generate`: the data of a synthetic specimen as CSV, and what specimens there are.

use std::path::Path;

use anyhow::Result;
use hysid::plant::{Specimen, with_noise};
use hysid::record::{ColumnNames, Dataset};

use crate::Outcome;
use crate::arguments::Generate;
use crate::csv_text::csv_text;
use crate::files;
use crate::identification::check_outputs;
use crate::lines::indented;
use crate::messages::{Usage, note, results};
use crate::page::count;

/// Runs the command.
pub fn run(arguments: &Generate) -> Result<Outcome> {
    match arguments.specimen {
        Some(specimen) => generate(specimen, arguments)?,
        None if arguments.list => list(arguments.json)?,
        None => {
            let names: Vec<&str> = Specimen::all().iter().map(|specimen| specimen.name).collect();
            let names = names.join(", ");
            return Err(Usage(format!("name a specimen: {names} (--list describes them)")).into());
        }
    }
    Ok(Outcome::Done)
}

fn generate(specimen: &Specimen, arguments: &Generate) -> Result<()> {
    let stdout = Path::new("-");
    let test = arguments.test.as_deref();
    let train = arguments.out.as_deref().or(test.is_none().then_some(stdout));
    if train == Some(stdout) && test == Some(stdout) {
        let advice = "name a file with --out or --test";
        return Err(Usage(format!("training and test data cannot both go to stdout: {advice}")).into());
    }
    let [train_file, test_file] = [train, test].map(|path| path.filter(|&path| path != stdout));
    check_outputs(&train_file.into_iter().chain(test_file).collect::<Vec<_>>(), &[])?;

    // Test data have a noise of their own: nobody types the complement of a seed.
    let (noise, seed) = (arguments.noise, arguments.seed);
    if let Some(path) = train {
        write(path, "training", &with_noise(&specimen.train(), noise, seed)?)?;
    }
    if let Some(path) = test {
        write(path, "test", &with_noise(&specimen.test(), noise, !seed)?)?;
    }
    if train_file.or(test_file).is_some() {
        note(format_args!("{}", next(train_file, test_file)));
    }
    Ok(())
}

/// Writes the data to a file and says so, or to stdout for `-`.
fn write(path: &Path, what: &str, data: &Dataset) -> Result<()> {
    let text = csv_text(data)?;
    if path == Path::new("-") {
        return results(&text);
    }
    files::write(path, text.as_bytes())?;
    let blank = match data.rows() - data.scored() {
        0 => String::new(),
        rows => format!(", {rows} of them with a blank output"),
    };
    let (records, rows) = (count(data.records().len(), "record"), count(data.rows(), "row"));
    note(format_args!("wrote {}: {what} data, {records}, {rows}{blank}", files::shown(path)));
    Ok(())
}

/// What to type next.
fn next(train: Option<&Path>, test: Option<&Path>) -> String {
    let shown = |path: Option<&Path>, unknown: &str| path.map_or_else(|| unknown.into(), files::shown);
    let model = train.map(|train| train.with_extension("json"));
    let (model, test) = (shown(model.as_deref(), "MODEL.json"), shown(test, "TEST.csv"));
    let fit = train.map(|train| format!("  hysid fit {} -o {model}\n", files::shown(train)));
    format!("\nnext:\n{}  hysid evaluate {model} {test}", fit.unwrap_or_default())
}

fn list(json: bool) -> Result<()> {
    let specimens = Specimen::all().iter().copied();
    results(&match json {
        true => serde_json::to_string_pretty(&specimens.map(Described::of).collect::<Vec<_>>())? + "\n",
        false => specimens.map(description).collect::<Vec<_>>().join("\n"),
    })
}

/// What `--list` prints of a specimen.
fn description(specimen: &Specimen) -> String {
    let columns = specimen.columns();
    let columns: Vec<String> =
        columns.time.into_iter().chain(columns.inputs).chain([columns.output]).collect();
    let columns = columns.join(", ");
    let lines = [
        ("", specimen.summary),
        ("columns", columns.as_str()),
        ("published", specimen.published),
        ("designed", specimen.designed),
        ("training", specimen.training),
        ("test", specimen.testing),
    ];
    let mut text = format!("{} ({} of the paper)\n", specimen.name, specimen.example);
    for (what, words) in lines {
        let indent = if what.is_empty() { 2 } else { 13 };
        let words = indented(words, indent);
        text += &format!("{:<indent$}{}", format!("  {what}"), words.trim_start());
    }
    text
}

/// The object that `--list --json` prints of a specimen.
#[derive(serde::Serialize)]
struct Described {
    name: &'static str,
    example: &'static str,
    summary: &'static str,
    published: &'static str,
    designed: &'static str,
    training: &'static str,
    testing: &'static str,
    columns: ColumnNames,
}

impl Described {
    fn of(specimen: &'static Specimen) -> Self {
        Self {
            name: specimen.name,
            example: specimen.example,
            summary: specimen.summary,
            published: specimen.published,
            designed: specimen.designed,
            training: specimen.training,
            testing: specimen.testing,
            columns: specimen.columns(),
        }
    }
}
