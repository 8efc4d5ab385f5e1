//! The options of a fit by their names, all of them optional: what the command line and the Python package
//! have in common.

use std::ops::RangeInclusive;
use std::str::FromStr;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use crate::data::rate::RateMethod;
use crate::error::{Error, Result};
use crate::network::{Family, Sizes};
use crate::options::auto::{AutoOptions, MOST_MEMBERS};
use crate::options::classical::Sign;
use crate::options::classical::{ClassicalOptions, Rival};
use crate::options::network::POPULATIONS;
use crate::options::network::{FitOptions, Trainer};
use crate::options::network::{MOST_EPOCHS, PENALTIES};
use crate::options::shaping::Shaping;
use crate::options::{ModelName, Request};

/// Numbers of neurons or operators that can be asked for.
pub const NEURONS: RangeInclusive<usize> = 1..=1000;

/// Numbers of starts that can be asked for.
pub const STARTS: RangeInclusive<usize> = 1..=10_000;

/// What was asked for; `None` is the default of the model or its trainer. An option that a model has no use
/// for is left alone, and told by [`ChosenOptions::useless`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChosenOptions {
    /// Which model; `auto` if not said.
    #[serde(deserialize_with = "named")]
    pub model: Option<ModelName>,
    /// Models that answer together, at most; 1 for a single one. Of a model that is named, so many starts
    /// answer together.
    pub members: Option<usize>,
    /// Stop neurons of a network.
    pub stops: Option<usize>,
    /// Tanh neurons, for models that have them.
    pub hidden: Option<usize>,
    /// Relaxation neurons of each input, for `xpnn+` with time stamps.
    pub relaxation: Option<usize>,
    /// Stops do not deteriorate, whatever the family.
    pub no_deterioration: Option<bool>,
    /// Spreads the first input about zero: the scale of the spreading, as a share of its largest magnitude.
    pub companding: Option<f64>,
    /// The same for the rate.
    pub rate_companding: Option<f64>,
    /// The largest magnitude and the path of the input so far are inputs too, for `xpnn+` and
    /// `random-stops`.
    pub history: Option<bool>,
    /// Rows at the beginning of each record that drive the memory and are not trained on.
    pub warm_up: Option<usize>,
    /// How a network is trained.
    #[serde(deserialize_with = "named")]
    pub training: Option<Trainer>,
    /// Random networks or populations to start from.
    pub starts: Option<usize>,
    /// Epochs of each start.
    pub epochs: Option<usize>,
    /// Individuals of the genetic algorithm.
    pub population: Option<usize>,
    /// Epochs without noticeable improvement after which genetic algorithm or sub-gradient method end.
    pub stall: Option<usize>,
    /// Seed of all randomness.
    pub seed: Option<u64>,
    /// Share of the data held out to validate a network on, in the place of the folds of a cross-validation.
    pub validation: Option<f64>,
    /// Penalty on the output weights of a network.
    pub ridge: Option<f64>,
    /// Penalty on the weights of stops and tanh neurons.
    pub decay: Option<f64>,
    /// Plays, breakpoints, intervals of each axis of a Preisach plane, or random stops.
    pub operators: Option<usize>,
    /// Thresholds of plays in the unit of the input.
    pub thresholds: Option<Vec<f64>>,
    /// Sign of the weights of plays or cells.
    pub sign: Option<Sign>,
    /// Dead zones on each side of a modified Prandtl-Ishlinskii model.
    pub dead_zones: Option<usize>,
    /// A weight for each play in place of an exponential law.
    pub free_weights: Option<bool>,
    /// Thresholds of a rate-dependent Prandtl-Ishlinskii model grow with the logarithm of the rate.
    pub logarithmic_thresholds: Option<bool>,
    /// Bouc-Wen with the degradation and pinching of Baber and Noori.
    pub degradation: Option<bool>,
    /// Jiles-Atherton in its differential form of 1992.
    pub differential_form: Option<bool>,
}

impl ChosenOptions {
    /// The options that a map of names and values asks for; `null` is the default.
    ///
    /// # Errors
    /// A name that is no option, or a value outside an option's meaning: the text names the option.
    pub fn of(named: Map<String, Value>) -> Result<Self> {
        let names = Self::names();
        for (name, value) in &named {
            if !names.contains(name) {
                let names = names.join(", ");
                return Err(Error::Option(format!("there is no option `{name}`: the options are {names}")));
            }
            let alone = Map::from_iter([(name.clone(), value.clone())]);
            read::<Self>(alone).map_err(|problem| Error::Option(format!("{name}: {problem}")))?;
        }
        let options: Self = read(named).map_err(Error::Option)?;
        options.check()?;
        Ok(options)
    }

    /// The names of all options, in alphabetical order.
    pub fn names() -> Vec<String> {
        match serde_json::to_value(Self::default()) {
            Ok(Value::Object(fields)) => fields.keys().cloned().collect(),
            _ => unreachable!("the options are a map"),
        }
    }

    /// Refuses numbers outside the ranges that the command line has.
    fn check(&self) -> Result<()> {
        let counts = [
            ("members", self.members, 1..=MOST_MEMBERS),
            ("stops", self.stops, NEURONS),
            ("hidden", self.hidden, NEURONS),
            ("operators", self.operators, NEURONS),
            ("dead_zones", self.dead_zones, NEURONS),
            ("starts", self.starts, STARTS),
            ("epochs", self.epochs, 0..=MOST_EPOCHS),
            ("population", self.population, POPULATIONS),
        ];
        for (name, count, range) in counts {
            if let Some(count) = count.filter(|count| !range.contains(count)) {
                let (low, high) = range.into_inner();
                return Err(Error::Option(format!("{name} {count}: choose {low} to {high}")));
            }
        }
        match self.validation {
            Some(share) if !(share > 0.0 && share < 1.0) => {
                Err(Error::Option(format!("validation {share}: a number between 0 and 1 is needed")))
            }
            _ => {
                [("ridge", self.ridge), ("decay", self.decay)].into_iter().try_for_each(|(name, penalty)| {
                    match penalty {
                        Some(penalty) if !PENALTIES.contains(&penalty) => {
                            let (low, high) = (PENALTIES.start(), PENALTIES.end());
                            Err(Error::Option(format!("{name} {penalty}: choose {low} to {high}")))
                        }
                        _ => Ok(()),
                    }
                })
            }
        }
    }

    /// Which model is asked for.
    pub fn model(&self) -> ModelName {
        self.model.unwrap_or(ModelName::AUTO)
    }

    /// The library's request, with the rate decided; `always_rate` if the user has, and wants no model
    /// without it.
    pub fn request(&self, rate: Option<RateMethod>, always_rate: bool) -> Request {
        let alone = match self.model() {
            ModelName::Network(family) => Request::Network(self.of_network(family, rate)),
            ModelName::Rival(rival) => Request::Classical(self.of_rival(rival, rate)),
            ModelName::Auto(_) => return Request::Auto(self.of_auto(rate, always_rate, None)),
        };
        match (self.members, alone) {
            (None | Some(0 | 1), alone) => alone,
            (Some(_), mut alone) => {
                if let Request::Network(options) = &mut alone {
                    options.starts = 1;
                }
                Request::Auto(self.of_auto(rate, always_rate, Some(Box::new(alone))))
            }
        }
    }

    fn of_auto(
        &self,
        rate: Option<RateMethod>,
        always_rate: bool,
        only: Option<Box<Request>>,
    ) -> AutoOptions {
        let defaults = AutoOptions::default();
        let members = self.members.unwrap_or(defaults.members);
        AutoOptions {
            members,
            // Of one model, all members are starts.
            starts: self.starts.unwrap_or(if only.is_some() { members } else { defaults.starts }),
            only,
            rate,
            always_rate: always_rate && rate.is_some(),
            deterioration: self.no_deterioration.map(|none| !none),
            relaxation: self.relaxation,
            stops: self.stops,
            hidden: self.hidden,
            operators: self.operators,
            epochs: self.epochs,
            companding: self.companding.map(|share| share > 0.0),
            history: self.history,
            warm_up: self.warm_up,
            ridge: self.ridge,
            decay: self.decay,
            seed: self.seed.unwrap_or(defaults.seed),
            ..defaults
        }
    }

    fn of_network(&self, model: Family, rate: Option<RateMethod>) -> FitOptions {
        let defaults = FitOptions::of(self.trainer());
        let sizes = Sizes::default();
        FitOptions {
            model,
            sizes: Sizes {
                stops: self.stops.unwrap_or(sizes.stops),
                hidden: self.hidden.unwrap_or(sizes.hidden),
                relaxation: self.relaxation.unwrap_or(sizes.relaxation),
            },
            no_deterioration: self.no_deterioration.unwrap_or(defaults.no_deterioration),
            rate,
            shaping: self.shaping(),
            starts: self.starts.unwrap_or(defaults.starts),
            epochs: self.epochs.unwrap_or(defaults.epochs),
            population: self.population.unwrap_or(defaults.population),
            stall: self.stall.unwrap_or(defaults.stall),
            seed: self.seed.unwrap_or(defaults.seed),
            validation: self.validation,
            ridge: self.ridge,
            decay: self.decay,
            ..defaults
        }
    }

    fn of_rival(&self, model: Rival, rate: Option<RateMethod>) -> ClassicalOptions {
        let defaults = ClassicalOptions::of(model);
        ClassicalOptions {
            model,
            operators: self.operators,
            thresholds: self.thresholds.clone(),
            sign: self.sign,
            dead_zones: self.dead_zones,
            free_weights: self.free_weights,
            logarithmic_thresholds: self.logarithmic_thresholds.unwrap_or(defaults.logarithmic_thresholds),
            degradation: self.degradation.unwrap_or(defaults.degradation),
            differential_form: self.differential_form.unwrap_or(defaults.differential_form),
            hidden: self.hidden,
            deterioration: self.no_deterioration.map(|none| !none),
            rate,
            shaping: self.shaping(),
            starts: self.starts,
            epochs: self.epochs,
            seed: self.seed.unwrap_or(defaults.seed),
        }
    }

    fn shaping(&self) -> Shaping {
        Shaping {
            companding: self.companding.filter(|share| *share != 0.0),
            rate_companding: self.rate_companding.filter(|share| *share != 0.0),
            history: self.history.unwrap_or_default(),
            warm_up: self.warm_up.unwrap_or_default(),
        }
    }

    fn trainer(&self) -> Trainer {
        self.training.unwrap_or_default()
    }

    /// The trainer of a network, or the model that is fitted in its own way.
    pub fn trained_by(&self) -> &'static str {
        match self.model() {
            ModelName::Network(_) => self.trainer().name(),
            ModelName::Rival(rival) => rival.name(),
            ModelName::Auto(_) => ModelName::AUTO.name(),
        }
    }

    /// Names of options that were asked for and that the model or its trainer has no use for.
    pub fn useless(&self) -> Vec<&'static str> {
        let model = self.model();
        if model == ModelName::AUTO {
            return self.useless_for_auto();
        }
        let is_rival = matches!(model, ModelName::Rival(_));
        let is = |rival: Rival| model == ModelName::Rival(rival);
        let asked = |flag: Option<bool>| flag == Some(true);
        let given_thresholds =
            is(Rival::Masing) || is(Rival::PrandtlIshlinskii) || is(Rival::ModifiedPrandtlIshlinskii);
        let exponential =
            is(Rival::GeneralizedPrandtlIshlinskii) || is(Rival::RateDependentPrandtlIshlinskii);
        let has = self.trainer();
        let searched = match model {
            ModelName::Network(_) => true,
            ModelName::Rival(rival) => rival.is_searched(),
            ModelName::Auto(_) => true,
        };
        let has_operators =
            is_rival && !is(Rival::NeuroMadelung) && !is(Rival::BoucWen) && !is(Rival::JilesAtherton);
        let useless = [
            ("history", asked(self.history) && !model.takes_further_inputs()),
            ("rate_companding", self.rate_companding.is_some() && !model.uses_rate()),
            ("population", self.population.is_some() && (is_rival || !has.is_genetic())),
            ("stall", self.stall.is_some() && (is_rival || has == Trainer::LevenbergMarquardt)),
            ("training", is_rival && has != Trainer::default()),
            ("ridge", self.ridge.is_some() && is_rival),
            ("decay", self.decay.is_some() && is_rival),
            ("stops", self.stops.is_some() && is_rival),
            ("no_deterioration", asked(self.no_deterioration) && is_rival),
            ("starts", self.starts.is_some() && !searched),
            ("epochs", self.epochs.is_some() && !searched),
            (
                "hidden",
                self.hidden.is_some() && is_rival && !is(Rival::NeuroMadelung) && !is(Rival::RandomStops),
            ),
            ("operators", self.operators.is_some() && !has_operators),
            ("thresholds", self.thresholds.is_some() && !given_thresholds),
            ("sign", self.sign.is_some() && !is(Rival::Preisach) && !given_thresholds),
            ("dead_zones", self.dead_zones.is_some() && !is(Rival::ModifiedPrandtlIshlinskii)),
            ("free_weights", self.free_weights.is_some() && !exponential),
            (
                "logarithmic_thresholds",
                asked(self.logarithmic_thresholds) && !is(Rival::RateDependentPrandtlIshlinskii),
            ),
            ("degradation", asked(self.degradation) && !is(Rival::BoucWen)),
            ("differential_form", asked(self.differential_form) && !is(Rival::JilesAtherton)),
        ];
        useless.into_iter().filter(|(_, useless)| *useless).map(|(option, _)| option).collect()
    }
}

impl ChosenOptions {
    /// The candidates decide what is not said here, and there is no use for the rest.
    fn useless_for_auto(&self) -> Vec<&'static str> {
        let useless = [
            ("rate_companding", self.rate_companding.is_some()),
            ("training", self.training.is_some_and(|trainer| trainer != Trainer::default())),
            ("population", self.population.is_some()),
            ("stall", self.stall.is_some()),
            ("validation", self.validation.is_some()),
            ("thresholds", self.thresholds.is_some()),
            ("sign", self.sign.is_some()),
            ("dead_zones", self.dead_zones.is_some()),
            ("free_weights", self.free_weights.is_some()),
            ("logarithmic_thresholds", self.logarithmic_thresholds == Some(true)),
            ("degradation", self.degradation == Some(true)),
            ("differential_form", self.differential_form == Some(true)),
        ];
        useless.into_iter().filter(|(_, useless)| *useless).map(|(option, _)| option).collect()
    }
}

/// What is asked of the rate of the first input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateChoice {
    /// Central differences if there is time and the model has a use for them.
    #[default]
    Auto,
    /// No rate.
    None,
    /// By this method.
    Method(RateMethod),
}

impl RateChoice {
    /// The rate of this model on data with or without time stamps.
    pub fn method(self, model: ModelName, has_time: bool) -> Option<RateMethod> {
        match self {
            Self::Auto => (has_time && model.uses_rate()).then_some(RateMethod::Central),
            Self::None => None,
            Self::Method(method) => Some(method),
        }
    }
}

impl FromStr for RateChoice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::None),
            method => Ok(Self::Method(method.parse()?)),
        }
    }
}

fn read<T: DeserializeOwned>(map: Map<String, Value>) -> std::result::Result<T, String> {
    serde_json::from_value(Value::Object(map)).map_err(|error| error.to_string())
}

/// A value by its name, with the error that the command line has for an unknown one.
fn named<'de, D, T>(deserializer: D) -> std::result::Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err = Error>,
{
    let name = Option::<String>::deserialize(deserializer)?;
    name.map(|name| name.parse().map_err(serde::de::Error::custom)).transpose()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn chosen(value: Value) -> Result<ChosenOptions> {
        let Value::Object(map) = value else { panic!("{value} is no map") };
        ChosenOptions::of(map)
    }

    #[test]
    fn nothing_chosen_is_the_default() {
        let rate = Some(RateMethod::Central);
        let request = chosen(json!({})).unwrap().request(rate, false);
        assert_eq!(request, Request::Auto(AutoOptions { rate, ..AutoOptions::default() }));
        for rival in Rival::ALL {
            let request = chosen(json!({ "model": rival.name() })).unwrap().request(None, false);
            assert_eq!(request, Request::Classical(ClassicalOptions::of(rival)));
        }
    }

    #[test]
    fn every_option_reaches_the_request() {
        let network = json!({ "model": "epnn", "stops": 3, "hidden": 4, "relaxation": 0, "no_deterioration": true,
            "training": "hybrid", "starts": 2, "epochs": 7, "population": 9, "stall": 0, "seed": 5, "validation": 0.5, "ridge": 1e-9 });
        let Request::Network(options) = chosen(network).unwrap().request(None, false) else { panic!() };
        let expected = FitOptions {
            model: Family::Xpnn,
            sizes: Sizes { stops: 3, hidden: 4, relaxation: 0 },
            no_deterioration: true,
            starts: 2,
            epochs: 7,
            population: 9,
            stall: 0,
            seed: 5,
            validation: Some(0.5),
            ridge: Some(1e-9),
            ..FitOptions::of(Trainer::Hybrid)
        };
        assert_eq!(options, expected);
        let rival = json!({ "model": "masing", "operators": 6, "thresholds": [0.5, 1.0], "sign": "non-positive",
            "dead_zones": 2, "free_weights": false, "logarithmic_thresholds": true, "degradation": true,
            "differential_form": true, "hidden": 4, "starts": 2, "epochs": 3, "seed": 5 });
        let Request::Classical(options) = chosen(rival).unwrap().request(None, false) else { panic!() };
        let expected = ClassicalOptions {
            model: Rival::Masing,
            operators: Some(6),
            thresholds: Some(vec![0.5, 1.0]),
            sign: Some(Sign::NonPositive),
            dead_zones: Some(2),
            free_weights: Some(false),
            logarithmic_thresholds: true,
            degradation: true,
            differential_form: true,
            hidden: Some(4),
            deterioration: None,
            rate: None,
            shaping: Shaping::default(),
            starts: Some(2),
            epochs: Some(3),
            seed: 5,
        };
        assert_eq!(options, expected);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (options, words) in [
            (json!({ "stop": 3 }), "there is no option `stop`: the options are companding, dead_zones,"),
            (json!({ "stops": 0 }), "stops 0: choose 1 to 1000"),
            (json!({ "stops": "many" }), "stops: invalid type: string \"many\""),
            (json!({ "model": "neuro-madelung", "epochs": u64::MAX }), "choose 0 to 1000000"),
            (json!({ "model": "xpn" }), "model: model `xpn` is unknown: choose one of auto, pnn, gpnn"),
            (json!({ "training": "lm" }), "training `lm` is unknown"),
            (json!({ "validation": 1.0 }), "validation 1: a number between 0 and 1 is needed"),
        ] {
            let error = chosen(options).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn useless_options_are_told() {
        let useless = |options| chosen(options).unwrap().useless();
        assert_eq!(useless(json!({ "population": 50, "stops": 3 })), ["population"]);
        assert_eq!(useless(json!({ "model": "masing", "stops": 3, "starts": 2 })), ["stops", "starts"]);
        assert!(
            useless(json!({ "model": "xpnn", "training": "hybrid", "population": 50, "degradation": false }))
                .is_empty()
        );
    }

    #[test]
    fn an_automatic_rate_needs_time_and_a_use() {
        let xpnn = "xpnn".parse().unwrap();
        assert_eq!(RateChoice::Auto.method(xpnn, true), Some(RateMethod::Central));
        assert_eq!(RateChoice::Auto.method(xpnn, false), None);
        assert_eq!(RateChoice::Auto.method("pnn".parse().unwrap(), true), None);
        assert_eq!("backward".parse(), Ok(RateChoice::Method(RateMethod::Backward)));
    }
}
