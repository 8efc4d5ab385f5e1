//! Comparison of models: fits them to the same data and compares their errors on test data.

mod page;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use hysid::Error;
use hysid::data::known_beginning::KnownSpan;
use hysid::data::metrics::Errors;
use hysid::data::record::{Dataset, Record};
use hysid::fit::identify;
use hysid::fit::progress::Progress;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid_core::significant::Significant;
use hysid_core::termination::Termination;
use hysid_document::plain::indented;
use hysid_document::{Problem, Result, visible};

use crate::fading_errors::{self, FadingErrors};
use crate::models::parts;
use crate::{check_memory, ns_per_sample};

/// A simulation is timed over at least this time.
const TIMED: Duration = Duration::from_millis(30);

/// Default time limit of a named model, in seconds; `auto` has none, so that its result is that of `fit`.
const TIME_LIMIT: f64 = 20.0;

/// Models to compare, and the data for it.
#[derive(Debug, Clone)]
pub struct CompareRequest<'a> {
    pub train: &'a Dataset,
    /// Test data, which no model is fitted to; without them, models are compared on the training data.
    pub test: Option<&'a Dataset>,
    /// Models with their options, in the order in which their fits begin: the slowest first saves time. All have the
    /// same known beginning; errors are those after it.
    pub specs: Vec<FitSpec>,
    /// Seconds for each fit; by default 20, and no limit for `auto`.
    pub time_limit: Option<f64>,
    /// Number of fits at the same time; by default one for each processor.
    pub threads: Option<usize>,
    /// Times the simulations of the models too.
    pub times_simulations: bool,
}

/// The data that an error concerns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparedData {
    Train,
    Test,
}

/// Follows a comparison; called from several threads.
pub trait CompareObserver: Sync {
    /// True to stop: running fits end with their best model so far, and no new fit begins.
    fn is_to_stop(&self) -> bool;

    /// Called with the progress of the fit of `specs[place]`.
    fn progress(&self, _place: usize, _progress: &Progress<'_>) {}

    /// Called when the fit of `specs[place]` has ended; `count` fits have, this one included.
    fn ended(&self, _place: usize, _row: &CompareRow, _count: usize) {}

    /// An error in words.
    fn explain(&self, error: Error, _data: ComparedData) -> String {
        error.to_string()
    }
}

/// Models with their errors; the lowest error on test data comes first.
#[derive(Debug)]
pub struct CompareOutcome {
    pub rows: Vec<CompareRow>,
    /// True if test data were given.
    pub is_tested: bool,
    /// Threads of each fit.
    pub threads_of_a_fit: usize,
    /// Records that the best model follows only some rows after their beginning, in words.
    pub faded: Option<String>,
}

/// A model and the result of its fit.
#[derive(Debug)]
pub struct CompareRow {
    pub spec: FitSpec,
    /// The model, or the reason why there is none.
    pub fit: Result<ComparedFit, String>,
}

/// A fitted model and its errors.
#[derive(Debug)]
pub struct ComparedFit {
    /// The model, with the known beginning of the comparison.
    pub model: Model,
    pub train: Errors,
    /// Errors on the test data, if there are any.
    pub test: Option<Errors>,
    pub fit_seconds: f64,
    /// Nanoseconds for a sample of a free run, on one thread; `None` if simulations are not timed.
    pub simulate_ns_per_sample: Option<f64>,
}

impl CompareRow {
    /// The model, and its variant if it has more than one.
    pub fn label(&self) -> String {
        self.spec.variant_label()
    }

    /// Number that rows are sorted by; those without a model come last.
    fn error(&self) -> f64 {
        let fit = self.fit.as_ref().ok();
        fit.and_then(|fit| fit.judged().nrmse_std_percent).unwrap_or(f64::INFINITY)
    }

    /// The row in a line, once its fit has ended.
    pub fn line(&self) -> String {
        let name = self.label();
        match &self.fit {
            Ok(fit) => {
                let stopped = if fit.is_stopped() { " (stopped)" } else { "" };
                let error = percent(fit.judged());
                format!("{error:>9} % {:7.1} s  {name}{stopped}", fit.fit_seconds)
            }
            Err(why) => format!("{:>9} {:>11}  {name}: {why}", "-", "-"),
        }
    }
}

impl ComparedFit {
    /// True if the time limit or the observer ended the fit.
    fn is_stopped(&self) -> bool {
        self.model.provenance().termination == Termination::Stopped
    }

    /// Errors on the test data, or on the training data if there are no test data.
    fn judged(&self) -> &Errors {
        self.test.as_ref().unwrap_or(&self.train)
    }
}

/// Checks before the fits that all models can be judged after the known beginning.
fn check_beginning(request: &CompareRequest<'_>) -> Result<(), (Error, ComparedData)> {
    let of_train = |error| (error, ComparedData::Train);
    let of_test = |error| (error, ComparedData::Test);
    let Some(spec) = request.specs.first() else { return Ok(()) };
    let beginning = spec.judged_beginning(request.train.names()).map_err(of_train)?;
    if beginning.is_none() {
        return Ok(());
    }
    beginning.check_rest(request.train).map_err(of_train)?;
    request.test.map_or(Ok(()), |test| beginning.check_rest(test)).map_err(of_test)?;
    let records = request.test.unwrap_or(request.train).records();
    let known = records.iter().try_for_each(|record| beginning.of(record).map(drop));
    known.map_err(if request.test.is_some() { of_test } else { of_train })
}

/// Fits all models in parallel, each within its time limit and on one thread, or on an equal share of the threads if these
/// are at least twice as many as the models.
///
/// # Errors
/// A known beginning that no model can be judged after; threads that cannot be started.
pub fn compare(request: &CompareRequest<'_>, observer: &dyn CompareObserver) -> Result<CompareOutcome> {
    check_beginning(request).map_err(|(error, data)| Problem::from(observer.explain(error, data)))?;
    let count = request.specs.len();
    let workers = match request.threads {
        Some(threads) => threads,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    // A single model, or the last ones of a few, need not leave processors idle.
    let threads = (workers / count.max(1)).max(1);
    let queue: Mutex<VecDeque<(usize, &FitSpec)>> = Mutex::new(request.specs.iter().enumerate().collect());
    let ended: Mutex<Vec<CompareRow>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| -> Result<()> {
        let work = || -> Result<()> {
            let pool = hysid::thread_pool(Some(threads));
            let pool = pool.map_err(|error| Problem::from(format!("cannot start a thread: {error}")))?;
            loop {
                let next = queue.lock().expect("no thread panics with the lock").pop_front();
                let Some((place, spec)) = next else { return Ok(()) };
                let one = CompareTask { request, spec, place, threads: workers, observer };
                let row = CompareRow { spec: spec.clone(), fit: pool.install(|| one.fit()) };
                let mut ended = ended.lock().expect("no thread panics with the lock");
                observer.ended(place, &row, ended.len() + 1);
                ended.push(row);
            }
        };
        let workers: Vec<_> = (0..workers.min(count).max(1)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().expect("a worker does not panic"))
    })?;
    let mut rows = ended.into_inner().expect("all threads are done");
    if request.times_simulations {
        for fit in rows.iter_mut().filter_map(|row| row.fit.as_mut().ok()) {
            let time = ns_per_sample(&fit.model, request.train.records(), TIMED)?;
            fit.simulate_ns_per_sample = Some(time);
        }
    }
    rows.sort_by(|a, b| a.error().total_cmp(&b.error()));
    let faded = rows.first().and_then(|best| faded(best, request.test.unwrap_or(request.train)));
    Ok(CompareOutcome { rows, is_tested: request.test.is_some(), threads_of_a_fit: threads, faded })
}

/// Records that a model follows only some rows after their beginning, in words.
fn faded(row: &CompareRow, data: &Dataset) -> Option<String> {
    let model = &row.fit.as_ref().ok()?.model;
    let words = |record: &Record| {
        let mut errors = FadingErrors::default();
        errors.add(record.output(), &model.simulate(record).ok()?);
        Some(errors.fade(model)?.words(record.name(), &model.names().output))
    };
    fading_errors::first_of(data.records().iter().filter_map(words))
}

/// One of the fits of a comparison.
struct CompareTask<'a> {
    request: &'a CompareRequest<'a>,
    spec: &'a FitSpec,
    place: usize,
    threads: usize,
    observer: &'a dyn CompareObserver,
}

impl CompareTask<'_> {
    fn fit(&self) -> Result<ComparedFit, String> {
        let Self { request: CompareRequest { train, test, .. }, spec, place, observer, .. } = *self;
        if observer.is_to_stop() {
            return Err("not fitted: the comparison was ended before".into());
        }
        spec.model().check_data(train, spec.rate()).map_err(|error| error.to_string())?;
        let of_train = |error| observer.explain(error, ComparedData::Train);
        check_memory(train, spec, self.threads).map_err(of_train)?;
        let limit = match spec {
            FitSpec::Auto(_) => f64::INFINITY,
            FitSpec::Network(_) | FitSpec::Classical(_) => TIME_LIMIT,
        };
        let limit = self.request.time_limit.unwrap_or(limit);
        let began = Instant::now();
        let fitted = identify(train, spec, &mut |progress| {
            observer.progress(place, progress);
            let is_over = began.elapsed().as_secs_f64() >= limit || observer.is_to_stop();
            if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let beginning = spec.judged_beginning(train.names()).map_err(of_train)?;
        let model = fitted.map_err(of_train)?.model.with_known_beginning(beginning);
        let fit_seconds = began.elapsed().as_secs_f64();
        let test = test.map(|test| model.evaluate(test)).transpose();
        Ok(ComparedFit {
            train: model.provenance().train.clone(),
            test: test.map_err(|error| observer.explain(error, ComparedData::Test))?,
            model,
            fit_seconds,
            simulate_ns_per_sample: None,
        })
    }
}

fn percent(errors: &Errors) -> String {
    errors.nrmse_std_percent.map_or_else(|| "-".into(), |percent| format!("{:.4}", Significant(percent)))
}

/// The cells of a fitted model, in the order of [`HEADINGS`].
fn cells(fitted: &ComparedFit) -> [String; 5] {
    [
        fitted.test.as_ref().map_or_else(String::new, percent),
        percent(&fitted.train),
        fitted.model.parameters().to_string(),
        format!("{:.2}{}", Significant(fitted.fit_seconds), if fitted.is_stopped() { STOPPED } else { "" }),
        fitted.simulate_ns_per_sample.map_or_else(String::new, |time| format!("{:.2}", Significant(time))),
    ]
}

/// Marks a fit that was stopped.
const STOPPED: &str = "*";

/// Meaning of the mark; empty if no fit was stopped.
fn stopped_note(rows: &[CompareRow]) -> String {
    let is_stopped = |row: &CompareRow| row.fit.as_ref().is_ok_and(ComparedFit::is_stopped);
    if !rows.iter().any(is_stopped) {
        return String::new();
    }
    format!("{STOPPED} stopped early: the best model so far (for more time: --time-limit SECONDS)")
}

const HEADINGS: [&str; 6] = ["model", "unseen %", "train %", "parameters", "fit s", "ns/sample"];

/// A row of `--json`.
#[derive(serde::Serialize)]
#[serde(untagged)]
pub enum PrintedFit<'a> {
    Fitted {
        model: &'static str,
        /// The model and its variant, such as "bouc-wen (degradation)".
        label: String,
        /// Chosen model, or structure of a network; `null` for a law.
        structure: Option<String>,
        parameters: usize,
        train: &'a Errors,
        test: Option<&'a Errors>,
        /// Known beginning of each record: errors are those after it.
        known: Option<&'a KnownSpan>,
        fit_seconds: f64,
        simulate_ns_per_sample: Option<f64>,
        termination: Termination,
    },
    Failed {
        model: &'static str,
        label: String,
        error: &'a str,
    },
}

/// Structure of a model, in words; `None` for a law, whose name says it.
fn structure(model: &Model) -> Option<String> {
    let provenance = model.provenance();
    match (&provenance.selection, model.network()) {
        (Some(selection), _) => Some(selection.summary()[0].clone()),
        (None, network) => Some(parts(network?.architecture())),
    }
}

impl CompareOutcome {
    /// The threads of each fit, in words.
    fn threads(&self) -> String {
        match self.threads_of_a_fit {
            1 => "one thread".into(),
            threads => format!("{threads} threads"),
        }
    }

    /// The known beginning with which errors were judged, in words.
    fn beginning(&self) -> Option<String> {
        let known = self.rows.iter().find_map(|row| row.spec.known())?;
        Some(format!("They are those after a known beginning of each record: {known}."))
    }

    /// A doubt about the errors, in words.
    fn doubt(&self) -> Option<String> {
        Some(format!("With the best model, {}.", self.faded.as_ref()?))
    }

    /// The comparison as plain text in 80 columns.
    pub fn text(&self) -> String {
        const NAME: usize = 33;
        let line = |cells: [&str; 6]| {
            let [model, test, train, parameters, fit, simulate] = cells;
            let test = if self.is_tested { format!(" {test:>8}") } else { String::new() };
            // A long name has a line of its own.
            let is_long = model.chars().count() >= NAME;
            let name = if is_long { format!("{model}\n{:NAME$}", "") } else { format!("{model:<NAME$}") };
            format!("{name}{test} {train:>7} {parameters:>10} {fit:>6} {simulate:>9}\n")
        };
        let mut text = line(HEADINGS);
        for row in &self.rows {
            match &row.fit {
                Ok(fitted) => {
                    let [test, train, parameters, fit, simulate] = cells(fitted);
                    text += &line([&row.label(), &test, &train, &parameters, &fit, &simulate]);
                }
                Err(why) => text += &format!("{:<NAME$} {}\n", row.label(), visible::line(why)),
            }
        }
        let data =
            if self.is_tested { "the unseen data" } else { "the training data (name test data with --test)" };
        let stopped = match stopped_note(&self.rows) {
            note if note.is_empty() => note,
            note => note + "\n",
        };
        text + &format!(
            "\nErrors: NRMSE of free runs, in % of the standard deviation of the output.\n{}Sorted by the error \
             on {data}.\nEach fit ran on {}.\n{stopped}{}",
            self.beginning().map_or_else(String::new, |words| words + "\n"),
            self.threads(),
            self.doubt().map_or_else(String::new, |words| format!("\n{}", indented(&words, 0))),
        )
    }

    /// The comparison as `--json` prints it, one object for each model.
    pub fn printed(&self) -> Vec<PrintedFit<'_>> {
        self.rows
            .iter()
            .map(|row| match &row.fit {
                Ok(fitted) => PrintedFit::Fitted {
                    model: row.spec.model().name(),
                    label: row.label(),
                    structure: structure(&fitted.model),
                    parameters: fitted.model.parameters(),
                    train: &fitted.train,
                    test: fitted.test.as_ref(),
                    known: row.spec.known(),
                    fit_seconds: fitted.fit_seconds,
                    simulate_ns_per_sample: fitted.simulate_ns_per_sample,
                    termination: fitted.model.provenance().termination,
                },
                Err(error) => {
                    PrintedFit::Failed { model: row.spec.model().name(), label: row.label(), error }
                }
            })
            .collect()
    }
}
