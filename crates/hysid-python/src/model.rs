//! Fitted models.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hysid::data::initial_state::InitialState;
use hysid::data::known_beginning::KnownSpan;
use hysid::data::record::{self, Excitation};
use hysid::diagnosis::residuals::{ResidualOptions, Residuals};
use hysid::fit::intervals::ParameterIntervals;
use hysid::model::selection::Selection;
use hysid::model::{self, ADAPTATION_ROWS, BandLevel, ParameterInUnits, Prediction};
use hysid_app::diagnosis::DiagnosedModel;
use hysid_app::{Identified, origin, page_text, residual_words};
use hysid_export::description::RateSource;
use hysid_export::{FmiVersion, InverseOptions, MANIFEST, Options, Precision, Target, files_of};
use hysid_files::{Destination, Folder, Kind};
use numpy::PyArray1;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::data::{Column, Dataset, NewColumn, values};
use crate::failure::{explained, not_written, refused};
use crate::interruption::{interruptible, interruptible_if_long};
use crate::inverse::{Bounds, Inverse};

/// A fitted model.
#[pyclass(frozen, module = "hysid._hysid")]
pub struct Model {
    model: Arc<model::Model>,
}

impl Model {
    pub fn new(model: model::Model) -> Self {
        Self { model: Arc::new(model) }
    }
}

#[pymethods]
impl Model {
    /// Reads the text of a model file.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        model::Model::from_json(text).map(Self::new).map_err(refused)
    }

    /// The text of the model file.
    fn to_json(&self) -> String {
        self.model.to_json()
    }

    /// Writes the model file.
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let destination = Destination::new(path, Kind::Model, force);
        let written = py.detach(|| {
            destination.check()?;
            destination.write(self.model.to_json().as_bytes())
        });
        written.map(drop).map_err(not_written)
    }

    /// Writes a report on the model: its free runs over sets of data, each with its name.
    fn report(
        &self,
        py: Python<'_>,
        path: PathBuf,
        title: Option<String>,
        sets: Vec<(String, PyRef<'_, Dataset>)>,
        force: bool,
    ) -> PyResult<()> {
        let mut identified = Identified::before(model::Model::clone(&self.model));
        let sets: Vec<_> = sets.into_iter().map(|(name, data)| (name, Arc::clone(&data.set))).collect();
        let destination = Destination::new(path, Kind::Page, force);
        destination.check().map_err(not_written)?;
        let page = interruptible(py, move || {
            let sets: Vec<_> = sets.iter().map(|(name, data)| (name.as_str(), data.as_ref())).collect();
            for (_, data) in &sets {
                let warnings = identified.model.range_warnings(data)?;
                identified.beforehand.warnings.extend(warnings.iter().map(ToString::to_string));
            }
            Ok(identified.page(title.as_deref(), None, &sets).map(|mut page| {
                page.parts.push(origin::section("hysid.Model.report", &[]));
                page_text(&page)
            }))
        })?;
        let text = page.map_err(|problem| explained(&problem))?;
        destination.write(text.as_bytes()).map(drop).map_err(not_written)
    }

    /// Writes an export of the model into a folder; returns the names of its files, and notes for the user.
    #[allow(clippy::too_many_arguments)]
    fn export(
        &self,
        py: Python<'_>,
        to: &str,
        folder: PathBuf,
        name: String,
        precision: &str,
        rate: &str,
        fmi: u32,
        band: Option<(f64, usize)>,
        inverse: bool,
        limits: Option<(f64, f64)>,
        slew: Option<f64>,
        force: bool,
    ) -> PyResult<(Vec<String>, Option<String>)> {
        let target = Target::named(to).ok_or_else(|| refused(format!("there is no target {to:?}")))?;
        let options = Options {
            precision: if precision == "f32" { Precision::Single } else { Precision::Double },
            rate: if rate == "argument" { RateSource::Argument } else { RateSource::Backward },
            band: band.map(|(probability, of_ten)| BandLevel { probability, of_ten }),
            fmi: if fmi == 2 { FmiVersion::Two } else { FmiVersion::Three },
            inverse: inverse.then_some(InverseOptions { limits, slew }),
            ..Options::named(name)
        };
        let model = Arc::clone(&self.model);
        let exported = interruptible(py, move || Ok(hysid_export::export(&model, target, &options)))?;
        let exported = exported.map_err(refused)?;
        // The model is in memory, and the folder may hold the file that it was read from.
        let destination = Folder {
            path: &folder,
            what: "export of Hysid",
            manifest: MANIFEST,
            listed: files_of,
            checksum: hysid_export::checksum,
            inputs: &[],
            force,
        };
        destination.write(&exported.contents()).map_err(not_written)?;
        Ok((exported.files.into_iter().map(|file| file.path).collect(), exported.note))
    }

    /// Number of fitted parameters.
    fn parameters(&self) -> usize {
        self.model.parameters()
    }

    /// Symbol, value, unit and meaning of each parameter of its law; `None` for another model.
    fn law_parameters(&self) -> Option<Vec<(String, f64, String, &'static str)>> {
        let told = |ParameterInUnits { parameter, unit, .. }| {
            (parameter.symbol, parameter.value, unit, parameter.meaning)
        };
        Some(self.model.law_parameters()?.into_iter().map(told).collect())
    }

    /// True if it needs time stamps.
    fn needs_time(&self) -> bool {
        self.model.needs_time()
    }

    /// Free run over one record. Without the name of an initial state or a state that was found it begins as the training
    /// records did.
    #[allow(clippy::too_many_arguments)]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        time: Option<Column<'_>>,
        inputs: Vec<Column<'_>>,
        rate: Option<Column<'_>>,
        initial_state: Option<&str>,
        state: Option<PyRef<'_, RecordState>>,
    ) -> PyResult<NewColumn<'py>> {
        let (model, state) = (self.begun(initial_state)?, state.map(|state| state.state.clone()));
        let run = move |excitation: Excitation<'_>| model.response(&excitation.with_state(&state));
        Ok(PyArray1::from_vec(
            py,
            driven(py, self.model.work_of_longest_row(), name, time, inputs, rate, run)?,
        ))
    }

    /// As `simulate`, with a band of this probability in so many of ten data sets: output, lower and upper edge.
    #[allow(clippy::too_many_arguments)]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        time: Option<Column<'_>>,
        inputs: Vec<Column<'_>>,
        rate: Option<Column<'_>>,
        probability: f64,
        of_ten: usize,
        initial_state: Option<&str>,
        state: Option<PyRef<'_, RecordState>>,
    ) -> PyResult<[NewColumn<'py>; 3]> {
        let (model, state) = (self.begun(initial_state)?, state.map(|state| state.state.clone()));
        let level = BandLevel { probability, of_ten };
        let run = move |excitation: Excitation<'_>| model.predict(&excitation.with_state(&state), level);
        let Prediction { output, low, high } =
            driven(py, self.model.work_of_longest_row(), name, time, inputs, rate, run)?;
        Ok([output, low, high].map(|column| PyArray1::from_vec(py, column)))
    }

    /// Its state before the first row of a record, from the outputs of the first rows.
    fn find_state(
        &self,
        py: Python<'_>,
        name: &str,
        time: Option<Column<'_>>,
        inputs: Vec<Column<'_>>,
        rate: Option<Column<'_>>,
        known: Column<'_>,
    ) -> PyResult<RecordState> {
        let (model, known) = (Arc::clone(&self.model), values(&known)?);
        let run =
            move |excitation: Excitation<'_>| model.find_state(&excitation.with_known_beginning(&known)?);
        let work = RUNS_OF_SEARCH * self.model.work_of_longest_row();
        Ok(RecordState { state: driven(py, work, name, time, inputs, rate, run)? })
    }

    /// The choice among candidates and the reason, in two lines; `None` if there was no choice.
    fn selection(&self) -> Option<[String; 2]> {
        self.model.provenance().selection.as_ref().map(Selection::summary)
    }

    /// Errors of free runs over all records, as JSON; without the rows of a warm-up if requested. `known` is a number of rows or
    /// a time with its unit.
    fn evaluate(
        &self,
        py: Python<'_>,
        data: &Dataset,
        after_warm_up: bool,
        initial_state: Option<&str>,
        known: Option<&str>,
    ) -> PyResult<String> {
        let set = Arc::clone(&data.set);
        let model = self.begun(initial_state)?;
        let known = known.map(|known| known.parse::<KnownSpan>()?.beginning(model.names())).transpose();
        let model = match known.map_err(refused)? {
            Some(beginning) => Arc::new((*model).clone().with_known_beginning(beginning)),
            None => model,
        };
        let evaluate = move || match after_warm_up && model.warm_up() > 0 {
            true => model.evaluate_after_warm_up(&set),
            false => model.evaluate(&set).map(Some),
        };
        let operations = self.model.work_of_longest_row() * data.set.rows() as f64;
        let errors = interruptible_if_long(py, operations, evaluate)?;
        let errors = errors.ok_or_else(|| refused("no row after the warm-up has a measured output"))?;
        serde_json::to_string(&errors).map_err(refused)
    }

    /// Tests of the residual of free runs over all records, as JSON and as text.
    fn residuals(
        &self,
        py: Python<'_>,
        data: &Dataset,
        initial_state: Option<&str>,
    ) -> PyResult<(String, String)> {
        let set = Arc::clone(&data.set);
        let model = self.begun(initial_state)?;
        let test = move || {
            let is_training = !model.known_records(&set).is_empty();
            let options = ResidualOptions { is_training, ..ResidualOptions::default() };
            Residuals::of_model(&model, &set, &options)
        };
        let found = interruptible(py, test)?;
        Ok((serde_json::to_string(&found).map_err(refused)?, residual_words::text(&found)))
    }

    /// Confidence intervals of the parameters of a law, from its training data, as JSON; `None` for another model.
    fn parameter_intervals(&self, py: Python<'_>, data: &Dataset) -> PyResult<Option<String>> {
        let (model, set) = (Arc::clone(&self.model), Arc::clone(&data.set));
        let found = interruptible(py, move || ParameterIntervals::of(&model, &set))?;
        found.map(|found| serde_json::to_string(&found).map_err(refused)).transpose()
    }

    /// Rows at the beginning of each record that were not trained on.
    fn warm_up(&self) -> usize {
        self.model.warm_up()
    }

    /// Notes on the limits of this model.
    fn notes(&self) -> Vec<String> {
        self.model.notes()
    }

    /// Warns of data beyond what the model was trained on.
    fn range_warnings(&self, data: &Dataset) -> PyResult<Vec<String>> {
        let warnings = self.model.range_warnings(&data.set).map_err(refused)?;
        Ok(warnings.iter().map(ToString::to_string).collect())
    }

    /// Properties of its hysteresis, as JSON and as text.
    fn diagnose(&self, py: Python<'_>) -> PyResult<(String, String)> {
        let model = Arc::clone(&self.model);
        let diagnosed = interruptible(py, move || {
            Ok(DiagnosedModel::of(Path::new("model"), &model)
                .map(|found| (serde_json::to_string(found.diagnosis()), found.text())))
        })?;
        let (json, text) = diagnosed.map_err(|problem| explained(&problem))?;
        Ok((json.map_err(refused)?, text))
    }

    /// Its cycles and first-order reversal curves, as JSON.
    #[pyo3(signature = (division, field, smoothing_factor, density, height))]
    fn cycles(
        &self,
        py: Python<'_>,
        division: Option<&str>,
        field: Option<&str>,
        smoothing_factor: Option<usize>,
        density: Option<f64>,
        height: Option<f64>,
    ) -> PyResult<String> {
        crate::cycles::of_model(py, &self.model, division, field, smoothing_factor, (density, height))
    }

    /// Runs it sample by sample, from its initial state or a state that was found.
    fn stepper(&self, state: Option<PyRef<'_, RecordState>>) -> PyResult<Stepper> {
        let mut stepper = model::Model::clone(&self.model).into_stepper();
        state.map_or(Ok(()), |state| stepper.reset_to_record(&state.state)).map_err(refused)?;
        Ok(Stepper { stepper })
    }

    /// Its inverse, from its initial state.
    fn inverse(
        &self,
        limits: Option<(f64, f64)>,
        slew: Option<f64>,
        preview: f64,
        band: Option<(f64, usize)>,
    ) -> PyResult<Inverse> {
        let bounds = Bounds { limits, slew, preview, band };
        Inverse::of(model::Model::clone(&self.model), &bounds).map_err(refused)
    }
}

impl Model {
    /// The model, whose records begin in the named initial state if there is one.
    fn begun(&self, state: Option<&str>) -> PyResult<Arc<model::Model>> {
        let Some(name) = state else { return Ok(Arc::clone(&self.model)) };
        let begun = |name: &str| model::Model::clone(&self.model).with_initial_state(name.parse()?);
        begun(name).map(Arc::new).map_err(refused)
    }
}

/// Writes an archive of several models, which begins with its first so many bytes as all of them do.
#[pyfunction]
pub fn write_models(
    py: Python<'_>,
    path: PathBuf,
    content: Vec<u8>,
    beginning: usize,
    force: bool,
) -> PyResult<()> {
    let mark = content.get(..beginning).unwrap_or(&content).to_vec();
    let destination = Destination::new(path, Kind::Beginning(mark), force);
    let written = py.detach(|| {
        destination.check()?;
        destination.write(&content)
    });
    written.map(drop).map_err(not_written)
}

/// Runs over the known rows in the search of a state, about so many.
const RUNS_OF_SEARCH: f64 = 100.0;

/// State of a model before the first row of a record, as `Model.find_state` finds it.
#[pyclass(frozen, module = "hysid._hysid")]
pub struct RecordState {
    state: record::RecordState,
}

#[pymethods]
impl RecordState {
    fn __repr__(&self) -> String {
        format!("RecordState({})", self.state)
    }
}

/// Runs something over a copy of one record: what another thread does to the arrays meanwhile changes nothing.
fn driven<T: Send + 'static>(
    py: Python<'_>,
    work_of_row: f64,
    name: &str,
    time: Option<Column<'_>>,
    inputs: Vec<Column<'_>>,
    rate: Option<Column<'_>>,
    run: impl Fn(Excitation<'_>) -> hysid::Result<T> + Send + 'static,
) -> PyResult<T> {
    let name = name.to_owned();
    let inputs = inputs.iter().map(values).collect::<PyResult<Vec<_>>>()?;
    let [time, rate] = [time, rate].map(|column| column.as_ref().map(values).transpose());
    let (time, rate) = (time?, rate?);
    let operations = work_of_row * inputs.first().map_or(0, Vec::len) as f64;
    interruptible_if_long(py, operations, move || {
        let mut excitation = Excitation::new(&name, inputs.iter().map(Vec::as_slice).collect())?;
        if let Some(time) = &time {
            excitation = excitation.with_time(time)?;
        }
        if let Some(rate) = &rate {
            excitation = excitation.with_given_rate(rate)?;
        }
        run(excitation)
    })
}

/// More inputs than any model has.
const MOST_INPUTS: usize = 1 << 16;

/// The inputs of a sample.
fn inputs(x: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    if let Ok(x) = x.extract::<f64>() {
        return Ok(vec![x]);
    }
    let needed = || PyTypeError::new_err("x: a number, or a sequence of numbers, is needed");
    if !x.hasattr("__getitem__")? || x.is_instance_of::<PyDict>() {
        return Err(needed());
    }
    // A sequence without an end would take all memory.
    x.try_iter()
        .map_err(|_| needed())?
        .take(MOST_INPUTS)
        .map(|value| value?.extract())
        .collect::<PyResult<_>>()
        .map_err(|_| needed())
}

/// State of the corrections of a `Stepper` by measured outputs.
#[pyclass(frozen, get_all, module = "hysid._hysid")]
pub struct Tracking {
    /// Gain of the output; 1 unless `adapt` is used.
    gain: f64,
    /// Offset of the output, in its unit: `y` is about `gain * model + offset`.
    offset: f64,
    /// Disturbance that is added to the output, in its unit.
    disturbance: f64,
    /// Factor by which the disturbance fades from row to row.
    decay: f64,
    /// Share of a residual that becomes disturbance; 0 while the residuals are not correlated.
    kalman_gain: f64,
    /// Root mean square of the recent residuals behind gain and offset; None before the first measured output.
    residual: Option<f64>,
    /// True if it is at most twice the validation error of the model; None for a model without one, and before 100
    /// measured outputs.
    memory_fits: Option<bool>,
}

#[pymethods]
impl Tracking {
    fn __repr__(&self) -> String {
        let Self { gain, offset, disturbance, .. } = self;
        format!("Tracking(gain={gain:?}, offset={offset:?}, disturbance={disturbance:?})")
    }
}

/// The signature of `adapt` has the default as a number, for the stubs.
const _: () = assert!(ADAPTATION_ROWS == 1000);

/// A model that is run sample by sample.
#[pyclass(module = "hysid._hysid")]
pub struct Stepper {
    stepper: model::Stepper<'static>,
}

#[pymethods]
impl Stepper {
    /// Simulates one sample and gives the output.
    #[pyo3(signature = (x, time=None, rate=None))]
    fn step(&mut self, x: &Bound<'_, PyAny>, time: Option<f64>, rate: Option<f64>) -> PyResult<f64> {
        self.stepper.step(&inputs(x)?, time.unwrap_or(f64::NAN), rate).map_err(refused)
    }

    /// Gives the output at a sample from the committed state, which stays as it is.
    #[pyo3(signature = (x, time=None, rate=None))]
    fn trial(&mut self, x: &Bound<'_, PyAny>, time: Option<f64>, rate: Option<f64>) -> PyResult<f64> {
        self.stepper.trial(&inputs(x)?, time.unwrap_or(f64::NAN), rate).map_err(refused)
    }

    /// Gives the same, and the slope of the output by the first input; at a kink, that of the branch which continues.
    #[pyo3(signature = (x, time=None, rate=None))]
    fn trial_tangent(
        &mut self,
        x: &Bound<'_, PyAny>,
        time: Option<f64>,
        rate: Option<f64>,
    ) -> PyResult<(f64, f64)> {
        self.stepper.trial_with_tangent(&inputs(x)?, time.unwrap_or(f64::NAN), rate).map_err(refused)
    }

    /// Takes the output measured at the last sample and corrects the outputs from the next sample on, by a disturbance
    /// that fades. It is learned from the residuals; where they are not correlated, nothing is corrected. The memory of
    /// the model is not corrected.
    #[pyo3(signature = (y))]
    fn correct(&mut self, y: f64) -> PyResult<()> {
        self.stepper.correct(y).map_err(refused)
    }

    /// Takes the output measured at the last sample and adapts gain and offset of the output from the next sample on, with
    /// a memory of so many rows. Call it before `correct`. The memory of the model is not corrected.
    #[pyo3(signature = (y, rows=1000))]
    fn adapt(&mut self, y: f64, rows: i64) -> PyResult<()> {
        self.stepper.adapt(y, usize::try_from(rows).unwrap_or_default()).map_err(refused)
    }

    /// State of the corrections at the last committed sample.
    #[getter]
    fn tracking(&self) -> Tracking {
        let model::Tracking { gain, offset, disturbance, decay, kalman_gain, residual, memory_fits } =
            self.stepper.tracking();
        Tracking { gain, offset, disturbance, decay, kalman_gain, residual, memory_fits }
    }

    /// Makes the state of the last trial the committed one.
    fn commit(&mut self) {
        self.stepper.commit();
    }

    /// Forgets the last trial.
    fn revert(&mut self) {
        self.stepper.revert();
    }

    /// Goes back to the initial state of the model, or to another one.
    #[pyo3(signature = (initial_state=None))]
    fn reset(&mut self, initial_state: Option<&str>) -> PyResult<()> {
        match initial_state {
            Some(name) => {
                let state = name.parse::<InitialState>().map_err(refused)?;
                self.stepper.reset_to(state).map_err(refused)
            }
            None => {
                self.stepper.reset();
                Ok(())
            }
        }
    }
}
