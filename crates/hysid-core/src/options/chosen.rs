//! The options of a fit by name, all optional: the common set of the command line and the Python package.

use std::str::FromStr;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, SpeedEvidence};
use crate::error::{Error, OptionError, Result};
use crate::law::thresholds::MOST_THRESHOLDS;
use crate::network::Family;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::fields::{fields_of, with_fields};
use crate::options::fit_spec::AutoOptions;
use crate::options::input_options::InputOptions;
use crate::options::network::{FitOptions, Trainer};
pub use crate::options::table::NamedOptions;
use crate::options::table::{FitOption, OPTIONS, OptionValues, check};
use crate::options::{FitSpec, ModelName};

/// Options that a network or a law has not in a field of the same name: those of the ensemble and of the input transform.
const ELSEWHERE: [&str; 7] =
    ["model", "members", "compression", "rate_compression", "history", "warm_up", "initial_state"];

impl NamedOptions {
    /// Options from a map of names and values; `null` is the default.
    ///
    /// # Errors
    /// An unknown name, an invalid value, or one that is invalid for this model.
    pub fn of(mut named: Map<String, Value>) -> Result<Self> {
        named.retain(|_, value| !value.is_null());
        check(named.iter().map(|(name, value)| (name.as_str(), value.clone())))?;
        let options: Self = serde_json::from_value(Value::Object(named))
            .map_err(|error| OptionError::value("options", Value::Null, error.to_string()))?;
        options.check()?;
        Ok(options)
    }

    fn check(&self) -> Result<()> {
        let (model, fields) = (self.model(), fields_of(self));
        let limits = match model {
            ModelName::Classical(rival) => rival.facts().limits,
            ModelName::Network(_) | ModelName::Auto(_) => &[],
        };
        let most_models = ("operators", 1, MOST_THRESHOLDS);
        let is_named = limits.iter().any(|limit| limit.0 == most_models.0);
        for (option, least, most) in limits.iter().copied().chain((!is_named).then_some(most_models)) {
            let Some(asked) = fields.get(option).and_then(Value::as_u64) else { continue };
            let asked = asked as usize;
            let needed = match asked {
                _ if asked < least => format!("{} has at least {least}", model.name()),
                _ if asked > most => format!("{} has at most {most}", model.name()),
                _ => continue,
            };
            return Err(OptionError::value(option, asked, needed).into());
        }
        Ok(())
    }

    /// The model.
    pub fn model(&self) -> ModelName {
        self.model.unwrap_or(ModelName::AUTO)
    }

    /// The specification of the fit to these data. Data that pass each place at one speed determine no relaxation either: `xpnn+`
    /// then has none by default, and needs no time.
    pub fn request_for(&self, choice: RateChoice, data: &Dataset) -> FitSpec {
        let rate = choice.method(self.model(), data);
        let always_rate = matches!(choice, RateChoice::Method(_));
        // A network that relaxes uses the rate of data with time unless they have one speed.
        let is_of_one_speed = choice == RateChoice::Auto && rate.is_none() && data.has_time();
        match self.model() {
            ModelName::Network(family) if family.relaxes() && is_of_one_speed => {
                Self { relaxation: self.relaxation.or(Some(0)), ..self.clone() }.request(rate, always_rate)
            }
            _ => self.request(rate, always_rate),
        }
    }

    /// The specification of the fit. `always_rate` is true if only models with the rate are allowed.
    pub fn request(&self, rate: Option<RateMethod>, always_rate: bool) -> FitSpec {
        let used = self.used();
        let alone = match self.model() {
            ModelName::Network(family) => FitSpec::Network(used.of_network(family, rate)),
            ModelName::Classical(rival) => FitSpec::Classical(used.of_rival(rival, rate)),
            ModelName::Auto(_) => return FitSpec::Auto(used.of_auto(rate, always_rate, None)),
        };
        match (self.members, alone) {
            (None | Some(0 | 1), alone) => alone,
            (Some(_), mut alone) => {
                match &mut alone {
                    FitSpec::Network(options) => options.starts = 1,
                    FitSpec::Classical(options) if options.model.is_random() => {
                        options.starts = Some(1);
                    }
                    FitSpec::Classical(_) | FitSpec::Auto(_) => {}
                }
                FitSpec::Auto(used.of_auto(rate, always_rate, Some(Box::new(alone))))
            }
        }
    }

    /// The same without the options that the model or its trainer ignores.
    fn used(&self) -> Self {
        let ignored = self.ignored();
        with_fields(self, ignored.into_iter().map(|ignored| (ignored.option.into(), Value::Null)))
    }

    fn of_auto(
        &self,
        rate: Option<RateMethod>,
        always_rate: bool,
        only: Option<Box<FitSpec>>,
    ) -> AutoOptions {
        let elsewhere = ["model", "compression", "no_deterioration"];
        let of_others = OPTIONS.iter().filter(|option| !option.is_used_by(ModelName::AUTO, self.trainer()));
        let elsewhere: Vec<&str> = of_others.map(|option| option.name).chain(elsewhere).collect();
        let defaults = self.onto(&AutoOptions::default(), &elsewhere);
        let starts = if only.is_some() { defaults.members } else { defaults.effort.starts() };
        AutoOptions {
            // Of one model, all members are starts.
            starts: self.starts.unwrap_or(starts),
            only,
            rate,
            always_rate: always_rate && rate.is_some(),
            deterioration: self.no_deterioration.map(|none| !none),
            compression: self.compression.map(|share| share > 0.0),
            ..defaults
        }
    }

    fn of_network(&self, model: Family, rate: Option<RateMethod>) -> FitOptions {
        let defaults = FitOptions { model, rate, shaping: self.shaping(), ..FitOptions::of(self.trainer()) };
        self.onto(&defaults, &ELSEWHERE)
    }

    fn of_rival(&self, model: ClassicalModel, rate: Option<RateMethod>) -> ClassicalOptions {
        let deterioration = self.no_deterioration.map(|none| !none);
        let shaping = self.shaping();
        let defaults = ClassicalOptions { rate, shaping, deterioration, ..ClassicalOptions::of(model) };
        self.onto(&defaults, &[&ELSEWHERE[..], &["no_deterioration"]].concat())
    }

    /// The defaults with the chosen options in the fields of their names, but for the options that are elsewhere.
    fn onto<T: Serialize + DeserializeOwned>(&self, defaults: &T, elsewhere: &[&str]) -> T {
        let is_chosen =
            |(name, value): &(String, Value)| !value.is_null() && !elsewhere.contains(&name.as_str());
        with_fields(defaults, fields_of(self).into_iter().filter(is_chosen))
    }

    fn shaping(&self) -> InputOptions {
        InputOptions {
            compression: self.compression.filter(|share| *share != 0.0),
            rate_compression: self.rate_compression.filter(|share| *share != 0.0),
            history: self.history.unwrap_or_default(),
            warm_up: self.warm_up.unwrap_or_default(),
            initial_state: self.initial_state,
        }
    }

    fn trainer(&self) -> Trainer {
        self.training.unwrap_or_default()
    }

    /// Options that were set and that the model, or the trainer of a network, ignores.
    pub fn ignored(&self) -> Vec<Ignored> {
        let named = fields_of(self);
        // A flag that is not set asks for nothing.
        let is_asked = |option: &FitOption| match named.get(option.name) {
            None | Some(Value::Null) => false,
            Some(Value::Bool(false)) => matches!(option.values, OptionValues::Truth),
            Some(_) => true,
        };
        let (model, trainer) = (self.model(), self.trainer());
        let ignored = OPTIONS.iter().filter(|option| is_asked(option) && !option.is_used_by(model, trainer));
        let by_whom = |option: &'static FitOption| {
            let by = if option.users().contains(&model) { trainer.name() } else { model.name() };
            Ignored { option: option.name, by }
        };
        ignored.map(by_whom).collect()
    }
}

/// An option that was set and is ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ignored {
    /// Its name, in words joined by underscores.
    pub option: &'static str,
    /// The model, or the trainer, that ignores it.
    pub by: &'static str,
}

/// Choice of the rate of the first input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateChoice {
    /// Backward differences, if the model needs a rate, or uses one and the data show several speeds
    /// ([`Dataset::speeds`]).
    #[default]
    Auto,
    /// No rate.
    None,
    /// A rate that is computed by this method.
    Method(RateMethod),
}

impl RateChoice {
    /// The rate of this model on these data.
    pub fn method(self, model: ModelName, data: &Dataset) -> Option<RateMethod> {
        let is_shown = || model.uses_rate() && (model.needs_rate() || data.speeds() != SpeedEvidence::One);
        match self {
            Self::Auto => (data.has_time() && is_shown()).then_some(RateMethod::Backward),
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::data::record::{ColumnNames, Record};
    use crate::elementary::sin;
    use crate::network::Sizes;
    use crate::options::classical::Sign;

    fn chosen(value: Value) -> Result<NamedOptions> {
        let Value::Object(map) = value else { panic!("{value} is no map") };
        NamedOptions::of(map)
    }

    #[test]
    fn nothing_chosen_is_the_default() {
        let rate = Some(RateMethod::Central);
        let request = chosen(json!({})).unwrap().request(rate, false);
        assert_eq!(request, FitSpec::Auto(AutoOptions { rate, ..AutoOptions::default() }));
        for &rival in ClassicalModel::ALL {
            let request = chosen(json!({ "model": rival.name() })).unwrap().request(None, false);
            assert_eq!(request, FitSpec::Classical(ClassicalOptions::of(rival)));
        }
    }

    #[test]
    fn every_option_reaches_the_request() {
        let network = json!({ "model": "epnn", "stops": 3, "hidden": 4, "no_deterioration": true,
            "training": "hybrid", "starts": 2, "epochs": 7, "population": 9, "stall": 0, "seed": 5, "validation": 0.5, "ridge": 1e-9 });
        let FitSpec::Network(options) = chosen(network).unwrap().request(None, false) else { panic!() };
        let expected = FitOptions {
            model: Family::Xpnn,
            sizes: Sizes { stops: 3, hidden: 4, ..Sizes::default() },
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
        let law = |options| match chosen(options).unwrap().request(None, false) {
            FitSpec::Classical(options) => options,
            other => panic!("{other:?}"),
        };
        let given = json!({ "model": "modified-prandtl-ishlinskii", "operators": 6, "thresholds": [0.5, 1.0],
            "sign": "non-positive", "dead_zones": 2, "seed": 5 });
        let expected = ClassicalOptions {
            operators: Some(6),
            thresholds: Some(vec![0.5, 1.0]),
            sign: Some(Sign::NonPositive),
            dead_zones: Some(2),
            seed: 5,
            ..ClassicalOptions::of(ClassicalModel::ModifiedPrandtlIshlinskii)
        };
        assert_eq!(law(given), expected);
        let random_stops = law(json!({ "model": "random-stops", "hidden": 4, "no_deterioration": true }));
        assert_eq!((random_stops.hidden, random_stops.deterioration), (Some(4), Some(false)));
    }

    #[test]
    fn every_option_changes_the_request_of_each_of_its_users() {
        let values = |option: &FitOption| match option.values {
            OptionValues::Count(low, _) => [json!(low.max(2)), json!(low.max(2) + 1)],
            OptionValues::Whole => [json!(2), json!(3)],
            OptionValues::Positive => [json!([0.5]), json!([0.6])],
            OptionValues::Flag | OptionValues::Truth => [json!(true), json!(false)],
            OptionValues::Span => [json!(100), json!("0.5s")],
            OptionValues::Names(names) => [json!(names()[0]), json!(names()[1])],
            OptionValues::Fraction | OptionValues::ZeroOr(..) | OptionValues::Number(..) => {
                [json!(0.3), json!(0.4)]
            }
        };
        for option in OPTIONS.iter().filter(|option| option.name != "model") {
            for model in option.users() {
                let mut trainers = Trainer::ALL.into_iter();
                let trainer = trainers.find(|trainer| option.is_used_by(model, *trainer)).unwrap();
                let request = |value: &Value| {
                    let named =
                        json!({ "model": model.name(), "training": trainer.name(), option.name: value });
                    chosen(named).unwrap().request(None, false)
                };
                let plain = request(&Value::Null);
                let is_seen = values(option).iter().any(|value| request(value) != plain);
                assert!(is_seen, "{} of {}", option.name, model.name());
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (options, words) in [
            (json!({ "stop": 3 }), "there is no option `stop`: the options are model, members,"),
            (json!({ "stops": 0 }), "stops 0: choose a whole number from 1 to 1000"),
            (json!({ "stops": "many" }), "stops \"many\": choose a whole number from 1 to 1000"),
            (json!({ "epochs": u64::MAX }), "choose a whole number from 0 to 1000000"),
            (json!({ "model": "neuro-madelung", "hidden": 500 }), "neuro-madelung has at most 100"),
            (json!({ "model": "preisach", "operators": 201 }), "operators 201: preisach has at most 200"),
            (json!({ "model": "preisach", "operators": 0 }), "operators 0: preisach has at least 1"),
            (json!({ "model": "masing", "operators": 0 }), "operators 0: masing has at least 1"),
            (json!({ "operators": 0 }), "operators 0: auto has at least 1"),
            (json!({ "model": "duhem-nn", "operators": 101 }), "operators 101: duhem-nn has at most 100"),
            (json!({ "model": "duhem-nn", "states": 0 }), "states 0: duhem-nn has at least 1"),
            (json!({ "model": "duhem-nn", "states": 21 }), "states 21: choose a whole number from 0 to 20"),
            (json!({ "model": "duhem-nn", "hidden": 0 }), "hidden 0: choose a whole number from 1 to 1000"),
            (json!({ "model": "xpn" }), "model \"xpn\": choose one of auto, pnn, gpnn"),
            (json!({ "training": "lm" }), "training \"lm\": choose one of subgradient, levenberg-marquardt,"),
            (json!({ "validation": 1.0 }), "validation 1.0: a number between 0 and 1 is needed"),
            (json!({ "thresholds": 0.5 }), "thresholds 0.5: numbers above 0 are needed"),
        ] {
            let error = chosen(options).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn ignored_options_are_named_and_change_nothing() {
        let names = |asked: &NamedOptions| -> Vec<&str> {
            asked.ignored().into_iter().map(|ignored| ignored.option).collect()
        };
        let ignored = |options| names(&chosen(options).unwrap());
        assert_eq!(ignored(json!({ "population": 50, "stops": 3 })), ["population"]);
        assert_eq!(ignored(json!({ "model": "masing", "stops": 3, "starts": 2 })), ["stops", "starts"]);
        assert!(
            ignored(json!({ "model": "xpnn", "training": "hybrid", "population": 50, "degradation": false }))
                .is_empty()
        );
        for (model, option, value) in [
            ("pnn", "history", json!(true)),
            ("xpnn", "history", json!(true)),
            ("masing", "history", json!(true)),
            ("bouc-wen", "history", json!(true)),
            ("pnn", "hidden", json!(7)),
            ("pnn", "relaxation", json!(9)),
            ("preisach-nn", "no_deterioration", json!(true)),
            ("preisach", "validation", json!(0.5)),
        ] {
            let asked = chosen(json!({ "model": model, option: value })).unwrap();
            assert_eq!(names(&asked), [option], "{model}");
            let plain = chosen(json!({ "model": model })).unwrap();
            assert_eq!(asked.request(None, false), plain.request(None, false), "{model} {option}");
        }
        assert!(ignored(json!({ "model": "random-stops", "no_deterioration": true })).is_empty());
        let by_whom = |options| chosen(options).unwrap().ignored()[0].by;
        assert_eq!(by_whom(json!({ "model": "xpnn", "population": 50 })), "subgradient");
        assert_eq!(by_whom(json!({ "model": "pnn", "history": true })), "pnn");
    }

    #[test]
    fn every_option_is_used_by_some_model_and_a_law_lists_none_that_is_not_there() {
        for option in OPTIONS {
            assert!(!option.users().is_empty(), "{}", option.name);
        }
        for &rival in ClassicalModel::ALL {
            for option in rival.facts().options {
                assert!(FitOption::named(option).is_some(), "{} lists `{option}`", rival.name());
            }
        }
    }

    #[test]
    fn an_automatic_rate_needs_a_use_and_several_speeds() {
        // A sine whose frequency rises, run so many times faster.
        let sweep = |rise: f64| {
            let time: Vec<f64> = (0..1000).map(|row| 0.01 * f64::from(row)).collect();
            let x: Vec<f64> = time.iter().map(|t| sin(5.0 * t + rise * t * t)).collect();
            let record = Record::new("r", vec![x.clone()], x).unwrap().with_time(time).unwrap();
            Dataset::new(ColumnNames { time: Some("t".into()), ..ColumnNames::plain(1) }, vec![record])
                .unwrap()
        };
        let rate = |model: &str, rise: f64| RateChoice::Auto.method(model.parse().unwrap(), &sweep(rise));
        assert_eq!(rate("xpnn", 2.0), Some(RateMethod::Backward));
        assert_eq!(rate("xpnn", 0.0), None);
        assert_eq!(rate("lugre", 0.0), Some(RateMethod::Backward), "a model that is nothing without it");
        assert_eq!(rate("pnn", 2.0), None);
        assert_eq!("backward".parse(), Ok(RateChoice::Method(RateMethod::Backward)));

        let relaxation = |options: Value, choice: RateChoice, rise: f64| match chosen(options)
            .unwrap()
            .request_for(choice, &sweep(rise))
        {
            FitSpec::Network(options) => options.sizes.relaxation,
            other => panic!("{other:?}"),
        };
        assert_eq!(relaxation(json!({"model": "xpnn+"}), RateChoice::Auto, 0.0), 0);
        assert_eq!(relaxation(json!({"model": "xpnn+"}), RateChoice::Auto, 2.0), 4);
        assert_eq!(relaxation(json!({"model": "xpnn+"}), RateChoice::None, 0.0), 4, "creep without a rate");
        assert_eq!(relaxation(json!({"model": "xpnn+", "relaxation": 3}), RateChoice::Auto, 0.0), 3);
    }
}
