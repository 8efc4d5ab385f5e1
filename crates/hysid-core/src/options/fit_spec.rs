//! Specification of a fit: the model and its options; those of `auto`, which cross-validates candidates and combines the
//! best, may hold the specification of its only model.

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
use crate::data::known_beginning::{KnownBeginning, KnownSpan};
use crate::data::rate::RateMethod;
use crate::data::record::ColumnNames;
use crate::error::Result;
use crate::options::classical::ClassicalOptions;
use crate::options::effort::Effort;
use crate::options::model_name::{Automatic, ModelName};
use crate::options::network::{FitOptions, SEED};

/// Specification of a fit: the model and its options.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FitSpec {
    /// A network of a named family, and its options.
    Network(FitOptions),
    /// A classical law, and its options.
    Classical(ClassicalOptions),
    /// The best of many models, chosen by cross-validation.
    Auto(AutoOptions),
}

/// Options of `auto`. Cross-validation chooses what is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AutoOptions {
    /// The name `auto`, which identifies these options in model files.
    pub model: Automatic,
    /// The only model of the ensemble; `None` for all candidates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Box<FitSpec>>,
    /// Largest number of members; 1 for a single model.
    pub members: usize,
    /// How long the candidates are searched.
    pub effort: Effort,
    /// Starts of a randomly initialized candidate.
    pub starts: usize,
    /// Method of the rate of the first input; `None` for candidates without rate.
    pub rate: Option<RateMethod>,
    /// True if all candidates use the rate.
    pub always_rate: bool,
    /// Whether stops deteriorate.
    pub deterioration: Option<bool>,
    /// Relaxation neurons of candidates that have them; 0 for candidates without.
    pub relaxation: Option<usize>,
    /// Stops of a network.
    pub stops: Option<usize>,
    /// Tanh neurons of a network.
    pub hidden: Option<usize>,
    /// Plays, intervals of each axis of a Preisach plane, or random stops.
    pub operators: Option<usize>,
    /// Modes of vibration of hysteretic oscillators and state space models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Epochs of a search.
    pub epochs: Option<usize>,
    /// Whether the input is compressed, `asinh(x / s)`.
    pub compression: Option<bool>,
    /// Whether running peak and travelled path are inputs.
    pub history: Option<bool>,
    /// Warm-up: rows at the beginning of each record that advance the memory and are not scored in training.
    pub warm_up: Option<usize>,
    /// Initial state of every record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<InitialState>,
    /// Known beginning of the records that the model will be used on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownSpan>,
    /// λ: penalty `½ λ ‖c‖²` on the output weights of networks (theory.md (3.1)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ridge: Option<f64>,
    /// κ: penalty `½ κ ‖θ‖²` on the other weights of networks (theory.md (3.1)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decay: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for AutoOptions {
    fn default() -> Self {
        Self {
            model: Automatic::Auto,
            only: None,
            members: 6,
            effort: Effort::Normal,
            starts: Effort::Normal.starts(),
            rate: None,
            always_rate: false,
            deterioration: None,
            relaxation: None,
            stops: None,
            hidden: None,
            operators: None,
            modes: None,
            epochs: None,
            compression: None,
            history: None,
            warm_up: None,
            initial_state: None,
            known: None,
            ridge: None,
            decay: None,
            seed: SEED,
        }
    }
}

/// Largest number of members of an ensemble.
pub const MOST_MEMBERS: usize = 200;

impl FitSpec {
    /// A model with its default options, and with this rate if it uses one.
    pub fn of(model: ModelName, rate: Option<RateMethod>, seed: u64) -> Self {
        let rate = rate.filter(|_| model.uses_rate());
        match model {
            ModelName::Network(model) => {
                Self::Network(FitOptions { model, rate, seed, ..FitOptions::default() })
            }
            ModelName::Classical(model) => {
                Self::Classical(ClassicalOptions { rate, seed, ..ClassicalOptions::of(model) })
            }
            ModelName::Auto(_) => Self::Auto(AutoOptions { rate, seed, ..AutoOptions::default() }),
        }
    }

    /// The model.
    pub fn model(&self) -> ModelName {
        match self {
            Self::Network(options) => ModelName::Network(options.model),
            Self::Classical(options) => ModelName::Classical(options.model),
            Self::Auto(options) => ModelName::Auto(options.model),
        }
    }

    /// Method of the rate; `None` for no rate.
    pub fn rate(&self) -> Option<RateMethod> {
        match self {
            Self::Network(options) => options.rate,
            Self::Classical(options) => options.rate,
            Self::Auto(options) => options.rate,
        }
    }

    /// Seed of the random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Network(options) => options.seed,
            Self::Classical(options) => options.seed,
            Self::Auto(options) => options.seed,
        }
    }

    /// Initial state of every record; `None` if it is not decided.
    pub fn initial_state(&self) -> Option<InitialState> {
        match self {
            Self::Network(options) => options.shaping.initial_state,
            Self::Classical(options) => options.shaping.initial_state,
            Self::Auto(options) => options.initial_state,
        }
    }

    /// True if the states before each record are found together with the parameters.
    pub fn has_free_states(&self) -> bool {
        self.initial_state() == Some(InitialState::Free)
    }

    /// Known beginning of the records that the model will be used on, if one was asked for.
    pub fn known(&self) -> Option<&KnownSpan> {
        let known = match self {
            Self::Network(options) => &options.known,
            Self::Classical(options) => &options.known,
            Self::Auto(options) => &options.known,
        };
        known.as_ref()
    }

    /// The known beginning with which models are judged on data with these columns ([`KnownBeginning::judged`]).
    ///
    /// # Errors
    /// A duration in another unit than the time.
    pub fn judged_beginning(&self, names: &ColumnNames) -> Result<KnownBeginning> {
        KnownBeginning::judged(self.known(), self.initial_state(), names)
    }

    /// The same with another initial state of every record.
    pub fn with_initial_state(&self, state: Option<InitialState>) -> Self {
        let mut spec = self.clone();
        match &mut spec {
            Self::Network(options) => options.shaping.initial_state = state,
            Self::Classical(options) => options.shaping.initial_state = state,
            Self::Auto(options) => options.initial_state = state,
        }
        spec
    }

    /// Number of requested starts; 1 if the model's own default is taken.
    pub fn starts(&self) -> usize {
        match self {
            Self::Network(options) => options.starts,
            Self::Classical(options) => options.starts.unwrap_or(1),
            Self::Auto(options) => options.starts,
        }
    }
}
