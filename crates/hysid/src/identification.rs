//! Identification of any model by its name: a network of the family, or one of its rivals.

mod cautions;
mod memory_need;
pub mod options;
pub(crate) mod variants;

use serde::{Deserialize, Serialize};

use crate::automatic::{self, AutoOptions, Automatic};
use crate::classical::identification::{self as classical, ClassicalOptions, Rival};
use crate::classical::search::SearchProgress;
use crate::error::{Error, Result};
use crate::model::{Body, Found, Model};
use crate::network::Family;
use crate::preprocessing::{Origin, Seen};
use crate::rate::RateMethod;
use crate::record::Dataset;
use crate::stop_check::StopCheck;
use crate::training::options::ENSEMBLE_PENALTIES;
use crate::training::random_stops::{RandomStopsOptions, fit_random_stops_until};
pub use memory_need::{MemoryNeed, memory_need};

use crate::training::{
    self, Fit, FitOptions, HistoryPoint, Method, Observer, Phase, Progress, Run, SharedObserver, Termination,
};

/// A model by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ModelName {
    /// A network of the family.
    Network(Family),
    /// Another model.
    Rival(Rival),
    /// What validation chooses, alone or together.
    Auto(Automatic),
}

impl ModelName {
    /// The automatic model.
    pub const AUTO: ModelName = ModelName::Auto(Automatic::Auto);

    /// All models that there are, the networks first; [`ModelName::AUTO`] chooses among them.
    pub fn all() -> impl Iterator<Item = ModelName> {
        Family::ALL.into_iter().map(Self::Network).chain(Rival::ALL.into_iter().map(Self::Rival))
    }

    /// The name on the command line and in model files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Network(family) => family.name(),
            Self::Rival(rival) => rival.name(),
            Self::Auto(_) => "auto",
        }
    }

    /// True if the model can make use of the rate of the input.
    pub fn uses_rate(self) -> bool {
        match self {
            Self::Network(family) => family.uses_rate(),
            Self::Rival(rival) => rival.uses_rate(),
            Self::Auto(_) => true,
        }
    }

    /// True if it takes more than one input.
    pub fn takes_further_inputs(self) -> bool {
        match self {
            Self::Network(family) => family.takes_further_inputs(),
            Self::Rival(rival) => rival.takes_further_inputs(),
            Self::Auto(_) => true,
        }
    }

    /// Why the model cannot be fitted to data like these, in words; `None` if it can.
    pub fn hindrance(self, data: &Dataset, rate: Option<RateMethod>) -> Option<String> {
        let inputs = data.names().inputs.len();
        if inputs > 1 && !self.takes_further_inputs() {
            return Some(format!("takes one input, not {inputs}"));
        }
        match self {
            Self::Rival(rival) if rival.needs_rate() && rate.is_none() => {
                Some("needs the rate of the input: there is no time".into())
            }
            _ => None,
        }
    }
}

impl std::str::FromStr for ModelName {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let known = if name == "epnn" { "xpnn" } else { name };
        let all = || std::iter::once(Self::AUTO).chain(Self::all());
        all().find(|model| model.name() == known).ok_or_else(|| {
            let names: Vec<&str> = all().map(Self::name).collect();
            Error::Option(format!("model `{name}` is unknown: choose one of {}", names.join(", ")))
        })
    }
}

/// What is to be identified, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Request {
    /// A network.
    Network(FitOptions),
    /// Another model.
    Classical(ClassicalOptions),
    /// What validation chooses.
    Auto(AutoOptions),
}

impl Request {
    /// A model with its defaults, and this rate if it has a use for one.
    pub fn of(model: ModelName, rate: Option<RateMethod>, seed: u64) -> Self {
        let rate = rate.filter(|_| model.uses_rate());
        match model {
            ModelName::Network(model) => {
                Self::Network(FitOptions { model, rate, seed, ..FitOptions::default() })
            }
            ModelName::Rival(model) => {
                Self::Classical(ClassicalOptions { rate, seed, ..ClassicalOptions::of(model) })
            }
            ModelName::Auto(_) => Self::Auto(AutoOptions { rate, seed, ..AutoOptions::default() }),
        }
    }

    /// The model.
    pub fn model(&self) -> ModelName {
        match self {
            Self::Network(options) => ModelName::Network(options.model),
            Self::Classical(options) => ModelName::Rival(options.model),
            Self::Auto(options) => ModelName::Auto(options.model),
        }
    }

    /// The model and its variant in a few words, such as `bouc-wen (degradation, rate)`.
    pub fn label(&self) -> String {
        let variant = self.variant();
        let name = self.model().name();
        if variant.is_empty() { name.into() } else { format!("{name} ({})", variant.join(", ")) }
    }

    /// What is not the model's default, in a few words.
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
                let has_tanh_layer =
                    options.model == Rival::RandomStops && options.hidden.is_some_and(|hidden| hidden > 0);
                (
                    options.shaping,
                    named([
                        ("deterioration", options.deterioration == Some(true)),
                        ("degradation", options.degradation),
                        ("differential form", options.differential_form),
                        ("logarithmic thresholds", options.logarithmic_thresholds),
                        ("rate", options.rate.is_some() && !options.model.needs_rate()),
                        ("tanh layer", has_tanh_layer),
                    ]),
                )
            }
            Self::Auto(_) => return Vec::new(),
        };
        if let Self::Network(options) = self {
            let ridge = options.ridge.filter(|ridge| *ridge != ENSEMBLE_PENALTIES.ridge);
            variant.extend(ridge.map(|ridge| format!("ridge {ridge:e}")));
        }
        variant.extend(shaping.companding.map(|share| format!("input companded {share}")));
        variant.extend(shaping.rate_companding.map(|share| format!("rate companded {share}")));
        variant.extend(shaping.history.then(|| "history".to_string()));
        variant
    }

    /// How the rate is found.
    pub fn rate(&self) -> Option<RateMethod> {
        match self {
            Self::Network(options) => options.rate,
            Self::Classical(options) => options.rate,
            Self::Auto(options) => options.rate,
        }
    }

    /// Starts of the search that was asked for; 1 where the model's own default is taken.
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

/// Identifies a model. The observer is as in [`training::fit`]; of a classical model it hears after every
/// round of its search, or now and then if there is none, and there is no checkpoint.
///
/// # Errors
/// Data that nothing can be identified from, options outside their meaning, or a stop before there was any model.
pub fn identify(data: &Dataset, request: &Request, observer: &mut Observer<'_>) -> Result<Fit> {
    match request {
        Request::Network(options) => training::fit(data, options, observer),
        Request::Auto(options) => automatic::fit(data, options, observer),
        Request::Classical(options) if options.model == Rival::RandomStops => {
            random_stops(data, options, observer)
        }
        Request::Classical(options) => law(data, options, observer),
    }
}

fn random_stops(data: &Dataset, options: &ClassicalOptions, observer: &mut Observer<'_>) -> Result<Fit> {
    let defaults = RandomStopsOptions::default();
    let wanted = RandomStopsOptions {
        stops: options.operators.unwrap_or(defaults.stops),
        hidden: options.hidden,
        rate: options.rate,
        deterioration: options.deterioration,
        seed: options.seed,
    };
    let seen = Seen::of(data, &options.shaping, options.rate, Origin::OfData)?;
    let observer = SharedObserver::new(observer, Progress::of_least_squares(options.model));
    let is_to_stop = || observer.is_to_stop();
    let stop = StopCheck::new(&is_to_stop);
    let wanted = RandomStopsOptions { rate: seen.rate, ..wanted };
    let found = fit_random_stops_until(&seen.data, &wanted, stop)?;
    let body = Body::Network { network: found.network, scaling: found.scaling };
    finished(data, options, &seen, body, 1, observer.termination(Termination::Converged), Vec::new())
}

fn law(data: &Dataset, options: &ClassicalOptions, observer: &mut Observer<'_>) -> Result<Fit> {
    let mut history = Vec::new();
    let seen = Seen::of(data, &options.shaping, options.rate, options.model.origin())?;
    let of_seen = ClassicalOptions { rate: seen.rate, ..options.clone() };
    let observer = SharedObserver::new(observer, Progress::of_least_squares(options.model));
    let is_to_stop = || observer.is_to_stop();
    let stop = StopCheck::new(&is_to_stop);
    let mut of_round = |progress: SearchProgress| {
        if !progress.train_nrmse_percent.is_nan() {
            history.push(HistoryPoint {
                epoch: progress.round,
                evaluations: progress.evaluations,
                train_nrmse_percent: progress.train_nrmse_percent,
            });
        }
        observer.tell(&Progress::of_search(options.model, &progress))
    };
    let found = classical::fit(&seen.data, &of_seen, &mut of_round, stop)?;
    let termination = observer.termination(found.termination);
    let run = Run {
        phase: Phase::AllData,
        start: 0,
        method: Method::LeastSquares,
        history,
        termination,
        fold: None,
        validation_nrmse_percent: None,
    };
    let runs = if run.history.is_empty() { Vec::new() } else { vec![run] };
    finished(data, options, &seen, Body::Law(found.law), found.evaluations, termination, runs)
}

fn finished(
    data: &Dataset,
    options: &ClassicalOptions,
    seen: &Seen,
    body: Body,
    evaluations: usize,
    termination: Termination,
    runs: Vec<Run>,
) -> Result<Fit> {
    let request = Request::Classical(options.clone());
    let found = Found {
        options: request,
        chosen_start: 0,
        termination,
        validation: None,
        penalties: None,
        runs,
        selection: None,
    };
    Ok(Fit { model: Model::new(body, seen.preprocessing.clone(), options.rate, data, found)?, evaluations })
}
