//! `hysid demo`: a synthetic ferromagnet, from its record to the report, without any file to begin
//! with.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use clap::Parser;
use hysid::plant::ferromagnet::Ferromagnet;

use crate::Outcome;
use crate::arguments::{Arguments, Command, Demo};
use crate::columns::Roles;
use crate::data::Data;
use crate::identification::{Work, check_outputs, identify, note_interrupted, report_path};
use crate::messages::{note, results};
use crate::table::Table;
use crate::{files, interrupt};

/// Rows of each record.
const ROWS: usize = 1500;

/// Turning points of the field in the training record, in A/m: growing and shrinking amplitudes, and
/// minor loops on both branches.
const TRAIN: [f64; 38] = [
    0.0, 30.0, -30.0, 60.0, -60.0, 100.0, -100.0, 160.0, -160.0, 250.0, -250.0, 400.0, 50.0, 200.0, -40.0,
    90.0, -100.0, 0.0, -400.0, -30.0, -150.0, 60.0, -80.0, 120.0, 20.0, 400.0, -300.0, 300.0, -200.0, 200.0,
    -130.0, 130.0, -80.0, 80.0, -45.0, 45.0, -20.0, 0.0,
];

/// Turning points of the unseen record: other amplitudes, other offsets.
const TEST: [f64; 26] = [
    0.0, 45.0, -45.0, 130.0, -130.0, 330.0, 80.0, 150.0, -20.0, 40.0, -60.0, -10.0, -330.0, -90.0, -200.0,
    20.0, -50.0, 70.0, 40.0, 370.0, -180.0, 180.0, -110.0, 60.0, -30.0, 0.0,
];

/// Runs the command.
pub fn run(arguments: &Demo) -> Result<Outcome> {
    let folder = &arguments.out;
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made: {}", folder.display(), files::reason(&error)))?;
    let [train, test, out, loops] =
        ["demo-train.csv", "demo-test.csv", "demo.json", "demo-loops.svg"].map(|name| folder.join(name));
    check_outputs(&[&train, &test, &out, &loops, &report_path(&out)], &[])?;
    note(format_args!("A ferromagnetic sheet, M330-50A: field H drives flux density B. Synthetic data.\n"));
    files::write(&train, record(&TRAIN).as_bytes())?;
    files::write(&test, record(&TEST).as_bytes())?;

    let data = read(&train)?;
    let unseen = read(&test)?;
    let request = fit_as_typed(&train).training.request(None);
    let identified = identify(&data, Work::new(&request))?;
    let errors = identified.model.evaluate(&unseen.set).map_err(|error| unseen.explain(error))?;
    let mut written = vec![("data", train.clone()), ("data", test.clone())];
    written.extend(identified.save(&out, Some(vec![("training", &data.set), ("unseen", &unseen.set)]))?);
    files::write(&loops, identified.loops("unseen", &unseen.set)?.as_bytes())?;
    written.push(("loops", loops));
    results(&(identified.results(Some(&errors), &written) + &next(&train, &test, &out)))?;
    if interrupt::requested() {
        note_interrupted(&out);
        return Ok(Outcome::Interrupted);
    }
    Ok(Outcome::Done)
}

/// The arguments of the `hysid fit` that does the same.
fn fit_as_typed(train: &Path) -> Box<crate::arguments::Fit> {
    let typed = ["hysid".as_ref(), "fit".as_ref(), train.as_os_str()];
    match Arguments::parse_from(typed).command {
        Command::Fit(arguments) => arguments,
        _ => unreachable!("fit was typed"),
    }
}

fn read(path: &Path) -> Result<Data> {
    let table = Table::read(path)?;
    let roles = Roles::detect(&table, &fit_as_typed(path).columns)?;
    Data::new(vec![table], roles, true)
}

/// A record of the ferromagnet along a path of the field, as CSV.
fn record(turning: &[f64]) -> String {
    let h = path(turning, ROWS);
    let b = Ferromagnet::m330_50a().run(&h);
    let mut text = String::from("H_A_per_m,B_T\n");
    for (h, b) in h.iter().zip(b) {
        text += &format!("{h},{b:.6}\n");
    }
    text
}

/// A path through the turning points in about this many rows, rounded to 0.01 A/m.
fn path(turning: &[f64], rows: usize) -> Vec<f64> {
    let travel: f64 = turning.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    let mut path = vec![turning[0]];
    for pair in turning.windows(2) {
        let swing = pair[1] - pair[0];
        let steps = (swing.abs() / travel * rows as f64).ceil().max(4.0) as usize;
        path.extend((1..=steps).map(|step| {
            let h = pair[0] + swing * step as f64 / steps as f64;
            (100.0 * h).round() / 100.0
        }));
    }
    path
}

fn next(train: &Path, test: &Path, out: &Path) -> String {
    let [train, test, out] = [train, test, out].map(files::shown);
    format!(
        "\nThe same by hand, and then with your own data:\n  hysid fit {train} -o {out}\n  hysid evaluate {out} {test}\n  \
         hysid simulate {out} {test} -o OUT.csv\n"
    )
}
