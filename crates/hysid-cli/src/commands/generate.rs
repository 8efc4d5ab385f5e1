//! `hysid generate`: the data of a synthetic specimen as CSV, and what specimens there are.

use std::path::Path;

use anyhow::Result;
use hysid::data::record::Dataset;
use hysid::specimens::{Specimen, with_noise};
use hysid_document::plain::indented;
use hysid_document::{count, object};
use hysid_files::{Destination, Kind};
use hysid_records::csv_text;
use serde::Serialize;

use crate::Outcome;
use crate::arguments::Generate;
use crate::files::{self, NO_INPUTS, check_outputs};
use crate::messages::{Usage, note, raw_results, told};

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
    // Test data have a noise of their own: nobody types the complement of a seed.
    let (noise, seed) = (arguments.noise, arguments.seed);
    let set = |path: Option<&'_ Path>, what, data: Dataset, seed| -> Result<Option<Set>> {
        path.map(|path| Set::new(path, what, with_noise(&data, noise, seed)?, arguments)).transpose()
    };
    let train = set(train, "training", specimen.train_with_seed(seed), seed)?;
    let test = set(test, "test", specimen.test_with_seed(seed), !seed)?;
    let file = |set: &'_ Option<Set>| set.as_ref().and_then(|set| set.destination.clone());
    let [train_file, test_file] = [&train, &test].map(file);
    check_outputs(train_file.iter().chain(&test_file), &NO_INPUTS)?;

    train.iter().chain(&test).try_for_each(Set::write)?;
    if train_file.is_some() || test_file.is_some() {
        let [train, test] = [&train_file, &test_file].map(|file| file.as_ref().map(Destination::path));
        next(train, test).lines().for_each(|line| note(format_args!("{line}")));
    }
    Ok(())
}

/// Data on their way to a file, or to stdout.
struct Set {
    what: &'static str,
    data: Dataset,
    text: String,
    destination: Option<Destination>,
}

impl Set {
    /// A path `-` is stdout.
    fn new(path: &Path, what: &'static str, data: Dataset, arguments: &Generate) -> Result<Self> {
        let text = csv_text(&data);
        let kind = || Kind::Content(text.as_bytes().to_vec());
        let is_file = path != Path::new("-");
        let destination = is_file.then(|| Destination::new(path, kind(), arguments.overwriting.force));
        Ok(Self { what, data, text, destination })
    }

    /// Writes the data; prints the name of a file.
    fn write(&self) -> Result<()> {
        let Some(destination) = &self.destination else { return raw_results(&self.text) };
        files::write(destination, self.text.as_bytes())?;
        let blank = match self.data.rows() - self.data.scored() {
            0 => String::new(),
            rows => format!(", {rows} of them with a blank output"),
        };
        let (records, rows) = (count(self.data.records().len(), "record"), count(self.data.rows(), "row"));
        let (file, what) = (files::shown(destination.path()), self.what);
        note(format_args!("wrote {file}: {what} data, {records}, {rows}{blank}"));
        Ok(())
    }
}

fn next(train: Option<&Path>, test: Option<&Path>) -> String {
    let shown = |path: Option<&Path>, unknown: &str| path.map_or_else(|| unknown.into(), files::shown);
    let model = train.map(|train| train.with_extension("json"));
    let (model, test) = (shown(model.as_deref(), "MODEL.json"), shown(test, "TEST.csv"));
    let fit = train.map(|train| format!("  hysid fit {} -o {model}\n", files::shown(train)));
    format!("\nnext:\n{}  hysid evaluate {model} {test}", fit.unwrap_or_default())
}

fn list(json: bool) -> Result<()> {
    let specimens = Specimen::all().iter().copied();
    let described = || Ok(specimens.clone().map(described).collect::<Vec<_>>());
    told(json, described, || specimens.clone().map(description).collect::<Vec<_>>().join("\n"))
}

/// Description of a specimen for `--list`.
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
    let example = specimen.example.map(|example| format!(" ({example} of the paper)")).unwrap_or_default();
    let mut text = format!("{}{example}\n", specimen.name);
    for (what, words) in lines {
        let indent = if what.is_empty() { 2 } else { 13 };
        let words = indented(words, indent);
        text += &format!("{:<indent$}{}", format!("  {what}"), words.trim_start());
    }
    text
}

/// The object that `--list --json` prints of a specimen.
fn described(specimen: &Specimen) -> impl Serialize {
    object! {
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
