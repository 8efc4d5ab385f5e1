//! `hysid cycles`: tables of what engineers read from hysteresis loops.

use std::path::Path;

use anyhow::Result;
use hysid::data::summary::Summary;
use hysid::diagnosis::cycles::CycleOptions;
use hysid::options::chosen::RateChoice;
use hysid_app::value_warnings;
use hysid_document::Face;
use hysid_files::{Destination, Kind};
use hysid_records::understanding;

use crate::Outcome;
use crate::arguments::{self, RateOption};
use crate::commands::{Given, model_from_bytes};
use crate::data::data_of;
use crate::files::{self, check_outputs};
use crate::messages::{note_labelled, raw_results, results, warning, warning_words};
use hysid_app::cycles::{self, BEGINNING, Cycles, Files, SideTable};

pub fn run(arguments: &arguments::Cycles) -> Result<Outcome> {
    let outputs = CycleFiles::of(arguments)?;
    let contents: Vec<Vec<u8>> =
        arguments.files.iter().map(|path| files::read(path)).collect::<Result<_>>()?;
    check_outputs(outputs.table.iter().chain(&outputs.page), &arguments.files)?;
    let factor = arguments.smoothing_factor;
    match Given::of(&arguments.files, contents, &arguments.columns.reading, "give it")? {
        Given::Model(content) => {
            let path = &arguments.files[0];
            let model = model_from_bytes(path, content)?;
            for option in useless_for_models(arguments) {
                warning(format_args!("the cycles of a model ignore {option}"));
            }
            let options = arguments.options(&model.names().inputs[0])?;
            let cycles = Cycles::of_model(path, &model, &options, factor)?;
            note_labelled(&cycles.understood);
            tell(arguments, &outputs, &cycles)
        }
        Given::Tables(tables) => {
            let data = data_of(tables, &arguments.columns)?;
            let summary = Summary::of(&data.set);
            let understood = understanding::of_data(&data, &summary, Face::Terminal);
            note_labelled(&understanding::in_short(&data, &summary, Face::Terminal));
            value_warnings(&data.set, Face::Terminal).iter().for_each(warning);
            data.unused_inputs("cycles of", "used").iter().for_each(warning_words);
            if matches!(arguments.columns.rate, RateOption::Choice(RateChoice::Method(_))) {
                warning("cycles ignores --rate: it needs no rate");
            }
            let options = arguments.options(&data.set.names().inputs[0])?;
            let files = data.source.files();
            let told = (files.as_str(), understood);
            let smoothing = (factor, arguments.smoothing_growth);
            let cycles = Cycles::of_data(&data.set, &options, &arguments.corrections(), smoothing, told)
                .map_err(|error| data.explain(error))?;
            tell(arguments, &outputs, &cycles)
        }
    }
}

/// Where the results go; no files if the table goes to stdout.
struct CycleFiles {
    table: Option<Destination>,
    page: Option<Destination>,
}

impl CycleFiles {
    fn of(arguments: &arguments::Cycles) -> Result<Self> {
        let path =
            arguments.out.clone().unwrap_or_else(|| files::named_after(&arguments.files[0], ".cycles.csv"));
        let to_stdout = path == Path::new("-");
        files::check_stdout(to_stdout, arguments.json)?;
        if to_stdout {
            return Ok(Self { table: None, page: None });
        }
        let force = arguments.overwriting.force;
        Ok(Self {
            page: files::page(arguments.no_report, path.with_extension("html"), force),
            table: Some(Destination::new(path, Kind::Beginning(BEGINNING.to_vec()), force)),
        })
    }
}

/// Prints and writes the results.
fn tell(arguments: &arguments::Cycles, outputs: &CycleFiles, cycles: &Cycles) -> Result<Outcome> {
    let table = cycles::csv(cycles);
    let Some(destination) = &outputs.table else {
        raw_results(&String::from_utf8(table)?)?;
        return Ok(Outcome::Done);
    };
    let beside = |table: SideTable| {
        let path = destination.path().with_extension(table.extension);
        let kind = Kind::Beginning(table.beginning.to_vec());
        (Destination::new(path, kind, arguments.overwriting.force), table)
    };
    let further: Vec<(Destination, SideTable)> =
        cycles::side_tables(cycles).into_iter().map(beside).collect();
    check_outputs(further.iter().map(|(destination, _)| destination), &arguments.files)?;
    files::write(destination, &table)?;
    for (destination, table) in &further {
        files::write(destination, &table.content)?;
    }
    if let Some(page) = &outputs.page {
        files::write_page(page, cycles::page(cycles), &arguments.files)?;
    }
    let path = |destination: &Destination| destination.path().to_path_buf();
    let written = Files {
        table: Some(path(destination)),
        page: outputs.page.as_ref().map(path),
        further: further.iter().map(|(destination, table)| (table.what, path(destination))).collect(),
    };
    if arguments.json {
        raw_results(&cycles.json(&written)?)?
    } else {
        results(&cycles::text(cycles))?
    }
    files::say_written([("table", written.table.as_deref())]);
    files::say_written(written.further.iter().map(|(what, path)| (*what, Some(path.as_path()))));
    files::say_written([("page", written.page.as_deref())]);
    Ok(Outcome::Done)
}

/// Options that were asked for and that concern data only.
fn useless_for_models(arguments: &arguments::Cycles) -> Vec<&'static str> {
    let further = [
        ("--smallest-reversal", arguments.smallest_reversal.is_some()),
        ("--subtract", !arguments.subtract.is_empty()),
        ("--center", arguments.center),
        ("--smoothing-growth", arguments.smoothing_growth != 0.0),
        ("--smoothing", arguments.smoothing != CycleOptions::default().smoothing),
    ];
    arguments.columns.given(&further)
}
