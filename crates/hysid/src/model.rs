//! A fitted model: a network with its scaling, a classical law, or an ensemble of both; what it was trained
//! on and how. It simulates in the user's units.

mod band;
mod ensemble;
mod file;
mod stepper;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::automatic::Selection;
use crate::classical::identification::Rival;
use crate::classical::series::samples;
use crate::classical::{Classical, Law};
use crate::error::{Channel, DataProblem, Error, Result};
use crate::free_run::FreeRun;
use crate::identification::{ModelName, Request};
use crate::metrics::{ErrorSums, Errors};
use crate::network::Network;
use crate::preprocessing::Preprocessing;
use crate::rate::RateMethod;
use crate::record::{ColumnNames, Dataset, Excitation, Record};
use crate::scaling::Scaling;
use crate::training::history::Run;
use crate::training::termination::Termination;
use crate::warning::Warning;

pub use band::{BAND_PROBABILITIES, Band, Prediction};
pub(crate) use band::{HeldOutRow, disagreement};
use ensemble::Answer;
pub use ensemble::{Ensemble, Group, Speaker, Voice, Weights};
pub(crate) use ensemble::{Excursion, Votes};
pub use file::FORMAT_VERSION;
pub use stepper::Stepper;

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    body: Body,
    preprocessing: Preprocessing,
    rate: Option<RateMethod>,
    names: ColumnNames,
    trained: TrainedRanges,
    band: Option<Band>,
    provenance: Provenance,
}

/// What simulates.
#[derive(Debug, Clone, PartialEq)]
pub enum Body {
    /// A network in scaled units, and the factors to the user's.
    Network {
        /// The network.
        network: Network,
        /// Factors between the user's units and the network's.
        scaling: Scaling,
    },
    /// A classical law in the user's units.
    Law(Classical),
    /// Several models that answer together.
    Ensemble(Ensemble),
}

impl Body {
    /// Free run over a record from the virgin state, in the user's unit.
    fn response(&self, rate: Option<RateMethod>, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        match self {
            Self::Network { network, scaling } => FreeRun::new(network, scaling, rate).response(excitation),
            Self::Law(law) => {
                if excitation.inputs().len() != 1 {
                    let problem = DataProblem::Inputs { expected: 1, found: excitation.inputs().len() };
                    return Err(excitation.defect(None, None, problem));
                }
                Ok(law.run(&samples(excitation, rate)?))
            }
            Self::Ensemble(ensemble) => ensemble.simulate(excitation),
        }
    }

    /// Errors of free runs over all records that have an output.
    pub(crate) fn errors(&self, rate: Option<RateMethod>, data: &Dataset) -> Result<Errors> {
        if let Self::Network { network, scaling } = self {
            return FreeRun::new(network, scaling, rate).errors(data);
        }
        let mut sums = ErrorSums::default();
        for record in data.records().iter().filter(|record| record.scored() > 0) {
            sums.add(record.output(), &self.response(rate, &record.excitation())?);
        }
        sums.errors(&data.names().output)
            .ok_or_else(|| data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore))
    }

    /// Parameters that were found from the data.
    fn parameters(&self) -> usize {
        match self {
            Self::Network { network, .. } => network.architecture().parameters(),
            Self::Law(law) => law.parameters().len(),
            Self::Ensemble(ensemble) => ensemble.members().iter().map(|member| member.parameters()).sum(),
        }
    }

    /// True if it needs the time between samples, apart from any rate.
    fn needs_steps(&self) -> bool {
        match self {
            Self::Network { network, .. } => network.architecture().relaxation > 0,
            Self::Law(_) => false,
            Self::Ensemble(ensemble) => ensemble.members().iter().any(|member| member.needs_time()),
        }
    }
}

/// Smallest and largest values seen in training, in the user's units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedRanges {
    /// Of each input.
    pub inputs: Vec<(f64, f64)>,
    /// Of the rate of the first input, if the model has one.
    pub rate: Option<(f64, f64)>,
    /// Of the output.
    pub output: (f64, f64),
}

/// How a model came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// What was asked for.
    pub options: Request,
    /// Rows with an output.
    pub samples: usize,
    /// Records.
    pub records: usize,
    /// The start that became the model, counted from 0.
    pub chosen_start: usize,
    /// Why the last training run ended.
    pub termination: Termination,
    /// Errors of the model on all data it was trained on, free run.
    pub train: Errors,
    /// Errors of the chosen start on the data held out, before it was trained on everything; `None`
    /// if the data were too few to hold any out.
    pub validation: Option<Errors>,
    /// Every training run.
    pub runs: Vec<Run>,
    /// How the candidates did that it was chosen from; `None` where there was no choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selection: Option<Selection>,
}

impl Model {
    /// A model of these data, whose body was trained on them after the preprocessing.
    pub(crate) fn new(
        body: Body,
        preprocessing: Preprocessing,
        rate: Option<RateMethod>,
        data: &Dataset,
        provenance: Provenance,
    ) -> Result<Self> {
        let uses_rate = match &body {
            Body::Network { network, .. } => network.architecture().rate,
            Body::Law(_) => provenance.options.model().uses_rate(),
            Body::Ensemble(ensemble) => ensemble.members().iter().any(|member| member.rate.is_some()),
        };
        let rate = rate.filter(|_| uses_rate);
        let mut model = Self {
            body,
            preprocessing,
            rate,
            names: data.names().clone(),
            trained: TrainedRanges {
                inputs: (0..data.names().inputs.len()).map(|input| data.input_range(input)).collect(),
                rate: None,
                output: data.output_range(),
            },
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
        } else if let Body::Network { scaling, .. } = &mut model.body {
            scaling.rate = None;
        }
        Ok(model)
    }

    /// Reads a model file's text.
    ///
    /// # Errors
    /// Text that is cut off, damaged, edited, of a later version, or no model at all.
    pub fn from_json(text: &str) -> Result<Self> {
        file::read(text)
    }

    /// The text of the model file.
    pub fn to_json(&self) -> String {
        file::write(self)
    }

    /// Which model it is.
    pub fn name(&self) -> ModelName {
        self.provenance.options.model()
    }

    /// What simulates.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The network, in scaled units; `None` for a classical law or an ensemble.
    pub fn network(&self) -> Option<&Network> {
        match &self.body {
            Body::Network { network, .. } => Some(network),
            Body::Law(_) | Body::Ensemble(_) => None,
        }
    }

    /// The ensemble; `None` for a single model.
    pub fn ensemble(&self) -> Option<&Ensemble> {
        match &self.body {
            Body::Ensemble(ensemble) => Some(ensemble),
            Body::Network { .. } | Body::Law(_) => None,
        }
    }

    /// How the model sees its input.
    pub fn preprocessing(&self) -> Preprocessing {
        self.preprocessing
    }

    /// Number of inputs of a record.
    pub(crate) fn inputs(&self) -> usize {
        match &self.body {
            Body::Network { scaling, .. } => scaling.inputs.len() - self.preprocessing.added_inputs(),
            Body::Law(_) => 1,
            Body::Ensemble(ensemble) => ensemble.members()[0].inputs(),
        }
    }

    /// Factors between the user's units and the network's; `None` for all that is no network.
    pub fn scaling(&self) -> Option<&Scaling> {
        match &self.body {
            Body::Network { scaling, .. } => Some(scaling),
            Body::Law(_) | Body::Ensemble(_) => None,
        }
    }

    /// Number of parameters that were found from the data.
    pub fn parameters(&self) -> usize {
        match (&self.body, self.name()) {
            // All others are random.
            (Body::Network { network, .. }, ModelName::Rival(Rival::RandomStops)) => network.output().len(),
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

    /// How it came about.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// True if the model needs time stamps.
    pub fn needs_time(&self) -> bool {
        self.body.needs_steps() || self.rate.is_some_and(|rate| rate != RateMethod::Given)
    }

    /// Free run over a record from the virgin state: the output of each row, in the user's unit. The
    /// record's own output is not looked at.
    ///
    /// # Errors
    /// A record without what the model needs: its number of inputs, time stamps, a given rate.
    pub fn simulate(&self, record: &Record) -> Result<Vec<f64>> {
        self.response(&record.excitation())
    }

    /// As [`Model::simulate`], of an excitation that is read where it lies.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    pub fn response(&self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        self.check_time(excitation)?;
        match self.preprocessing.columns(excitation, self.rate)? {
            None => self.body.response(self.rate, excitation),
            Some(seen) => {
                let rate = self.rate.map(|_| RateMethod::Given);
                self.body.response(rate, &seen.excitation(excitation)?)
            }
        }
    }

    /// Free run over a record with a band that holds the measured output with this probability, 0.5 to 0.99,
    /// as far as new data are like those held out in training.
    ///
    /// # Errors
    /// As [`Model::simulate`], a probability outside these bounds, and a model without a band.
    pub fn predict(&self, excitation: &Excitation<'_>, probability: f64) -> Result<Prediction> {
        Band::check(probability)?;
        let Some(band) = &self.band else {
            return Err(Error::Option(format!(
                "this model of {} has no band: `--model auto` calibrates one where the data are enough to hold some out",
                self.name().name()
            )));
        };
        self.check_time(excitation)?;
        let answers = match &self.body {
            Body::Ensemble(ensemble) => ensemble.answers(excitation)?,
            Body::Network { .. } | Body::Law(_) => {
                let mut excursion = Excursion::beyond(self.trained.inputs[0]);
                let output = self.response(excitation)?.into_iter();
                let answer = |(output, x): (f64, &f64)| Answer {
                    output,
                    disagreement: 0.0,
                    outside: excursion.take(*x),
                };
                output.zip(excitation.inputs()[0]).map(answer).collect()
            }
        };
        let half = |answer: &Answer| band.half_width(probability, answer.disagreement, answer.outside);
        Ok(Prediction {
            low: answers.iter().map(|answer| answer.output - half(answer)).collect(),
            high: answers.iter().map(|answer| answer.output + half(answer)).collect(),
            output: answers.into_iter().map(|answer| answer.output).collect(),
        })
    }

    /// The calibrated band, if there is one.
    pub fn band(&self) -> Option<&Band> {
        self.band.as_ref()
    }

    pub(crate) fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = provenance;
        self
    }

    /// With the ranges of these data, where it was trained on more than them.
    pub(crate) fn trained_on(self, data: &Dataset) -> Result<Self> {
        let Self { body, preprocessing, rate, band, provenance, .. } = self;
        Ok(Self::new(body, preprocessing, rate, data, provenance)?.with_band(band))
    }

    pub(crate) fn with_band(mut self, band: Option<Band>) -> Self {
        self.band = band;
        self
    }

    /// Errors of free runs over all records.
    ///
    /// # Errors
    /// As [`Model::simulate`], and data without any output.
    pub fn evaluate(&self, data: &Dataset) -> Result<Errors> {
        data.records().iter().try_for_each(|record| self.check_time(&record.excitation()))?;
        let (seen, rate) = self.preprocessing.data(data, self.rate)?;
        self.body.errors(rate, &seen)
    }

    fn check_time(&self, excitation: &Excitation<'_>) -> Result<()> {
        if self.needs_time() && excitation.time().is_none() {
            return Err(excitation.defect(None, Some(Channel::Time), DataProblem::NoTimeForModel));
        }
        Ok(())
    }

    /// Sample-by-sample simulation from the virgin state, for control loops and structural analyses.
    pub fn stepper(&self) -> Stepper<'_> {
        Stepper::new(Cow::Borrowed(self))
    }

    /// As [`Model::stepper`], of a model that it keeps.
    pub fn into_stepper(self) -> Stepper<'static> {
        Stepper::new(Cow::Owned(self))
    }

    /// Warns of inputs and rates beyond what the model was trained on.
    ///
    /// # Errors
    /// A rate that cannot be computed.
    pub fn range_warnings(&self, data: &Dataset) -> Result<Vec<Warning>> {
        let mut warnings = Vec::new();
        let mut check = |name: String, trained: (f64, f64), values: &mut dyn Iterator<Item = f64>| {
            // A rounding beyond the range is not outside it.
            let slack = 1e-9 * (trained.1 - trained.0);
            let (mut rows, mut outside, mut seen) = (0usize, 0usize, (f64::INFINITY, f64::NEG_INFINITY));
            for value in values {
                rows += 1;
                outside += usize::from(value < trained.0 - slack || value > trained.1 + slack);
                seen = (seen.0.min(value), seen.1.max(value));
            }
            if outside > 0 {
                let share_percent = 100.0 * outside as f64 / rows as f64;
                warnings.push(Warning::OutsideTrainedRange { name, share_percent, trained, seen });
            }
        };
        for (input, name) in self.names.inputs.iter().enumerate() {
            let mut values = data.records().iter().flat_map(|record| record.inputs()[input].iter().copied());
            check(name.clone(), self.trained.inputs[input], &mut values);
        }
        if let (Some(method), Some(trained)) = (self.rate, self.trained.rate) {
            let rates: Result<Vec<Vec<f64>>> =
                data.records().iter().map(|record| method.rate(record)).collect();
            let name = format!("the rate of {}", self.names.inputs[0]);
            check(name, trained, &mut rates?.into_iter().flatten());
        }
        Ok(warnings)
    }
}
