//! Figures of `hysid plot`: measured data and a model on them, for a paper or a talk.

mod curves;
mod cycles;
mod drawing;
mod fonts;
mod histories;

use anyhow::{Result, anyhow};
use hysid::data::record::Dataset;
use hysid::diagnosis::cycles::CycleOptions;
use hysid::model::Prediction;
use hysid_app::cycle_comparison::with_outputs;
use hysid_document::Chart;

pub use drawing::{Format, Style, drawing};

use crate::arguments::PlotKind;

pub struct PlotData {
    /// The data; the output is NaN where it was not measured.
    pub data: Dataset,
    /// Output of a model, and its band if there is one, for each record.
    pub predicted: Option<Vec<Prediction>>,
    pub band: Option<f64>,
}

impl PlotData {
    fn is_measured(&self) -> bool {
        self.data.scored() > 0
    }

    fn records(&self) -> impl Iterator<Item = (&hysid::data::record::Record, Option<&Prediction>)> {
        let predicted = |index| self.predicted.as_ref().map(|predicted| &predicted[index]);
        self.data.records().iter().enumerate().map(move |(index, record)| (record, predicted(index)))
    }

    /// The data with the output of the model in place of the measured one, in the rows that have one.
    fn simulated(&self) -> Result<Option<Dataset>> {
        let Some(predicted) = &self.predicted else { return Ok(None) };
        let outputs = predicted.iter().map(|predicted| predicted.output.as_slice());
        Ok(Some(with_outputs(&self.data, outputs)?))
    }

    /// Only the records of these names; all if there are none.
    pub fn only(self, names: &[String]) -> Result<Self> {
        if names.is_empty() {
            return Ok(self);
        }
        let has = |name: &String| self.data.records().iter().any(|record| record.name() == name);
        if let Some(missing) = names.iter().find(|name| !has(name)) {
            let known: Vec<&str> = self.data.records().iter().map(|record| record.name()).collect();
            return Err(anyhow!(
                "there is no record \"{}\" for --only (records: {})",
                crate::terminal::clipped(missing),
                crate::terminal::listed(&known)
            ));
        }
        let is_chosen = |index: usize| names.iter().any(|name| name == self.data.records()[index].name());
        let predicted = self.predicted.as_ref().map(|predicted| {
            let chosen = predicted.iter().enumerate().filter(|(index, _)| is_chosen(*index));
            chosen.map(|(_, predicted)| predicted.clone()).collect()
        });
        let (data, _) = self.data.partition(is_chosen);
        Ok(Self { data, predicted, band: self.band })
    }
}

/// The charts of a kind of figure, in a width in pixels.
pub fn charts(subject: &PlotData, kind: PlotKind, options: &CycleOptions, width: f64) -> Result<Vec<Chart>> {
    match kind {
        PlotKind::Loops => Ok(vec![curves::loops(subject, width)]),
        PlotKind::Histories => Ok(histories::histories(subject, width)),
        PlotKind::Errors => histories::errors(subject, width),
        PlotKind::Cycles => cycles::figures(subject, options, width),
        PlotKind::Backbone => Ok(vec![cycles::backbone(subject, options, width)?]),
        PlotKind::Energy => Ok(vec![cycles::energy(subject, options, width)?]),
        PlotKind::Frequency => Ok(vec![cycles::frequency(subject, options, width)?]),
    }
}
