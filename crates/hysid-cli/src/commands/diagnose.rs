//! `hysid diagnose`: what kind of hysteresis measured data or a model have.

use anyhow::Result;
use hysid::data::summary::Summary;
use hysid::diagnosis::DiagnosisOptions;
use hysid::options::chosen::RateChoice;
use hysid_app::diagnosis::{DataDiagnosis, DiagnosedModel};
use hysid_document::{Face, Page};
use hysid_records::understanding;
use hysid_tables::Table;

use crate::Outcome;
use crate::arguments::{ColumnOptions, Diagnose, RateOption};
use crate::commands::{Given, model_from_bytes};
use crate::data::data_of;
use crate::files::{self, check_outputs};
use crate::messages::{note, note_labelled, results, warning, warning_words};
use crate::progress::while_working;

/// Text of a diagnosis, and its page if there is to be one.
struct PrintedDiagnosis {
    text: String,
    page: Option<Page>,
}

pub fn run(arguments: &Diagnose) -> Result<Outcome> {
    let path =
        arguments.out.clone().unwrap_or_else(|| files::named_after(&arguments.files[0], ".diagnosis.html"));
    let page = files::page(arguments.no_report, path, arguments.overwriting.force);
    let contents: Vec<Vec<u8>> =
        arguments.files.iter().map(|path| files::read(path)).collect::<Result<_>>()?;
    check_outputs(&page, &arguments.files)?;
    let told = match Given::of(&arguments.files, contents, &arguments.columns.reading, "diagnose it")? {
        Given::Model(content) => of_model(arguments, content)?,
        Given::Tables(tables) => of_data(arguments, tables)?,
    };
    results(&told.text)?;
    if let (Some(destination), Some(page)) = (&page, told.page) {
        files::write_page(destination, page, &arguments.files)?;
        note(format_args!("page    {}", files::shown(destination.path())));
    }
    Ok(Outcome::Done)
}

fn of_data(arguments: &Diagnose, tables: Vec<Table>) -> Result<PrintedDiagnosis> {
    let data = data_of(tables, &arguments.columns)?;
    let summary = Summary::of(&data.set);
    let understood = understanding::of_data(&data, &summary, Face::Terminal);
    note_labelled(&understanding::in_short(&data, &summary, Face::Terminal));
    data.unused_inputs("diagnosed:", "diagnosed").iter().for_each(warning_words);
    if matches!(arguments.columns.rate, RateOption::Choice(RateChoice::Method(_))) {
        warning("diagnose ignores --rate: it uses the speeds between turning points");
    }
    let diagnosed = while_working("diagnosing the data", || {
        DataDiagnosis::of(&data, &arguments.options(), &understood, fit_command(arguments), Face::Terminal)
    })?;
    let text = if arguments.json { diagnosed.json()? } else { diagnosed.text() };
    Ok(PrintedDiagnosis { text, page: (!arguments.no_report).then(|| diagnosed.page()) })
}

/// The command that fits a model to the same data.
fn fit_command(arguments: &Diagnose) -> String {
    let files = arguments.files.iter().map(|file| files::shown(file));
    let words = std::iter::once("hysid fit".to_string()).chain(files);
    words.chain(arguments.columns.choice().options()).collect::<Vec<String>>().join(" ")
}

fn of_model(arguments: &Diagnose, content: Vec<u8>) -> Result<PrintedDiagnosis> {
    let path = &arguments.files[0];
    let model = model_from_bytes(path, content)?;
    let diagnosed = while_working("probing the model", || DiagnosedModel::of(path, &model))?;
    note_labelled(&diagnosed.understood());
    for option in useless_for_models(&arguments.columns, &arguments.options()) {
        warning(format_args!("the diagnosis of a model ignores {option}"));
    }
    let text = if arguments.json { diagnosed.json()? } else { diagnosed.text() };
    Ok(PrintedDiagnosis { text, page: (!arguments.no_report).then(|| diagnosed.page()) })
}

/// Options that were asked for and that concern data only.
fn useless_for_models(columns: &ColumnOptions, options: &DiagnosisOptions) -> Vec<&'static str> {
    let defaults = DiagnosisOptions::default();
    columns.given(&[
        ("--smallest-reversal", options.smallest_reversal != defaults.smallest_reversal),
        ("--smoothing", options.smoothing != defaults.smoothing),
    ])
}
