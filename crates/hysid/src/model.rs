//! A fitted model: a network with its scaling or a classical law, what it was trained on and how. It
//! simulates in the user's units.

mod file;

use serde::{Deserialize, Serialize};

use crate::classical::identification::Rival;
use crate::classical::series::Series;
use crate::classical::{Classical, ClassicalState, Law, Sample};
use crate::error::{Channel, DataProblem, Error, Result};
use crate::free_run::FreeRun;
use crate::identification::{ModelName, Request};
use crate::metrics::{ErrorSums, Errors};
use crate::network::{Network, Simulator};
use crate::rate::RateMethod;
use crate::record::{ColumnNames, Dataset, Record};
use crate::scaling::Scaling;
use crate::training::history::Run;
use crate::training::termination::Termination;
use crate::warning::Warning;

pub use file::FORMAT_VERSION;

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    body: Body,
    rate: Option<RateMethod>,
    names: ColumnNames,
    trained: TrainedRanges,
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
}

impl Body {
    /// Free run over a record from the virgin state, in the user's unit.
    fn simulate(&self, rate: Option<RateMethod>, record: &Record) -> Result<Vec<f64>> {
        match self {
            Self::Network { network, scaling } => FreeRun::new(network, scaling, rate).record(record),
            Self::Law(law) => {
                if record.inputs().len() != 1 {
                    let problem = DataProblem::Inputs { expected: 1, found: record.inputs().len() };
                    return Err(record.defect(None, None, problem));
                }
                Ok(law.run(&Series::of(record, rate)?.samples))
            }
        }
    }

    /// Errors of free runs over all records that have an output.
    pub(crate) fn errors(&self, rate: Option<RateMethod>, data: &Dataset) -> Result<Errors> {
        if let Self::Network { network, scaling } = self {
            return FreeRun::new(network, scaling, rate).errors(data);
        }
        let mut sums = ErrorSums::default();
        for record in data.records().iter().filter(|record| record.scored() > 0) {
            sums.add(record.output(), &self.simulate(rate, record)?);
        }
        sums.errors(&data.names().output)
            .ok_or_else(|| data.records()[0].defect(None, Some(Channel::Output), DataProblem::NothingToScore))
    }

    /// Number of inputs.
    fn inputs(&self) -> usize {
        match self {
            Self::Network { scaling, .. } => scaling.inputs.len(),
            Self::Law(_) => 1,
        }
    }

    /// Parameters that were found from the data.
    fn parameters(&self) -> usize {
        match self {
            Self::Network { network, .. } => network.architecture().parameters(),
            Self::Law(law) => law.parameters().len(),
        }
    }

    fn relaxes(&self) -> bool {
        matches!(self, Self::Network { network, .. } if network.architecture().relaxation > 0)
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
}

impl Model {
    pub(crate) fn new(
        body: Body,
        rate: Option<RateMethod>,
        data: &Dataset,
        provenance: Provenance,
    ) -> Result<Self> {
        let uses_rate = match &body {
            Body::Network { network, .. } => network.architecture().rate,
            Body::Law(_) => provenance.options.model().uses_rate(),
        };
        let rate = rate.filter(|_| uses_rate);
        let mut model = Self {
            body,
            rate,
            names: data.names().clone(),
            trained: TrainedRanges {
                inputs: (0..data.names().inputs.len()).map(|input| data.input_range(input)).collect(),
                rate: None,
                output: data.output_range(),
            },
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

    /// The network, in scaled units; `None` for a classical law.
    pub fn network(&self) -> Option<&Network> {
        match &self.body {
            Body::Network { network, .. } => Some(network),
            Body::Law(_) => None,
        }
    }

    /// Factors between the user's units and the network's; `None` for a classical law, which needs none.
    pub fn scaling(&self) -> Option<&Scaling> {
        match &self.body {
            Body::Network { scaling, .. } => Some(scaling),
            Body::Law(_) => None,
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
        self.body.relaxes() || self.rate.is_some_and(|rate| rate != RateMethod::Given)
    }

    /// Free run over a record from the virgin state: the output of each row, in the user's unit. The
    /// record's own output is not looked at.
    ///
    /// # Errors
    /// A record without what the model needs: its number of inputs, time stamps, a given rate.
    pub fn simulate(&self, record: &Record) -> Result<Vec<f64>> {
        self.check_time(record)?;
        self.body.simulate(self.rate, record)
    }

    /// Errors of free runs over all records.
    ///
    /// # Errors
    /// As [`Model::simulate`], and data without any output.
    pub fn evaluate(&self, data: &Dataset) -> Result<Errors> {
        data.records().iter().try_for_each(|record| self.check_time(record))?;
        self.body.errors(self.rate, data)
    }

    fn check_time(&self, record: &Record) -> Result<()> {
        if self.needs_time() && record.time().is_none() {
            return Err(record.defect(None, Some(Channel::Time), DataProblem::NoTimeForModel));
        }
        Ok(())
    }

    /// Sample-by-sample simulation from the virgin state, for control loops and structural analyses.
    pub fn stepper(&self) -> Stepper<'_> {
        let memory = match &self.body {
            Body::Network { network, .. } => {
                Memory::Network(Box::new(network.simulator()), vec![0.0; network.architecture().channels()])
            }
            Body::Law(law) => Memory::Law(law.virgin()),
        };
        Stepper { model: self, memory, last: None }
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

/// A model that is run sample by sample. Fed with the rates that [`Model::simulate`] would use, it
/// gives the same outputs to the last bit.
#[derive(Debug, Clone)]
pub struct Stepper<'m> {
    model: &'m Model,
    memory: Memory,
    /// Time and first input of the last sample.
    last: Option<(f64, f64)>,
}

/// What a stepper knows of the past.
#[derive(Debug, Clone)]
enum Memory {
    /// A network's simulator, and room for its channels.
    Network(Box<Simulator>, Vec<f64>),
    Law(ClassicalState),
}

impl Stepper<'_> {
    /// The next sample: inputs and time in the user's units, `time` of no matter for a model that
    /// needs none. `rate` is that of the first input, for a model with one; without it a backward
    /// difference is taken (0 at the first sample).
    ///
    /// # Errors
    /// Another number of inputs, a value that is not finite, or time that does not advance.
    pub fn step(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        let expected = self.model.body.inputs();
        if inputs.len() != expected {
            return Err(Error::Option(format!("{} inputs where the model has {expected}", inputs.len())));
        }
        let elapsed = match self.last {
            Some((before, _)) => time - before,
            None => 0.0,
        };
        if self.model.needs_time() && !(time.is_finite() && (self.last.is_none() || elapsed > 0.0)) {
            return Err(Error::Option(format!("time {time} does not come after the last sample's")));
        }
        let rate = self.model.rate.map(|_| {
            let backward = self.last.map_or(0.0, |(_, before)| (inputs[0] - before) / elapsed);
            rate.unwrap_or(backward)
        });
        if let Some(bad) = inputs.iter().chain(&rate).find(|value| !value.is_finite()) {
            return Err(Error::Option(format!("an input or its rate is {bad}, not a finite number")));
        }
        let y = match (&self.model.body, &mut self.memory) {
            (Body::Network { scaling, .. }, Memory::Network(simulator, u)) => {
                let mut channels = u.iter_mut();
                for (input, (&x, &scale)) in inputs.iter().zip(&scaling.inputs).enumerate() {
                    *channels.next().expect("a channel for each input") = x * (1.0 / scale);
                    if input == 0
                        && let Some((rate, scale)) = rate.zip(scaling.rate)
                    {
                        *channels.next().expect("a channel for the rate") = rate * (1.0 / scale);
                    }
                }
                if let Some(bad) = u.iter().find(|u| !u.is_finite()) {
                    return Err(Error::Option(format!("an input or its rate is {bad}, not a finite number")));
                }
                scaling.output(simulator.step(u, elapsed))
            }
            (Body::Law(law), Memory::Law(state)) => {
                let step = if self.model.needs_time() { elapsed } else { 0.0 };
                law.step(state, Sample { x: inputs[0], rate: rate.unwrap_or(0.0), step })
            }
            _ => unreachable!("the memory was made for the body"),
        };
        self.last = Some((time, inputs[0]));
        Ok(y)
    }

    /// Back to the virgin state.
    pub fn reset(&mut self) {
        match (&self.model.body, &mut self.memory) {
            (Body::Law(law), Memory::Law(state)) => *state = law.virgin(),
            (_, Memory::Network(simulator, _)) => simulator.reset(),
            _ => unreachable!("the memory was made for the body"),
        }
        self.last = None;
    }
}
