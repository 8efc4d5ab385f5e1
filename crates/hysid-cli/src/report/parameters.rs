//! The parameters of a classical law, in the field's symbols and the user's units.

use hysid::data::unit::of_column;
use hysid::fit::intervals::{IntervalStatus, ParameterInterval, ParameterIntervals};
use hysid::model::Predictor;
use hysid_document::{Cell, Part, Table, count, number};

use super::{Report, seen_label};

/// Most rows of the table.
const MOST_ROWS: usize = 60;

/// Heading of the intervals.
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

/// What the intervals mean.
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

/// The section on the parameters; `None` for a network, whose neurons are shown.
pub fn section(report: &Report) -> Option<Part> {
    let Predictor::Law(law) = report.model.predictor() else { return None };
    let names = report.model.names();
    let is_companded = report.model.input_transform().companding.is_some();
    let input = of_column(&names.inputs[0]).filter(|_| !is_companded);
    let (output, time) = (of_column(&names.output), names.time.as_deref().and_then(of_column));
    let parameters = law.parameters();
    let bound = |value: f64| match value.abs() >= 1e50 {
        true if value < 0.0 => "−∞".to_string(),
        true => "∞".to_string(),
        false => number(value, 3),
    };
    let mut columns = vec!["parameter", "value", "unit", "meaning", "bounds"];
    if report.intervals.is_some() {
        columns.insert(2, INTERVAL);
    }
    let mut table = Table::new(columns);
    for (index, parameter) in parameters.iter().enumerate().take(MOST_ROWS) {
        let (low, high) = parameter.bounds;
        let interval = report.intervals.and_then(|intervals| intervals.parameters.get(index)).map(interval);
        let mut row = vec![
            parameter.symbol.as_str().into(),
            Cell::number(parameter.value, 5),
            parameter.unit.unit(input.as_deref(), output.as_deref(), time.as_deref()).into(),
            parameter.meaning.into(),
            format!("{} to {}", bound(low), bound(high)).into(),
        ];
        if report.intervals.is_some() {
            row.insert(2, interval.unwrap_or_default().into());
        }
        table.push(row);
    }
    let mut parts = vec![Part::Table(table)];
    if parameters.len() > MOST_ROWS {
        let more = count(parameters.len() - MOST_ROWS, "more parameter");
        parts.push(Part::note(format!("{more} are in the model file.")));
    }
    parts.extend(report.intervals.map(explanation));
    if is_companded {
        let seen = seen_label(report);
        parts.push(Part::note(format!(
            "The input of the law is {seen}, which has no unit; its parameters refer to this input."
        )));
    }
    Some(Part::section("Parameters", parts))
}
