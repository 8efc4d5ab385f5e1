//! Cautions before a fit: data that do not suit the model.

use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, SpeedEvidence};
use crate::data::warning::Warning;
use crate::law::facts::Origin;
use crate::options::{FitSpec, ModelName};
use crate::significant::Significant;
use crate::words::{Hint, Words};

/// Half ranges that the middle of the field may lie away from 0.
const FAR: f64 = 2.0;

impl FitSpec {
    /// Cautions for a fit of this model to these data, in sentences.
    pub fn cautions(&self, data: &Dataset) -> Vec<Words> {
        let model = self.model();
        let mut cautions = Vec::new();
        if self.rate().is_some() && !model.uses_rate() {
            cautions.push(format!("{} ignores the rate (xpnn and xpnn+ use it)", model.name()).into());
        }
        cautions.extend(self.acceleration_not_used(data));
        cautions.extend(self.rate_not_shown(data));
        cautions.extend(far_from_zero(model, data).map(Words::from));
        cautions.extend(self.larger_than(data).map(|warning| warning.to_string().into()));
        cautions
    }
}

impl FitSpec {
    /// An acceleration that was asked for although the data, or the options, have no time or no rate to go with it.
    fn acceleration_not_used(&self, data: &Dataset) -> Option<Words> {
        let Self::Classical(options) = self else { return None };
        let is_ignored = options.acceleration && (options.rate.is_none() || !data.has_time());
        is_ignored.then(|| {
            Words::from(options.model.name())
                + " ignores "
                + Hint::Option("acceleration")
                + ", which needs time stamps and a rate"
        })
    }

    /// A rate that is used although the data pass each place at one speed; `auto` tries models without it too.
    fn rate_not_shown(&self, data: &Dataset) -> Option<Words> {
        let model = self.model();
        let is_used = matches!(self.rate(), Some(method) if method != RateMethod::Given) && model.uses_rate();
        (is_used && data.speeds() == SpeedEvidence::One).then(|| {
            let words = Words::from(format!(
                "{} uses the rate, but the data pass each place of {} at one speed: at other speeds the model is \
                 arbitrary",
                model.name(),
                data.names().inputs[0]
            ));
            words.advised(Words::from(Hint::Value("rate", "none".into())) + " leaves the rate out")
        })
    }

    /// A network with more parameters than rows with an output; of other models there is a note after the fit.
    fn larger_than(&self, data: &Dataset) -> Option<Warning> {
        let Self::Network(options) = self else { return None };
        // Sizes that no network can have are refused by the fit.
        Warning::of_size(options.architecture(data).ok()?.parameters(), data.scored())
    }
}

/// Data far from the special state that a law has at an input of 0; other models measure the input from where the data
/// go about.
fn far_from_zero(model: ModelName, data: &Dataset) -> Option<String> {
    let ModelName::Classical(law) = model else { return None };
    let Origin::Zero(state) = law.facts().origin else { return None };
    let (low, high) = data.input_range(0);
    let (middle, half_range) = (0.5 * (low + high), 0.5 * (high - low));
    (middle.abs() > FAR * half_range).then(|| {
        format!(
            "{}: {} ranges from {:.4} to {:.4}, but for the law 0 is {state} (subtract the offset of the \
             input, or fit another model)",
            model.name(),
            data.names().inputs[0],
            Significant(low),
            Significant(high)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::rate::RateMethod;
    use crate::data::record::{ColumnNames, Record};
    use crate::elementary::sin;
    use crate::options::classical::ClassicalModel;

    fn data(offset: f64) -> Dataset {
        let x: Vec<f64> = (0..100).map(|row| offset + sin(0.1 * f64::from(row))).collect();
        let record = Record::new("r", vec![x.clone()], x).unwrap();
        Dataset::new(ColumnNames::plain(1), vec![record]).unwrap()
    }

    #[test]
    fn a_field_far_from_zero_is_told_of_for_the_law_that_needs_zero() {
        let cautions = |model, offset| FitSpec::of(model, None, 1).cautions(&data(offset));
        let jiles_atherton = ModelName::Classical(ClassicalModel::JilesAtherton);
        assert!(cautions(jiles_atherton, 0.0).is_empty());
        assert!(cautions(jiles_atherton, 1.5).is_empty());
        let [caution] = &cautions(jiles_atherton, 200.0)[..] else { panic!("one caution") };
        let caution = format!("{caution:?}");
        assert!(caution.contains("199") && caution.contains("201"), "{caution}");
        assert!(cautions(ModelName::Classical(ClassicalModel::Preisach), 200.0).is_empty());
    }

    #[test]
    fn a_rate_that_a_model_cannot_use_is_told_of() {
        let rival = ClassicalModel::Preisach;
        let options = crate::options::classical::ClassicalOptions {
            rate: Some(RateMethod::Central),
            ..crate::options::classical::ClassicalOptions::of(rival)
        };
        let cautions = FitSpec::Classical(options).cautions(&data(0.0));
        assert_eq!(cautions, [Words::from("preisach ignores the rate (xpnn and xpnn+ use it)")]);
    }
    #[test]
    fn an_acceleration_that_cannot_be_computed_is_told_of() {
        let options = |acceleration, rate| crate::options::classical::ClassicalOptions {
            acceleration,
            rate,
            ..crate::options::classical::ClassicalOptions::of(ClassicalModel::DuhemNn)
        };
        let cautions =
            |acceleration, rate| FitSpec::Classical(options(acceleration, rate)).cautions(&data(0.0)).len();
        assert_eq!([cautions(true, None), cautions(false, None)], [1, 0]);
    }
}
