//! The table of options: name, meaning, range and default of each option of a fit, once. The command line, the Python
//! keywords, the checks, the warnings and `docs/options.md` are made from it or tested against it.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::data::initial_state::InitialState;
use crate::data::known_beginning::{KNOWN_SPANS, KnownSpan};
use crate::error::{OptionError, Result};
use crate::law::duhem_nn::MOST_STATES;
use crate::law::hysteretic_dynamics::MOST_PARTS;
use crate::network::{Family, Sizes};
use crate::options::ModelName;
use crate::options::classical::{FittedError, Sign};
use crate::options::effort::Effort;
use crate::options::fit_spec::{AutoOptions, MOST_MEMBERS};
use crate::options::input_options::SHARES;
use crate::options::network::{
    FitOptions, MOST_EPOCHS, MOST_STARTS, PENALTIES, POPULATIONS, Regularisation, SEED, Trainer,
};
use crate::options::preset::{Preset, count_of};

/// An option of a fit: name, meaning, valid values, defaults.
#[derive(Debug, Clone, Copy)]
pub struct FitOption {
    /// Its name, in words joined by underscores, as in Python; the command line joins them by hyphens.
    pub name: &'static str,
    /// The group in which it is listed.
    pub group: OptionGroup,
    /// Its effect, in a sentence without a full stop.
    pub meaning: &'static str,
    /// Its valid values.
    pub values: OptionValues,
    /// The default for a model, and for a network when it is trained by this trainer.
    default: fn(ModelName, Trainer) -> Preset,
    /// Whether a network, or `auto`, uses it. A classical model lists its options itself.
    used_by: fn(ModelName, Trainer) -> bool,
}

/// Group under which options are listed in help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionGroup {
    /// Options of most models.
    Model,
    /// Options of the training of networks and of searches.
    Training,
    /// Options of classical models.
    Classical,
}

impl OptionGroup {
    /// All of them, in their order.
    pub const ALL: [Self; 3] = [Self::Model, Self::Training, Self::Classical];

    /// Heading of the group in help.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Model => "Model",
            Self::Training => "Training",
            Self::Classical => "Classical models",
        }
    }
}

/// The valid values of an option.
#[derive(Debug, Clone, Copy)]
pub enum OptionValues {
    /// Whole numbers from the first to the second.
    Count(usize, usize),
    /// Whole numbers from 0 up.
    Whole,
    /// Numbers between 0 and 1, both excluded.
    Fraction,
    /// 0, or numbers from the first to the second.
    ZeroOr(f64, f64),
    /// Numbers from the first to the second.
    Number(f64, f64),
    /// Numbers above 0, separated by commas on the command line.
    Positive,
    /// Given or not.
    Flag,
    /// True or false.
    Truth,
    /// A number of rows, or a time with its unit.
    Span,
    /// One of these names.
    Names(fn() -> Vec<&'static str>),
}

use OptionGroup::{Classical, Model, Training};

/// Valid numbers of neurons or operators.
const NEURONS: OptionValues = OptionValues::Count(1, 1000);

const PENALTY: OptionValues = OptionValues::Number(*PENALTIES.start(), *PENALTIES.end());

const SHARE: OptionValues = OptionValues::ZeroOr(*SHARES.start(), *SHARES.end());

/// Makes the table and the options by name from one row for each option: its name, its type, and the fields of
/// [`FitOption`], the meaning first.
macro_rules! options {
    ($($name:ident: $kind:ty {
        meaning: $meaning:literal, $($field:ident: $value:expr,)* $(..$others:expr)?
    })*) => {
        /// Every option, in the order in which it is listed.
        pub const OPTIONS: &[FitOption] = &[
            $(FitOption { name: stringify!($name), meaning: $meaning, $($field: $value,)* $(..$others)? },)*
        ];

        /// Options of a fit, described in [`OPTIONS`]; `None` stands for the default of the model or its trainer.
        #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct NamedOptions {
            $(#[doc = $meaning] pub $name: Option<$kind>,)*
        }
    };
}

/// A flag that selects a variant of classical models.
const FLAG_OF_LAWS: FitOption = FitOption {
    name: "",
    meaning: "",
    group: Classical,
    values: OptionValues::Flag,
    default: |_, _| Preset::Off,
    used_by: of_none,
};

options! {
    model: ModelName {
        meaning: "Model to fit. `auto` cross-validates networks and classical models and combines the best",
        group: Model,
        values: OptionValues::Names(models),
        default: |_, _| Preset::Name(ModelName::AUTO.name()),
        used_by: |_, _| true,
    }
    members: usize {
        meaning: "Maximum ensemble size; 1 gives a single small model. With a named model, the number of random starts \
                  that are combined",
        group: Model,
        values: OptionValues::Count(1, MOST_MEMBERS),
        default: |model, _| {
            Preset::Count(match model {
                ModelName::Auto(_) => AutoOptions::default().members,
                _ => 1,
            })
        },
        used_by: |_, _| true,
    }
    stops: usize {
        meaning: "Stop neurons of a network",
        group: Model,
        values: NEURONS,
        default: |_, _| Preset::Count(Sizes::default().stops),
        used_by: |_, _| true,
    }
    hidden: usize {
        meaning: "Tanh neurons of a network, of neuro-madelung or duhem-nn (at most 100), of random-stops, or of each \
                  hysteretic element (at most 60)",
        group: Model,
        values: NEURONS,
        default: |model, _| match model {
            ModelName::Classical(model) if model.is_network() => Preset::Chosen,
            ModelName::Auto(_) => Preset::ByCandidate,
            _ => count_of(model, "hidden", Sizes::default().hidden),
        },
        used_by: |model, _| network_or_auto(model, |family| family.has_tanh_layer()),
    }
    relaxation: usize {
        meaning: "Relaxation neurons of each input of xpnn+, for data with time stamps (by default none for data of \
                  one speed), or relaxation elements of dynamic-prandtl-ishlinskii (at most 3); 0 for none",
        group: Model,
        values: OptionValues::Count(0, 1000),
        default: |model, _| match model {
            ModelName::Auto(_) => Preset::ByCandidate,
            _ => count_of(model, "relaxation", Sizes::default().relaxation),
        },
        used_by: |model, _| network_or_auto(model, |family| family.relaxes()),
    }
    no_deterioration: bool {
        meaning: "Use stops that do not deteriorate",
        group: Model,
        values: OptionValues::Flag,
        default: |model, _| match model {
            ModelName::Network(_) => Preset::Off,
            _ => Preset::Chosen,
        },
        used_by: |model, _| network_or_auto(model, |family| family.deteriorates()),
    }
    history: bool {
        meaning: "Add the running peak and the travelled path of the input as inputs",
        group: Model,
        values: OptionValues::Flag,
        default: chosen_or_off,
        used_by: |model, _| network_or_auto(model, |family| family.takes_further_inputs()),
    }
    compression: f64 {
        meaning: "Expand the first input around zero by asinh: the scale, as a share of its largest magnitude, such as \
                  0.1; 0 for off",
        group: Model,
        values: SHARE,
        default: chosen_or_off,
        used_by: |_, _| true,
    }
    rate_compression: f64 {
        meaning: "Expand the rate of the first input around zero: the scale, as a share of the rate that 99.5 % of all \
                  rows stay below; 0 for off",
        group: Model,
        values: SHARE,
        default: |_, _| Preset::Off,
        used_by: |model, _| matches!(model, ModelName::Network(family) if family.uses_rate()),
    }
    warm_up: usize {
        meaning: "Rows at the beginning of each record that drive the memory and are not trained on, for records that \
                  do not begin in the virgin state",
        group: Training,
        values: OptionValues::Whole,
        default: |model, _| match model {
            ModelName::Auto(_) => Preset::Chosen,
            _ => Preset::Count(0),
        },
        used_by: |_, _| true,
    }
    initial_state: InitialState {
        meaning: "State of the memory at the beginning of each record: without history, after a visit of the upper or \
                  the lower end of the input range, demagnetised, periodic (each record is a period of a steady state), \
                  unknown (one of 11 pasts, found for each record before the fit), or free (found for each record during the \
                  fit, for records that are cut out of a longer past). With free, duhem-nn finds its internal states, \
                  models with inertia find displacements and velocities, and other models find up to three turning points \
                  before the first row",
        group: Training,
        values: OptionValues::Names(initial_states),
        default: |model, _| match model {
            ModelName::Auto(_) => Preset::Chosen,
            _ => Preset::Name(InitialState::default().name()),
        },
        used_by: |_, _| true,
    }
    known: KnownSpan {
        meaning: "Measured beginning of the records on which the model will be used, as in `hysid evaluate --known`. Errors \
                  are then those after this beginning of each record, and `auto` also tries initial_state free. Default \
                  with free: the first tenth of each record. Blocks that are held out of a single record have no known \
                  beginning",
        group: Training,
        values: OptionValues::Span,
        default: |_, _| Preset::Off,
        used_by: |_, _| true,
    }
    training: Trainer {
        meaning: "Trainer of a network: the sub-gradient method with space dilatation, Levenberg-Marquardt, the genetic \
                  algorithm, or the paper's hybrid of the genetic algorithm and the sub-gradient method",
        group: Training,
        values: OptionValues::Names(trainers),
        default: |_, _| Preset::Name(Trainer::default().name()),
        used_by: of_networks,
    }
    effort: Effort {
        meaning: "How long `auto` searches: `quick` takes about half the normal time, `thorough` about five times as \
                  long",
        group: Training,
        values: OptionValues::Names(efforts),
        default: |_, _| Preset::Name(Effort::default().name()),
        used_by: |model, _| matches!(model, ModelName::Auto(_)),
    }
    starts: usize {
        meaning: "Number of random starts: networks, populations or parameter sets from which the training begins",
        group: Training,
        values: OptionValues::Count(1, MOST_STARTS),
        default: |model, trainer| match model {
            ModelName::Auto(_) => Preset::Count(AutoOptions::default().starts),
            _ => count_of(model, "starts", trainer.default_starts()),
        },
        used_by: |_, _| true,
    }
    epochs: usize {
        meaning: "Epochs of each start: iterations of levenberg-marquardt, generations of the genetic algorithm, \
                  iterations of the sub-gradient method; the hybrid uses half of them for each",
        group: Training,
        values: OptionValues::Count(0, MOST_EPOCHS),
        default: |model, trainer| match model {
            ModelName::Auto(_) => Preset::ByCandidate,
            _ => count_of(model, "epochs", trainer.default_epochs()),
        },
        used_by: |_, _| true,
    }
    population: usize {
        meaning: "Individuals of the genetic algorithm",
        group: Training,
        values: OptionValues::Count(*POPULATIONS.start(), *POPULATIONS.end()),
        default: |_, trainer| Preset::Count(FitOptions::of(trainer).population),
        used_by: |model, trainer| of_networks(model, trainer) && trainer.is_genetic(),
    }
    stall: usize {
        meaning: "Epochs without a noticeable improvement after which the genetic algorithm or the sub-gradient method \
                  ends; 0 for never",
        group: Training,
        values: OptionValues::Whole,
        default: |_, trainer| Preset::Count(FitOptions::of(trainer).stall),
        used_by: |model, trainer| of_networks(model, trainer) && trainer != Trainer::LevenbergMarquardt,
    }
    seed: u64 {
        meaning: "Seed of all random numbers; the same data, options and seed give the same model",
        group: Training,
        values: OptionValues::Whole,
        default: |_, _| Preset::Count(SEED as usize),
        used_by: |_, _| true,
    }
    validation: f64 {
        meaning: "Share of the data held out to validate a network on, between 0 and 1; the final network is trained \
                  on all data",
        group: Training,
        values: OptionValues::Fraction,
        default: |_, _| Preset::Folds,
        used_by: of_networks,
    }
    ridge: f64 {
        meaning: "Penalty on the squared output weights of a network, in scaled units; 0 for plain least squares, as \
                  in the paper",
        group: Training,
        values: PENALTY,
        default: |model, _| match model {
            ModelName::Network(_) => Preset::Penalty(Regularisation::default().ridge),
            _ => Preset::Chosen,
        },
        used_by: |_, _| true,
    }
    decay: f64 {
        meaning: "Penalty on the squared weights of stops and tanh neurons",
        group: Training,
        values: PENALTY,
        default: |model, _| match model {
            ModelName::Network(_) => Preset::Penalty(Regularisation::default().decay),
            _ => Preset::Chosen,
        },
        used_by: |_, _| true,
    }
    operators: usize {
        meaning: "Plays, breakpoints, intervals of each axis of a Preisach plane (at most 200), random stops, stops of \
                  duhem-nn (at most 100, 0 for none), or stops of each hysteretic element (at most 60, 0 for none)",
        group: Classical,
        values: OptionValues::Count(0, 1000),
        default: |model, _| match model {
            ModelName::Auto(_) => Preset::ByCandidate,
            _ => count_of(model, "operators", 0),
        },
        used_by: of_auto,
    }
    states: usize {
        meaning: "States of duhem-nn, driven by the input and by time (1 to 20), or memory states of each hysteretic \
                  element, which change only when its displacement changes (0 to 10; an element without memory states \
                  and stops has no hysteresis)",
        group: Classical,
        values: OptionValues::Count(0, MOST_STATES),
        default: |model, _| count_of(model, "states", 0),
        used_by: of_none,
    }
    modes: usize {
        meaning: "Modes of vibration of hysteretic-oscillator and hysteretic-state-space",
        group: Classical,
        values: OptionValues::Count(1, MOST_PARTS),
        default: |model, _| match model {
            ModelName::Auto(_) => Preset::ByCandidate,
            _ => count_of(model, "modes", 0),
        },
        used_by: of_auto,
    }
    thresholds: Vec<f64> {
        meaning: "Thresholds of the plays of masing, prandtl-ishlinskii or modified-prandtl-ishlinskii, in the unit of \
                  the input",
        group: Classical,
        values: OptionValues::Positive,
        default: |_, _| Preset::Chosen,
        used_by: of_none,
    }
    sign: Sign {
        meaning: "Sign of the weights of plays, or of the cells of a Preisach plane",
        group: Classical,
        values: OptionValues::Names(signs),
        default: |_, _| Preset::Chosen,
        used_by: of_none,
    }
    dead_zones: usize {
        meaning: "Dead zones on each side of modified-prandtl-ishlinskii or dynamic-prandtl-ishlinskii",
        group: Classical,
        values: OptionValues::Count(1, 100),
        default: |model, _| count_of(model, "dead_zones", 0),
        used_by: of_none,
    }
    free_weights: bool {
        meaning: "Give each play of generalized-prandtl-ishlinskii or rate-dependent-prandtl-ishlinskii a weight of its \
                  own, in place of an exponential law",
        group: Classical,
        values: OptionValues::Truth,
        default: |_, _| Preset::On,
        used_by: of_none,
    }
    logarithmic_thresholds: bool {
        meaning: "Let the thresholds of rate-dependent-prandtl-ishlinskii grow with the logarithm of the rate",
        ..FLAG_OF_LAWS
    }
    degradation: bool {
        meaning: "Use bouc-wen with the degradation and pinching of Baber and Noori, peak-oriented with softening \
                  and deterioration, or hysteretic-oscillator and hysteretic-state-space with stops that deteriorate",
        ..FLAG_OF_LAWS
    }
    asymmetric: bool {
        meaning: "Use peak-oriented or menegotto-pinto with different strengths upwards and downwards",
        ..FLAG_OF_LAWS
    }
    differential_form: bool {
        meaning: "Use jiles-atherton in its differential form of 1992 in place of that of 1986",
        ..FLAG_OF_LAWS
    }
    resonance: bool {
        meaning: "Use dynamic-prandtl-ishlinskii with a resonance behind its plays",
        ..FLAG_OF_LAWS
    }
    lagged_input: bool {
        meaning: "Use dynamic-prandtl-ishlinskii with a lag before its plays and the input beside them, for an output that \
                  follows the integral of the input, as the voltage of a cell follows its charge",
        ..FLAG_OF_LAWS
    }
    acceleration: bool {
        meaning: "Add the second derivative of the input as an input of duhem-nn; needs time stamps, a rate and little \
                  noise in the input",
        ..FLAG_OF_LAWS
    }
    odd: bool {
        meaning: "Use duhem-nn without constants: opposite inputs from opposite initial states give the opposite output; \
                  slow further inputs, such as a temperature, stay the same",
        ..FLAG_OF_LAWS
    }
    error: FittedError {
        meaning: "Error that the fit of duhem-nn minimises: `row`, the mean square error of all rows; `record`, the mean \
                  over the records of the error relative to the record's root mean square output",
        group: Classical,
        values: OptionValues::Names(errors),
        default: |_, _| Preset::BySizes,
        used_by: of_none,
    }
}

fn chosen_or_off(model: ModelName, _: Trainer) -> Preset {
    match model {
        ModelName::Auto(_) => Preset::Chosen,
        _ => Preset::Off,
    }
}

fn models() -> Vec<&'static str> {
    std::iter::once(ModelName::AUTO).chain(ModelName::all()).map(ModelName::name).collect()
}

fn efforts() -> Vec<&'static str> {
    Effort::ALL.map(Effort::name).into()
}

fn trainers() -> Vec<&'static str> {
    Trainer::ALL.map(Trainer::name).into()
}

fn initial_states() -> Vec<&'static str> {
    InitialState::ALL.map(InitialState::name).into()
}

fn errors() -> Vec<&'static str> {
    FittedError::ALL.map(FittedError::name).into()
}

fn signs() -> Vec<&'static str> {
    Sign::ALL.map(Sign::name).into()
}

fn network_or_auto(model: ModelName, is_used: impl Fn(Family) -> bool) -> bool {
    match model {
        ModelName::Network(family) => is_used(family),
        ModelName::Auto(_) => true,
        ModelName::Classical(_) => false,
    }
}

fn of_networks(model: ModelName, _: Trainer) -> bool {
    matches!(model, ModelName::Network(_))
}

fn of_auto(model: ModelName, _: Trainer) -> bool {
    matches!(model, ModelName::Auto(_))
}

fn of_none(_: ModelName, _: Trainer) -> bool {
    false
}

/// Options of every model, whatever it is.
const OF_EVERY_MODEL: [&str; 7] =
    ["model", "members", "compression", "warm_up", "initial_state", "known", "seed"];

/// Checks values of options.
///
/// # Errors
/// An unknown name, or an invalid value: the first of them.
pub fn check<'a>(values: impl IntoIterator<Item = (&'a str, Value)>) -> Result<()> {
    for (name, value) in values {
        let Some(option) = FitOption::named(name) else {
            return Err(OptionError::unknown(name, OPTIONS.iter().map(|option| option.name).collect()).into());
        };
        option.check(&value).map_err(|needed| OptionError::value(name, value, needed))?;
    }
    Ok(())
}

/// Checks the numbers of the parts of a law against its limits: the name of an option, its least and its largest value.
///
/// # Errors
/// The first number that is out of its limits.
pub fn check_counts(
    limits: &[(&'static str, usize, usize)],
    count_of: impl Fn(&'static str) -> usize,
) -> Result<()> {
    for &(option, least, most) in limits {
        let count = count_of(option);
        if !(least..=most).contains(&count) {
            return Err(OptionError::value(option, count, format!("choose {least} to {most}")).into());
        }
    }
    Ok(())
}

impl FitOption {
    /// The option of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        OPTIONS.iter().find(|option| option.name == name)
    }

    /// Whether a model uses it; a network when it is trained by this trainer.
    pub fn is_used_by(&self, model: ModelName, trainer: Trainer) -> bool {
        match model {
            ModelName::Classical(rival) => {
                OF_EVERY_MODEL.contains(&self.name) || rival.facts().options.contains(&self.name)
            }
            _ => (self.used_by)(model, trainer),
        }
    }

    /// Its default for a model; for a network, when it is trained by this trainer.
    pub fn default(&self, model: ModelName, trainer: Trainer) -> Preset {
        (self.default)(model, trainer)
    }

    /// The models that use it, by any trainer; in the order of [`ModelName::all`], after `auto`.
    pub fn users(&self) -> Vec<ModelName> {
        let is_used =
            |model: &ModelName| Trainer::ALL.iter().any(|trainer| self.is_used_by(*model, *trainer));
        std::iter::once(ModelName::AUTO).chain(ModelName::all()).filter(is_used).collect()
    }

    /// Checks a value.
    ///
    /// # Errors
    /// The valid values, in words.
    pub fn check(&self, value: &Value) -> std::result::Result<(), String> {
        if self.values.hold(value) { Ok(()) } else { Err(self.values.needed()) }
    }

    /// Reads a value from its text on a command line.
    ///
    /// # Errors
    /// The valid values, in words.
    pub fn read(&self, text: &str) -> std::result::Result<Value, String> {
        let value = self.values.read(text).ok_or_else(|| self.values.needed())?;
        self.check(&value).map(|()| value)
    }
}

impl OptionValues {
    /// Valid values, in words.
    pub fn needed(&self) -> String {
        match self {
            Self::Count(low, high) => format!("choose a whole number from {low} to {high}"),
            Self::Whole => "a whole number, 0 or more, is needed".into(),
            Self::Fraction => "a number between 0 and 1 is needed".into(),
            Self::ZeroOr(low, high) => format!("choose 0 for off, or {low:e} to {high:e}"),
            Self::Number(low, high) => format!("choose a number from {low} to {high:e}"),
            Self::Positive => "numbers above 0 are needed, such as 0.1, 0.2, 0.5".into(),
            Self::Flag | Self::Truth => "choose true or false".into(),
            Self::Span => KNOWN_SPANS.into(),
            Self::Names(names) => format!("choose one of {}", names().join(", ")),
        }
    }

    /// Placeholder of the value in a usage line.
    pub fn placeholder(&self) -> &'static str {
        match self {
            Self::Count(..) | Self::Whole => "N",
            Self::Fraction | Self::ZeroOr(..) => "SHARE",
            Self::Number(..) => "NUMBER",
            Self::Positive => "LIST",
            Self::Flag | Self::Truth => "BOOL",
            Self::Span => "ROWS|TIME",
            Self::Names(_) => "NAME",
        }
    }

    fn hold(&self, value: &Value) -> bool {
        let number = |is_allowed: &dyn Fn(f64) -> bool| value.as_f64().is_some_and(is_allowed);
        match self {
            Self::Count(low, high) => {
                value.as_u64().is_some_and(|count| (*low as u64..=*high as u64).contains(&count))
            }
            Self::Whole => value.is_u64(),
            Self::Fraction => number(&|share| share > 0.0 && share < 1.0),
            Self::ZeroOr(low, high) => number(&|share| share == 0.0 || (*low..=*high).contains(&share)),
            Self::Number(low, high) => number(&|number| (*low..=*high).contains(&number)),
            Self::Positive => value.as_array().is_some_and(|values| {
                let is_positive = |value: &Value| value.as_f64().is_some_and(|value| value > 0.0);
                !values.is_empty() && values.iter().all(is_positive)
            }),
            Self::Flag | Self::Truth => value.is_boolean(),
            Self::Span => match value.as_str() {
                Some(text) => text.parse::<KnownSpan>().is_ok(),
                None => value.as_u64().is_some_and(|rows| rows > 0),
            },
            Self::Names(names) => {
                let known = |name: &str| name == "epnn" || names().contains(&name);
                value.as_str().is_some_and(known)
            }
        }
    }

    fn read(&self, text: &str) -> Option<Value> {
        match self {
            Self::Count(..) | Self::Whole => text.parse::<u64>().ok().map(Value::from),
            Self::Fraction | Self::ZeroOr(..) | Self::Number(..) => finite(text),
            Self::Positive => text.split(',').map(finite).collect::<Option<Vec<_>>>().map(Value::from),
            Self::Flag | Self::Truth => text.parse::<bool>().ok().map(Value::from),
            Self::Span => serde_json::to_value(text.parse::<KnownSpan>().ok()?).ok(),
            Self::Names(_) => Some(Value::from(text)),
        }
    }
}

fn finite(text: &str) -> Option<Value> {
    let number: f64 = text.trim().parse().ok()?;
    number.is_finite().then(|| Value::from(number))
}
