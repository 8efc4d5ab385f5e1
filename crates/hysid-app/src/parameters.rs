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

/// The laws in a model, each with its weight before the input leaves the trained range: the law itself, without a weight,
/// or those among the members of an ensemble.
pub fn laws(model: &Model) -> Vec<(&Model, Option<f64>)> {
    let Some(ensemble) = model.ensemble() else {
        return model.law().map(|_| (model, None)).into_iter().collect();
    };
    let shares = ensemble.group().shares();
    let weight = |place: usize| shares.iter().filter(|one| one.0 == place).map(|one| one.1.inside).sum();
    let members = ensemble.members().iter().enumerate();
    let laws = members.filter(|(_, member)| member.law().is_some());
    let mut laws: Vec<(&Model, Option<f64>)> = laws.map(|(place, law)| (law, Some(weight(place)))).collect();
    laws.sort_by(|a, b| b.1.unwrap_or(0.0).total_cmp(&a.1.unwrap_or(0.0)));
    laws
}

/// The section on the parameters of all laws; `None` without laws.
pub fn section(report: &Report) -> Option<Part> {
    let laws = laws(report.model);
    let intervals = |place: usize| report.intervals.get(place).and_then(Option::as_ref);
    let mut parts = Vec::new();
    for (place, &(law, weight)) in laws.iter().enumerate() {
        let Some(of_law) = of_law(law, intervals(place)) else { continue };
        parts.extend(match weight {
            None => of_law,
            Some(weight) => {
                let heading = format!("{}, weight {} %", law.name().name(), number(100.0 * weight, 3));
                // Without intervals, parameters are many, or weights without a physical meaning.
                match intervals(place) {
                    Some(_) => [vec![Part::heading(heading)], of_law].concat(),
                    None => vec![Part::Folded(heading, of_law)],
                }
            }
        });
    }
    let chosen =
        report.model.provenance().selection.is_some() && report.intervals.iter().any(Option::is_some);
    parts.extend(chosen.then(|| {
        Part::note("The laws were chosen on the same data. The intervals do not allow for this choice.")
    }));
    (!parts.is_empty()).then(|| Part::section("Parameters", parts))
}

/// The parameters of a law, and what they refer to.
fn of_law(law: &Model, intervals: Option<&ParameterIntervals>) -> Option<Vec<Part>> {
    let mut parts = vec![Part::Table(table(law, intervals)?)];
    parts.extend(left_out(law).map(Part::note));
    parts.extend(intervals.map(explanation));
    if law.input_transform().compression.is_some() {
        let seen = seen_label(law);
        parts.push(Part::note(format!(
            "The input of the law is {seen}, which has no unit; its parameters refer to this input."
        )));
    }
    Some(parts)
}
