//! Options of `auto`, which cross-validates candidates and combines the best.

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
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

/// How long the candidates of `auto` are searched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// The first three candidates of each kind, one start of each, a third of the epochs.
    Quick,
    /// Two starts of each candidate.
    #[default]
    Normal,
    /// Sixteen starts of each candidate, five times the epochs, five times the starts of each search.
    Thorough,
}

impl Effort {
    /// All of them, the least first.
    pub const ALL: [Self; 3] = [Self::Quick, Self::Normal, Self::Thorough];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Normal => "normal",
            Self::Thorough => "thorough",
        }
    }

    /// Candidates of each kind at most, apart from laws that are searched.
    pub fn candidates_of_a_kind(self) -> usize {
        match self {
            Self::Quick => 3,
            Self::Normal | Self::Thorough => usize::MAX,
        }
    }

    /// Starts of a randomly initialized candidate.
    pub fn starts(self) -> usize {
        match self {
            Self::Quick => 1,
            Self::Normal => 2,
            Self::Thorough => 16,
        }
    }

    /// A number of epochs, or of starts of one search, from that of the normal effort.
    pub fn scaled(self, normal: usize) -> usize {
        match self {
            Self::Quick => normal.div_ceil(3),
            Self::Normal => normal,
            Self::Thorough => 5 * normal,
        }
    }
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
    /// Whether the input is companded, `asinh(x / s)`.
    pub companding: Option<bool>,
    /// Whether running peak and travelled path are inputs.
    pub history: Option<bool>,
    /// Warm-up: rows at the beginning of each record that advance the memory and are not scored in training.
    pub warm_up: Option<usize>,
    /// Initial state of every record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<InitialState>,
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
            companding: None,
            history: None,
            warm_up: None,
            initial_state: None,
            ridge: None,
            decay: None,
            seed: SEED,
        }
    }
}

/// Largest number of members of an ensemble.
pub const MOST_MEMBERS: usize = 200;
