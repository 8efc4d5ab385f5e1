//! `hysid invert`: the input that drives a model along a wanted output.

use std::path::Path;

use anyhow::Result;
use hysid::Model;
use hysid::data::metrics::Errors;
use hysid::data::unit;
use hysid_core::significant::Significant;
use hysid_document::{count, object};
use hysid_files::{Destination, Kind};
use hysid_records::{Roles, check_new_columns, header_line};
use hysid_tables::{Table, push_shortest};
use serde::Serialize;

use crate::Outcome;
use crate::arguments::Invert;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::files::{self, check_outputs};
use crate::messages::{note_labelled, raw_results, told, warning};
use crate::terminal::clipped;
use hysid_app::errors_table::errors_table;
use hysid_app::inversion::{self, InputBounds, Inverted, Preview, ReferenceOutputs};

pub fn run(arguments: &Invert) -> Result<Outcome> {
    let model = arguments.beginning.of(read_model(&arguments.model)?)?;
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;
    let table = Table::read(&arguments.reference, &arguments.columns.reading.reading())?;
    let names = Names::of(&model, &table, arguments.band.is_some())?;
    let header =
        header_line(delimiter_of(&table), table.header.iter().chain(names.all()).map(String::as_str));
    let out = arguments.out.as_deref().filter(|out| *out != Path::new("-"));
    files::check_stdout(out.is_none(), arguments.json)?;
    let force = arguments.overwriting.force;
    let drive = out.map(|out| Destination::new(out, Kind::Beginning(header.clone()), force));
    let page_path = out.filter(|_| !arguments.no_report).map(|out| out.with_extension("html"));
    let page = page_path.as_ref().map(|path| Destination::new(path.clone(), Kind::Page, force));
    check_outputs(drive.iter().chain(&page), &[&arguments.reference, &arguments.model])?;

    let bounds = InputBounds {
        limits: arguments.limits,
        slew: arguments.slew,
        preview: arguments.preview,
        band: arguments.data_sets.level(arguments.band),
    };
    let roles = Roles::of_inverse(&model, bounds.need_time(&model)?, &table, &arguments.columns.choice())?;
    let factors = factors(&model, &roles, &table.file, true, arguments.units.same_units)?;
    let wanted = ReferenceOutputs::of(&table, &roles, &factors)?;
    let inverted = Inverted::of(&model, &wanted, &bounds)?;

    let understood = understood(arguments, &model, &roles, &inverted);
    note_labelled(&understood);
    let mut warnings = warnings(&inverted);
    warnings
        .extend(model.stepping_note().map(|note| format!("{note} (simulate with --initial-state virgin)")));
    warnings.iter().for_each(warning);
    let text = header.into_iter().chain(rows(&table, &wanted, &inverted)?).collect::<Vec<u8>>();
    match &drive {
        None => raw_results(&String::from_utf8(text)?)?,
        Some(drive) => {
            files::write(drive, &text)?;
            let printed = || Ok(printed(&model, drive.path(), page_path.as_deref(), &inverted));
            told(arguments.json, printed, || summary(&model, &inverted))?;
        }
    }
    if let Some(page) = &page {
        let report = inversion::page(&model, &wanted, &inverted, &bounds, &understood, &warnings);
        files::write_page(page, report, &[&arguments.model, &arguments.reference])?;
    }
    let written = [("drive", &drive), ("report", &page)];
    files::say_written(written.map(|(what, file)| (what, file.as_ref().map(Destination::path))));
    Ok(Outcome::Done)
}

/// Delimiter of the table that is written.
fn delimiter_of(table: &Table) -> u8 {
    table.delimiter().in_a_copy(table.numbers().decimal)
}

/// Names of the columns that are added.
struct Names {
    drive: String,
    edges: Vec<String>,
    others: [String; 3],
}

impl Names {
    /// The drive is named after the input of the model, so that the table can be simulated; if the table has such a
    /// column, `_inverse` is appended.
    fn of(model: &Model, table: &Table, has_band: bool) -> Result<Self> {
        let input = &model.names().inputs[0];
        let drive = match table.column(input) {
            None => input.clone(),
            Some(_) => format!("{input}_inverse"),
        };
        let edges = if has_band { vec![format!("{drive}_low"), format!("{drive}_high")] } else { Vec::new() };
        let others =
            [format!("{}_reached", model.names().output), "reach".to_string(), "extrapolated".to_string()];
        let names = Self { drive, edges, others };
        check_new_columns(&table.file, |name| table.column(name), names.all())?;
        Ok(names)
    }

    fn all(&self) -> impl Iterator<Item = &String> + Clone {
        std::iter::once(&self.drive).chain(&self.edges).chain(&self.others)
    }
}

/// The rows of the table with the columns that are added.
fn rows(table: &Table, wanted: &ReferenceOutputs, inverted: &Inverted) -> Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new().delimiter(delimiter_of(table)).from_writer(Vec::new());
    let mut number = String::new();
    for (record, inversion) in wanted.records.iter().zip(&inverted.records) {
        for (row, place) in record.rows.clone().enumerate() {
            for column in 0..table.header.len() {
                writer.write_field(table.cell(place, column))?;
            }
            for column in [&inversion.input, &inversion.low, &inversion.high, &inversion.output] {
                if let Some(&value) = column.get(row) {
                    number.clear();
                    push_shortest(&mut number, value, wanted.sign);
                    writer.write_field(&number)?;
                }
            }
            writer.write_field(inversion.reach[row].word())?;
            writer.write_field(if inversion.is_extrapolated[row] { "yes" } else { "no" })?;
            writer.write_record(None::<&[u8]>)?;
        }
    }
    Ok(writer.into_inner()?)
}

/// Request and its reading, label and text.
fn understood(
    arguments: &Invert,
    model: &Model,
    roles: &Roles,
    inverted: &Inverted,
) -> Vec<(String, String)> {
    let names = model.names();
    let with_unit = |value: f64, name: &str| {
        let unit = unit::of_column(name).map_or_else(String::new, |unit| format!(" {}", clipped(&unit)));
        format!("{:.4}{unit}", Significant(value))
    };
    let input = &names.inputs[0];
    let (low, high) = arguments.limits.unwrap_or(model.trained_ranges().inputs[0]);
    let of = if arguments.limits.is_some() { "" } else { ", the trained range" };
    let mut lines = vec![
        ("model", format!("{}: {}", files::shown(&arguments.model), model.name().name())),
        ("wanted", format!("{} of {}", clipped(&roles.output), files::shown(&arguments.reference))),
        (
            "drive",
            format!("{}, from {:.4} to {}{of}", clipped(input), Significant(low), with_unit(high, input)),
        ),
    ];
    if let Some(slew) = arguments.slew {
        let time = names.time.as_ref().or(roles.time.as_ref());
        let per = match (unit::of_column(input), time.and_then(|name| unit::of_column(name))) {
            (Some(unit), Some(time)) => format!("{}/{}", clipped(&unit), clipped(&time)),
            _ => "per unit of time".into(),
        };
        lines.push(("slew", format!("at most {:.4} {per}", Significant(slew))));
    }
    if model.needs_time() || inverted.previews.iter().any(|preview| *preview > 0.0) {
        let time = names.time.as_deref().unwrap_or("time");
        let mut all = inverted.previews.clone();
        all.sort_by(f64::total_cmp);
        all.dedup();
        let chosen = if arguments.preview == Preview::Auto { " (chosen; change: --preview)" } else { "" };
        let shown = match all[..] {
            [least, .., largest] => {
                let (least, largest) = (Significant(least), with_unit(largest, time));
                format!("{least:.4} to {largest}, by record")
            }
            _ => all.iter().map(|&preview| with_unit(preview, time)).collect(),
        };
        lines.push(("preview", format!("{shown}{chosen}")));
    }
    lines.into_iter().map(|(label, text)| (label.to_string(), text)).collect()
}

/// Deviation of the driven model, in percent of the standard deviation of the wanted output, above which to warn.
const LARGE: f64 = 5.0;

/// Warnings on the drive.
fn warnings(inverted: &Inverted) -> Vec<String> {
    let rows = inverted.rows();
    let mut all = Vec::new();
    let missed = inverted.not_reached();
    if !missed.is_empty() {
        let counts: Vec<String> = missed.iter().map(|(word, count)| format!("{word} {count}")).collect();
        let total = rows - inverted.reached();
        all.push(format!(
            "{total} of {rows} rows do not reach the wanted output: {} (column reach)",
            counts.join(", ")
        ));
    }
    let extrapolated = inverted.extrapolated();
    if extrapolated > 0 {
        all.push(format!(
            "{extrapolated} of {rows} rows have an input or a rate outside the range of the training data (column extrapolated)"
        ));
    }
    if let Some(percent) = inverted.errors.nrmse_std_percent.filter(|percent| *percent > LARGE) {
        all.push(format!(
            "the RMS deviation of the model output is {percent:.1} % of the standard deviation of the wanted output: \
             within these bounds the model does not follow the reference"
        ));
    }
    all
}

/// The error of the model, which is that of the specimen when it is driven: that on held-out rows, or else in training.
fn expected(model: &Model) -> (&Errors, &'static str) {
    let provenance = model.provenance();
    match &provenance.validation {
        Some(errors) => (errors, "held-out rows, with the noise of their outputs"),
        None => (
            provenance.trained_error(),
            "training rows, with the noise of their outputs; on other inputs it may be larger",
        ),
    }
}

/// The result as text.
fn summary(model: &Model, inverted: &Inverted) -> String {
    let (low, high) = inverted.range();
    let (errors, rows) = expected(model);
    let output = &model.names().output;
    let unit = unit::suffix(unit::of_column(output).as_deref());
    format!(
        "expected deviation of the specimen: {:.4}{unit} RMS, the error of the model on {rows}\n\n{}\nrows reached: {} of {}; drive from {:.4} to {:.4}\n",
        Significant(errors.rmse),
        errors_table(&[("model driven", &inverted.errors)]),
        inverted.reached(),
        count(inverted.rows(), "row"),
        Significant(low),
        Significant(high)
    )
}

/// The object that `--json` prints.
fn printed(model: &Model, drive: &Path, report: Option<&Path>, inverted: &Inverted) -> impl Serialize {
    object! {
        drive: drive,
        report: report,
        rows: inverted.rows(),
        records: inverted.records.len(),
        /// Rows that reach the wanted output.
        reached: inverted.reached(),
        /// Rows by why they do not.
        not_reached: inverted.not_reached(),
        extrapolated: inverted.extrapolated(),
        /// Lowest and highest input.
        drive_range: inverted.range(),
        /// How far the search looked ahead, for each record.
        previews: &inverted.previews,
        /// The expected deviation of the specimen: RMSE of the model on held-out rows, or else in training.
        expected_rmse: expected(model).0.rmse,
        /// The output of the driven model against the wanted one.
        errors: &inverted.errors,
    }
}
