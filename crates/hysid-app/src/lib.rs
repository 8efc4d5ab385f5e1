//! The use cases of Hysid, one for all faces: program, studio and Python collect requests and show outcomes.
//!
//! The report of a fit ([`page`], [`Identified`]), [`compare`], [`cycles`], [`evaluation`], [`plan`], [`inversion`], [`restoring_force`], [`simulation`], [`validation`], the [`diagnosis`] of
//! data and of models, and how a page was made ([`origin`]).

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]
// Without tables, as in the Python package, some items are not used.
#![cfg_attr(not(feature = "tables"), allow(dead_code))]

mod band;
mod band_coverage;
#[cfg(feature = "tables")]
mod beforehand;
pub mod compare;
mod course;
pub mod cycle_comparison;
pub mod cycles;
pub mod date;
pub mod diagnosis;
mod ensemble;
mod errors;
pub mod errors_table;
#[cfg(feature = "tables")]
pub mod evaluation;
mod fading_errors;
mod figures;
pub mod folds_text;
mod frequency_response;
#[cfg(feature = "tables")]
pub mod gathered;
pub mod histories;
mod identified;
#[cfg(feature = "tables")]
pub mod inversion;
mod memory;
pub mod models;
pub mod origin;
pub mod parameters;
pub mod plan;
pub mod provenance;
pub mod quantities;
#[cfg(feature = "tables")]
mod residual_tests;
pub mod residual_words;
mod residuals;
#[cfg(feature = "tables")]
pub mod restoring_force;
#[cfg(feature = "tables")]
pub mod simulation;
#[cfg(feature = "tables")]
pub mod table_run;
mod timing;
pub mod tracks;
mod usage;
#[cfg(feature = "tables")]
pub mod validation;

use hysid::data::initial_state::in_words;
use hysid::data::metrics::{ErrorSums, Errors};
use hysid::data::record::{Dataset, Record};
use hysid::diagnosis::frequency_response::{ModelResponses, NoResponse};
use hysid::diagnosis::residuals::Residuals;
use hysid::fit::intervals::ParameterIntervals;
use hysid::model::{Model, Prediction};
use hysid_document::{Page, Problem, Result, html, number, unit};
use hysid_files::{PAGE_MARK, with_page_sum};

pub use band_coverage::BandCoverage;
#[cfg(feature = "tables")]
pub use beforehand::{data_warnings, value_warnings};
pub use course::ProgressText;
pub use figures::{MEASURED_WIDTH, MODEL_WIDTH, loops, path_curves, scored_rows, small_loops};
pub use identified::{Beforehand, Identified};
pub use memory::check_memory;
pub use timing::ns_per_sample;
pub use tracks::Tracks;
pub use usage::purpose;

/// Probability of the band that is drawn and judged.
pub const BAND: f64 = 0.9;

pub struct Report<'a> {
    pub title: String,
    pub model: &'a Model,
    /// Data that it was run on, the training data first.
    pub sets: Vec<ReportSet<'a>>,
    /// Tests of the residual, with the name of the data.
    pub residuals: &'a [(String, Residuals)],
    /// Confidence intervals of the parameters of each law in the model, for those that have them.
    pub intervals: &'a [Option<ParameterIntervals>],
    /// Frequency responses on the training data, of a model with inertia; or why the data have none.
    pub frequency_response: Option<std::result::Result<ModelResponses, NoResponse>>,
    pub warnings: &'a [String],
    /// Reading of the data: labels and texts.
    pub understood: &'a [(String, String)],
    /// Name of the model file, if there is one.
    pub model_file: Option<String>,
    /// Time of the fit, if the report is of a fit.
    pub seconds: Option<f64>,
}

/// Data, and what the model makes of them.
pub struct ReportSet<'a> {
    /// Name of the data: "training", "unseen".
    pub name: String,
    pub data: &'a Dataset,
    /// Free run over each record.
    pub simulated: Vec<Vec<f64>>,
    /// The same with the band of probability [`BAND`], if the model has one.
    pub predicted: Option<Vec<Prediction>>,
    pub errors: Errors,
    /// Tracks that the curves of its records share.
    pub tracks: Tracks,
}

impl<'a> ReportSet<'a> {
    /// Simulates a model over some data, in a free run.
    pub fn of(model: &Model, name: &str, data: &'a Dataset) -> Result<Self> {
        let predict = |record: &Record| model.predict(&record.excitation(), BAND);
        let predicted = model.band().map(|_| data.records().iter().map(predict).collect());
        let predicted: Option<Vec<Prediction>> = predicted.transpose()?;
        let simulated: Vec<Vec<f64>> = match &predicted {
            Some(predicted) => predicted.iter().map(|predicted| predicted.output.clone()).collect(),
            None => {
                data.records().iter().map(|record| model.simulate(record)).collect::<hysid::Result<_>>()?
            }
        };
        let mut sums = ErrorSums::default();
        data.records().iter().zip(&simulated).for_each(|(record, output)| sums.add(record.output(), output));
        let errors = sums.errors(&data.names().output);
        let errors = errors.ok_or_else(|| Problem::from("there is nothing to score".to_string()))?;
        let tracks = Tracks::of(name, data);
        Ok(Self { name: name.into(), data, simulated, predicted, errors, tracks })
    }
}

/// The text of a page, with the mark and the checksum by which Hysid recognizes its own.
pub fn page_text(page: &Page) -> String {
    with_page_sum(&html::page(page, &format!("{PAGE_MARK}{}\">", env!("CARGO_PKG_VERSION"))))
}

pub fn page(report: &Report) -> Page {
    let mut parts = errors::verdict(report);
    let figures = |set| figures::section(set, histories::of_records(set), histories::left_out(set));
    parts.extend(report.sets.iter().map(figures));
    parts.push(errors::section(report));
    parts.extend(provenance::notes(report));
    parts.push(provenance::warnings(report));
    parts.extend(report.sets.iter().filter_map(cycle_comparison::section));
    parts.extend(frequency_response::section(report));
    parts.extend(usage::sections(report));
    parts.extend(residuals::section(report));
    parts.extend(band::section(report));
    parts.extend(ensemble::section(report));
    parts.extend(parameters::section(report));
    parts.extend(figures::convergence_section(report.model));
    parts.extend(provenance::understood(report));
    parts.push(provenance::section(report));
    Page { title: report.title.clone(), parts }
}

/// The state in which records begin, in a few words; `None` if it is the virgin one, in training too.
pub fn initial_state(model: &Model) -> Option<String> {
    if model.is_periodic() {
        return Some("after one period of the record".into());
    }
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
    match model.input_transform().compression {
        None => unit::label(input),
        Some(scale) => {
            let scale = unit::with(&number(scale, 3), input);
            format!("asinh({} / {scale})", unit::split(input).0)
        }
    }
}

#[cfg(test)]
mod tests;
