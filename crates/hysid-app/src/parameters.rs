//! The parameters of a classical law, in the field's symbols and the user's units.

use hysid::fit::intervals::{IntervalStatus, ParameterInterval, ParameterIntervals};
use hysid::model::{Model, ParameterInUnits};
use hysid_document::{Cell, Part, Table, count, number};

use crate::{Report, seen_label};

const MOST_ROWS: usize = 60;

const INTERVAL: &str = "95 % interval";

/// An interval, or why there is none.
fn interval(interval: &ParameterInterval) -> String {
    let (Some(low), Some(high)) = (interval.low, interval.high) else {
        return interval.status.words().into();
    };
    let ends = format!("{} to {}", number(low, 4), number(high, 4));
    if interval.status == IntervalStatus::AtKink {
        format!("{ends} ({})", interval.status.words())
    } else {
        ends
    }
}

fn explanation(intervals: &ParameterIntervals) -> Part {
    let correlated = match intervals.correlation_lag {
        0 => "neighbouring rows of the residual are not correlated".to_string(),
        rows => format!("the residual is taken as correlated over {}", count(rows, "row")),
    };
    Part::note(format!(
        "The intervals contain the parameters of the specimen with a probability of 95 %, if the law can represent it. \
         They follow from the scatter of the residual over {} of the training data ({correlated}). A parameter at its \
         bound has none, and the others hold for it there. Other data of the same specimen determine other parameters.",
        count(intervals.rows, "row")
    ))
}

/// The parameters of a law, with their intervals where there are any; `None` for another model.
pub fn table(model: &Model, intervals: Option<&ParameterIntervals>) -> Option<Table> {
    let parameters = model.law_parameters()?;
    let bound = |value: f64| match value.abs() >= 1e50 {
        true if value < 0.0 => "−∞".to_string(),
        true => "∞".to_string(),
        false => number(value, 3),
    };
    let mut columns = vec!["parameter", "value", "unit", "meaning", "bounds"];
    if intervals.is_some() {
        columns.insert(2, INTERVAL);
    }
    let mut table = Table::new(columns);
    for (index, ParameterInUnits { parameter, unit, .. }) in parameters.iter().enumerate().take(MOST_ROWS) {
        let (low, high) = parameter.bounds;
        let mut row = vec![
            parameter.symbol.as_str().into(),
            Cell::number(parameter.value, 5),
            unit.as_str().into(),
            parameter.meaning.into(),
            format!("{} to {}", bound(low), bound(high)).into(),
        ];
        if let Some(intervals) = intervals {
            let interval = intervals.parameters.get(index).map(interval);
            row.insert(2, interval.unwrap_or_default().into());
        }
        table.push(row);
    }
    Some(table)
}

/// How many parameters the table leaves out, if any, in words.
pub fn left_out(model: &Model) -> Option<String> {
    let all = model.law()?.parameters().len();
    (all > MOST_ROWS).then(|| format!("{} are in the model file.", count(all - MOST_ROWS, "more parameter")))
}

/// The section on the parameters; `None` for a network.
pub fn section(report: &Report) -> Option<Part> {
    let model = report.model;
    let mut parts = vec![Part::Table(table(model, report.intervals)?)];
    parts.extend(left_out(model).map(Part::note));
    parts.extend(report.intervals.map(explanation));
    if model.input_transform().companding.is_some() {
        let seen = seen_label(model);
        parts.push(Part::note(format!(
            "The input of the law is {seen}, which has no unit; its parameters refer to this input."
        )));
    }
    Some(Part::section("Parameters", parts))
}
