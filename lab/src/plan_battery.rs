//! `plan-battery`: which second test lowers the error on unseen data most: the first one again, the plan of
//! `hysid plan`, or random reversals of the same length.

mod page;
mod trial;

use std::io::{self, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::files;
use crate::origin::origin;

use trial::{FirstTest, Trial, trial};

/// Plans of cases whose specimens are driven: of every field, with and without rate, pinched and degrading.
const SPECIMENS: [&str; 12] = [
    "joint-growing",
    "timber-growing",
    "squat-wall-repeated",
    "brace-irregular",
    "structural-steel-growing",
    "thin-sheet-loops",
    "sma-actuator-reversals",
    "stack-reversals",
    "rate-actuator-frequencies",
    "piezo-halves",
    "damper-random",
    "bush-random",
];

/// Trials to run.
#[derive(Debug, Args)]
pub struct Request {
    /// First test; both without
    #[arg(long, value_enum)]
    first: Option<FirstTest>,
    /// Seeds of each specimen, from 1 on
    #[arg(long, value_name = "NUMBER", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Specimens, separated by commas; all without
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = PossibleValuesParser::new(SPECIMENS))]
    specimens: Vec<String>,
    /// Write the tables to this file too, with their origin
    #[arg(long, value_name = "FILE.md")]
    out: Option<PathBuf>,
}

impl Request {
    /// The specimens in the order of the command line, all without.
    fn specimens(&self) -> Vec<&'static str> {
        let of_name = |name: &String| SPECIMENS.into_iter().find(|known| known == name);
        match self.specimens.is_empty() {
            true => SPECIMENS.to_vec(),
            false => self.specimens.iter().filter_map(of_name).collect(),
        }
    }
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.out.as_deref().map_or(Ok(()), files::check_writable)?;
    let names = request.specimens();
    let first_tests = request.first.map_or(FirstTest::ALL.to_vec(), |first| vec![first]);
    let all = names.len() * first_tests.len() * request.seeds as usize;
    let mut trials: Vec<Trial> = Vec::new();
    for first in first_tests {
        for &name in &names {
            for seed in 1..=request.seeds {
                let done = trial(name, first, seed)?;
                eprintln!("{}/{all} {}", trials.len() + 1, done.line());
                trials.push(done);
            }
        }
    }
    let tables = page::tables(&trials);
    if let Some(out) = &request.out {
        let version = concat!("hysid ", env!("CARGO_PKG_VERSION"));
        let origin = origin(true, version);
        files::write(out, &format!("# Does the plan help?\n\n{origin}\n{tables}"))?;
    }
    io::stdout().write_all(tables.as_bytes()).context("cannot write to stdout")
}
