//! `hysid demo`: a synthetic ferromagnet, from its record to the report, without any file to begin
//! with.

use std::path::Path;

use anyhow::Result;
use clap::Parser;
use hysid::data::record::Dataset;
use hysid::specimens::Specimen;
use hysid_files::{Destination, Kind};
use hysid_records::Data;
use hysid_records::csv_text;
use hysid_tables::{Reading, Table};

use crate::Outcome;
use crate::arguments::{Arguments, Command, Demo};
use crate::data::data_of;
use crate::files::{self, NO_INPUTS, check_outputs};
use crate::identification::{self, FitTask, identify, note_interrupted};
use crate::interrupt;
use crate::messages::{note, results};

pub fn run(arguments: &Demo) -> Result<Outcome> {
    let folder = &arguments.out;
    files::make_folder(folder)?;
    let ferromagnet = Specimen::named("ferromagnet").expect("the specimen is in the catalogue");
    let place =
        |name: &str, kind: Kind| Destination::new(folder.join(name), kind, arguments.overwriting.force);
    let table = |name: &str, data: &Dataset| {
        let content = csv_text(data).into_bytes();
        anyhow::Ok((place(name, Kind::Content(content.clone())), content))
    };
    let (train, train_text) = table("demo-train.csv", &ferromagnet.train())?;
    let (test, test_text) = table("demo-test.csv", &ferromagnet.test())?;
    let (model, loops) = (place("demo.json", Kind::Model), place("demo-loops.svg", Kind::Drawing));
    let report = place("demo.html", Kind::Page);
    check_outputs([&train, &test, &model, &loops, &report], &NO_INPUTS)?;
    note(format_args!("A ferromagnetic sheet, M330-50A: field H drives flux density B. Synthetic data."));
    note(format_args!(""));
    files::write(&train, &train_text)?;
    files::write(&test, &test_text)?;

    let [train, test, out] = [&train, &test, &model].map(Destination::path);
    let data = read(train)?;
    let unseen = read(test)?;
    let typed = fit_as_typed(train);
    let request = typed.model.0.request(None, false);
    let identified = identify(&data, FitTask::new(&request))?;
    let errors = identified.model.evaluate(&unseen.set).map_err(|error| unseen.explain(error))?;
    identification::save(&identified, &model)?;
    let trained = identified.model.as_trained(&data.set)?;
    identification::write_report(
        &identified,
        (&report, None),
        out,
        &[("training", &trained), ("unseen", &unseen.set)],
        &[train, test],
    )?;
    files::write(&loops, identified.loops("unseen", &unseen.set)?.as_bytes())?;
    let written =
        [("data", train), ("data", test), ("model", out), ("report", report.path()), ("loops", loops.path())];
    results(&(identification::printed(&identified, Some(&errors), &written) + &next(train, test, out)))?;
    if interrupt::requested() {
        note_interrupted(out);
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
    let table = Table::read(path, &Reading::default())?;
    data_of(vec![table], &fit_as_typed(path).columns)
}

fn next(train: &Path, test: &Path, out: &Path) -> String {
    let [train, test, out] = [train, test, out].map(files::shown);
    format!(
        "\nTo repeat this step by step, or with your own data:\n  hysid fit {train} -o {out}\n  hysid \
         evaluate {out} {test}\n  hysid simulate {out} {test} -o OUT.csv\n"
    )
}
