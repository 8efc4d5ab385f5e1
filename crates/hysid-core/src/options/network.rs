//! Options of the fit of a network.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::data::known_beginning::KnownSpan;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::network::{Architecture, Family, Sizes};
use crate::options::input_options::{HISTORY_INPUTS, InputOptions};

/// How networks are trained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trainer {
    /// Levenberg-Marquardt from several starts.
    LevenbergMarquardt,
    /// The paper's: a genetic algorithm, then the sub-gradient method from its best individual.
    Hybrid,
    /// The genetic algorithm alone.
    Genetic,
    /// The sub-gradient method with space dilatation from several starts.
    #[default]
    Subgradient,
}

/// An optimization method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Levenberg-Marquardt.
    #[default]
    LevenbergMarquardt,
    /// The genetic algorithm; an epoch is a generation.
    Genetic,
    /// The sub-gradient method with space dilatation; an epoch is an outer iteration.
    Subgradient,
    /// Multi-start least squares of a classical model; an epoch is a round of all its starts.
    LeastSquares,
}

impl Trainer {
    /// All trainers.
    pub const ALL: [Trainer; 4] =
        [Trainer::Subgradient, Trainer::LevenbergMarquardt, Trainer::Hybrid, Trainer::Genetic];

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Trainer::LevenbergMarquardt => "levenberg-marquardt",
            Trainer::Hybrid => "hybrid",
            Trainer::Genetic => "genetic",
            Trainer::Subgradient => "subgradient",
        }
    }

    /// Default number of starts: 1 where a population is the start.
    pub fn default_starts(self) -> usize {
        match self {
            Trainer::LevenbergMarquardt => 8,
            Trainer::Subgradient => 2,
            Trainer::Hybrid | Trainer::Genetic => 1,
        }
    }

    /// Default number of epochs.
    pub fn default_epochs(self) -> usize {
        match self {
            Trainer::LevenbergMarquardt => 40,
            Trainer::Subgradient => 400,
            Trainer::Hybrid | Trainer::Genetic => 2000,
        }
    }

    /// True if it uses a genetic algorithm.
    pub fn is_genetic(self) -> bool {
        matches!(self, Trainer::Hybrid | Trainer::Genetic)
    }

    /// Its methods, one after another, and the epochs of each.
    pub fn plan(self, epochs: usize) -> Vec<(Method, usize)> {
        match self {
            Trainer::LevenbergMarquardt => vec![(Method::LevenbergMarquardt, epochs)],
            Trainer::Hybrid => {
                vec![(Method::Genetic, epochs / 2), (Method::Subgradient, epochs - epochs / 2)]
            }
            Trainer::Genetic => vec![(Method::Genetic, epochs)],
            Trainer::Subgradient => vec![(Method::Subgradient, epochs)],
        }
    }
}

impl std::str::FromStr for Trainer {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        Trainer::ALL.into_iter().find(|trainer| trainer.name() == name).ok_or_else(|| {
            let known = Trainer::ALL.map(Trainer::name).into();
            Error::UnknownName { what: "training", name: name.into(), known }
        })
    }
}

/// Options of the fit of a network. Each field has the name of its command-line option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The network family.
    pub model: Family,
    /// Numbers of neurons.
    #[serde(flatten)]
    pub sizes: Sizes,
    /// True for stops that do not deteriorate, in any family.
    pub no_deterioration: bool,
    /// Method of the rate; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// Input transform.
    #[serde(default, skip_serializing_if = "InputOptions::is_none")]
    pub shaping: InputOptions,
    /// Known beginning of the records that the model will be used on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownSpan>,
    /// The trainer.
    pub training: Trainer,
    /// Number of random networks, or populations, to start from; the lowest objective becomes the model.
    pub starts: usize,
    /// Epochs of each start: Levenberg-Marquardt iterations, generations, or outer iterations of the
    /// sub-gradient method. In a hybrid each of its two methods has half of them.
    pub epochs: usize,
    /// Individuals of the genetic algorithm.
    pub population: usize,
    /// Epochs without a relative improvement of 1e-4 after which a method ends; 0 for never.
    pub stall: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Share of the data that is held out for the validation error; `None` for cross-validation.
    pub validation: Option<f64>,
    /// λ: penalty `½ λ ‖c‖²` on the output weights `c`, in scaled units (theory.md (3.1)); `None` for the default.
    pub ridge: Option<f64>,
    /// κ: penalty `½ κ ‖θ‖²` on the weights of stops, linear and tanh neurons (theory.md (3.1)).
    pub decay: Option<f64>,
    /// Largest number of scored rows of the iterations. If there are more rows, those on straight parts of the path of
    /// the inputs are left out. The output weights, and the last iterations of Levenberg-Marquardt, use all rows.
    pub thin: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self::of(Trainer::default())
    }
}

impl FitOptions {
    /// The defaults of a trainer.
    pub fn of(training: Trainer) -> Self {
        Self {
            model: Family::XpnnPlus,
            sizes: Sizes::default(),
            no_deterioration: false,
            rate: None,
            shaping: InputOptions::default(),
            known: None,
            training,
            starts: training.default_starts(),
            epochs: training.default_epochs(),
            population: 50,
            stall: 50,
            seed: SEED,
            validation: None,
            ridge: None,
            decay: None,
            thin: 20_000,
        }
    }

    /// The architecture for these data.
    ///
    /// # Errors
    /// Sizes or a number of inputs that the family does not have.
    pub fn architecture(&self, data: &Dataset) -> Result<Architecture> {
        let added = if self.shaping.history { HISTORY_INPUTS } else { 0 };
        let (inputs, rate) = (data.names().inputs.len() + added, self.rate.is_some());
        let mut architecture = Architecture::new(self.model, self.sizes, inputs, rate, data.has_time())?;
        architecture.deterioration &= !self.no_deterioration;
        Ok(architecture)
    }

    /// The requested penalties, or the defaults.
    pub fn penalties(&self) -> Regularisation {
        let defaults = Regularisation::default();
        Regularisation {
            ridge: self.ridge.unwrap_or(defaults.ridge),
            decay: self.decay.unwrap_or(defaults.decay),
        }
    }

    /// True if the requested penalties must not be changed.
    pub fn keeps_penalties(&self) -> bool {
        self.ridge.is_some() || self.decay.is_some()
    }

    /// True if the stops deteriorate.
    pub fn deteriorates(&self) -> bool {
        !self.no_deterioration && self.model.deteriorates()
    }
}

/// Default seed.
pub const SEED: u64 = 1;

/// Smallest and largest population.
pub const POPULATIONS: RangeInclusive<usize> = 4..=100_000;

/// Largest number of epochs of a start.
pub const MOST_EPOCHS: usize = 1_000_000;

/// Largest number of starts.
pub const MOST_STARTS: usize = 10_000;

/// Penalties on the weights, in scaled units: `½ λ ‖c‖² + ½ κ ‖θ‖²` of the objective (theory.md (3.1)).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Regularisation {
    /// λ, on the output weights `c`.
    pub ridge: f64,
    /// κ, on the weights `θ` of stops, linear neuron and tanh neurons.
    pub decay: f64,
}

impl Default for Regularisation {
    fn default() -> Self {
        Self { ridge: 1e-6, decay: 1e-7 }
    }
}

/// Default penalties of networks in ensembles. Chosen on measured and generated cases: docs/accuracy.md.
pub const ENSEMBLE_PENALTIES: Regularisation = Regularisation { ridge: 3e-4, decay: 1e-7 };

/// Valid penalties.
pub const PENALTIES: RangeInclusive<f64> = 0.0..=1e6;
