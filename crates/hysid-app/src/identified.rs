//! A fit with its reading of the data, its warnings and its report.

use std::borrow::Cow;
use std::path::Path;

use hysid::data::record::Dataset;
use hysid::diagnosis::frequency_response::ModelResponses;
use hysid::diagnosis::residuals::{FEWEST_ROWS, ResidualOptions, Residuals};
use hysid::fit::intervals::ParameterIntervals;
use hysid::fit::progress::HeldOutRows;
use hysid::model::Model;
use hysid_document::{Page, Result, capitalised, unit};
use hysid_files::GENERATOR;

use crate::parameters::laws;
use crate::{Report, ReportSet, loops, page};

/// Reading of the data, and warnings, before a fit.
#[derive(Debug, Clone, Default)]
pub struct Beforehand {
    /// Reading of data and request, label and text.
    pub understood: Vec<(String, String)>,
    /// The same in a few lines.
    pub in_short: Vec<(String, String)>,
    pub warnings: Vec<String>,
}

/// A fitted model, with the reading of its data and the cost of its fit.
#[derive(Debug)]
pub struct Identified {
    pub model: Model,
    pub evaluations: usize,
    /// Rows that were held out in turn, and what was predicted for them.
    pub held_out: Option<HeldOutRows>,
    /// Time of the fit; `None` for a model that was fitted before.
    pub seconds: Option<f64>,
    /// Reading and warnings from before the fit.
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
        let data = self.model.as_judged(data)?.into_owned().warmed_up(if is_training {
            self.model.warm_up()
        } else {
            0
        });
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

    /// A model that was fitted before.
    pub fn before(model: Model) -> Self {
        Self { model, evaluations: 0, held_out: None, seconds: None, beforehand: Beforehand::default() }
    }

    /// The report on the model with some data: those called "training" are what it was fitted to. Without a title, the
    /// quantities and the model are its title.
    ///
    /// # Errors
    /// Data that the model cannot be run on, or without a measured output.
    pub fn page(&self, title: Option<&str>, file: Option<&Path>, sets: &[(&str, &Dataset)]) -> Result<Page> {
        let mut residuals = Vec::new();
        let mut intervals = Vec::new();
        for &(name, data) in sets {
            match name {
                "training" => {
                    residuals.extend(self.residuals(data)?);
                    let of_law = |(law, _): (&Model, _)| Ok(ParameterIntervals::of(law, data)?);
                    intervals = laws(&self.model).into_iter().map(of_law).collect::<Result<_>>()?;
                }
                _ => residuals.extend(self.residuals_of(name, data)?),
            }
        }
        let judged = |&(name, data)| Ok((name, self.model.as_judged(data)?));
        let judged: Vec<(&str, Cow<'_, Dataset>)> = sets.iter().map(judged).collect::<Result<_>>()?;
        let reported = judged.iter().map(|(name, data)| ReportSet::of(&self.model, name, data));
        let reported: Vec<ReportSet> = reported.collect::<Result<_>>()?;
        let training = reported.iter().find(|set| set.name == "training" && self.model.has_inertia());
        let responses = training.map(|set| ModelResponses::of(&self.model, set.data, &set.simulated));
        Ok(page(&Report {
            title: title.map_or_else(|| title_of(&self.model), String::from),
            model: &self.model,
            sets: reported,
            residuals: &residuals,
            intervals: &intervals,
            frequency_response: responses.transpose()?,
            warnings: &self.beforehand.warnings,
            understood: &self.beforehand.understood,
            model_file: file.map(|file| file.display().to_string()),
            seconds: self.seconds,
        }))
    }

    /// Measured and simulated loops on a set of data, as an SVG file.
    pub fn loops(&self, name: &str, data: &Dataset) -> Result<String> {
        Ok(loops(&ReportSet::of(&self.model, name, &*self.model.as_judged(data)?)?).file(GENERATOR))
    }
}

/// Quantities and model: `Force over displacement: bouc-wen`.
fn title_of(model: &Model) -> String {
    let name = match model.ensemble() {
        Some(ensemble) => format!("ensemble of {} models", ensemble.members().len()),
        None => model.name().name().into(),
    };
    let [x, y] = [&model.names().inputs[0], &model.names().output].map(|name| unit::split(name).0);
    capitalised(&format!("{y} over {x}: {name}"))
}
