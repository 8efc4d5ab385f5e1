//! One table: a row for each case, a column for each model, the best of each row in bold, and the geometric means.

use std::cmp::Reverse;
use std::iter;

use super::answer::{Case, Figures};
use crate::statistics::geometric_mean;

/// What stands in the cells.
pub type Measure = fn(&Figures) -> Option<f64>;

/// Why cells are without a number. The same reason is told once.
#[derive(Default)]
pub struct Reasons(Vec<String>);

impl Reasons {
    /// The number of a reason, counted from 1.
    pub fn number(&mut self, reason: &str) -> usize {
        let known = self.0.iter().position(|other| other == reason);
        1 + known.unwrap_or_else(|| {
            self.0.push(reason.to_owned());
            self.0.len() - 1
        })
    }

    /// All reasons as a numbered list.
    pub fn list(&self) -> String {
        (1..).zip(&self.0).map(|(number, reason)| format!("{number}. {reason}\n")).collect()
    }
}

/// The models that any case has an answer of, the best on the left: those with the fewest failures, and of these those
/// with the lowest mean error on test data.
pub fn models(cases: &[Case]) -> Vec<&str> {
    let mut models = Vec::new();
    for answer in cases.iter().flat_map(|case| &case.outcome).flatten() {
        if !models.contains(&answer.model.as_str()) {
            models.push(&answer.model);
        }
    }
    let errors = |model: &str| -> Vec<f64> {
        cases.iter().filter_map(|case| value(case, model, |figures| figures.test).ok()).collect()
    };
    let rank = |model: &str| (Reverse(errors(model).len()), geometric_mean(&errors(model)));
    models.sort_by(|a, b| {
        let ((a_worked, a_mean), (b_worked, b_mean)) = (rank(a), rank(b));
        a_worked.cmp(&b_worked).then(a_mean.total_cmp(&b_mean))
    });
    models
}

/// The table in Markdown.
pub fn table(cases: &[Case], measure: Measure, reasons: &mut Reasons) -> String {
    let mut models = models(cases);
    if models.is_empty() {
        // So that the cases still have a place to say why.
        models.push("any model");
    }
    let values: Vec<Vec<Result<f64, &str>>> =
        cases.iter().map(|case| models.iter().map(|model| value(case, model, measure)).collect()).collect();

    let mut rows = vec![row("case", &models)];
    for (case, values) in cases.iter().zip(&values) {
        let best = least(values.iter().filter_map(|value| value.ok()));
        let cells = values.iter().map(|value| match value {
            Ok(value) => marked(*value, &best),
            Err(reason) => format!("– ({})", reasons.number(reason)),
        });
        rows.push(row(&case.name, &cells.collect::<Vec<_>>()));
    }
    rows.push(row("geometric mean", &geometric_means(&values, models.len())));
    aligned(&rows)
}

/// The value in a cell, or why there is none.
fn value<'a>(case: &'a Case, model: &str, measure: Measure) -> Result<f64, &'a str> {
    let answers = case.outcome.as_ref().map_err(String::as_str)?;
    let answer = answers.iter().find(|answer| answer.model == model).ok_or("not among the answers")?;
    let figures = answer.figures.as_ref().map_err(String::as_str)?;
    measure(figures).ok_or("the answer has no such number")
}

/// The geometric mean of each column over the cells with a number, and how many these are where not all are. Only
/// models with a number wherever any has one are compared: a model that fails where it is hard is not the best.
fn geometric_means(rows: &[Vec<Result<f64, &str>>], columns: usize) -> Vec<String> {
    let columns: Vec<Vec<f64>> =
        (0..columns).map(|column| rows.iter().filter_map(|row| row[column].ok()).collect()).collect();
    let answered = rows.iter().filter(|row| row.iter().any(Result::is_ok)).count();
    let best =
        least(columns.iter().filter(|column| column.len() == answered).map(|column| geometric_mean(column)));
    let cell = |column: &Vec<f64>| match column.len() {
        0 => "–".into(),
        count if count == answered && count == rows.len() => marked(geometric_mean(column), &best),
        count if count == answered => format!("{} ({count})", marked(geometric_mean(column), &best)),
        count => format!("{} ({count})", shown(geometric_mean(column))),
    };
    columns.iter().map(cell).collect()
}

/// The least of the values, as it is shown.
fn least(values: impl Iterator<Item = f64>) -> Option<String> {
    values.min_by(f64::total_cmp).map(shown)
}

/// A value, in bold if it is the best as far as the digits tell.
fn marked(value: f64, best: &Option<String>) -> String {
    let text = shown(value);
    if best.as_ref() == Some(&text) { format!("**{text}**") } else { text }
}

/// Three significant digits.
fn shown(value: f64) -> String {
    let scientific = format!("{value:.2e}");
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        _ if value == 0.0 => "0".into(),
        Some(exponent @ -3..=5) => format!("{value:.*}", (2 - exponent).max(0) as usize),
        _ => scientific,
    }
}

/// A row of a table from its name and its cells.
pub fn row(name: &str, cells: &[impl AsRef<str>]) -> Vec<String> {
    iter::once(name).chain(cells.iter().map(AsRef::as_ref)).map(|cell| cell.replace('|', "\\|")).collect()
}

/// Rows as a Markdown table, the first as its heading; columns of equal width, numbers to the right.
pub fn aligned(rows: &[Vec<String>]) -> String {
    markdown(rows, true)
}

/// The same of words, which stand to the left.
pub fn in_words(rows: &[Vec<String>]) -> String {
    markdown(rows, false)
}

fn markdown(rows: &[Vec<String>], numbers: bool) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(|column| width(column).max(3)).collect();
    let rule = widths.iter().enumerate().map(|(column, &width)| match column {
        0 => "-".repeat(width),
        _ if !numbers => "-".repeat(width),
        _ => format!("{}:", "-".repeat(width - 1)),
    });
    let lines = rows.iter().map(|row| {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
            0 => format!("{cell:<width$}"),
            _ if !numbers => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        line(cells)
    });
    let mut lines: Vec<String> = lines.collect();
    lines.insert(1, line(rule));
    lines.concat()
}

fn line(cells: impl Iterator<Item = String>) -> String {
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

#[cfg(test)]
mod tests;
