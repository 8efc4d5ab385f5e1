//! From data to a model: in a thread of its own, so that the caller's can handle Ctrl-C and report the
//! progress.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use hysid::data::known_beginning::KnownBeginning;
use hysid::fit;
use hysid::fit::cross_validate;
use hysid::fit::progress::Progress;
use hysid::options::chosen::{Ignored, NamedOptions, RateChoice};
use hysid::options::table::OPTIONS;
use hysid::options::{self, ModelName};
use hysid_app::check_memory;
use hysid_app::compare::{CompareObserver, CompareRequest, CompareRow};
use hysid_app::folds_text::folds_text;
use hysid_document::Face;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;

use crate::data::Dataset;
use crate::failure::{explained, refused};
use crate::interruption::waited_for;
use crate::model::Model;

/// Model to fit and its options.
#[pyclass(frozen, module = "hysid._hysid")]
pub struct FitSpec {
    chosen: NamedOptions,
    request: options::FitSpec,
}

#[pymethods]
impl FitSpec {
    /// From options as a JSON object, and the rate by its name, for these data.
    #[new]
    fn new(options: &str, rate: &str, data: &Dataset) -> PyResult<Self> {
        let chosen = NamedOptions::of(serde_json::from_str(options).map_err(refused)?).map_err(refused)?;
        let rate: RateChoice = rate.parse().map_err(refused)?;
        let request = chosen.request_for(rate, &data.set);
        chosen.model().check_data(&data.set, request.rate()).map_err(refused)?;
        Ok(Self { chosen, request })
    }

    /// A model with its defaults in all variants of its law, for these data.
    #[staticmethod]
    fn variants(options: &str, rate: &str, data: &Dataset) -> PyResult<Vec<Self>> {
        let Self { chosen, request } = Self::new(options, rate, data)?;
        Ok(request.variants().into_iter().map(|request| Self { chosen: chosen.clone(), request }).collect())
    }

    /// Checks options that are the same for several models, as a JSON object.
    #[staticmethod]
    fn check(options: &str) -> PyResult<()> {
        NamedOptions::of(serde_json::from_str(options).map_err(refused)?).map(drop).map_err(refused)
    }

    /// The name of the model, and of the variant of its law if it has more than one.
    fn label(&self) -> String {
        self.request.variant_label()
    }

    /// The name of the model.
    fn model(&self) -> &'static str {
        self.chosen.model().name()
    }

    /// Options that the model ignores, and data that do not suit it, in words.
    fn warnings(&self, data: &Dataset) -> Vec<String> {
        let ignored = self.chosen.ignored().into_iter();
        let mut warnings: Vec<String> =
            ignored.map(|Ignored { option, by }| format!("{by} ignores {option}")).collect();
        warnings.extend(self.request.cautions(&data.set).iter().map(|caution| Face::Python.told(caution)));
        warnings
    }
}

/// The names of all models, the networks first.
#[pyfunction]
pub fn model_names() -> Vec<&'static str> {
    ModelName::all().map(ModelName::name).collect()
}

/// The names of all options of a model and its training.
#[pyfunction]
pub fn option_names() -> Vec<&'static str> {
    OPTIONS.iter().map(|option| option.name).collect()
}

/// Arguments of a progress callback: share of the work done, error on the training rows in percent of std,
/// start, epoch, what is being done, the model that is being fitted, and whether that fit is one of many.
type Report = (f64, f64, usize, usize, String, String, bool);

fn report(progress: &Progress<'_>) -> Report {
    let word = |value: serde_json::Result<serde_json::Value>| -> String {
        value.ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
    };
    let phase = word(serde_json::to_value(progress.phase));
    let model = progress.model.name().to_string();
    let error = progress.train_nrmse_percent;
    (progress.done, error, progress.start, progress.epoch, phase, model, progress.is_part)
}

/// Messages between the fit's thread and the caller's.
struct Exchange {
    stop: AtomicBool,
    latest: Mutex<Option<Report>>,
    deadline: Option<Instant>,
}

impl Exchange {
    fn ask_to_stop(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    fn take_latest(&self) -> Option<Report> {
        self.latest.lock().ok().and_then(|mut latest| latest.take())
    }

    fn keep(&self, report: Report) {
        if let Ok(mut latest) = self.latest.lock() {
            *latest = Some(report);
        }
    }

    fn is_to_stop(&self) -> bool {
        self.stop.load(Ordering::SeqCst) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// The observer of the fit.
    fn observe(&self, progress: &Progress<'_>) -> ControlFlow<()> {
        self.keep(report(progress));
        if self.is_to_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Identifies a model. Gives it, how often the objective was evaluated, and whether Ctrl-C ended the fit: then it is
/// the best model so far. `progress` is called with a report every now and then and ends the fit by
/// returning true.
#[pyfunction]
pub fn identify(
    py: Python<'_>,
    data: &Dataset,
    request: &FitSpec,
    threads: Option<usize>,
    time_limit: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Model, usize, bool)> {
    let (set, request) = (Arc::clone(&data.set), request.request.clone());
    let work = move |exchange: &Exchange| {
        check_memory(&set, &request, rayon::current_num_threads())?;
        fit::identify(&set, &request, &mut |progress| exchange.observe(progress))
    };
    let (fitted, interrupted) = attended(py, threads, time_limit, progress, work)?;
    Ok((Model::new(fitted.model), fitted.evaluations, interrupted))
}

/// Cross-validates a request. Gives the errors of the folds as JSON and as text, and whether Ctrl-C ended it; otherwise
/// as [`identify`].
#[pyfunction]
pub fn validate(
    py: Python<'_>,
    data: &Dataset,
    request: &FitSpec,
    folds: usize,
    threads: Option<usize>,
    time_limit: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String, bool)> {
    let (set, request) = (Arc::clone(&data.set), request.request.clone());
    let work = move |exchange: &Exchange| {
        check_memory(&set, &request, rayon::current_num_threads())?;
        cross_validate(&set, &request, folds, &mut |progress| exchange.observe(progress))
    };
    let (validation, interrupted) = attended(py, threads, time_limit, progress, work)?;
    Ok((serde_json::to_string(&validation).map_err(refused)?, folds_text(&validation), interrupted))
}

/// A row of a comparison: label, model, errors on the test data as JSON, seconds of the fit, and why there is no model.
type ComparedRow = (String, Option<Model>, Option<String>, Option<f64>, Option<String>);

/// Fits all requests to the same data, as many at the same time as there are threads, each under its time limit. Gives a row
/// for each, the lowest error first, and whether Ctrl-C ended the comparison; otherwise as [`identify`].
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    data: &Dataset,
    requests: Vec<PyRef<'_, FitSpec>>,
    test: Option<PyRef<'_, Dataset>>,
    threads: Option<usize>,
    time_limit: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Vec<ComparedRow>, bool)> {
    let limit = time_limit.map(hysid::time_limit).transpose();
    limit.map_err(|needed| refused(format!("time_limit: {needed}")))?;
    let specs: Vec<_> = requests.iter().map(|request| request.request.clone()).collect();
    let (train, test) = (Arc::clone(&data.set), test.map(|test| Arc::clone(&test.set)));
    let work = move |exchange: &Exchange| {
        let done = Mutex::new(vec![0.0; specs.len()]);
        let (train, test) = (train.as_ref(), test.as_deref());
        let request = CompareRequest { train, test, specs, time_limit, threads, times_simulations: false };
        Ok(hysid_app::compare::compare(&request, &CompareProgress { exchange, done }))
    };
    let (outcome, interrupted) = attended(py, None, None, progress, work)?;
    let outcome = outcome.map_err(|problem| explained(&problem))?;
    let row = |row: CompareRow| {
        let label = row.label();
        Ok(match row.fit {
            Ok(fit) => {
                let test =
                    fit.test.map(|errors| serde_json::to_string(&errors)).transpose().map_err(refused)?;
                let model = fit.model.with_known_beginning(KnownBeginning::default());
                (label, Some(Model::new(model)), test, Some(fit.fit_seconds), None)
            }
            Err(why) => (label, None, None, None, Some(why)),
        })
    };
    Ok((outcome.rows.into_iter().map(row).collect::<PyResult<_>>()?, interrupted))
}

/// Follows a comparison: the share of each fit that is done.
struct CompareProgress<'a> {
    exchange: &'a Exchange,
    done: Mutex<Vec<f64>>,
}

impl CompareProgress<'_> {
    fn keep(&self, place: usize, share: f64) {
        let Ok(mut done) = self.done.lock() else { return };
        done[place] = share;
        let fits = done.len();
        let number = (done.iter().filter(|share| **share >= 1.0).count() + 1).min(fits);
        let name = format!("model {number} of {fits}");
        let share = done.iter().sum::<f64>() / fits.max(1) as f64;
        self.exchange.keep((share, f64::NAN, 0, 0, "all-data".into(), name, true));
    }
}

impl CompareObserver for CompareProgress<'_> {
    fn is_to_stop(&self) -> bool {
        self.exchange.is_to_stop()
    }

    fn progress(&self, place: usize, progress: &Progress<'_>) {
        self.keep(place, progress.done);
    }

    fn ended(&self, place: usize, _: &CompareRow, _: usize) {
        self.keep(place, 1.0);
    }
}

/// Does the work in a thread of its own, while the caller's checks for Ctrl-C and reports the progress. Returns
/// the result, and whether Ctrl-C ended it.
fn attended<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    time_limit: Option<f64>,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&Exchange) -> hysid::Result<T> + Send + 'static,
) -> PyResult<(T, bool)> {
    let limit = time_limit.map(hysid::time_limit).transpose();
    let limit = limit.map_err(|needed| refused(format!("time_limit: {needed}")))?;
    let deadline = limit.map(|limit| Instant::now() + limit);
    let pool = hysid::thread_pool(threads);
    let pool = pool.map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads: {error}")))?;
    let exchange = Arc::new(Exchange { stop: AtomicBool::new(false), latest: Mutex::new(None), deadline });
    let (answer, answers) = channel();
    let with_work = Arc::clone(&exchange);
    std::thread::spawn(move || {
        let done = pool.install(|| work(&with_work));
        // Nobody listens any more after a second Ctrl-C.
        let _ = answer.send(done);
    });
    let mut interrupted = false;
    let mut failure = None;
    let done = waited_for(py, answers, || {
        if let Err(error) = py.check_signals() {
            exchange.ask_to_stop();
            if interrupted || !error.is_instance_of::<PyKeyboardInterrupt>(py) {
                return Err(error);
            }
            interrupted = true;
        }
        if let Err(error) = tell(&exchange, progress.as_ref().filter(|_| failure.is_none())) {
            exchange.ask_to_stop();
            failure = Some(error);
        }
        Ok(())
    })?;
    if let Some(error) = failure {
        return Err(error);
    }
    let done = done.map_err(refused)?;
    tell(&exchange, progress.as_ref())?;
    Ok((done, interrupted))
}

/// Reports the progress since the last time; stops the fit if the callback returns so.
fn tell(exchange: &Exchange, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let Some((progress, report)) = progress.zip(exchange.take_latest()) else { return Ok(()) };
    if progress.call1(report)?.is_truthy()? {
        exchange.ask_to_stop();
    }
    Ok(())
}
