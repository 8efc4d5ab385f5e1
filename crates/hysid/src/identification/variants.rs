//! The variants of a law: the same equations with and without a term that not every specimen needs.

use crate::classical::identification::{ClassicalOptions, Rival};
use crate::identification::Request;

impl Request {
    /// The same in all variants of its law, the simplest first: Bouc-Wen with and without degradation,
    /// Jiles-Atherton in both forms, rate-dependent Prandtl-Ishlinskii with both spacings of its thresholds, and
    /// laws that can leave out the rate with and without it. A network has one variant.
    pub fn variants(&self) -> Vec<Self> {
        match self {
            Self::Classical(options) => variants(options).into_iter().map(Self::Classical).collect(),
            Self::Network(_) | Self::Auto(_) => vec![self.clone()],
        }
    }
}

/// The variants of a law with these options.
pub(crate) fn variants(options: &ClassicalOptions) -> Vec<ClassicalOptions> {
    let (degradation, differential_form, logarithmic_thresholds): (&[bool], &[bool], &[bool]) =
        match options.model {
            Rival::BoucWen => (&[false, true], &[false], &[false]),
            Rival::JilesAtherton => (&[false], &[false, true], &[false]),
            Rival::RateDependentPrandtlIshlinskii => (&[false], &[false], &[false, true]),
            _ => (&[false], &[false], &[false]),
        };
    let with_rate = options.model.uses_rate() && options.rate.is_some();
    let rates = match (with_rate, options.model.needs_rate() || options.model == Rival::RandomStops) {
        (false, _) => vec![None],
        (true, true) => vec![options.rate],
        (true, false) => vec![None, options.rate],
    };
    let mut all = Vec::new();
    for &rate in &rates {
        for &degradation in degradation {
            for &differential_form in differential_form {
                for &logarithmic_thresholds in logarithmic_thresholds {
                    all.push(ClassicalOptions {
                        rate,
                        degradation,
                        differential_form,
                        logarithmic_thresholds,
                        ..options.clone()
                    });
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::ModelName;
    use crate::rate::RateMethod;

    fn labels(model: ModelName, rate: Option<RateMethod>) -> Vec<String> {
        Request::of(model, rate, 1).variants().iter().map(Request::label).collect()
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
    fn the_simplest_variant_comes_first() {
        let bouc_wen = ModelName::Rival(Rival::BoucWen);
        assert_eq!(labels(bouc_wen, None), ["bouc-wen", "bouc-wen (degradation)"]);
        assert_eq!(
            labels(bouc_wen, Some(RateMethod::Central)),
            ["bouc-wen", "bouc-wen (degradation)", "bouc-wen (rate)", "bouc-wen (degradation, rate)"]
        );
        assert_eq!(labels(ModelName::AUTO, None), ["auto"]);
    }
}
