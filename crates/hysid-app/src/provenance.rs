//! Reading of the data, warnings, and the provenance of the model.

use hysid::data::rate::RateMethod;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid::options::classical::ClassicalOptions;
use hysid::options::fit_spec::AutoOptions;
use hysid::options::network::FitOptions;
use hysid_document::{Part, count, number};

use crate::{Report, seen_label};

pub fn understood(report: &Report) -> Option<Part> {
    let parts = [Part::Definitions(report.understood.to_vec())];
    (!report.understood.is_empty()).then(|| Part::section("How the data were read", parts))
}

pub fn warnings(report: &Report) -> Part {
    let warnings = match report.warnings {
        [] => Part::paragraph("None."),
        warnings => Part::warnings(warnings),
    };
    Part::section("Warnings", [warnings])
}

/// Limitations of the model, if there are any.
pub fn notes(report: &Report) -> Option<Part> {
    let notes = report.model.notes();
    (!notes.is_empty()).then(|| Part::section("Notes", [Part::warnings(&notes)]))
}

/// Options and provenance.
pub fn section(report: &Report) -> Part {
    let mut pairs = of_model(report.model);
    pairs.extend(report.seconds.map(|seconds| pair("Time taken", format!("{} s", number(seconds, 3)))));
    pairs.extend(report.model_file.as_deref().map(|file| pair("Model file", file)));
    Part::section("Options and provenance", [Part::Definitions(pairs)])
}

/// Options and provenance as a model stores them, name and value.
pub fn of_model(model: &Model) -> Vec<(String, String)> {
    let provenance = model.provenance();
    let rate = match model.rate() {
        None => "none",
        Some(RateMethod::Given) => "a column",
        Some(RateMethod::Central) => "central differences",
        Some(RateMethod::Backward) => "backward differences",
        Some(RateMethod::SavitzkyGolay) => "Savitzky-Golay",
    };
    let mut pairs = match &provenance.options {
        FitSpec::Network(options) => of_network(model, options),
        FitSpec::Classical(options) => of_rival(options),
        FitSpec::Auto(options) => of_auto(model, options),
    };
    let mut say = |name: &str, value: String| pairs.push((name.to_string(), value));
    let preprocessing = model.input_transform();
    for (input, origin) in model.names().inputs.iter().zip(&preprocessing.origins) {
        say(&format!("Offset of {input}"), number(*origin, 6));
    }
    if preprocessing.compression.is_some() {
        say("Transformed input", seen_label(model));
    }
    if let Some(scale) = preprocessing.rate_compression {
        say("Transformed rate", format!("asinh(rate / {})", number(scale, 3)));
    }
    if preprocessing.history.is_some() {
        say("Further inputs", "running peak and travelled path".into());
    }
    if let Some(state) = crate::initial_state(model) {
        say("Initial state", state);
    }
    say("Rate", rate.into());
    if provenance.weighted {
        say("Weights of rows", "given; errors count all rows alike".into());
    }
    say(
        "Trained on",
        format!("{} in {}", count(provenance.samples, "sample"), count(provenance.records, "record")),
    );
    say("Ended", provenance.termination.to_string());
    pairs
}

fn pair(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_string(), value.into())
}

fn of_network(model: &Model, options: &FitOptions) -> Vec<(String, String)> {
    let provenance = model.provenance();
    let held_out = match (&provenance.validation, &provenance.selection) {
        (_, Some(selection)) => {
            format!("{} in turn, to choose this model", count(selection.folds.len(), "part"))
        }
        (Some(errors), None) => match options.validation {
            Some(share) => {
                format!("{} %: {}", number(100.0 * share, 3), count(errors.samples, "sample"))
            }
            None => format!("the folds of a cross-validation: {}", count(errors.samples, "sample")),
        },
        (None, None) if options.starts == 1 => "nothing, because there was only one start".into(),
        (None, None) => "nothing: too few data".into(),
    };
    let (starts, epochs) = match options.starts {
        1 => ("1".into(), format!("at most {}", options.epochs)),
        starts => (
            format!("{starts}, of which number {} has the lowest error", provenance.chosen_start + 1),
            format!("at most {} of each start", options.epochs),
        ),
    };
    let mut pairs = Vec::new();
    if let Some(network) = model.network() {
        let a = network.architecture();
        let mut sizes = count(a.stops, "stop");
        if a.hidden > 0 {
            sizes += &format!(", {}", count(a.hidden, "tanh neuron"));
        }
        if a.relaxation > 0 {
            sizes += &format!(", {} of each input", count(a.relaxation, "relaxation neuron"));
        }
        pairs.push(pair("Model", format!("{} ({sizes})", options.model.name())));
        pairs.push(pair("Deterioration", if a.deterioration { "yes" } else { "no" }));
    }
    pairs.push(pair("Training", options.training.name()));
    pairs.push(pair("Starts", starts));
    pairs.push(pair("Epochs", epochs));
    if options.training.is_genetic() {
        pairs.push(pair("Population", options.population.to_string()));
    }
    if let Some(penalties) = provenance.penalties {
        pairs.push(pair("Penalties", format!("ridge {:e}, decay {:e}", penalties.ridge, penalties.decay)));
    }
    pairs.push(pair("Seed", options.seed.to_string()));
    pairs.push(pair("Held out", held_out));
    pairs
}

fn of_auto(model: &Model, options: &AutoOptions) -> Vec<(String, String)> {
    let members = model.ensemble().map_or(1, |ensemble| ensemble.members().len());
    let (of, candidates) = match &options.only {
        Some(request) => (format!(" of {}", request.model().name()), "the model"),
        None => (String::new(), "each candidate"),
    };
    vec![
        pair("Model", format!("auto: {}{of}, {} at most", count(members, "member"), options.members)),
        pair("Training", format!("{candidates} with a part of the data held out, then on all data")),
        pair("Seed", options.seed.to_string()),
    ]
}

fn of_rival(options: &ClassicalOptions) -> Vec<(String, String)> {
    let training = if options.model.is_searched() { "multi-start search" } else { "linear least squares" };
    vec![
        pair("Model", options.model.name()),
        pair("Training", training),
        pair("Seed", options.seed.to_string()),
    ]
}
