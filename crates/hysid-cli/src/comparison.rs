//! Models side by side: each is fitted to the same data, and judged on data that none has seen.

mod page;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use hysid::data::metrics::Errors;
use hysid::fit::identify;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::significant::Significant;
use hysid::termination::Termination;
use hysid_records::{Data as Read, understanding};
use hysid_report::ns_per_sample;

use crate::arguments::Compare;
use crate::identification::check_memory;
use crate::interrupt;
use crate::messages::note;
use crate::terminal;
pub use page::page;

/// A simulation is timed over at least this time.
const TIMED: Duration = Duration::from_millis(30);

pub struct Data<'a> {
    pub train: &'a Read,
    /// What none has seen.
    pub test: Option<&'a Read>,
}

/// A model and what became of it.
pub struct Row {
    pub request: FitSpec,
    /// The model, or why there is none.
    pub outcome: Result<Fitted, String>,
}

/// A fitted model and its errors.
pub struct Fitted {
    pub model: Model,
    pub train: Errors,
    /// Errors on the test data, if there are any.
    pub test: Option<Errors>,
    pub fit_seconds: f64,
    /// Nanoseconds for a sample of a free run, on one thread.
    pub simulate_ns_per_sample: f64,
}

impl Row {
    /// The model, and its variant if it has more than one.
    pub fn label(&self) -> String {
        self.request.variant_label()
    }
}

impl Fitted {
    /// True if the time limit or Ctrl-C ended the fit.
    fn is_stopped(&self) -> bool {
        self.model.provenance().termination == Termination::Stopped
    }

    /// Error on unseen data; on the training data if there are no others.
    fn judged(&self) -> &Errors {
        self.test.as_ref().unwrap_or(&self.train)
    }
}

/// Seconds for a model that is named; `auto` has no limit of its own, so that its row is what `fit` gives.
const TIME_LIMIT: f64 = 20.0;

/// Fits every model, several at a time, each on one thread (on more, if there are fewer models) and under its time
/// limit; the lowest error on unseen data comes first.
pub fn run(data: &Data, requests: &[FitSpec], arguments: &Compare) -> Result<Vec<Row>> {
    let workers = match arguments.threads {
        Some(threads) => threads.into(),
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    // A single model, or the last ones of a few, need not leave processors idle.
    let threads = (workers / requests.len().max(1)).max(1);
    let queue: Mutex<VecDeque<&FitSpec>> = Mutex::new(requests.iter().collect());
    let finished: Mutex<Vec<Row>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| -> Result<()> {
        let work = || -> Result<()> {
            let pool = hysid::thread_pool(Some(threads));
            let pool = pool.context("cannot start a thread")?;
            loop {
                let next = queue.lock().expect("no thread panics with the lock").pop_front();
                let Some(request) = next else { return Ok(()) };
                let row = pool.install(|| row(data, request, arguments.time_limit, workers));
                let mut finished = finished.lock().expect("no thread panics with the lock");
                finished.push(row);
                say(finished.last().expect("one was added"), finished.len(), requests.len());
            }
        };
        let workers: Vec<_> = (0..workers.min(requests.len()).max(1)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })?;
    let mut rows = finished.into_inner().expect("all threads are done");
    for row in &mut rows {
        if let Ok(fitted) = &mut row.outcome {
            fitted.simulate_ns_per_sample = ns_per_sample(&fitted.model, data.train.set.records(), TIMED)?;
        }
    }
    rows.sort_by(|a, b| error(a).total_cmp(&error(b)));
    Ok(rows)
}

/// What rows are sorted by; those without a model come last.
fn error(row: &Row) -> f64 {
    let fitted = row.outcome.as_ref().ok();
    fitted.and_then(|fitted| fitted.judged().nrmse_std_percent).unwrap_or(f64::INFINITY)
}

fn row(data: &Data, request: &FitSpec, time_limit: Option<f64>, workers: usize) -> Row {
    let of = |outcome| Row { request: request.clone(), outcome };
    if interrupt::requested() {
        return of(Err("interrupted".into()));
    }
    if let Err(error) = request.model().check_data(&data.train.set, request.rate()) {
        return of(Err(error.to_string()));
    }
    let limit = match request {
        FitSpec::Auto(_) => time_limit.unwrap_or(f64::INFINITY),
        FitSpec::Network(_) | FitSpec::Classical(_) => time_limit.unwrap_or(TIME_LIMIT),
    };
    of(fitted(data, request, limit, workers).map_err(|error| format!("{error:#}")))
}

fn fitted(data: &Data, request: &FitSpec, time_limit: f64, threads: usize) -> Result<Fitted> {
    check_memory(&data.train.set, request, threads).map_err(|error| data.train.explain(error))?;
    let began = Instant::now();
    let fit = identify(&data.train.set, request, &mut |_| {
        let over = began.elapsed().as_secs_f64() >= time_limit || interrupt::requested();
        if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let fit = fit.map_err(|error| data.train.explain(error))?;
    let fit_seconds = began.elapsed().as_secs_f64();
    let test = data.test.map(|test| fit.model.evaluate(&test.set).map_err(|error| test.explain(error)));
    Ok(Fitted {
        train: fit.model.provenance().train.clone(),
        test: test.transpose()?,
        model: fit.model,
        fit_seconds,
        simulate_ns_per_sample: f64::NAN,
    })
}

fn say(row: &Row, done: usize, all: usize) {
    let name = row.label();
    match &row.outcome {
        Ok(fitted) => {
            let stopped = if fitted.is_stopped() { " (stopped)" } else { "" };
            let error = percent(fitted.judged());
            note(format_args!(
                "{done:>2}/{all} {name:<33} {error:>9} % {:7.1} s{stopped}",
                fitted.fit_seconds
            ));
        }
        Err(why) => note(format_args!("{done:>2}/{all} {name:<33} {why}")),
    }
}

fn percent(errors: &Errors) -> String {
    errors.nrmse_std_percent.map_or_else(|| "-".into(), |percent| format!("{:.3}", Significant(percent)))
}

/// The cells of a fitted model, in the order of [`HEADINGS`].
fn cells(fitted: &Fitted) -> [String; 5] {
    [
        fitted.test.as_ref().map_or_else(String::new, percent),
        percent(&fitted.train),
        fitted.model.parameters().to_string(),
        format!("{:.2}{}", Significant(fitted.fit_seconds), if fitted.is_stopped() { STOPPED } else { "" }),
        format!("{:.2}", Significant(fitted.simulate_ns_per_sample)),
    ]
}

/// Marks a fit that was stopped.
const STOPPED: &str = "*";

/// What the mark means; empty if no fit was stopped.
fn stopped_note(rows: &[Row]) -> String {
    let is_stopped = |row: &Row| row.outcome.as_ref().is_ok_and(Fitted::is_stopped);
    if !rows.iter().any(is_stopped) {
        return String::new();
    }
    format!("{STOPPED} stopped early: the best model so far (for more time: --time-limit SECONDS)")
}

const HEADINGS: [&str; 6] = ["model", "unseen %", "train %", "parameters", "fit s", "ns/sample"];

/// The comparison as plain text in 80 columns.
pub fn table(rows: &[Row], tested: bool) -> String {
    const NAME: usize = 33;
    let line = |cells: [&str; 6]| {
        let [model, test, train, parameters, fit, simulate] = cells;
        let test = if tested { format!(" {test:>8}") } else { String::new() };
        // A long name has a line of its own.
        let is_long = model.chars().count() >= NAME;
        let name = if is_long { format!("{model}\n{:NAME$}", "") } else { format!("{model:<NAME$}") };
        format!("{name}{test} {train:>7} {parameters:>10} {fit:>6} {simulate:>9}\n")
    };
    let mut text = line(HEADINGS);
    for row in rows {
        match &row.outcome {
            Ok(fitted) => {
                let [test, train, parameters, fit, simulate] = cells(fitted);
                text += &line([&row.label(), &test, &train, &parameters, &fit, &simulate]);
            }
            Err(why) => text += &format!("{:<NAME$} {}\n", row.label(), terminal::line(why)),
        }
    }
    let data = if tested { "the unseen data" } else { "the training data (name test data with --test)" };
    let stopped = match stopped_note(rows) {
        note if note.is_empty() => note,
        note => note + "\n",
    };
    text + &format!(
        "\nErrors: NRMSE of free runs, in % of the standard deviation of the output.\nSorted by the error \
         on {data}.\nEach fit ran on one thread.\n{stopped}"
    )
}

/// A row of `--json`.
#[derive(serde::Serialize)]
#[serde(untagged)]
pub enum Printed<'a> {
    Fitted {
        model: &'static str,
        /// The model and its variant, such as "bouc-wen (degradation)".
        label: String,
        /// What was chosen, or what a network is made of; `null` for a law.
        structure: Option<String>,
        parameters: usize,
        train: &'a Errors,
        test: Option<&'a Errors>,
        fit_seconds: f64,
        simulate_ns_per_sample: f64,
        termination: Termination,
    },
    Failed {
        model: &'static str,
        label: String,
        error: &'a str,
    },
}

/// What a model is made of, in words; `None` for a law, whose name says it.
fn structure(model: &Model) -> Option<String> {
    let provenance = model.provenance();
    match (&provenance.selection, model.network()) {
        (Some(selection), _) => Some(selection.summary()[0].clone()),
        (None, network) => Some(understanding::parts(network?.architecture())),
    }
}

/// The comparison as `--json` prints it, one object for each model.
pub fn printed(rows: &[Row]) -> Vec<Printed<'_>> {
    rows.iter()
        .map(|row| match &row.outcome {
            Ok(fitted) => Printed::Fitted {
                model: row.request.model().name(),
                label: row.label(),
                structure: structure(&fitted.model),
                parameters: fitted.model.parameters(),
                train: &fitted.train,
                test: fitted.test.as_ref(),
                fit_seconds: fitted.fit_seconds,
                simulate_ns_per_sample: fitted.simulate_ns_per_sample,
                termination: fitted.model.provenance().termination,
            },
            Err(error) => Printed::Failed { model: row.request.model().name(), label: row.label(), error },
        })
        .collect()
}
