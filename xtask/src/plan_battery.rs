//! `cargo xtask plan-battery`: which second test lowers the error on unseen data most: the first one again, the plan of
//! `hysid plan`, or random reversals of the same length.

mod page;
mod request;
mod trial;

use anyhow::{Context, Result};
use std::io::{self, Write};

use crate::cases::origin;
use crate::files;

pub use request::Request;
use trial::{Trial, trial};

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

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.out.as_deref().map_or(Ok(()), files::check_writable)?;
    let names = request.specimens()?;
    let first_tests = request.first_tests();
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
        let origin = origin("plan-battery", &request.typed, true, version);
        files::write(out, &format!("# Does the plan help?\n\n{origin}\n{tables}"))?;
    }
    io::stdout().write_all(tables.as_bytes()).context("cannot write to stdout")
}
