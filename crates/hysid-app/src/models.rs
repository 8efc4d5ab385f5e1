//! All models that a fit can use, each with what it is.

use hysid::law::facts::Rate;
use hysid::options::ModelName;
use hysid::options::network::Trainer;
use hysid::options::table::OPTIONS;
use hysid_core::network::Architecture;
use hysid_document::plain::{aligned, indented};
use serde::Serialize;

#[derive(Debug, Serialize)]
pub struct Listed {
    /// Its name, as `--model` takes it.
    pub name: &'static str,
    /// Kind of model, in a few words.
    pub what: &'static str,
    /// `network`, `law` or `ensemble`.
    pub kind: &'static str,
    /// How its parameters are found.
    pub identified_by: &'static str,
    /// Whether it uses the rate of the input, which needs time stamps: `no`, `optional` or `needed`.
    pub rate: &'static str,
    /// Whether it takes more than one input.
    pub several_inputs: bool,
    /// Options of a fit that are for it and not for all models, such as `operators`.
    pub options: Vec<&'static str>,
}

/// All models, `auto` first.
pub fn all() -> Vec<Listed> {
    std::iter::once(ModelName::AUTO).chain(ModelName::all()).map(Listed::of).collect()
}

/// The list as text within 80 columns.
pub fn text(models: &[Listed]) -> String {
    let heading = ["model", "rate", "inputs", "identified by"].map(String::from).to_vec();
    let row = |model: &Listed| {
        let inputs = if model.several_inputs { "several" } else { "one" };
        [model.name, model.rate, inputs, model.identified_by].map(String::from).to_vec()
    };
    let rows: Vec<Vec<String>> = std::iter::once(heading).chain(models.iter().map(row)).collect();
    let lines = aligned(&rows);
    let mut text = format!("{}\n", lines[0]);
    for (line, model) in lines[1..].iter().zip(models) {
        text += &format!("{line}\n{}", indented(model.what, 4));
    }
    text + "\nfit one: hysid fit DATA.csv --model NAME; compare all: hysid compare\n"
}

impl Listed {
    pub fn of(model: ModelName) -> Self {
        let (kind, identified_by) = match model {
            ModelName::Auto(_) => ("ensemble", "cross-validation"),
            ModelName::Network(_) => ("network", "search"),
            // Its equations are those of the networks.
            ModelName::Classical(model) if model.is_network() => ("network", "least squares"),
            ModelName::Classical(law) if law.is_searched() => ("law", "search"),
            ModelName::Classical(_) => ("law", "least squares"),
        };
        let rate = match model {
            ModelName::Classical(law) => match law.facts().rate {
                Rate::Ignored => "no",
                Rate::Optional => "optional",
                Rate::Needed => "needed",
            },
            other if other.uses_rate() => "optional",
            _ => "no",
        };
        Self {
            name: model.name(),
            what: what(model),
            kind,
            identified_by,
            rate,
            several_inputs: model.takes_further_inputs(),
            options: own_options(model),
        }
    }
}

/// Options that this model uses and some other does not.
fn own_options(model: ModelName) -> Vec<&'static str> {
    let is_used = |model: ModelName, option: &hysid::options::table::FitOption| {
        Trainer::ALL.iter().any(|trainer| option.is_used_by(model, *trainer))
    };
    let own = OPTIONS
        .iter()
        .filter(|option| is_used(model, option) && !ModelName::all().all(|other| is_used(other, option)));
    own.map(|option| option.name).collect()
}

/// Describes a model in a few words; docs/models.md says more.
fn what(model: ModelName) -> &'static str {
    match model {
        ModelName::Auto(_) => {
            "the default: an ensemble of the models below with the lowest cross-validation errors"
        }
        ModelName::Network(family) => family.summary(),
        ModelName::Classical(law) => law.facts().summary,
    }
}

/// The neurons of a network, in words.
pub fn parts(architecture: &Architecture) -> String {
    let deteriorating = if architecture.deterioration { "deteriorating " } else { "" };
    let mut parts = vec![format!("{} {deteriorating}stops", architecture.stops)];
    if architecture.hidden > 0 {
        parts.push(format!("{} hidden", architecture.hidden));
    }
    if architecture.relaxation > 0 {
        parts.push(format!("{} relaxation", architecture.relaxation_neurons()));
    }
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_inputs_are_those_that_a_fit_checks() {
        for (listed, model) in all().iter().zip(std::iter::once(ModelName::AUTO).chain(ModelName::all())) {
            assert_eq!(listed.rate != "no", model.uses_rate(), "{}", listed.name);
            assert_eq!(listed.several_inputs, model.takes_further_inputs(), "{}", listed.name);
        }
        let lugre = all().into_iter().find(|listed| listed.name == "lugre").unwrap();
        assert_eq!((lugre.rate, lugre.identified_by), ("needed", "search"));
    }
}
