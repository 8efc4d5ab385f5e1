//! `hysid demo`: a synthetic ferromagnet, from its record to the report, without any file to begin
//! with.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use clap::Parser;
use hysid::plant::Specimen;

use crate::Outcome;
use crate::arguments::{Arguments, Command, Demo};
use crate::columns::Roles;
use crate::csv_text::csv_text;
use crate::data::Data;
use crate::identification::{Work, check_outputs, identify, note_interrupted, report_path};
use crate::messages::{note, results};
use crate::table::Table;
use crate::{files, interrupt};

/// Runs the command.
pub fn run(arguments: &Demo) -> Result<Outcome> {
    let folder = &arguments.out;
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made: {}", folder.display(), files::reason(&error)))?;
    let [train, test, out, loops] =
        ["demo-train.csv", "demo-test.csv", "demo.json", "demo-loops.svg"].map(|name| folder.join(name));
    check_outputs(&[&train, &test, &out, &loops, &report_path(&out)], &[])?;
    note(format_args!("A ferromagnetic sheet, M330-50A: field H drives flux density B. Synthetic data.\n"));
    let ferromagnet = Specimen::named("ferromagnet").expect("the specimen is in the catalogue");
    files::write(&train, csv_text(&ferromagnet.train())?.as_bytes())?;
    files::write(&test, csv_text(&ferromagnet.test())?.as_bytes())?;

    let data = read(&train)?;
    let unseen = read(&test)?;
    let typed = fit_as_typed(&train);
    let request = typed.training.chosen(&typed.rival).request(None, false);
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

fn next(train: &Path, test: &Path, out: &Path) -> String {
    let [train, test, out] = [train, test, out].map(files::shown);
    format!(
        "\nThe same by hand, and then with your own data:\n  hysid fit {train} -o {out}\n  hysid evaluate {out} {test}\n  \
         hysid simulate {out} {test} -o OUT.csv\n"
    )
}
