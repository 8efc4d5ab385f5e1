//! What was understood of the data, warnings, and how the model came about.

use hysid::rate::RateMethod;

use super::Report;
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

/// Options and provenance.
pub fn section(report: &Report) -> String {
    let provenance = report.model.provenance();
    let options = &provenance.options;
    let a = report.model.network().architecture();
    let rate = match report.model.rate() {
        None => "none",
        Some(RateMethod::Given) => "a column",
        Some(RateMethod::Central) => "central differences",
        Some(RateMethod::Backward) => "backward differences",
        Some(RateMethod::SavitzkyGolay) => "Savitzky-Golay",
    };
    let held_out = match &provenance.validation {
        Some(errors) => format!(
            "{} % asked for: {}",
            number(100.0 * options.validation, 3),
            count(errors.samples, "sample")
        ),
        None if options.starts == 1 => "nothing: there was but one start".into(),
        None => "nothing: too few data".into(),
    };
    let mut sizes = count(a.stops, "stop");
    if a.hidden > 0 {
        sizes += &format!(", {}", count(a.hidden, "tanh neuron"));
    }
    if a.relaxation > 0 {
        sizes += &format!(", {} of each input", count(a.relaxation, "relaxation neuron"));
    }
    let (starts, epochs) = match options.starts {
        1 => ("1".into(), format!("at most {}", options.epochs)),
        starts => (
            format!("{starts}, of which number {} was chosen", provenance.chosen_start + 1),
            format!("at most {} of each start, and again on all data", options.epochs),
        ),
    };
    let pair = |name: &str, value: String| (name.to_string(), value);
    let mut pairs = vec![
        pair("Model", format!("{} ({sizes})", report.model.family().name())),
        pair("Deterioration", if a.deterioration { "yes".into() } else { "no".into() }),
        pair("Rate", rate.into()),
        pair("Training", options.training.name().into()),
        pair("Starts", starts),
        pair("Epochs", epochs),
        pair("Seed", options.seed.to_string()),
        pair("Held out", held_out),
        pair(
            "Trained on",
            format!("{} in {}", count(provenance.samples, "sample"), count(provenance.records, "record")),
        ),
        pair("Ended", provenance.termination.to_string()),
        pair("Time taken", format!("{} s", number(report.seconds, 3))),
        pair("Model file", report.model_file.clone()),
        pair("Version", format!("hysid {}", env!("CARGO_PKG_VERSION"))),
    ];
    if options.training.is_genetic() {
        pairs.insert(6, pair("Population", options.population.to_string()));
    }
    section_of("Options and provenance", &definitions(&pairs))
}
