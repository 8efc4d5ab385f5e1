//! What was understood of the data, warnings, and how the model came about.

use hysid::data::rate::RateMethod;
use hysid::options::Request;
use hysid::options::auto::AutoOptions;
use hysid::options::classical::ClassicalOptions;
use hysid::options::network::FitOptions;

use super::{Report, seen_label};
use crate::page::{count, definitions, number, section as section_of};
use crate::plot::escape;

/// What was understood of the data.
pub fn understood(report: &Report) -> String {
    if report.understood.is_empty() {
        return String::new();
    }
    section_of("What was understood of the data", &definitions(report.understood))
}

/// The warnings, or that there is none.
pub fn warnings(report: &Report) -> String {
    if report.warnings.is_empty() {
        return section_of("Warnings", "<p>None.</p>\n");
    }
    let items: String =
        report.warnings.iter().map(|warning| format!("<li>{}</li>\n", escape(warning))).collect();
    section_of("Warnings", &format!("<ul class=\"warnings\">\n{items}</ul>\n"))
}

/// What to know before relying on the model; empty if there is nothing.
pub fn notes(report: &Report) -> String {
    let notes = report.model.notes();
    if notes.is_empty() {
        return String::new();
    }
    let items: String = notes.iter().map(|note| format!("<li>{}</li>\n", escape(note))).collect();
    section_of("Notes", &format!("<ul class=\"warnings\">\n{items}</ul>\n"))
}

/// Options and provenance.
pub fn section(report: &Report) -> String {
    let provenance = report.model.provenance();
    let rate = match report.model.rate() {
        None => "none",
        Some(RateMethod::Given) => "a column",
        Some(RateMethod::Central) => "central differences",
        Some(RateMethod::Backward) => "backward differences",
        Some(RateMethod::SavitzkyGolay) => "Savitzky-Golay",
    };
    let mut pairs = match &provenance.options {
        Request::Network(options) => of_network(report, options),
        Request::Classical(options) => of_rival(options),
        Request::Auto(options) => of_auto(report, options),
    };
    let mut say = |name: &str, value: String| pairs.push((name.to_string(), value));
    let preprocessing = report.model.preprocessing();
    for (input, origin) in report.model.names().inputs.iter().zip(&preprocessing.origins) {
        say(&format!("{input} is measured from"), number(*origin, 6));
    }
    if preprocessing.companding.is_some() {
        say("Input as it is seen", seen_label(report));
    }
    if let Some(scale) = preprocessing.rate_companding {
        say("Rate as it is seen", format!("asinh(rate / {})", number(scale, 3)));
    }
    if preprocessing.history.is_some() {
        say("Past as it is seen", "largest input and path so far".into());
    }
    say("Rate", rate.into());
    say(
        "Trained on",
        format!("{} in {}", count(provenance.samples, "sample"), count(provenance.records, "record")),
    );
    say("Ended", provenance.termination.to_string());
    say("Time taken", format!("{} s", number(report.seconds, 3)));
    say("Model file", report.model_file.clone());
    say("Version", format!("hysid {}", env!("CARGO_PKG_VERSION")));
    section_of("Options and provenance", &definitions(&pairs))
}

fn pair(name: &str, value: impl Into<String>) -> (String, String) {
    (name.to_string(), value.into())
}

fn of_network(report: &Report, options: &FitOptions) -> Vec<(String, String)> {
    let provenance = report.model.provenance();
    let held_out = match (&provenance.validation, &provenance.selection) {
        (_, Some(selection)) => {
            format!("{} in turn, to choose this model among others", count(selection.folds.len(), "part"))
        }
        (Some(errors), None) => match options.validation {
            Some(share) => {
                format!("{} %: {}", number(100.0 * share, 3), count(errors.samples, "sample"))
            }
            None => format!("the folds of a cross-validation: {}", count(errors.samples, "sample")),
        },
        (None, None) if options.starts == 1 => "nothing, since there was one start only".into(),
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
    if let Some(network) = report.model.network() {
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

fn of_auto(report: &Report, options: &AutoOptions) -> Vec<(String, String)> {
    let members = report.model.ensemble().map_or(1, |ensemble| ensemble.members().len());
    let (of, candidates) = match &options.only {
        Some(request) => (format!(" of {}", request.model().name()), "the model"),
        None => (String::new(), "each candidate"),
    };
    vec![
        pair("Model", format!("auto: {}{of}, {} at most", count(members, "member"), options.members)),
        pair("Training", format!("{candidates} on data of which a part was held out, then on everything")),
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
