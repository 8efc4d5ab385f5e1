//! The report of a fit: one page of HTML that needs nothing but itself.

mod band;
mod ensemble;
mod errors;
mod figures;
mod histories;
mod neurons;
mod parameters;
mod provenance;
mod unit;
mod usage;

use hysid::data::metrics::Errors;
use hysid::data::record::Dataset;
use hysid::model::{Model, Prediction};

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
}

/// The whole page.
pub fn page(report: &Report) -> String {
    let sections = [
        errors::section(report),
        provenance::notes(report),
        ensemble::section(report),
        band::section(report),
        report.sets.iter().map(figures::loops_section).collect(),
        report.sets.iter().map(histories::section).collect(),
        figures::convergence_section(report.model),
        neurons::section(report),
        parameters::section(report),
        provenance::understood(report),
        provenance::warnings(report),
        provenance::section(report),
        usage::section(report),
    ]
    .concat();
    crate::page::whole(&report.title, &(errors::verdict(report) + &sections))
}

/// Measured and simulated loops of a set in one chart, an `svg` element.
/// [`plot::standalone`] makes a file of it.
pub fn loops_svg(set: &ReportSet) -> String {
    figures::loops(set)
}

/// Measured and simulated loops of a set in a small chart with this title.
pub fn small_loops(set: &ReportSet, title: String) -> String {
    figures::small_loops(set, title)
}

/// Training error against epoch, an `svg` element; `None` for a model that was not searched for.
pub fn convergence_svg(model: &Model) -> Option<String> {
    figures::convergence(model)
}

/// The unit of a column, or words for it.
pub fn unit_of(column: &str) -> String {
    unit::of(column)
}

/// A column's name as the label of an axis.
pub fn unit_label(column: &str) -> String {
    unit::label(column)
}

/// The first input as the model sees it, with its unit: spread about zero, maybe.
fn seen_label(report: &Report) -> String {
    let input = &report.model.names().inputs[0];
    match report.model.preprocessing().companding {
        None => unit::label(input),
        Some(scale) => {
            let scale = unit::with(&crate::page::number(scale, 3), input);
            format!("asinh({} / {scale})", unit::split(input).0)
        }
    }
}

#[cfg(test)]
mod tests;
