//! Variants of a law: its equations with and without an optional term, or in another form.

use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};

impl FitSpec {
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
    let needs_rate = options.model.needs_rate() || options.model == ClassicalModel::RandomStops;
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
    let with = |options: &ClassicalOptions, variant, is_there| {
        let mut options = options.clone();
        *options.variant(variant).expect("a law names an option that there is") = is_there;
        options
    };
    let both = |variant| move |options: ClassicalOptions| [false, true].map(|is| with(&options, variant, is));
    let variants = options.model.facts().variants.iter();
    variants.fold(vec![options.clone()], |all, variant| all.into_iter().flat_map(both(variant)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::rate::RateMethod;
    use crate::options::ModelName;

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
