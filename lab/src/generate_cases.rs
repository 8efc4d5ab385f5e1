//! `generate-cases DIR`: generated identification cases as folders with `train.csv` and `test.csv`, in the
//! form of measured ones, for `cases DIR`.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use hysid::data::record::{Dataset, Record};
use hysid::specimens::{Specimen, with_noise};
use hysid_lab::generated::{Case, KINDS, generated, one_loop};

use crate::files;

/// Cases to write.
#[derive(Debug, Args)]
pub struct Request {
    /// Folder of the cases
    folder: PathBuf,
    /// Number of cases
    #[arg(long, default_value_t = KINDS as u64, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    count: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One loop to train on, smaller loops inside it to test
    #[arg(long)]
    one_loop: bool,
    /// The specimens of the paper's examples, with noise on the output, in percent of its standard deviation
    #[arg(long, value_name = "NOISE", conflicts_with_all = ["one_loop", "count"])]
    specimens: Option<f64>,
    /// With --specimens: runs of the training data, which differ in their noise
    #[arg(long, default_value_t = 1, requires = "specimens")]
    runs: u64,
}

pub fn run(request: &Request) -> Result<()> {
    let cases = match request.specimens {
        Some(noise) => of_specimens(noise, request.runs, request.seed)?,
        None if request.one_loop => one_loop(request.count as usize, request.seed)?,
        None => generated(request.count as usize, request.seed)?,
    };
    println!("| case | law | design | train: scored of rows, records | test: scored of rows, records |");
    println!("|---|---|---|---|---|");
    for case in &cases {
        write_case(&request.folder, case)?;
        let (train, test) = (amount(&case.train), amount(&case.test));
        println!("| {} | {} | {} | {train} | {test} |", case.name, case.law, case.design);
    }
    Ok(())
}

/// The specimens with noise; test data have other noise than the runs of the training data.
fn of_specimens(percent: f64, runs: u64, seed: u64) -> Result<Vec<Case>> {
    let noise_of = |run: u64| seed.wrapping_mul(1000).wrapping_add(run);
    let of_specimen = |specimen: &&Specimen| -> Result<Case> {
        let (train, test) = (specimen.train(), specimen.test());
        let mut records = Vec::new();
        for run in 0..runs {
            let noisy = with_noise(&train, percent, noise_of(run))?;
            for record in noisy.records() {
                records.push(if run == 0 { record.clone() } else { renamed(record, run + 1)? });
            }
        }
        Ok(Case {
            name: specimen.name.into(),
            law: "that of the specimen",
            design: "training and test data of `hysid generate`",
            train: Dataset::new(train.names().clone(), records)?,
            test: with_noise(&test, percent, noise_of(runs))?,
        })
    };
    Specimen::of_the_paper().iter().map(of_specimen).collect()
}

fn renamed(record: &Record, run: u64) -> Result<Record> {
    let inputs = record.inputs().iter().map(|input| input.to_vec()).collect();
    let name = format!("{} run {run}", record.name());
    let renamed = Record::new(name, inputs, record.output().to_vec())?;
    Ok(match record.time() {
        Some(time) => renamed.with_time(time.to_vec())?,
        None => renamed,
    })
}

fn write_case(folder: &Path, case: &Case) -> Result<()> {
    let folder = folder.join(&case.name);
    fs::create_dir_all(&folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    files::write(&folder.join("train.csv"), &csv_text(&case.train))?;
    files::write(&folder.join("test.csv"), &csv_text(&case.test))
}

fn amount(data: &Dataset) -> String {
    format!("{} of {}, {}", data.scored(), data.rows(), data.records().len())
}

/// The data as CSV: `record`, the time if there is one, the input, the output. A blank output is an empty cell, and
/// every number reads back as the same number. No name of a generated case needs quotation marks.
fn csv_text(data: &Dataset) -> String {
    let names = data.names();
    let columns = names.time.iter().chain(&names.inputs).chain([&names.output]);
    let mut text = String::from("record");
    for name in columns {
        text = text + "," + name;
    }
    text.push('\n');
    for record in data.records() {
        for row in 0..record.len() {
            push_row(&mut text, record, row);
        }
    }
    text
}

fn push_row(text: &mut String, record: &Record, row: usize) {
    text.push_str(record.name());
    let inputs = record.inputs().iter().map(|input| &**input);
    for column in record.time().into_iter().chain(inputs).chain([record.output()]) {
        text.push(',');
        if !column[row].is_nan() {
            write!(text, "{}", column[row]).expect("a string takes all that is written");
        }
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use hysid::data::record::ColumnNames;

    use super::*;

    #[test]
    fn blanks_are_empty_and_numbers_are_exact() {
        let names = ColumnNames {
            time: Some("t_s".into()),
            inputs: vec!["x_mm".into()],
            rate: None,
            output: "F_N".into(),
        };
        let record = Record::new("5 Hz", vec![vec![0.1 + 0.2, -2.0]], vec![f64::NAN, 1.0 / 3.0]).unwrap();
        let data = Dataset::new(names, vec![record.with_time(vec![0.0, 0.5]).unwrap()]).unwrap();
        let expected = "record,t_s,x_mm,F_N\n5 Hz,0,0.30000000000000004,\n5 Hz,0.5,-2,0.3333333333333333\n";
        assert_eq!(csv_text(&data), expected);
    }
}
