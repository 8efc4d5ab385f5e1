//! Defaults in words, for help and pages.

use std::borrow::Borrow;

use crate::options::ModelName;
use crate::options::network::Trainer;
use crate::options::preset::Preset;
use crate::options::table::FitOption;

impl FitOption {
    /// Its defaults in words, with the models that have them.
    pub fn default_in_words(&self) -> String {
        let mut groups: Vec<(String, Vec<&'static str>)> = Vec::new();
        for (name, preset) in by_name(self) {
            let text = preset.to_string();
            match groups.iter_mut().find(|group| group.0 == text) {
                Some(group) => group.1.push(name),
                None => groups.push((text, vec![name])),
            }
        }
        if let [(only, _)] = &groups[..] {
            return only.clone();
        }
        let longest = groups.iter().map(|group| group.1.len()).max().unwrap_or_default();
        let (named, otherwise): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|group| group.1.len() < longest.max(MOST_NAMES + 1));
        let named = named.into_iter().map(|(text, names)| format!("{text} for {}", listed(&names)));
        let otherwise = otherwise.into_iter().map(|(text, _)| format!("otherwise {text}"));
        named.chain(otherwise).collect::<Vec<_>>().join("; ")
    }
}

/// Names that one default is listed for at most; a longer list becomes "otherwise".
const MOST_NAMES: usize = 5;

/// The defaults of an option with the name of the model, or of the trainer where networks differ by it.
fn by_name(option: &FitOption) -> Vec<(&'static str, Preset)> {
    let users = option.users();
    let network = users.iter().copied().find(|model| matches!(model, ModelName::Network(_)));
    let of_trainers: Vec<(&'static str, Preset)> = network
        .into_iter()
        .flat_map(|network| Trainer::ALL.map(|trainer| (network, trainer)))
        .filter(|(network, trainer)| option.is_used_by(*network, *trainer))
        .map(|(network, trainer)| (trainer.name(), option.default(network, trainer)))
        .collect();
    let all_alike = of_trainers.windows(2).all(|pair| pair[0].1 == pair[1].1);
    let of_networks = match of_trainers.first() {
        Some((_, preset)) if all_alike => vec![("networks", *preset)],
        _ => of_trainers,
    };
    let others = users.into_iter().filter(|model| !matches!(model, ModelName::Network(_)));
    let others = others.map(|model| (model.name(), option.default(model, Trainer::default())));
    of_networks.into_iter().chain(others).collect()
}

/// `a, b and c`.
pub(crate) fn listed<S: Borrow<str>>(parts: &[S]) -> String {
    match parts {
        [first @ .., last] if !first.is_empty() => format!("{} and {}", first.join(", "), last.borrow()),
        _ => parts.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::classical::{ClassicalModel, ClassicalOptions};

    #[test]
    fn a_printed_default_is_the_value_that_a_fit_takes() {
        for &law in ClassicalModel::ALL {
            let options = ClassicalOptions::of(law);
            let degrading = ClassicalOptions { degradation: true, ..options.clone() };
            let taken = |options: &ClassicalOptions, name: &str| match name {
                "operators" => options.operators(),
                "hidden" => options.hidden(),
                "states" => options.states(),
                "modes" => options.modes(),
                "dead_zones" => options.dead_zones(),
                "starts" => options.starts(),
                "epochs" => options.epochs(),
                _ => unreachable!("an option that counts something"),
            };
            for name in ["operators", "hidden", "states", "modes", "dead_zones", "starts", "epochs"] {
                let option = FitOption::named(name).unwrap();
                if !option.is_used_by(ModelName::Classical(law), Trainer::default()) {
                    continue;
                }
                let printed = match option.default(ModelName::Classical(law), Trainer::default()) {
                    Preset::Count(count) => [count; 2],
                    Preset::WithDegradation(plain, degrading) => [plain, degrading],
                    Preset::Chosen => continue,
                    other => panic!("{name} of {}: {other:?}", law.name()),
                };
                assert_eq!(
                    printed,
                    [taken(&options, name), taken(&degrading, name)],
                    "{name} {}",
                    law.name()
                );
            }
        }
    }

    #[test]
    fn networks_differ_only_by_their_trainer() {
        for option in crate::options::table::OPTIONS {
            let networks = option.users().into_iter().filter(|model| matches!(model, ModelName::Network(_)));
            let networks: Vec<ModelName> = networks.collect();
            for trainer in Trainer::ALL {
                for pair in networks.windows(2) {
                    assert_eq!(option.default(pair[0], trainer), option.default(pair[1], trainer));
                }
            }
        }
    }
}
