//! What the user can choose of a fit.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::data::FEWEST_ROWS;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::{Error, OptionError, Result};
use crate::network::{Architecture, Family, Sizes};
use crate::options::input_options::{HISTORY_INPUTS, InputOptions};
use crate::options::table::check;

/// How networks are trained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trainer {
    /// Levenberg-Marquardt with variable projection from several starts.
    #[default]
    LevenbergMarquardt,
    /// The paper's: a genetic algorithm, then the sub-gradient method from its best individual.
    Hybrid,
    /// The genetic algorithm alone.
    Genetic,
    /// The sub-gradient method with space dilatation alone.
    Subgradient,
}

/// A way to lower the objective.
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
        [Trainer::LevenbergMarquardt, Trainer::Hybrid, Trainer::Genetic, Trainer::Subgradient];

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Trainer::LevenbergMarquardt => "levenberg-marquardt",
            Trainer::Hybrid => "hybrid",
            Trainer::Genetic => "genetic",
            Trainer::Subgradient => "subgradient",
        }
    }

    /// Starts unless the user says otherwise: the paper trains one network.
    pub fn default_starts(self) -> usize {
        match self {
            Trainer::LevenbergMarquardt => 8,
            _ => 1,
        }
    }

    /// Epochs unless the user says otherwise.
    pub fn default_epochs(self) -> usize {
        match self {
            Trainer::LevenbergMarquardt => 40,
            _ => 2000,
        }
    }

    /// True if it breeds a population.
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

/// What the user can choose; every field has the name of its command-line option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitOptions {
    /// The network family.
    pub model: Family,
    /// Numbers of neurons.
    #[serde(flatten)]
    pub sizes: Sizes,
    /// Stops do not deteriorate, whatever the family.
    pub no_deterioration: bool,
    /// How the rate is found; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// What the network sees of the input.
    #[serde(default, skip_serializing_if = "InputOptions::is_none")]
    pub shaping: InputOptions,
    /// The trainer.
    #[serde(default)]
    pub training: Trainer,
    /// Random networks, or populations, to start from. Of several, the one with the lowest objective is taken,
    /// and a few of them are cross-validated.
    pub starts: usize,
    /// Epochs of each start: Levenberg-Marquardt iterations, generations or outer iterations of the
    /// sub-gradient method; a hybrid shares them out in halves.
    pub epochs: usize,
    /// Individuals of the genetic algorithm.
    #[serde(default = "default_population")]
    pub population: usize,
    /// Epochs without a relative improvement of 1e-4 after which the genetic algorithm or the
    /// sub-gradient method ends; 0 for never.
    #[serde(default = "default_stall")]
    pub stall: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Share of the data held out to validate the fit on; `None` for the folds of a cross-validation.
    #[serde(default)]
    pub validation: Option<f64>,
    /// λ of theory.md (3.1), on the output weights, in scaled units; `None` for the default, which is left
    /// out where cross-validation finds it does harm.
    #[serde(default)]
    pub ridge: Option<f64>,
    /// κ of theory.md (3.1), on the weights of stops and tanh neurons; `None` as for `ridge`.
    #[serde(default)]
    pub decay: Option<f64>,
    /// Scored rows that early iterations use at most; the memory runs through every row, and the last
    /// iterations see all.
    pub thin: usize,
}

fn default_population() -> usize {
    50
}

fn default_stall() -> usize {
    50
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
            training,
            starts: training.default_starts(),
            epochs: training.default_epochs(),
            population: default_population(),
            stall: default_stall(),
            seed: SEED,
            validation: None,
            ridge: None,
            decay: None,
            thin: 20_000,
        }
    }

    /// The network that the options ask for on these data.
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

    /// The penalties that were asked for, or the defaults.
    pub fn penalties(&self) -> Regularisation {
        let defaults = Regularisation::default();
        Regularisation {
            ridge: self.ridge.unwrap_or(defaults.ridge),
            decay: self.decay.unwrap_or(defaults.decay),
        }
    }

    /// True if the penalties stay as they were asked for.
    pub fn keeps_penalties(&self) -> bool {
        self.ridge.is_some() || self.decay.is_some()
    }

    /// True if the stops deteriorate.
    pub fn deteriorates(&self) -> bool {
        !self.no_deterioration && self.model.deteriorates()
    }

    /// Refuses options outside their meaning.
    pub fn check(&self) -> Result<()> {
        check([
            ("starts", json!(self.starts)),
            ("epochs", json!(self.epochs)),
            ("population", json!(self.population)),
        ])?;
        check(self.validation.map(|share| ("validation", json!(share))))?;
        if self.thin < FEWEST_ROWS {
            return Err(OptionError::value(
                "thin",
                self.thin,
                format!("at least {FEWEST_ROWS} rows are needed"),
            )
            .into());
        }
        self.shaping.check()?;
        self.penalties().check()
    }
}

/// The seed of every fit that was given none.
pub const SEED: u64 = 1;

/// Fewest and most individuals.
pub const POPULATIONS: RangeInclusive<usize> = 4..=100_000;

/// Most epochs of a start.
pub const MOST_EPOCHS: usize = 1_000_000;

/// Most starts.
pub const MOST_STARTS: usize = 10_000;

/// Penalties on the weights, in scaled units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Regularisation {
    /// λ of theory.md (3.1), on the output weights.
    pub ridge: f64,
    /// κ of theory.md (3.1), on the weights of stops and tanh neurons.
    pub decay: f64,
}

impl Default for Regularisation {
    fn default() -> Self {
        Self { ridge: 1e-6, decay: 1e-7 }
    }
}

/// Penalties of networks that are combined with others. Chosen on measured and generated cases:
/// docs/accuracy.md.
pub const ENSEMBLE_PENALTIES: Regularisation = Regularisation { ridge: 3e-4, decay: 1e-7 };

/// Penalties that can be asked for.
pub const PENALTIES: RangeInclusive<f64> = 0.0..=1e6;

impl Regularisation {
    pub(crate) fn check(&self) -> Result<()> {
        check([("ridge", json!(self.ridge)), ("decay", json!(self.decay))])
    }
}
