//! `hysid invert`: the input that drives a model along a wanted output.

use std::path::Path;

use anyhow::Result;
use hysid::Model;
use hysid::data::metrics::Errors;
use hysid::data::unit;
use hysid_core::significant::Significant;
use hysid_document::{count, object};
use hysid_files::{Destination, Kind};
use hysid_records::Roles;
use hysid_tables::Table;
use serde::Serialize;

use crate::Outcome;
use crate::arguments::Invert;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::files::{self, check_outputs};
use crate::messages::{note_labelled, raw_results, told, warning};
use crate::terminal::clipped;
use hysid_app::errors_table::errors_table;
use hysid_app::inversion::{self, DriveTable, InputBounds, Inverted, Preview, ReferenceOutputs};

pub fn run(arguments: &Invert) -> Result<Outcome> {
    let model = arguments.beginning.of(read_model(&arguments.model)?)?;
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;
    let table = Table::read(&arguments.reference, &arguments.columns.reading.reading())?;
    let drive_table = DriveTable::of(&model, &table, arguments.band.is_some())?;
    let header = drive_table.header(&table);
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
    let mut warnings = inverted.warnings();
    warnings
        .extend(model.stepping_note().map(|note| format!("{note} (simulate with --initial-state virgin)")));
    warnings.iter().for_each(warning);
    let text = [header, drive_table.rows(&table, &wanted, &inverted)].concat();
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

/// Request and its reading, label and text.
fn understood(
    arguments: &Invert,
    model: &Model,
    roles: &Roles,
    inverted: &Inverted,
) -> Vec<(String, String)> {
    let names = model.names();
    let with_unit = |value: f64, name: &str| {
        let unit = unit::of_column(name)
            .map_or_else(String::new, |unit| format!(" {}", clipped(&unit::written(&unit))));
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
            (Some(unit), Some(time)) => {
                format!("{}/{}", clipped(&unit::written(&unit)), clipped(&unit::written(&time)))
            }
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
