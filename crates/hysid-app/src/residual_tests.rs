//! Tests of the residual of a run over a table.

use hysid::data::record::ColumnNames;
use hysid::data::warning::Warning;
use hysid::diagnosis::residuals::{ResidualOptions, Residuals};
use hysid::model::Model;

use crate::gathered::{Gathered, Gatherer};

/// The tests of a run that was gathered; `warnings` show whether the model was trained on the data.
pub fn tests(
    gatherer: Gatherer,
    model: &Model,
    output: &str,
    warnings: &[Warning],
) -> hysid::Result<Residuals> {
    let names = ColumnNames { output: output.into(), ..model.names().clone() };
    let Gathered { data, predicted } = gatherer.gathered(names)?;
    let simulated: Vec<Vec<f64>> = predicted.into_iter().map(|prediction| prediction.output).collect();
    let is_training = warnings.iter().any(|warning| matches!(warning, Warning::TrainedOn { .. }));
    let options =
        ResidualOptions { uses_rate: model.rate().is_some(), is_training, ..ResidualOptions::default() };
    Residuals::of(&data, &simulated, &options)
}
