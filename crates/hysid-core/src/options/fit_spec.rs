//! Specification of a fit: the model and its options.

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
use crate::data::rate::RateMethod;
use crate::network::Family;
use crate::options::ModelName;
use crate::options::auto::AutoOptions;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::network::{ENSEMBLE_PENALTIES, FitOptions};

/// Specification of a fit: the model and its options.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FitSpec {
    /// A network.
    Network(FitOptions),
    /// Another model.
    Classical(ClassicalOptions),
    /// The best of many models, chosen by cross-validation.
    Auto(AutoOptions),
}

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

    /// The model and its variant in a few words, such as `bouc-wen (degradation, rate)`.
    pub fn label(&self) -> String {
        let variant = self.variant();
        let name = self.model().name();
        if variant.is_empty() { name.into() } else { format!("{name} ({})", variant.join(", ")) }
    }

    /// The options that differ from the model's default, in a few words.
    fn variant(&self) -> Vec<String> {
        let (shaping, mut variant) = match self {
            Self::Network(options) => (
                options.shaping,
                named([
                    ("deterioration", options.deteriorates()),
                    ("rate", options.rate.is_some()),
                    ("relaxation", options.model == Family::XpnnPlus && options.sizes.relaxation > 0),
                ]),
            ),
            Self::Classical(options) => {
                let has_no_memory = options.has_no_memory();
                let has_tanh_layer = options.model == ClassicalModel::RandomStops
                    && options.hidden.is_some_and(|hidden| hidden > 0);
                (
                    options.shaping,
                    named([
                        ("deterioration", options.deterioration == Some(true)),
                        ("asymmetric", options.asymmetric),
                        ("degradation", options.degradation),
                        ("differential form", options.differential_form),
                        ("logarithmic thresholds", options.logarithmic_thresholds),
                        ("resonance", options.resonance),
                        ("lagged input", options.lagged_input),
                        ("rate", options.rate.is_some() && !options.model.needs_rate()),
                        ("tanh layer", has_tanh_layer),
                        ("no stops", options.operators == Some(0) && !has_no_memory),
                        ("no memory", has_no_memory),
                    ]),
                )
            }
            Self::Auto(_) => return Vec::new(),
        };
        if let Self::Network(options) = self {
            let ridge = options.ridge.filter(|ridge| *ridge != ENSEMBLE_PENALTIES.ridge);
            variant.extend(ridge.map(|ridge| format!("ridge {ridge:e}")));
        }
        if let Self::Classical(ClassicalOptions { modes: Some(modes), .. }) = self {
            variant.push(if *modes == 1 { "1 mode".into() } else { format!("{modes} modes") });
        }
        variant.extend(shaping.companding.map(|share| format!("input companded {share}")));
        variant.extend(shaping.rate_companding.map(|share| format!("rate companded {share}")));
        variant.extend(shaping.history.then(|| "history".to_string()));
        variant
    }

    /// Method of the rate; `None` for no rate.
    pub fn rate(&self) -> Option<RateMethod> {
        match self {
            Self::Network(options) => options.rate,
            Self::Classical(options) => options.rate,
            Self::Auto(options) => options.rate,
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

/// The names of what is so.
fn named<const N: usize>(all: [(&str, bool); N]) -> Vec<String> {
    all.into_iter().filter(|(_, is_so)| *is_so).map(|(name, _)| name.to_string()).collect()
}
