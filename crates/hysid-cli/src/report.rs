//! The report of a fit: one page of HTML that needs nothing but itself.

mod band;
mod ensemble;
mod errors;
mod figures;
pub mod histories;
mod neurons;
pub mod parameters;
pub mod provenance;
mod residuals;
pub mod tracks;
mod usage;

use hysid::data::initial_state::in_words;
use hysid::data::metrics::Errors;
use hysid::data::record::Dataset;
use hysid::diagnosis::residuals::Residuals;
use hysid::fit::intervals::ParameterIntervals;
use hysid::model::{Model, Prediction};
use hysid_document::{Page, number, unit};

pub use figures::{MEASURED_WIDTH, MODEL_WIDTH, loops, path_curves, scored_rows, small_loops};
pub use tracks::Tracks;

/// Probability of the band that is drawn and judged.
pub const BAND: f64 = 0.9;

/// What is reported.
pub struct Report<'a> {
    /// Headline.
    pub title: String,
    /// The fitted model.
    pub model: &'a Model,
    /// Data that it was run on, the training data first.
    pub sets: Vec<ReportSet<'a>>,
    /// Tests of the residual, with the name of the data.
    pub residuals: &'a [(String, Residuals)],
    /// Confidence intervals of the parameters, for a law that has them.
    pub intervals: Option<&'a ParameterIntervals>,
    /// What to be aware of.
    pub warnings: &'a [String],
    /// What was understood of the data: a question and its answer.
    pub understood: &'a [(String, String)],
    /// Name of the model file.
    pub model_file: String,
    /// How long the fit took.
    pub seconds: f64,
}

/// Data, and what the model makes of them.
pub struct ReportSet<'a> {
    /// What the data are: "training", "unseen".
    pub name: String,
    /// The data.
    pub data: &'a Dataset,
    /// Free run over each record.
    pub simulated: Vec<Vec<f64>>,
    /// The same with the band of probability [`BAND`], if the model has one.
    pub predicted: Option<Vec<Prediction>>,
    /// Errors of these.
    pub errors: Errors,
    /// What ties the curves of its records together.
    pub tracks: Tracks,
}

/// The whole page.
pub fn page(report: &Report) -> Page {
    let mut parts = vec![errors::verdict(report)];
    parts.extend(report.sets.iter().map(figures::loops_section));
    parts.push(errors::section(report));
    parts.extend(provenance::notes(report));
    parts.push(provenance::warnings(report));
    parts.extend(report.sets.iter().map(histories::section));
    parts.extend(usage::sections(report));
    parts.extend(residuals::section(report));
    parts.extend(band::section(report));
    parts.extend(ensemble::section(report));
    parts.extend(parameters::section(report));
    parts.extend(neurons::section(report));
    parts.extend(figures::convergence_section(report.model));
    parts.extend(provenance::understood(report));
    parts.push(provenance::section(report));
    Page { title: report.title.clone(), parts }
}

/// The state in which records begin, in a few words; `None` if it is the virgin one, in training too.
pub fn initial_state(model: &Model) -> Option<String> {
    let has_past = !model.lead_in().is_empty() || !model.provenance().lead_ins.is_empty();
    has_past.then(|| in_words(model.lead_in(), model.trained_ranges().inputs[0]))
}

/// The label of the axis of time: rows where there is no time.
pub fn time_label(data: &Dataset) -> String {
    match (&data.names().time, data.has_time()) {
        (Some(name), true) => unit::label(name),
        (None, true) => "time".into(),
        (_, false) => "row".into(),
    }
}

/// The first input as the model sees it, with its unit: spread about zero, maybe.
fn seen_label(model: &Model) -> String {
    let input = &model.names().inputs[0];
    match model.input_transform().companding {
        None => unit::label(input),
        Some(scale) => {
            let scale = unit::with(&number(scale, 3), input);
            format!("asinh({} / {scale})", unit::split(input).0)
        }
    }
}

#[cfg(test)]
mod tests;
