//! The models other than networks and `auto`, and their options.

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;
use crate::data::known_beginning::KnownSpan;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::for_each_law;
use crate::law::Law;
use crate::law::facts::{Advised, Behaviour, ErrorsInside, Facts, Identification, LawKind, Rate};
use crate::named;
use crate::options::input_options::InputOptions;
use crate::options::network::SEED;

const RANDOM_STOPS: Facts = Facts {
    rate: Rate::Optional,
    kind: LawKind::RandomNetwork,
    ..Facts::linear(
        "random-stops",
        "random deteriorating stops with a ridge penalty",
        &["operators", "hidden", "no_deterioration", "history", "rate_compression"],
        ErrorsInside { softening: 0.05, sigmoid: 0.7, other: 0.6 },
    )
    .with_defaults(&[("operators", 300)])
};

macro_rules! classical_model {
    ($($module:ident::$law:ident),* $(,)?) => {
        /// A model other than a network and `auto`.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum ClassicalModel {
            $(#[doc = concat!("[`", stringify!($law), "`](crate::law::Classical::", stringify!($law), ").")] $law,)*
            /// Random deteriorating stops and a ridge: a network whose stops are not trained.
            #[default]
            RandomStops,
        }

        impl ClassicalModel {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$law,)* Self::RandomStops];

            /// Facts that hold for all parameters.
            pub fn facts(self) -> &'static Facts {
                match self {
                    $(Self::$law => &<crate::law::$module::$law as Law>::FACTS,)*
                    Self::RandomStops => &RANDOM_STOPS,
                }
            }
        }
    };
}

for_each_law!(classical_model);

impl ClassicalModel {
    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// True if the model can use the rate of the input.
    pub fn uses_rate(self) -> bool {
        self.facts().rate != Rate::Ignored
    }

    /// True if the model always needs the rate.
    pub fn needs_rate(self) -> bool {
        self.facts().rate == Rate::Needed
    }

    /// True if the model always needs the time between samples.
    pub fn needs_time(self) -> bool {
        self.facts().needs_time
    }

    /// True for a network, with equations and inputs as of those that are trained.
    pub fn is_network(self) -> bool {
        self.facts().kind == LawKind::RandomNetwork
    }

    /// True if it takes more than one input.
    pub fn takes_further_inputs(self) -> bool {
        self.is_network() || self.facts().takes_further_inputs
    }

    /// True if it is a mass on springs: a model of a resonance.
    pub fn has_inertia(self) -> bool {
        self.facts().kind == LawKind::Inertia
    }

    /// True if another seed gives another model of much the same error: medians of several are then better.
    pub fn is_random(self) -> bool {
        self.facts().kind != LawKind::Law
    }

    /// The simplest law for data with this behaviour.
    ///
    /// # Panics
    /// No law is advised for it.
    pub fn simplest_for(behaviour: Behaviour) -> Self {
        let is_advised = |model: &Self| model.facts().advice.contains(&(behaviour, Advised::Simplest));
        Self::ALL.iter().copied().find(is_advised).expect("a law that is advised for the behaviour")
    }

    /// The laws with fewer parameters than the simplest model for data with this behaviour, each with a remark.
    pub fn with_fewer_parameters_for(behaviour: Behaviour) -> impl Iterator<Item = (Self, &'static str)> {
        Self::ALL.iter().flat_map(move |model| {
            model.facts().advice.iter().filter_map(move |(of, advised)| match advised {
                Advised::FewerParameters(remark) if *of == behaviour => Some((*model, *remark)),
                _ => None,
            })
        })
    }

    /// True if its parameters are found by a search from several starts; otherwise by linear least squares.
    pub fn is_searched(self) -> bool {
        self.facts().identification == Identification::Search
    }
}

/// Options of such a model, named as on the command line. A model ignores those that it does not use.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassicalOptions {
    /// The model.
    pub model: ClassicalModel,
    /// Plays, breakpoints, intervals of a Preisach axis, or stops; the model's own default if `None`.
    pub operators: Option<usize>,
    /// Thresholds of the plays of a (modified) Prandtl-Ishlinskii or Masing model, in the unit of the input.
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the weights of plays or cells; chosen by cross-validation if `None`.
    pub sign: Option<Sign>,
    /// Dead zones on each side of a modified Prandtl-Ishlinskii model; its own default if `None`.
    pub dead_zones: Option<usize>,
    /// Whether each play has a free weight, instead of an exponential law; the model's own default if `None`.
    pub free_weights: Option<bool>,
    /// True if thresholds of a rate-dependent Prandtl-Ishlinskii model grow with the logarithm of the rate.
    pub logarithmic_thresholds: bool,
    /// True for Bouc-Wen with degradation and pinching, a deteriorating peak-oriented law, or deteriorating stops.
    pub degradation: bool,
    /// True for a peak-oriented or Menegotto-Pinto law with different strengths upwards and downwards.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub asymmetric: bool,
    /// True for a Jiles-Atherton law in the form of 1992, false for that of 1986.
    pub differential_form: bool,
    /// Tanh neurons of a neuro-Madelung model, of a Duhem neural network or beside random stops.
    pub hidden: Option<usize>,
    /// States of a Duhem neural network or of a hysteretic element; its own default if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub states: Option<usize>,
    /// Modes of vibration of a hysteretic oscillator or state space model; its own default if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<usize>,
    /// Relaxation elements of a dynamic Prandtl-Ishlinskii model; its own default if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relaxation: Option<usize>,
    /// True for a dynamic Prandtl-Ishlinskii model with a resonance behind its plays.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub resonance: bool,
    /// True for a dynamic Prandtl-Ishlinskii model with a lag before its plays.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub lagged_input: bool,
    /// True for a Duhem neural network with the second derivative of the input.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub acceleration: bool,
    /// True for a Duhem neural network without constants.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub odd: bool,
    /// Error that a Duhem neural network is fitted to; see [`fitted_error`](Self::fitted_error) if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<FittedError>,
    /// Known beginning of the records that the model will be used on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownSpan>,
    /// Whether random stops deteriorate; chosen by cross-validation if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deterioration: Option<bool>,
    /// Method of the rate; `None` for no rate.
    pub rate: Option<RateMethod>,
    /// Input transform.
    #[serde(default, skip_serializing_if = "InputOptions::is_none")]
    pub shaping: InputOptions,
    /// Starts of a search; the model's own default if `None`.
    pub starts: Option<usize>,
    /// Iterations of each start; the model's own default if `None`.
    pub epochs: Option<usize>,
    /// Searched parameters of a similar fit, which are a start of their own; empty if there is none. Not stored.
    #[serde(skip)]
    pub near: Vec<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl ClassicalOptions {
    /// Ratio of the sizes of records above which their errors are compared relative to these sizes. Designed.
    pub const RATIO_OF_SIZES: f64 = 5.0;

    /// The error that a Duhem neural network is fitted to: as requested; otherwise that of each record if states are free or
    /// the sizes of the records differ by more than [`RATIO_OF_SIZES`](Self::RATIO_OF_SIZES), and that of the rows if not.
    pub fn fitted_error(&self, data: &Dataset) -> FittedError {
        let is_free = self.shaping.initial_state == Some(InitialState::Free);
        let differ = || data.size_ratio() > Self::RATIO_OF_SIZES;
        self.error.unwrap_or_else(|| if is_free || differ() { FittedError::Record } else { FittedError::Row })
    }
}

macro_rules! counts {
    ($($option:ident: $meaning:literal),* $(,)?) => {
        impl ClassicalOptions {
            $(
                #[doc = concat!($meaning, ": the requested value, or the default of the model.")]
                pub fn $option(&self) -> usize {
                    self.$option.unwrap_or(self.model.facts().default_of(stringify!($option), self.degradation))
                }
            )*
        }
    };
}

counts! {
    operators: "Plays, breakpoints, intervals of each axis of a Preisach plane, or stops",
    hidden: "Tanh neurons",
    states: "Memory states",
    modes: "Modes of vibration",
    dead_zones: "Dead zones on each side",
    starts: "Starts of the search",
    epochs: "Iterations of each start",
}

impl ClassicalOptions {
    /// Relaxation elements: the requested number, or that of the model; none beside a resonance.
    pub fn relaxation(&self) -> usize {
        let default = if self.resonance { 0 } else { self.model.facts().default_of("relaxation", false) };
        self.relaxation.unwrap_or(default)
    }

    /// Plays: the given thresholds, or operators.
    pub fn plays(&self) -> usize {
        self.thresholds.as_ref().map_or(self.operators(), Vec::len)
    }

    /// True for random stops that deteriorate, or are followed by tanh neurons: as flexible as a network.
    pub fn has_random_layer(&self) -> bool {
        self.model.is_network() && self.deterioration == Some(true) || self.has_random_tanh_layer()
    }

    /// True for random stops that are followed by tanh neurons.
    pub(super) fn has_random_tanh_layer(&self) -> bool {
        self.model.is_network() && self.hidden.is_some_and(|hidden| hidden > 0)
    }

    /// True for a model with inertia whose elements have neither memory states nor stops.
    pub fn has_no_memory(&self) -> bool {
        self.model.has_inertia() && self.states == Some(0) && self.operators() == 0
    }

    /// The defaults of a model.
    pub fn of(model: ClassicalModel) -> Self {
        Self { model, seed: SEED, ..Self::default() }
    }
}

/// Error that a model is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FittedError {
    /// Of all rows alike.
    Row,
    /// Mean over the records of the error as a share of the root mean square output of the record.
    Record,
}

named!(FittedError, "error": Row = "row", Record = "record");

/// Sign constraint of weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sign {
    /// Any sign.
    Any,
    /// At least 0: the output lags behind the input, as that of magnets and actuators.
    NonNegative,
    /// At most 0, with a rising reversible part: the output leads the input, as a force leads the displacement.
    NonPositive,
}

impl Sign {
    /// All of them; the strictest last.
    pub const ALL: [Sign; 3] = [Sign::Any, Sign::NonNegative, Sign::NonPositive];

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Sign::Any => "any",
            Sign::NonNegative => "non-negative",
            Sign::NonPositive => "non-positive",
        }
    }
}
