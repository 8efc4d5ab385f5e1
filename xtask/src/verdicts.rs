//! `cargo xtask verdicts DIR`: what `hysid diagnose` says of every case, as a table of properties. A case is a folder
//! with `train.csv`.

mod answer;
mod page;

use anyhow::Result;

use crate::cases::{Cases, Request, origin};
use answer::Diagnosis;
use page::Page;

/// The options of `cargo xtask verdicts`.
pub const OPTIONS: [&str; 3] = ["--out", "--case-limit", "--program"];

pub fn run(request: &Request) -> Result<()> {
    let cases = Cases::find(request, &["train.csv"])?;
    let mut page = Page::new(origin("verdicts", &request.typed, request.program.is_none(), &cases.version));
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
