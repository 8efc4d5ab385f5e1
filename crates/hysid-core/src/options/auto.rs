//! What can be decided of the automatic model.

use serde::{Deserialize, Serialize};

use crate::data::rate::RateMethod;
use crate::options::FitSpec;
use crate::options::network::SEED;

/// The name of the automatic model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Automatic {
    /// `auto`
    #[default]
    Auto,
}

/// What the user can decide; what is `None` is decided by validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AutoOptions {
    /// Marks the request in model files.
    pub model: Automatic,
    /// A model to make an ensemble of; `None` for all candidates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Box<FitSpec>>,
    /// Members at most; 1 for a single model.
    pub members: usize,
    /// Starts of a random candidate, on all data.
    pub starts: usize,
    /// How the rate of the first input is found; `None` for candidates that do not see it.
    pub rate: Option<RateMethod>,
    /// No candidate without the rate.
    pub always_rate: bool,
    /// Whether stops deteriorate.
    pub deterioration: Option<bool>,
    /// Relaxation neurons of candidates that have any; 0 for none at all.
    pub relaxation: Option<usize>,
    /// Stops of a network.
    pub stops: Option<usize>,
    /// Tanh neurons of a network.
    pub hidden: Option<usize>,
    /// Plays, intervals of each axis of a Preisach plane, or random stops.
    pub operators: Option<usize>,
    /// Epochs of a search.
    pub epochs: Option<usize>,
    /// Whether the input is companded.
    pub companding: Option<bool>,
    /// Whether largest input and path so far are inputs.
    pub history: Option<bool>,
    /// Rows at the beginning of each record that drive the memory and are not trained on.
    pub warm_up: Option<usize>,
    /// λ and κ of theory.md (3.1), the penalties of networks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ridge: Option<f64>,
    /// See `ridge`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decay: Option<f64>,
    /// Seed of all randomness.
    pub seed: u64,
}

impl Default for AutoOptions {
    fn default() -> Self {
        Self {
            model: Automatic::Auto,
            only: None,
            members: 32,
            starts: 8,
            rate: None,
            always_rate: false,
            deterioration: None,
            relaxation: None,
            stops: None,
            hidden: None,
            operators: None,
            epochs: None,
            companding: None,
            history: None,
            warm_up: None,
            ridge: None,
            decay: None,
            seed: SEED,
        }
    }
}

/// Most members of an ensemble.
pub const MOST_MEMBERS: usize = 200;
