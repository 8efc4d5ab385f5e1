//! `verdicts DIR`: what `hysid diagnose` says of every case, as a table of properties. A case is a folder
//! with `train.csv`.

mod answer;
mod page;

use anyhow::Result;
use clap::Args;

use crate::cases::{CaseRequest, Cases};
use crate::origin::origin;
use answer::Diagnosis;
use page::Page;

/// Cases to diagnose.
#[derive(Debug, Args)]
pub struct Request {
    #[command(flatten)]
    cases: CaseRequest,
}

pub fn run(request: &Request) -> Result<()> {
    let cases = Cases::find(&request.cases, &["train.csv"])?;
    let mut page = Page::new(origin(request.cases.program.is_none(), &cases.version));
    cases.ask(
        |folder, command| {
            command.arg("diagnose").arg(folder.join("train.csv")).args(["--json", "--no-report"]);
        },
        answer::parse,
        |diagnosis: &Diagnosis| {
            let told = diagnosis.verdicts.iter().filter(|verdict| verdict.verdict != "not testable").count();
            format!("{told} of {} properties told", diagnosis.verdicts.len())
        },
        |case| {
            page.cases.push(case);
            (page.text(), page.tables())
        },
    )
}
