//! `cycle-battery`: right and wrong tables of `hysid cycles` on protocols of six standards, single loops, periods from any
//! phase, nested loops and spirals, of laws with known loops. Cycles, amplitudes, energies and coercive fields are those
//! of the protocol, by the trapezoidal rule over its rows, apart from how the library divides records.

mod answer;
mod laws;
mod page;
mod protocols;

use std::io::{self, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use crate::files;
use crate::origin::origin;

use answer::{Answer, answer};
use laws::Law;
use protocols::{Disturbance, PROTOCOLS, Protocol, Trial};

/// Rows of a cycle.
const ROWS: [usize; 4] = [20, 60, 200, 2000];

/// Tables to judge.
#[derive(Debug, Args)]
pub struct Request {
    /// Only protocols whose name contains this
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// Print each case that is not right
    #[arg(long)]
    cases: bool,
    /// Write the table to this file too, with its origin
    #[arg(long, value_name = "FILE.md")]
    out: Option<PathBuf>,
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.out.as_deref().map_or(Ok(()), files::check_writable)?;
    let table = page::table(&judged(&request.only, request.cases)?);
    if let Some(out) = &request.out {
        let origin = origin(true, concat!("hysid ", env!("CARGO_PKG_VERSION")));
        files::write(out, &format!("# Are the tables of cycles right?\n\n{origin}\n{table}"))?;
    }
    io::stdout().write_all(table.as_bytes()).context("cannot write to stdout")
}

/// All answers, with the protocol and the disturbance.
fn judged(only: &str, prints: bool) -> Result<Vec<(&'static str, Disturbance, Answer)>> {
    let mut answers = Vec::new();
    for protocol in PROTOCOLS.iter().filter(|protocol| protocol.name.contains(only)) {
        for law in Law::ALL {
            if protocol.is_steady < law.needs_steady() {
                continue;
            }
            for rows in ROWS {
                for disturbance in Disturbance::ALL {
                    let found = of_case(protocol, law, rows, disturbance)?;
                    if prints && !matches!(found, Answer::Right) {
                        eprintln!("{}, {law:?}, {rows} rows, {disturbance:?}: {found:?}", protocol.name);
                    }
                    answers.push((protocol.name, disturbance, found));
                }
            }
        }
    }
    Ok(answers)
}

fn of_case(protocol: &Protocol, law: Law, rows: usize, disturbance: Disturbance) -> Result<Answer> {
    answer(&Trial::new(protocol, law, rows, disturbance))
}
