//! A fitted model: a network with its scaling, a classical law, or an ensemble of both, with the ranges of
//! its training data and how it was fitted. It simulates in the user's units.
//!
//! | to | use |
//! |---|---|
//! | read and write a model file | [`Model::from_json`], [`Model::to_json`] |
//! | simulate a whole input | [`Model::run`], [`Model::simulate`] |
//! | simulate sample by sample | [`Model::stepper`] |
//! | find the input for a wanted output | [`Model::inverse`] |
//! | simulate long records in blocks | [`Model::simulation`] |
//! | compare with measurements | [`Model::evaluate`] |
//! | get a prediction band | [`Model::predict`] |

mod band;
mod beginning;
mod ensemble;
mod file;
pub mod history;
pub mod input_transform;
mod inverse;
mod notes;
mod ranges;
mod runner;
pub mod selection;
mod simulation;
mod stepper;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
use crate::data::known_beginning::KnownBeginning;
use crate::data::likeness::Likeness;
use crate::data::metrics::{ErrorSums, Errors};
use crate::data::rate::RateMethod;
use crate::data::record::{ColumnNames, Dataset, Excitation, Fingerprint, Record};
use crate::data::unit::{of_column, pure_quotient};
use crate::data::warning::Warning;
use crate::error::{Channel, DataProblem, Error, LARGEST_VALUE, OptionError, Result};
use crate::law::{Classical, Dimension, Parameter};
use crate::model::history::Run;
use crate::model::input_transform::InputTransform;
use crate::model::selection::Selection;
use crate::network::Network;
use crate::network::scaling::Scaling;
use crate::options::network::Regularisation;
use crate::options::{FitSpec, ModelName};
use crate::termination::Termination;

pub use band::{BAND_OF_TEN, BAND_PROBABILITIES, Band, BandLevel, Prediction};
pub use band::{HeldOutRow, disagreement};
use beginning::begun;
pub use ensemble::{Ensemble, Group, Node, NodeKind, Weights};
pub use ensemble::{Excursion, MedianBuffers, Predictions};
pub use file::FORMAT_VERSION;
pub use inverse::{Inverse, Inversion, Inverted, MOST_TRIALS, Reach, Reference};
use ranges::Ranges;
use runner::{OutputSpread, Runner};
pub use simulation::Simulation;
pub use stepper::{ADAPTATION_ROWS, Snapshot, Stepper, Tracking};

/// A fitted model, which simulates in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    body: Predictor,
    preprocessing: InputTransform,
    rate: Option<RateMethod>,
    names: ColumnNames,
    trained: TrainedRanges,
    /// Lead-in of records that have none of their own; empty for the virgin state.
    lead_in: Vec<f64>,
    /// Records that have no lead-in begin after one period of themselves.
    is_periodic: bool,
    /// Known beginning of records that have none of their own. It is not stored.
    beginning: KnownBeginning,
    band: Option<Band>,
    provenance: Provenance,
}

/// Network, law or ensemble that simulates.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a model has one, not many of them side by side")]
pub enum Predictor {
    /// A network in scaled units, with its scale factors.
    Network {
        /// Weights and architecture, in scaled units.
        network: Network,
        /// Factors between the user's units and the network's.
        scaling: Scaling,
    },
    /// A classical law in the user's units.
    Law(Classical),
    /// Several models whose outputs are combined by weighted medians.
    Ensemble(Ensemble),
}

impl Predictor {
    /// The range of the first input beyond which a record has been outside: that of an ensemble, or of the training data.
    fn first_input_range(&self, trained: (f64, f64)) -> (f64, f64) {
        match self {
            Self::Ensemble(ensemble) => ensemble.range(),
            Self::Network { .. } | Self::Law(_) => trained,
        }
    }

    /// Number of parameters that were determined from the data.
    fn parameters(&self) -> usize {
        match self {
            Self::Network { network, .. } => network.architecture().parameters(),
            Self::Law(law) => law.parameters().len(),
            Self::Ensemble(ensemble) => ensemble.members().iter().map(|member| member.parameters()).sum(),
        }
    }

    /// True if it, or a member of it, has a mass: its output responds later than by the next sample.
    fn has_inertia(&self) -> bool {
        match self {
            Self::Network { .. } => false,
            Self::Law(law) => law.has_inertia(),
            Self::Ensemble(ensemble) => ensemble.members().iter().any(Model::has_inertia),
        }
    }

    /// True if it needs the time between samples, other than for a rate.
    fn needs_steps(&self) -> bool {
        match self {
            Self::Network { network, .. } => network.architecture().relaxation > 0,
            Self::Law(law) => law.needs_steps(),
            Self::Ensemble(ensemble) => ensemble.members().iter().any(|member| member.needs_time()),
        }
    }
}

/// Errors of free runs over all records that have an output.
fn errors(mut runner: Runner<'_>, data: &Dataset) -> Result<Errors> {
    let mut sums = ErrorSums::default();
    for record in data.records().iter().filter(|record| record.scored() > 0) {
        sums.add(record.output(), &runner.record(&record.excitation())?);
    }
    sums.errors(&data.names().output)
        .ok_or_else(|| data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore))
}

/// The lead-ins of the records, if they differ and do not follow from the records.
fn lead_ins(data: &Dataset) -> Vec<RecordLeadIn> {
    if data.begin_periodically() {
        return Vec::new();
    }
    let of = |record: &Record| RecordLeadIn {
        record: record.name().into(),
        lead_in: record.lead_in().unwrap_or_default().to_vec(),
    };
    let all: Vec<RecordLeadIn> = data.records().iter().map(of).collect();
    let is_one = all.iter().all(|one| one.lead_in == all[0].lead_in);
    if is_one || all.len() > MOST_REMEMBERED { Vec::new() } else { all }
}

/// Fingerprints of the records, unless there are very many.
fn remembered(data: &Dataset) -> Vec<String> {
    if data.records().len() > MOST_REMEMBERED {
        return Vec::new();
    }
    data.records().iter().filter_map(|record| record.fingerprint().text()).collect()
}

/// Rows at the beginning of each record that were not used in training.
fn warm_up(body: &Predictor, options: &FitSpec) -> usize {
    match (options, body) {
        (FitSpec::Network(options), _) => options.shaping.warm_up,
        (FitSpec::Classical(options), _) => options.shaping.warm_up,
        (FitSpec::Auto(_), Predictor::Ensemble(ensemble)) => {
            ensemble.members().iter().map(Model::warm_up).max().unwrap_or_default()
        }
        (FitSpec::Auto(_), Predictor::Network { .. } | Predictor::Law(_)) => 0,
    }
}

/// The data without outputs in the first rows of each record; `None` without such rows or remaining outputs.
fn behind(data: &Dataset, rows: usize) -> Option<Dataset> {
    let behind = (rows > 0).then(|| data.clone().warmed_up(rows))?;
    (behind.scored() > 0).then_some(behind)
}

/// Smallest and largest values in training, in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedRanges {
    /// Smallest and largest value of each input.
    pub inputs: Vec<(f64, f64)>,
    /// Smallest and largest rate of the first input, if the model has one.
    pub rate: Option<(f64, f64)>,
    /// Smallest and largest output.
    pub output: (f64, f64),
    /// The records, by their [`Fingerprint`]s, at most [`MOST_REMEMBERED`]; empty in a member of an ensemble.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<String>,
}

/// Largest number of records whose fingerprints a model stores.
pub const MOST_REMEMBERED: usize = 1000;
impl TrainedRanges {
    fn check(&self) -> Result<()> {
        let is_range =
            |&(low, high): &(f64, f64), most: f64| low <= high && low.abs().max(high.abs()) <= most;
        let values = self.inputs.iter().chain([&self.output]).all(|range| is_range(range, LARGEST_VALUE));
        if values && self.rate.iter().all(|range| is_range(range, f64::MAX)) {
            return Ok(());
        }
        Err(Error::Parts("a range that it was trained on is none".into()))
    }

    /// Middle and half the width of the output, 1 if it was constant: the scale of gain and offset in
    /// [`Stepper::adapt`] (theory.md (8.69)).
    pub fn middle_and_half_width(&self) -> [f64; 2] {
        let (low, high) = self.output;
        [0.5 * low + 0.5 * high, if high > low { 0.5 * high - 0.5 * low } else { 1.0 }]
    }
}

/// How a model was fitted: options, errors, training runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Options of the fit, as requested.
    pub options: FitSpec,
    /// Rows with an output.
    pub samples: usize,
    /// Number of training records.
    pub records: usize,
    /// The start that became the model, counted from 0.
    pub chosen_start: usize,
    /// Why the last training run ended.
    pub termination: Termination,
    /// Errors of the model on all its training data, as [`Model::evaluate`] gives them, warm-up included.
    pub train: Errors,
    /// The same without the rows of the warm-up, which were not used in training; `None` without a warm-up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub train_after_warm_up: Option<Errors>,
    /// Held-out errors of models fitted in the same way; `None` if none were held out.
    pub validation: Option<Errors>,
    /// Penalties that a network was trained with; `None` for other models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalties: Option<Regularisation>,
    /// True if the rows had weights in the fit; errors count all rows alike.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub weighted: bool,
    /// Every training run.
    pub runs: Vec<Run>,
    /// The candidates and their errors, if the model was chosen among several; otherwise `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selection: Option<Selection>,
    /// Lead-ins of the training records; empty if all have the model's, and beyond [`MOST_REMEMBERED`] records.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lead_ins: Vec<RecordLeadIn>,
}

/// The [lead-in](crate::data::initial_state) that a training record has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordLeadIn {
    /// Name of the record.
    pub record: String,
    /// Turning points of the first input before its first row, in its unit; empty for the virgin state.
    pub lead_in: Vec<f64>,
}

impl Provenance {
    /// Errors on the rows that the model was trained on.
    pub fn trained_error(&self) -> &Errors {
        self.train_after_warm_up.as_ref().unwrap_or(&self.train)
    }
}

/// How a model was fitted, before its errors on the data are known; with them it becomes the [`Provenance`].
#[derive(Debug, Clone)]
pub struct ProvenanceDraft {
    /// Options of the fit, as requested.
    pub options: FitSpec,
    /// The start that became the model, counted from 0.
    pub chosen_start: usize,
    /// Why the last training run ended.
    pub termination: Termination,
    /// Errors on data held out.
    pub validation: Option<Errors>,
    /// Penalties that a network was trained with.
    pub penalties: Option<Regularisation>,
    /// Every training run.
    pub runs: Vec<Run>,
    /// How the candidates did that it was chosen from.
    pub selection: Option<Selection>,
}

impl ProvenanceDraft {
    /// Of a fit from one start, without more that is known of it.
    pub fn of(options: FitSpec, termination: Termination) -> Self {
        let (validation, penalties, runs, selection) = Default::default();
        Self { options, chosen_start: 0, termination, validation, penalties, runs, selection }
    }

    fn on(self, data: &Dataset, train: Errors, train_after_warm_up: Option<Errors>) -> Provenance {
        let Self { options, chosen_start, termination, validation, penalties, runs, selection } = self;
        Provenance {
            options,
            samples: data.scored(),
            records: data.records().len(),
            chosen_start,
            termination,
            train,
            train_after_warm_up,
            validation,
            penalties,
            weighted: data.is_weighted(),
            runs,
            selection,
            lead_ins: lead_ins(data),
        }
    }
}

impl From<Provenance> for ProvenanceDraft {
    fn from(known: Provenance) -> Self {
        let Provenance { options, chosen_start, termination, validation, penalties, runs, selection, .. } =
            known;
        Self { options, chosen_start, termination, validation, penalties, runs, selection }
    }
}

/// A parameter of a model's law in the units of the model's columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterInUnits {
    /// The parameter, value and bounds in this unit.
    pub parameter: Parameter,
    /// Empty for a pure number, and if a unit is unknown.
    pub unit: String,
    /// Value in this unit over that in the law; not 1 where a quotient is shown as a pure number.
    pub factor: f64,
}

impl Model {
    /// A model with this part that simulates, which was trained on these data after the input transform.
    pub fn new(
        body: Predictor,
        preprocessing: InputTransform,
        rate: Option<RateMethod>,
        data: &Dataset,
        found: ProvenanceDraft,
    ) -> Result<Self> {
        let uses_rate = match &body {
            Predictor::Network { network, .. } => network.architecture().rate,
            Predictor::Law(_) => found.options.model().uses_rate(),
            Predictor::Ensemble(ensemble) => ensemble.members().iter().any(|member| member.rate.is_some()),
        };
        let rate = rate.filter(|_| uses_rate);
        let judged = begun(data, found.options.judged_beginning(data.names())?);
        let range = body.first_input_range(data.input_range(0));
        let runner = || Runner::of_body(&body, Some(&preprocessing), rate, range);
        let train = errors(runner(), &judged)?;
        let train_after_warm_up = match behind(&judged, warm_up(&body, &found.options)) {
            Some(behind) => Some(errors(runner(), &behind)?),
            None => None,
        };
        let provenance = found.on(data, train, train_after_warm_up);
        let is_periodic = data.begin_periodically();
        let mut model = Self {
            body,
            preprocessing,
            rate,
            names: data.names().clone(),
            trained: TrainedRanges {
                inputs: (0..data.names().inputs.len()).map(|input| data.input_range(input)).collect(),
                rate: None,
                output: data.output_range(),
                records: remembered(data),
            },
            lead_in: if is_periodic { Vec::new() } else { data.most_frequent_lead_in().to_vec() },
            is_periodic,
            beginning: KnownBeginning::default(),
            band: None,
            provenance,
        };
        if let Some(method) = rate {
            let mut range = (f64::INFINITY, f64::NEG_INFINITY);
            for record in data.records() {
                for rate in method.rate(record)? {
                    range = (range.0.min(rate), range.1.max(rate));
                }
            }
            model.trained.rate = Some(range);
        } else if let Predictor::Network { scaling, .. } = &mut model.body {
            scaling.rate = None;
        }
        Ok(model)
    }

    /// Reads the text of a model file.
    ///
    /// # Errors
    /// Text that is truncated, damaged, edited, of a later version, or no model.
    pub fn from_json(text: &str) -> Result<Self> {
        file::read(text)
    }

    /// The text of the model file.
    pub fn to_json(&self) -> String {
        file::write(self)
    }

    /// The name of the model, such as `xpnn+`.
    pub fn name(&self) -> ModelName {
        self.provenance.options.model()
    }

    /// Network, law or ensemble that simulates.
    pub fn predictor(&self) -> &Predictor {
        &self.body
    }

    /// The network, in scaled units; `None` for a classical law or an ensemble.
    pub fn network(&self) -> Option<&Network> {
        match &self.body {
            Predictor::Network { network, .. } => Some(network),
            Predictor::Law(_) | Predictor::Ensemble(_) => None,
        }
    }

    /// The law of a classical model; `None` for another model.
    pub fn law(&self) -> Option<&Classical> {
        match &self.body {
            Predictor::Law(law) => Some(law),
            Predictor::Network { .. } | Predictor::Ensemble(_) => None,
        }
    }

    /// The parameters of its law in the units of the columns; `None` for a network and an ensemble.
    pub fn law_parameters(&self) -> Option<Vec<ParameterInUnits>> {
        let names = self.names();
        let is_compressed = self.input_transform().compression.is_some();
        let input = of_column(&names.inputs[0]).filter(|_| !is_compressed);
        let (output, time) = (of_column(&names.output), names.time.as_deref().and_then(of_column));
        let (input, output, time) = (input.as_deref(), output.as_deref(), time.as_deref());
        let in_units = |mut parameter: Parameter| {
            let is_quotient = parameter.unit == Dimension::COMPLIANCE;
            match input.zip(output).filter(|_| is_quotient).and_then(|(x, y)| pure_quotient(x, y)) {
                Some(factor) => {
                    parameter.value *= factor;
                    parameter.bounds = (parameter.bounds.0 * factor, parameter.bounds.1 * factor);
                    ParameterInUnits { parameter, factor, unit: String::new() }
                }
                None => ParameterInUnits {
                    unit: parameter.unit.unit(input, output, time),
                    parameter,
                    factor: 1.0,
                },
            }
        };
        Some(self.law()?.parameters().into_iter().map(in_units).collect())
    }

    /// The ensemble; `None` for a single model.
    pub fn ensemble(&self) -> Option<&Ensemble> {
        match &self.body {
            Predictor::Ensemble(ensemble) => Some(ensemble),
            Predictor::Network { .. } | Predictor::Law(_) => None,
        }
    }

    /// The transform of its input.
    pub fn input_transform(&self) -> &InputTransform {
        &self.preprocessing
    }

    /// The range of the first input beyond which a record has been outside.
    fn first_input_range(&self) -> (f64, f64) {
        self.body.first_input_range(self.trained.inputs[0])
    }

    pub(crate) fn inputs(&self) -> usize {
        match &self.body {
            Predictor::Network { scaling, .. } => scaling.inputs.len() - self.preprocessing.added_inputs(),
            Predictor::Law(law) => {
                (1 + law.further_inputs()).saturating_sub(self.preprocessing.added_inputs())
            }
            Predictor::Ensemble(ensemble) => ensemble.members()[0].inputs(),
        }
    }

    /// Scale factors between the user's units and the network's; `None` for a model that is not a network.
    pub fn scaling(&self) -> Option<&Scaling> {
        match &self.body {
            Predictor::Network { scaling, .. } => Some(scaling),
            Predictor::Law(_) | Predictor::Ensemble(_) => None,
        }
    }

    /// Number of parameters that were determined from the data.
    pub fn parameters(&self) -> usize {
        match (&self.body, self.name()) {
            // All others are random.
            (Predictor::Network { network, .. }, ModelName::Classical(model)) if model.is_network() => {
                network.output().len()
            }
            (body, _) => body.parameters(),
        }
    }

    /// How the rate is found; `None` for a model without rate.
    pub fn rate(&self) -> Option<RateMethod> {
        self.rate
    }

    /// Names of the columns it was trained on.
    pub fn names(&self) -> &ColumnNames {
        &self.names
    }

    /// Ranges of the training data.
    pub fn trained_ranges(&self) -> &TrainedRanges {
        &self.trained
    }

    /// How it was fitted.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Elementary operations of a row in which the first input travels so far in so much time, roughly and at most.
    pub fn work_of_row(&self, travel: f64, time: f64) -> f64 {
        match &self.body {
            Predictor::Network { network, .. } => 20.0 + 4.0 * network.parameters().len() as f64,
            Predictor::Law(law) => law.work_of_row(travel, time),
            Predictor::Ensemble(ensemble) => {
                ensemble.members().iter().map(|member| member.work_of_row(travel, time)).sum()
            }
        }
    }

    /// The same of a row in which the input travels through the trained range.
    pub fn work_of_longest_row(&self) -> f64 {
        let (low, high) = self.trained.inputs.first().copied().unwrap_or_default();
        self.work_of_row(high - low, 0.0)
    }

    /// True if the model needs time stamps.
    pub fn needs_time(&self) -> bool {
        self.body.needs_steps() || self.rate.is_some_and(|rate| rate != RateMethod::Given)
    }

    /// The lead-in of a record that has none of its own: turning points in the unit of the input, of most training
    /// records.
    pub fn lead_in(&self) -> &[f64] {
        &self.lead_in
    }

    /// True if a record that has no lead-in of its own begins after one period of itself
    /// ([`InitialState::Periodic`]). Sample by sample the model then begins in the virgin state.
    pub fn is_periodic(&self) -> bool {
        self.is_periodic
    }

    /// The lead-in of an initial state for this model, with the range of its training data and its origin.
    ///
    /// # Errors
    /// An unknown state, which is found only in a fit, and a periodic one, which depends on the record.
    pub fn lead_in_of(&self, state: InitialState) -> Result<Vec<f64>> {
        let origins = match &self.body {
            Predictor::Ensemble(ensemble) => ensemble.members(),
            Predictor::Network { .. } | Predictor::Law(_) => std::slice::from_ref(self),
        };
        // Members that measure the input from the data have one origin, the others 0.
        let origin = origins.iter().map(|model| model.preprocessing.origin(0)).find(|origin| *origin != 0.0);
        state.lead_in(self.trained.inputs[0], origin.unwrap_or_default()).ok_or_else(|| {
            let known = InitialState::known().into_iter().filter(|name| *name != state.name());
            let needed = format!(
                "choose one of {}; without it the initial state is that of the training",
                known.collect::<Vec<_>>().join(", ")
            );
            OptionError::value("initial_state", state.name(), needed).into()
        })
    }

    /// The same model with another initial state for records that have none of their own.
    ///
    /// # Errors
    /// An unknown state.
    pub fn with_initial_state(mut self, state: InitialState) -> Result<Self> {
        self.is_periodic = state == InitialState::Periodic;
        self.lead_in = if self.is_periodic { Vec::new() } else { self.lead_in_of(state)? };
        Ok(self)
    }

    /// The training data with the lead-ins that their records had in training, where these differ or are periodic.
    pub fn as_trained<'d>(&self, data: &'d Dataset) -> Result<Cow<'d, Dataset>> {
        if self.is_periodic {
            return data.clone().with_periodic_lead_ins().map(Cow::Owned);
        }
        if self.provenance.lead_ins.is_empty() {
            return Ok(Cow::Borrowed(data));
        }
        let of_record = |_: usize, record: &Record| {
            let mut known = self.provenance.lead_ins.iter();
            let known = known.find(|known| known.record == record.name());
            known.map_or(&self.lead_in, |known| &known.lead_in).clone()
        };
        data.clone().with_lead_ins(of_record).map(Cow::Owned)
    }

    /// Simulates from the initial state of the model: the output at each sample of the input `x`, both in the units of the
    /// training data.
    ///
    /// # Errors
    /// A model of several inputs, or one that needs time stamps or a rate ([`Model::response`] takes them);
    /// an input that is empty, not finite or too large.
    pub fn run(&self, x: &[f64]) -> Result<Vec<f64>> {
        self.response(&Excitation::new("data", vec![x])?)
    }

    /// Simulates a record: the output of each row, in the user's unit, after the record's lead-in or the model's own.
    ///
    /// # Errors
    /// A record without what the model needs: its number of inputs, time stamps, a given rate.
    pub fn simulate(&self, record: &Record) -> Result<Vec<f64>> {
        self.response(&self.begun(record)?.excitation())
    }

    /// As [`Model::simulate`], from borrowed columns.
    pub fn response(&self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        self.check(excitation)?;
        Runner::of_model(self).record(excitation)
    }

    /// A simulation of records that are processed in blocks.
    pub fn simulation(&self) -> Simulation<'_> {
        Simulation::new(self, None)
    }

    /// The same with a prediction band, as of [`Model::predict`].
    ///
    /// # Errors
    /// A level outside its bounds, and a model without a band.
    pub fn simulation_with_band(&self, level: impl Into<BandLevel>) -> Result<Simulation<'_>> {
        let level = level.into();
        Ok(Simulation::new(self, Some((self.checked_band(level)?, level))))
    }

    /// Simulates a record as [`Model::simulate`], with a band that contains the measured output in this share of
    /// the rows, 0.5 to 0.99, if new data resemble those held out in training. That holds on average over data
    /// sets: in one it may be more or less. With a [`BandLevel`] the band is one that contains at least this share
    /// in so many of ten data sets.
    ///
    /// # Errors
    /// As [`Model::simulate`], a level outside these bounds, and a model without a band.
    pub fn predict(&self, excitation: &Excitation<'_>, level: impl Into<BandLevel>) -> Result<Prediction> {
        let level = level.into();
        let band = self.checked_band(level)?;
        self.check(excitation)?;
        let mut output = vec![0.0; excitation.len()];
        let mut spreads = vec![OutputSpread::default(); excitation.len()];
        Runner::of_model(self).rows(excitation, 0, &mut output, Some(&mut spreads))?;
        Ok(Prediction::of(Some((band, level)), output, &spreads))
    }

    fn checked_band(&self, level: BandLevel) -> Result<&Band> {
        level.check()?;
        self.band.as_ref().ok_or_else(|| Error::NoBand(self.name().name()))
    }

    /// The calibrated band, if there is one.
    pub fn band(&self) -> Option<&Band> {
        self.band.as_ref()
    }

    /// The same model with another [`Provenance`].
    pub fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = provenance;
        self
    }

    /// The same model with the ranges of these data, if it was trained on more than them.
    pub fn trained_on(self, data: &Dataset) -> Result<Self> {
        let Self { body, preprocessing, rate, band, provenance, .. } = self;
        Ok(Self::new(body, preprocessing, rate, data, provenance.into())?.with_band(band))
    }

    /// The same model with this band, at least as wide as its errors on these data require, or without one.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    pub fn with_band_over(self, band: Option<Band>, data: &Dataset) -> Result<Self> {
        let Some(band) = band else { return Ok(self.with_band(None)) };
        let mut errors = Predictions::default();
        for record in self.as_judged(data)?.records() {
            let mut output = vec![0.0; record.len()];
            let mut spreads = vec![OutputSpread::default(); record.len()];
            Runner::of_model(&self).rows(&record.excitation(), 0, &mut output, Some(&mut spreads))?;
            for ((y, simulated), spread) in record.output().iter().zip(output).zip(spreads) {
                if !y.is_nan() {
                    errors.push((y - simulated).abs() / band.scale(spread.disagreement), 1.0);
                }
            }
        }
        Ok(self.with_band(Some(band.at_least(&mut errors))))
    }

    /// The same model with this band, or without one.
    pub fn with_band(mut self, band: Option<Band>) -> Self {
        self.band = band;
        self
    }

    /// Errors of simulations of all records, as of [`Model::simulate`], against their measured outputs.
    ///
    /// # Errors
    /// As [`Model::simulate`], and data without any output.
    pub fn evaluate(&self, data: &Dataset) -> Result<Errors> {
        data.records().iter().try_for_each(|record| self.check(&record.excitation()))?;
        data.records().iter().try_for_each(|record| self.begun(record).map(drop))?;
        errors(Runner::of_model(self), &begun(data, self.beginning))
    }

    /// True for a model with inertia, or an ensemble with one.
    pub fn has_inertia(&self) -> bool {
        self.body.has_inertia()
    }

    /// Rows at the beginning of each record that were not scored in training (warm-up).
    pub fn warm_up(&self) -> usize {
        warm_up(&self.body, &self.provenance.options)
    }

    /// As [`Model::evaluate`], of the rows after the warm-up only; `None` for a model without a warm-up, and
    /// if no row with an output is left.
    pub fn evaluate_after_warm_up(&self, data: &Dataset) -> Result<Option<Errors>> {
        behind(data, self.warm_up()).map(|behind| self.evaluate(&behind)).transpose()
    }

    /// Checks that an excitation has what the model needs.
    fn check(&self, excitation: &Excitation<'_>) -> Result<()> {
        excitation.state().map_or(Ok(()), |state| self.check_state(state))?;
        if self.needs_time() && excitation.time().is_none() {
            return Err(excitation.defect(None, Some(Channel::Time), DataProblem::NoTimeForModel));
        }
        Ok(())
    }

    /// A sample-by-sample simulation from the initial state of the model, for control loops and structural analyses.
    pub fn stepper(&self) -> Stepper<'_> {
        Stepper::new(Cow::Borrowed(self))
    }

    /// As [`Model::stepper`]; the stepper owns the model.
    pub fn into_stepper(self) -> Stepper<'static> {
        Stepper::new(Cow::Owned(self))
    }

    /// Removes what the members of an ensemble have in common.
    fn forget_records(&mut self) {
        self.trained.records.clear();
        self.lead_in.clear();
        self.is_periodic = false;
        self.provenance.lead_ins.clear();
    }

    /// True if the model stores this fingerprint among those of its training records.
    pub fn was_trained_on(&self, record: &Fingerprint) -> bool {
        record.text().is_some_and(|text| self.trained.records.contains(&text))
    }

    /// Warnings of records that are equal to training records of the model.
    pub fn known_records(&self, data: &Dataset) -> Vec<Warning> {
        let known = data.records().iter().filter(|record| self.was_trained_on(&record.fingerprint()));
        let warning =
            |record: &Record| Warning::TrainedOn { record: record.name().into(), likeness: Likeness::Equal };
        known.map(warning).collect()
    }

    /// Warnings of inputs and rates outside the range of the training data.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn range_warnings(&self, data: &Dataset) -> Result<Vec<Warning>> {
        let mut ranges = Ranges::of(self);
        for record in data.records() {
            let rate = self.rate.map(|method| method.rate(record)).transpose()?;
            let inputs: Vec<&[f64]> = record.inputs().iter().map(|input| &**input).collect();
            ranges.take(&inputs, rate.as_deref());
        }
        Ok(ranges.warnings())
    }
}
