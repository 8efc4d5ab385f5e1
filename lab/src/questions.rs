//! `questions`: the tables of docs/questions.md, measured on specimens whose laws are known.

mod amplitudes;
mod by_specimen;
mod columns;
mod cycles;
mod disturbances;
mod durations;
mod errors;
mod inverses;
mod models;
mod one_loop;
mod processor;
mod rates;
mod wear;

use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use clap::builder::PossibleValuesParser;
use hysid::data::record::Dataset;
use hysid::{Fit, Model};

use crate::files;
use crate::origin::origin;

/// A question whose answer is measured.
struct Question {
    /// Name on the command line.
    name: &'static str,
    /// Heading of its table.
    heading: &'static str,
    /// The table, in Markdown.
    table: fn() -> Result<String>,
}

/// All questions, in the order of the page.
const QUESTIONS: [Question; 11] = [
    Question { name: "cycles", heading: "How many cycles", table: cycles::table },
    Question { name: "columns", heading: "Which column is the input", table: columns::table },
    Question { name: "one-loop", heading: "Is one loop enough", table: one_loop::table },
    Question { name: "rates", heading: "What a causal rate costs", table: rates::table },
    Question { name: "wear", heading: "Does the model still hold", table: wear::table },
    Question { name: "durations", heading: "How long it takes", table: durations::table },
    Question { name: "models", heading: "Which model first", table: models::table },
    Question { name: "inverses", heading: "How to invert", table: inverses::table },
    Question { name: "disturbances", heading: "Gaps, noise, offsets", table: disturbances::table },
    Question { name: "amplitudes", heading: "Outside the trained range", table: amplitudes::table },
    Question { name: "errors", heading: "What the error means", table: errors::table },
];

/// Questions to measure.
#[derive(Debug, Args)]
pub struct Request {
    /// Only this question
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(QUESTIONS.map(|question| question.name)))]
    only: Option<String>,
    /// Write the tables to this file too, with their origin
    #[arg(long, value_name = "FILE.md")]
    out: Option<PathBuf>,
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.out.as_deref().map_or(Ok(()), files::check_writable)?;
    let mut page = String::new();
    let is_wanted = |question: &&Question| request.only.as_ref().is_none_or(|only| only == question.name);
    for question in QUESTIONS.iter().filter(is_wanted) {
        let begun = Instant::now();
        let table = (question.table)().with_context(|| format!("question `{}`", question.name))?;
        eprintln!("{}: {:.0} s", question.name, begun.elapsed().as_secs_f64());
        let section = format!("## {}\n\n{table}\n", question.heading);
        io::stdout().write_all(section.as_bytes()).context("cannot write to stdout")?;
        page.push_str(&section);
    }
    if let Some(out) = &request.out {
        let version = concat!("hysid ", env!("CARGO_PKG_VERSION"));
        let origin = origin(true, version);
        files::write(out, &format!("# Questions with measured answers\n\n{origin}\n{page}"))?;
    }
    Ok(())
}

/// The default fit of data that begin in the virgin state, with one start of each candidate.
fn auto(data: &Dataset, seed: u64) -> Result<Model> {
    Ok(Fit::new().option("starts", 1).option("initial_state", "virgin").seed(seed).run(data)?)
}

/// A fit of this model with its defaults; of `auto` with those of [`auto`].
fn fit(model: &str, data: &Dataset, seed: u64) -> Result<Model> {
    match model {
        "auto" => auto(data, seed),
        name => Ok(Fit::new().model(name).seed(seed).run(data)?),
    }
}

/// Probability of the bands that are judged.
const BAND: f64 = 0.9;

/// The rows within the band of the model, in percent of those with an output.
fn percent_in_band(model: &Model, data: &Dataset) -> Result<f64> {
    let (mut inside, mut scored) = (0, 0);
    for record in data.records() {
        let (covered, all) = model.predict(&record.excitation(), BAND)?.covered(record.output());
        inside += covered;
        scored += all;
    }
    Ok(100.0 * inside as f64 / scored as f64)
}

/// The error on the held-out data of the fit, NRMSE in percent of the standard deviation of the output.
fn validation_error(model: &Model) -> Result<f64> {
    let validation = model.provenance().validation.as_ref();
    validation.and_then(|errors| errors.nrmse_std_percent).context("the default fit has a validation error")
}
