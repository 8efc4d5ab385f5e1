//! `hysid plan`: which experiment next, as a drive with its reasons.

use std::path::{Path, PathBuf};

use anyhow::Result;
use hysid::data::summary::Summary;
use hysid::plan::{LimitOptions, MOST_ROWS, Plan, PlanOptions, Protocol, ProtocolOptions};
use hysid_document::{Face, Problem};
use hysid_files::{Destination, Kind};
use hysid_records::header_line;
use hysid_records::{Roles, understanding};

use crate::Outcome;
use crate::arguments;
use crate::data::{data_with, read_tables};
use crate::files::{self, check_outputs};
use crate::messages::{Usage, note_labelled, raw_results, told};
use hysid_app::plan::{self as planning, Planned};

pub fn run(arguments: &arguments::Plan) -> Result<Outcome> {
    match (&arguments.kind, arguments.like.is_empty()) {
        (Some(kind), _) => of_kind(arguments, kind),
        (None, false) => of_data(arguments),
        (None, true) => {
            let kinds = Protocol::ALL.map(Protocol::name).join(", ");
            Err(Usage(format!("name measured data with --like, or a kind of specimen with --for: {kinds}"))
                .into())
        }
    }
}

/// A first test.
fn of_kind(arguments: &arguments::Plan, kind: &str) -> Result<Outcome> {
    let of_options = |error: hysid::Error| Problem::request(error.to_string());
    let protocol = Protocol::named(kind).map_err(of_options)?;
    if arguments.range.is_none() {
        return Err(Usage("--for needs the range of the input: --range LOW:HIGH".into()).into());
    }
    if arguments.duration.is_some() && arguments.step.is_none() {
        return Err(Usage("--duration needs the time between rows: --step TIME".into()).into());
    }
    let options = ProtocolOptions { limits: wanted(arguments, arguments.step)?, wave: arguments.wave };
    let plan = protocol.plan(&options).map_err(of_options)?;
    let out =
        arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.drive.csv", protocol.name())));
    let outputs = PlanFiles::of(arguments, out, &plan.names)?;
    let planned = Planned {
        plan: &plan,
        title: format!("First test: {}", protocol.name()),
        understood: Vec::new(),
        next: "hysid fit NEW.csv".into(),
    };
    tell(arguments, &outputs, &planned)
}

/// Plans the next measurement from data.
fn of_data(arguments: &arguments::Plan) -> Result<Outcome> {
    let tables = read_tables(&arguments.like, &arguments.columns.reading)?;
    let roles = Roles::detect(&tables[0], &arguments.columns.choice())?;
    let out = arguments.out.clone().unwrap_or_else(|| files::named_after(&arguments.like[0], ".drive.csv"));
    let outputs = PlanFiles::of(arguments, out, &roles.names())?;
    let data = data_with(tables, roles, arguments.columns.reading.zero)?;
    let count = data.roles.inputs.len();
    if count > 1 {
        return Err(
            Usage(format!("there are {count} inputs, and a plan drives one: choose with --input")).into()
        );
    }
    if arguments.duration.is_some() && !data.set.has_time() {
        return Err(
            Usage("--duration needs time stamps: use --length, or name them with --time".into()).into()
        );
    }
    let summary = Summary::of(&data.set);
    let of_data = || summary.records.iter().find_map(|record| Some(record.time_steps?.1));
    let limits = wanted(arguments, arguments.step.or_else(of_data))?;
    let options = PlanOptions { limits, wave: arguments.wave, seed: arguments.seed };
    let understood = understanding::of_data(&data, &summary, Face::Terminal);
    note_labelled(&understanding::in_short(&data, &summary, Face::Terminal));
    let plan = Plan::of(&data.set, &options).map_err(|error| data.explain(error))?;
    let shown: Vec<String> = arguments.like.iter().map(|path| files::shown(path)).collect();
    let planned = Planned {
        plan: &plan,
        title: "What to measure next".into(),
        understood,
        next: format!("hysid fit {} NEW.csv", shown.join(" ")),
    };
    tell(arguments, &outputs, &planned)
}

/// The limits that are asked for; `step` is the time between rows, for a duration.
fn wanted(arguments: &arguments::Plan, step: Option<f64>) -> Result<LimitOptions> {
    let rows = arguments.duration.zip(step).map(|(duration, step)| duration / step + 1.0);
    if let Some(rows) = rows.filter(|rows| *rows > MOST_ROWS as f64) {
        return Err(
            Usage(format!("--duration takes {rows:.0} rows: at most {MOST_ROWS} are possible")).into()
        );
    }
    Ok(LimitOptions {
        range: arguments.range,
        step: arguments.step,
        max_rate: arguments.max_rate,
        length: arguments.length.or(rows.map(|rows| rows as usize)),
    })
}

/// Where the results go; no files if the table goes to stdout.
struct PlanFiles {
    header: Vec<u8>,
    table: Option<Destination>,
    page: Option<Destination>,
}

impl PlanFiles {
    fn of(
        arguments: &arguments::Plan,
        path: PathBuf,
        names: &hysid::data::record::ColumnNames,
    ) -> Result<Self> {
        let columns = names.time.iter().chain(&names.inputs[..1]).map(String::as_str);
        let header = header_line(b',', columns);
        let to_stdout = path == Path::new("-");
        files::check_stdout(to_stdout, arguments.json)?;
        if to_stdout {
            return Ok(Self { header, table: None, page: None });
        }
        let force = arguments.overwriting.force;
        let page = files::page(arguments.no_report, path.with_extension("html"), force);
        let table = Some(Destination::new(path, Kind::Beginning(header.clone()), force));
        check_outputs(table.iter().chain(&page), &arguments.like)?;
        Ok(Self { header, table, page })
    }
}

/// Prints and writes the results.
fn tell(arguments: &arguments::Plan, outputs: &PlanFiles, planned: &Planned<'_>) -> Result<Outcome> {
    let table = [outputs.header.clone(), planning::rows(planned.plan)].concat();
    let Some(destination) = &outputs.table else {
        raw_results(&String::from_utf8(table)?)?;
        return Ok(Outcome::Done);
    };
    files::write(destination, &table)?;
    if let Some(page) = &outputs.page {
        files::write_page(page, planning::page(planned), &arguments.like)?;
    }
    let page = outputs.page.as_ref().map(Destination::path);
    let printed = || Ok(planning::printed(planned.plan, destination.path(), page));
    told(arguments.json, printed, || planning::text(planned))?;
    files::say_written([("drive", Some(destination.path())), ("page", page)]);
    Ok(Outcome::Done)
}
