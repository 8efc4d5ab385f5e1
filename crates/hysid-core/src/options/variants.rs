//! Variants of a law: its equations with and without an optional term, or in another form.

use serde_json::Value;

use crate::network::Family;
use crate::options::FitSpec;
use crate::options::classical::ClassicalOptions;
use crate::options::fields::{fields_of, with_fields};
use crate::options::network::ENSEMBLE_PENALTIES;
use crate::options::table::{FitOption, OptionValues};

impl FitSpec {
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
            Self::Classical(options) => (options.shaping, of_law(options)),
            Self::Auto(_) => return Vec::new(),
        };
        if let Self::Network(options) = self {
            let ridge = options.ridge.filter(|ridge| *ridge != ENSEMBLE_PENALTIES.ridge);
            variant.extend(ridge.map(|ridge| format!("ridge {ridge:e}")));
        }
        variant.extend(shaping.compression.map(|share| format!("input compressed {share}")));
        variant.extend(shaping.rate_compression.map(|share| format!("rate compressed {share}")));
        variant.extend(shaping.history.then(|| "history".to_string()));
        variant.extend(self.has_free_states().then(|| "initial state free".to_string()));
        variant
    }

    /// The name of the model, and of the variant of its law if it has more than one.
    pub fn variant_label(&self) -> String {
        if self.variants().len() > 1 { self.label() } else { self.model().name().into() }
    }

    /// This specification in all variants of its law, the simplest first: Bouc-Wen and peak-oriented with and
    /// without degradation, peak-oriented and Menegotto-Pinto with the same and with different sides,
    /// Jiles-Atherton in both forms, rate-dependent Prandtl-Ishlinskii with both spacings of its
    /// thresholds, and laws with an optional rate with and without it. A network has one variant.
    pub fn variants(&self) -> Vec<Self> {
        match self {
            Self::Classical(options) => variants(options).into_iter().map(Self::Classical).collect(),
            Self::Network(_) | Self::Auto(_) => vec![self.clone()],
        }
    }
}

/// The variants of a law with these options.
pub fn variants(options: &ClassicalOptions) -> Vec<ClassicalOptions> {
    let rate = options.rate.filter(|_| options.model.uses_rate());
    let needs_rate = options.model.needs_rate() || options.model.is_network();
    let without_rate = ClassicalOptions { rate: None, ..options.clone() };
    let with_rate = rate.map(|rate| ClassicalOptions { rate: Some(rate), ..options.clone() });
    let by_rate = match with_rate {
        Some(with_rate) if needs_rate => vec![with_rate],
        Some(with_rate) => vec![without_rate, with_rate],
        None => vec![without_rate],
    };
    by_rate.iter().flat_map(terms).collect()
}

fn terms(options: &ClassicalOptions) -> Vec<ClassicalOptions> {
    let both = |option: &'static str| {
        move |options: ClassicalOptions| {
            [false, true].map(|is_there| {
                let near = options.near.clone();
                ClassicalOptions { near, ..with_fields(&options, [(option.into(), is_there.into())]) }
            })
        }
    };
    let variants = options.model.facts().variants.iter();
    variants.fold(vec![options.clone()], |all, variant| all.into_iter().flat_map(both(variant)).collect())
}

/// Flags, rate and parts of a law, in a few words.
fn of_law(options: &ClassicalOptions) -> Vec<String> {
    let fields = fields_of(options);
    let is_flag = |name: &&&str| {
        matches!(FitOption::named(name), Some(FitOption { values: OptionValues::Flag, .. }))
            && fields.get(**name) == Some(&Value::Bool(true))
    };
    let flags = options.model.facts().options.iter().filter(is_flag).map(|name| name.replace('_', " "));
    let has_no_memory = options.has_no_memory();
    let deterioration = named([("deterioration", options.deterioration == Some(true))]);
    let others = named([
        ("rate", options.rate.is_some() && !options.model.needs_rate()),
        ("tanh layer", options.has_random_tanh_layer()),
        ("no stops", options.operators == Some(0) && !has_no_memory),
        ("no memory", has_no_memory),
    ]);
    let modes =
        options.modes.map(|modes| if modes == 1 { "1 mode".into() } else { format!("{modes} modes") });
    deterioration.into_iter().chain(flags).chain(others).chain(modes).collect()
}

/// The names of what is so.
fn named<const N: usize>(all: [(&str, bool); N]) -> Vec<String> {
    all.into_iter().filter(|(_, is_so)| *is_so).map(|(name, _)| name.to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::rate::RateMethod;
    use crate::options::ModelName;
    use crate::options::classical::ClassicalModel;

    fn labels(model: ModelName, rate: Option<RateMethod>) -> Vec<String> {
        FitSpec::of(model, rate, 1).variants().iter().map(FitSpec::variant_label).collect()
    }

    #[test]
    fn every_variant_has_a_label_of_its_own() {
        let rate = Some(RateMethod::Central);
        let all: Vec<String> = ModelName::all().flat_map(|model| labels(model, rate)).collect();
        let mut distinct = all.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), all.len(), "{all:?}");
    }

    #[test]
    fn a_model_with_inertia_tells_its_modes_and_whether_it_has_memory() {
        let label = |options: ClassicalOptions| FitSpec::Classical(options).label();
        let plain = ClassicalOptions::of(ClassicalModel::HystereticOscillator);
        let without_states = ClassicalOptions { states: Some(0), modes: Some(1), ..plain.clone() };
        let degrading = ClassicalOptions { degradation: true, modes: Some(2), ..without_states.clone() };
        assert_eq!(label(plain), "hysteretic-oscillator");
        assert_eq!(label(without_states), "hysteretic-oscillator (no memory, 1 mode)");
        // It has deteriorating stops.
        assert_eq!(label(degrading), "hysteretic-oscillator (degradation, 2 modes)");
    }
}
