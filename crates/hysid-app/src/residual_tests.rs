//! Tests of the residual of a run over a table, and their text for a terminal.

use crate::residual_words::{name, p_value, verdict};
use hysid::data::record::ColumnNames;
use hysid::data::warning::Warning;
use hysid::diagnosis::residuals::{ResidualFinding, ResidualOptions, Residuals};
use hysid::model::Model;
use hysid_document::plain::{aligned, indented};

use crate::gathered::{Gathered, Gatherer};

/// How far statements stand in under their verdict.
const INDENT: usize = 4;

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

/// The verdicts in a table, under each what was found.
pub fn text(residuals: &Residuals) -> String {
    let mut rows = vec![["test of the residual", "verdict", "p"].map(String::from).to_vec()];
    rows.extend(residuals.findings.iter().map(cells));
    let mut lines = left(&rows).into_iter();
    let mut text = lines.next().unwrap_or_default() + "\n";
    for (line, finding) in lines.zip(&residuals.findings) {
        text += &(line + "\n" + &indented(&finding.statement, INDENT));
        if let Some(advice) = &finding.advice {
            text += &indented(advice, INDENT);
        }
    }
    text += &residuals
        .caution
        .as_ref()
        .map_or_else(String::new, |caution| indented(&format!("Note: {caution}"), 0));
    let tested = match residuals.rows == residuals.scored {
        true => format!("{} rows", residuals.rows),
        false => format!("{} of {} rows, in evenly spaced stretches", residuals.rows, residuals.scored),
    };
    let words = format!(
        "(residual: measured minus simulated output, {tested}; p: probability of as much without structure, corrected for \
         the number of tests)"
    );
    text + &indented(&words, 0)
}

/// Columns with their text at the left.
fn left(rows: &[Vec<String>]) -> Vec<String> {
    let width = rows.iter().map(|row| row[0].chars().count()).max().unwrap_or_default();
    let padded: Vec<Vec<String>> =
        rows.iter().map(|row| vec![format!("{:<width$}  {:<12}", row[0], row[1]), row[2].clone()]).collect();
    aligned(&padded)
}

fn cells(finding: &ResidualFinding) -> Vec<String> {
    vec![name(finding), verdict(finding.verdict).into(), p_value(finding)]
}
