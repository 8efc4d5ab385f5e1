//! `cases DIR`: every model on every case. A case is a folder with `train.csv` and `test.csv`; `hysid
//! compare` does the work, one case after the other, and its answers become tables.

mod answer;
mod folders;
mod page;
mod request;
mod table;

use std::path::Path;
use std::process::Command;

use anyhow::Result;
use clap::Args;

use crate::origin::origin;
use answer::Answer;
pub use answer::Case;
pub use folders::Cases;
use page::Page;
pub use request::CaseRequest;
use request::seconds;
pub use table::{Reasons, aligned, in_words, row};

/// Models and cases to compare.
#[derive(Debug, Args)]
pub struct Request {
    #[command(flatten)]
    cases: CaseRequest,
    /// Models to compare, as `hysid compare` takes them
    #[arg(long, value_name = "LIST")]
    models: Option<String>,
    /// Time limit of each fit, as `hysid compare` takes it
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<f64>,
}

pub fn run(request: &Request) -> Result<()> {
    let cases = Cases::find(&request.cases, &["train.csv", "test.csv"])?;
    let mut page = Page::new(origin(request.cases.program.is_none(), &cases.version), cases.len());
    cases.ask(
        |folder, command| compare(folder, command, request),
        answer::parse,
        |answers: &Vec<Answer>| said(answers),
        |case| {
            page.cases.push(case);
            (page.text(), page.tables())
        },
    )
}

/// The arguments that compare the models on a case.
fn compare(folder: &Path, command: &mut Command, request: &Request) {
    command.arg("compare").arg(folder.join("train.csv")).arg("--test").arg(folder.join("test.csv"));
    if let Some(models) = &request.models {
        command.args(["--models", models]);
    }
    if let Some(seconds) = request.time_limit {
        command.args(["--time-limit", &seconds.to_string()]);
    }
    command.args(["--json", "--no-report"]);
}

/// What came of a case, in a few words.
fn said(answers: &[Answer]) -> String {
    let failed = answers.iter().filter(|answer| answer.figures.is_err()).count();
    format!("{} of {} models worked", answers.len() - failed, answers.len())
}
