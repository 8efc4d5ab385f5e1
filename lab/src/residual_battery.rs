//! `residual-battery`: power and false alarms of the tests of the residual. Residuals are noise of a known kind, alone or
//! beside a planted dependence of known size; drives, noise and dependences are made here, apart from what tests them.

mod drives;
mod page;
mod residual;

use std::io::{self, Write};
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::diagnosis::residuals::{ResidualOptions, ResidualTest, Residuals};
use rayon::prelude::*;

use crate::files;
use crate::origin::origin;

use drives::{DRIVES, Drive};
use residual::{Dependence, Noise};

/// Root mean squares of what is planted, as multiples of that of the noise.
pub const SIZES: [f64; 3] = [0.3, 1.0, 20.0];

/// Tables to measure.
#[derive(Debug, Args)]
pub struct Request {
    /// Seeds of each cell
    #[arg(long, default_value_t = 200)]
    seeds: u64,
    /// Write the tables to this file too, with their origin
    #[arg(long, value_name = "FILE.md")]
    out: Option<PathBuf>,
}

/// Shares of the seeds in which tests found structure.
#[derive(Debug)]
pub struct Cell {
    pub drive: &'static str,
    pub noise: Noise,
    /// The dependence and its size, if one is planted.
    pub planted: Option<(Dependence, f64)>,
    /// Share with a finding of each test, after the correction for their number; `None` where it is not testable.
    pub found: Vec<(ResidualTest, Option<f64>)>,
    /// Share with any finding but whiteness.
    pub any: f64,
}

/// Runs the command.
pub fn run(request: &Request) -> Result<()> {
    request.out.as_deref().map_or(Ok(()), files::check_writable)?;
    let tables = page::tables(&measured(request.seeds));
    if let Some(out) = &request.out {
        let origin = origin(true, concat!("hysid ", env!("CARGO_PKG_VERSION")));
        files::write(
            out,
            &format!("# Power and false alarms of the tests of the residual\n\n{origin}\n{tables}"),
        )?;
    }
    io::stdout().write_all(tables.as_bytes()).context("cannot write to stdout")
}

/// All cells: noise alone, and each dependence in each size beside white noise.
fn measured(seeds: u64) -> Vec<Cell> {
    let mut cases = Vec::new();
    for drive in &DRIVES {
        cases.extend(Noise::ALL.map(|noise| (drive, noise, None)));
        for dependence in Dependence::ALL {
            cases.extend(SIZES.map(|size| (drive, Noise::White, Some((dependence, size)))));
        }
    }
    cases.into_par_iter().map(|(drive, noise, planted)| cell(drive, noise, planted, seeds)).collect()
}

fn cell(drive: &Drive, noise: Noise, planted: Option<(Dependence, f64)>, seeds: u64) -> Cell {
    let (mut found, mut any): (Vec<(ResidualTest, Option<usize>)>, usize) = (Vec::new(), 0);
    for seed in 0..seeds {
        let tested = tested(drive, noise, planted, seed);
        if found.is_empty() {
            found = tested.findings.iter().map(|finding| (finding.test, None)).collect();
        }
        for (finding, (_, count)) in tested.findings.iter().zip(&mut found) {
            if finding.p_value.is_some() {
                *count = Some(count.unwrap_or(0) + usize::from(tested.is_found(finding.test)));
            }
        }
        any += usize::from(tested.found().any(|finding| finding.test != ResidualTest::Whiteness));
    }
    let share = |count: usize| count as f64 / seeds as f64;
    Cell {
        drive: drive.name,
        noise,
        planted,
        found: found.into_iter().map(|(test, count)| (test, count.map(share))).collect(),
        any: share(any),
    }
}

/// The tests of one residual: the measured output is the residual, the simulated one 0.
fn tested(drive: &Drive, noise: Noise, planted: Option<(Dependence, f64)>, seed: u64) -> Residuals {
    let (time, x) = drive.run(seed);
    let mut residual = noise.drawn(seed, x.len());
    if let Some((dependence, size)) = planted {
        dependence.plant(&mut residual, size, &time, &x);
    }
    let record = Record::new("residual", vec![x.clone()], residual).and_then(|record| record.with_time(time));
    let data = Dataset::new(ColumnNames::plain(1), vec![record.expect("finite numbers")]);
    let data = data.expect("a record with one input");
    Residuals::of(&data, &[vec![0.0; x.len()]], &ResidualOptions::default()).expect("enough rows")
}
