//! A fit with what is told before and after it.

use std::path::Path;

use anyhow::Result;
use hysid::data::record::Dataset;
use hysid::data::summary::Summary;
use hysid::diagnosis::frequency_response::ModelResponses;
use hysid::diagnosis::residuals::{FEWEST_ROWS, ResidualOptions, Residuals};
use hysid::diagnosis::{DataIssueKind, before_a_fit};
use hysid::fit::intervals::ParameterIntervals;
use hysid::fit::progress::HeldOutRows;
use hysid::model::Model;
use hysid::options::FitSpec;
use hysid_document::Page;
use hysid_files::GENERATOR;
use hysid_records::{Data, summarised, understanding};

use crate::{Report, ReportSet, loops, page};

/// What is told before a fit.
#[derive(Debug, Clone, Default)]
pub struct Beforehand {
    /// What was understood of data and request, label and text.
    pub understood: Vec<(String, String)>,
    pub warnings: Vec<String>,
}

impl Beforehand {
    /// # Errors
    /// Data that the model cannot be fitted to.
    pub fn of(data: &Data, request: &FitSpec) -> Result<Self> {
        let model = match request {
            FitSpec::Network(options) => {
                let architecture = options.architecture(&data.set).map_err(|error| data.explain(error))?;
                format!(": {} parameters; {}", architecture.parameters(), understanding::parts(&architecture))
            }
            FitSpec::Auto(options) => understanding::choice(options),
            FitSpec::Classical(_) => String::new(),
        };
        request.model().check_data(&data.set, request.rate()).map_err(|error| data.explain(error))?;
        let summary = Summary::of(&data.set);
        let understood = understanding::understanding(data, &summary, request, &model);
        let mut warnings = data_warnings(data, &summary);
        warnings.extend(request.cautions(&data.set));
        Ok(Self { understood, warnings })
    }
}

/// What to be aware of in data that a model is to be fitted to.
pub fn data_warnings(data: &Data, summary: &Summary) -> Vec<String> {
    // Data that cannot be looked at cannot be fitted to either: the fit says why.
    let doubtful = before_a_fit(&data.set).unwrap_or_default();
    let output = format!("\"{}\" ", data.roles.output);
    let statements = doubtful.into_iter().map(|issue| match (issue.kind, issue.value) {
        (DataIssueKind::MissingValueMark, Some(value)) if issue.statement.starts_with(&output) => {
            format!("{} (--missing {value})", issue.statement)
        }
        _ => issue.statement,
    });
    summarised(&summary.warnings(&data.set)).into_iter().chain(statements).collect()
}

/// A model and what was told and spent on the way to it.
#[derive(Debug)]
pub struct Identified {
    pub model: Model,
    pub evaluations: usize,
    /// Rows that were held out in turn, and what was predicted for them.
    pub held_out: Option<HeldOutRows>,
    pub seconds: f64,
    /// What was told before.
    pub beforehand: Beforehand,
}

impl Identified {
    /// Tests of the residual on the data that the model was fitted to (as it was trained on them), and on rows that were
    /// held out from other models made in the same way.
    pub fn residuals(&self, trained: &Dataset) -> Result<Vec<(String, Residuals)>> {
        let mut all = Vec::new();
        all.extend(self.residuals_of("training", trained)?);
        let options =
            ResidualOptions { uses_rate: self.model.rate().is_some(), ..ResidualOptions::default() };
        if let Some(HeldOutRows { data, simulated }) = &self.held_out
            && data.scored() >= FEWEST_ROWS
        {
            all.push(("held-out".into(), Residuals::of(data, simulated, &options)?));
        }
        Ok(all)
    }

    /// Tests of the residual on some data; `None` for too few rows.
    fn residuals_of(&self, name: &str, data: &Dataset) -> Result<Option<(String, Residuals)>> {
        let is_training = name == "training";
        // The rows of a warm-up were not trained on.
        let data = data.clone().warmed_up(if is_training { self.model.warm_up() } else { 0 });
        if data.scored() < FEWEST_ROWS {
            return Ok(None);
        }
        let options = ResidualOptions { is_training, ..ResidualOptions::default() };
        Ok(Some((name.into(), Residuals::of_model(&self.model, &data, &options)?)))
    }

    /// Confidence intervals of the parameters, for a law that has them.
    pub fn intervals(&self, trained: &Dataset) -> Result<Option<ParameterIntervals>> {
        Ok(ParameterIntervals::of(&self.model, trained)?)
    }

    /// The report on the model, whose file is at `path`, with some data: those called "training" are what it was fitted to.
    pub fn page(&self, path: &Path, sets: &[(&str, &Dataset)]) -> Result<Page> {
        let mut residuals = Vec::new();
        let mut intervals = None;
        for &(name, data) in sets {
            match name {
                "training" => {
                    residuals.extend(self.residuals(data)?);
                    intervals = self.intervals(data)?;
                }
                _ => residuals.extend(self.residuals_of(name, data)?),
            }
        }
        let reported: Vec<ReportSet> =
            sets.iter().map(|(name, data)| ReportSet::of(&self.model, name, data)).collect::<Result<_>>()?;
        let training = reported.iter().find(|set| set.name == "training" && self.model.has_inertia());
        let responses = training.map(|set| ModelResponses::of(&self.model, set.data, &set.simulated));
        let title = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(page(&Report {
            title,
            model: &self.model,
            sets: reported,
            residuals: &residuals,
            intervals: intervals.as_ref(),
            frequency_response: responses.transpose()?,
            warnings: &self.beforehand.warnings,
            understood: &self.beforehand.understood,
            model_file: path.display().to_string(),
            seconds: self.seconds,
        }))
    }

    /// Measured and simulated loops on a set of data, as an SVG file.
    pub fn loops(&self, name: &str, data: &Dataset) -> Result<String> {
        Ok(loops(&ReportSet::of(&self.model, name, data)?).file(GENERATOR))
    }
}
