//! Tests of the residual in words: their table for a terminal and for Python.

use hysid::diagnosis::residuals::{ResidualFinding, ResidualVerdict, Residuals};
use hysid_document::plain::{aligned, indented};
use hysid_document::visible::clipped;

/// How far statements stand in under their verdict.
const INDENT: usize = 4;

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

/// The test, with the input that it is about.
pub fn name(finding: &ResidualFinding) -> String {
    match &finding.input {
        None => finding.test.name().into(),
        Some(input) => format!("{}: {}", finding.test.name(), clipped(input)),
    }
}

pub fn verdict(verdict: ResidualVerdict) -> &'static str {
    match verdict {
        ResidualVerdict::Found => "found",
        ResidualVerdict::NotFound => "not found",
        ResidualVerdict::NotTestable => "not testable",
    }
}

pub fn p_value(finding: &ResidualFinding) -> String {
    match finding.adjusted_p_value {
        None => "-".into(),
        Some(p) if p < 0.001 => "<0.001".into(),
        Some(p) => format!("{p:.3}"),
    }
}
