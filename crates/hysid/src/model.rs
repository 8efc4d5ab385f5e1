//! A fitted model: a network, its scaling, what it was trained on and how. It simulates in the user's
//! units.

mod file;

use serde::{Deserialize, Serialize};

use crate::error::{Channel, DataProblem, Error, Result};
use crate::free_run::FreeRun;
use crate::metrics::Errors;
use crate::network::{Family, Network, Simulator};
use crate::rate::RateMethod;
use crate::record::{ColumnNames, Dataset, Record};
use crate::scaling::Scaling;
use crate::training::history::Run;
use crate::training::options::FitOptions;
use crate::training::termination::Termination;
use crate::warning::Warning;

pub use file::FORMAT_VERSION;

/// A fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    family: Family,
    network: Network,
    scaling: Scaling,
    rate: Option<RateMethod>,
    names: ColumnNames,
    trained: TrainedRanges,
    provenance: Provenance,
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
    /// The options it was given.
    pub options: FitOptions,
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
        family: Family,
        network: Network,
        scaling: Scaling,
        rate: Option<RateMethod>,
        data: &Dataset,
        provenance: Provenance,
    ) -> Result<Self> {
        let rate = rate.filter(|_| network.architecture().rate);
        let mut model = Self {
            family,
            network,
            scaling,
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
        } else {
            model.scaling.rate = None;
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

    /// The network family.
    pub fn family(&self) -> Family {
        self.family
    }

    /// The network, in scaled units.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Factors between the user's units and the network's.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
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
        self.network.architecture().relaxation > 0 || self.rate.is_some_and(|rate| rate != RateMethod::Given)
    }

    /// Free run over a record from the virgin state: the output of each row, in the user's unit. The
    /// record's own output is not looked at.
    ///
    /// # Errors
    /// A record without what the model needs: its number of inputs, time stamps, a given rate.
    pub fn simulate(&self, record: &Record) -> Result<Vec<f64>> {
        self.check_time(record)?;
        FreeRun::new(&self.network, &self.scaling, self.rate).record(record)
    }

    /// Errors of free runs over all records.
    ///
    /// # Errors
    /// As [`Model::simulate`], and data without any output.
    pub fn evaluate(&self, data: &Dataset) -> Result<Errors> {
        data.records().iter().try_for_each(|record| self.check_time(record))?;
        FreeRun::new(&self.network, &self.scaling, self.rate).errors(data)
    }

    fn check_time(&self, record: &Record) -> Result<()> {
        if self.needs_time() && record.time().is_none() {
            return Err(record.defect(None, Some(Channel::Time), DataProblem::NoTimeForModel));
        }
        Ok(())
    }

    /// Sample-by-sample simulation from the virgin state, for control loops and structural analyses.
    pub fn stepper(&self) -> Stepper<'_> {
        Stepper {
            model: self,
            simulator: self.network.simulator(),
            u: vec![0.0; self.network.architecture().channels()],
            last: None,
        }
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
    simulator: Simulator,
    u: Vec<f64>,
    /// Time and first input of the last sample.
    last: Option<(f64, f64)>,
}

impl Stepper<'_> {
    /// The next sample: inputs and time in the user's units, `time` of no matter for a model that
    /// needs none. `rate` is that of the first input, for a model with one; without it a backward
    /// difference is taken (0 at the first sample).
    ///
    /// # Errors
    /// Another number of inputs, a value that is not finite, or time that does not advance.
    pub fn step(&mut self, inputs: &[f64], time: f64, rate: Option<f64>) -> Result<f64> {
        let scaling = &self.model.scaling;
        if inputs.len() != scaling.inputs.len() {
            return Err(Error::Option(format!(
                "{} inputs where the model has {}",
                inputs.len(),
                scaling.inputs.len()
            )));
        }
        let elapsed = match self.last {
            Some((before, _)) => time - before,
            None => 0.0,
        };
        if self.model.needs_time() && !(time.is_finite() && (self.last.is_none() || elapsed > 0.0)) {
            return Err(Error::Option(format!("time {time} does not come after the last sample's")));
        }
        let mut u = self.u.iter_mut();
        for (input, (&x, &scale)) in inputs.iter().zip(&scaling.inputs).enumerate() {
            *u.next().expect("a channel for each input") = x * (1.0 / scale);
            if input == 0
                && let Some(scale) = scaling.rate
            {
                let backward = match self.last {
                    Some((_, before)) => (x - before) / elapsed,
                    None => 0.0,
                };
                *u.next().expect("a channel for the rate") = rate.unwrap_or(backward) * (1.0 / scale);
            }
        }
        if let Some(bad) = self.u.iter().find(|u| !u.is_finite()) {
            return Err(Error::Option(format!("an input or its rate is {bad}, not a finite number")));
        }
        self.last = Some((time, inputs[0]));
        Ok(scaling.output(self.simulator.step(&self.u, elapsed)))
    }

    /// Back to the virgin state.
    pub fn reset(&mut self) {
        self.simulator.reset();
        self.last = None;
    }
}
