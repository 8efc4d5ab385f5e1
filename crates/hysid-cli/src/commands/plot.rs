//! `hysid plot`: one figure of measured data and a model, for a paper or a talk.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use hysid::model::Model;
use hysid_files::{Destination, Kind};
use hysid_records::{Roles, explained};
use hysid_tables::{Rows, is_model};

use crate::Outcome;
use crate::arguments::Plot;
use crate::commands::{check_band, model_from_bytes};
use crate::data::{data_of, factors, read_tables};
use crate::files::{self, check_outputs};
use crate::messages::{Usage, is_usage, summarised, warning};
use crate::plotting::{self, Format, PlotData, Style};
use hysid_app::gathered::{Gathered, Gatherer};
use hysid_app::table_run::{self, KeptColumns};

pub fn run(arguments: &Plot) -> Result<Outcome> {
    let (model, tables) = given(arguments)?;
    let kind = arguments.kind;
    let ending = format!(".{}.svg", kind.name());
    let out = arguments.out.clone().unwrap_or_else(|| files::named_after(&tables[0], &ending));
    let format = Format::of(&out)?;
    let destination = Destination::new(out, Kind::Drawing, arguments.overwriting.force);
    check_outputs([&destination], &arguments.files)?;
    let subject = match &model {
        Some(model) => simulated(arguments, model, tables)?,
        None => measured(arguments, tables)?,
    };
    let style = Style {
        width: arguments.width,
        height: arguments.height,
        font: arguments.font.clone(),
        points: arguments.text_size,
        dots_per_inch: arguments.dpi,
    };
    let in_file = |error: anyhow::Error| {
        if is_usage(&error) { error } else { error.context(files::shown(&tables[0])) }
    };
    let subject = subject.only(&arguments.only).map_err(in_file)?;
    let charts = plotting::charts(&subject, kind, &arguments.options(), style.pixels()).map_err(in_file)?;
    let title = charts.first().map(|chart| chart.description.clone()).unwrap_or_default();
    files::write(&destination, &plotting::drawing(charts, &style, format, &title)?)?;
    files::say_written([("figure", Some(destination.path()))]);
    Ok(Outcome::Done)
}

/// The model, if one is named, and the tables.
fn given(arguments: &Plot) -> Result<(Option<Model>, &[PathBuf])> {
    let (first, rest) = arguments.files.split_first().context("no files")?;
    if first == Path::new("-") {
        return Ok((None, &arguments.files));
    }
    let content = files::read(first)?;
    if !is_model(&content) {
        return Ok((None, &arguments.files));
    }
    let model = arguments.beginning.of(model_from_bytes(first, content)?)?;
    if rest.is_empty() {
        let advice = "name data to draw it on, or let `hysid cycles` drive and draw it alone";
        return Err(Usage(format!("{} is a model: {advice}", files::shown(first))).into());
    }
    Ok((Some(model), rest))
}

/// Data alone.
fn measured(arguments: &Plot, tables: &[PathBuf]) -> Result<PlotData> {
    if arguments.band.is_some() {
        return Err(Usage("--band needs a model: hysid plot MODEL.json DATA.csv".into()).into());
    }
    let data = data_of(read_tables(tables, &arguments.columns.reading)?, &arguments.columns)?;
    Ok(PlotData { data: data.set, predicted: None, band: None })
}

/// Data, and a model run on them.
fn simulated(arguments: &Plot, model: &Model, tables: &[PathBuf]) -> Result<PlotData> {
    arguments.band.map_or(Ok(()), |_| check_band(model, &arguments.files[0]))?;
    let mut gatherer = Gatherer::default();
    let mut names = None;
    for table in tables {
        let mut rows = Rows::open(table, &arguments.columns.reading.reading())?;
        let columns = &arguments.columns;
        let (roles, has_output) = match Roles::of_model(model, &rows.head, &columns.choice(), true) {
            // Without a measured output, the model is drawn alone.
            Err(_) if columns.output.is_none() => {
                (Roles::of_model(model, &rows.head, &columns.choice(), false)?, false)
            }
            roles => (roles?, true),
        };
        let roles = roles.with_time(&rows.head, &arguments.columns.choice())?;
        let factors = factors(model, &roles, &rows.head.file, has_output, arguments.units.same_units)?;
        let wanted = KeptColumns {
            measured: has_output,
            drive: true,
            cells: false,
            band: arguments.data_sets.level(arguments.band),
            zero: arguments.columns.reading.zero,
        };
        let mut take = |rows: &table_run::Simulated<'_>| -> Result<_> {
            gatherer.take(rows);
            Ok(ControlFlow::Continue(()))
        };
        let end = table_run::run(model, &mut rows, &roles, &factors, wanted, &mut take)?;
        end.note.into_iter().chain(summarised(&end.warnings)).for_each(warning);
        names.get_or_insert((factors.names(model, &roles), rows.head.file.clone(), roles));
    }
    let (names, file, roles) = names.context("no tables")?;
    let gathered = gatherer.gathered(names).map_err(|error| explained(&file, None, error, &roles))?;
    let Gathered { data, predicted } = gathered;
    Ok(PlotData { data, predicted: Some(predicted), band: arguments.band })
}
