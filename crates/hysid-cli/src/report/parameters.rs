//! The parameters of a classical law, in the field's symbols and the user's units.

use hysid::data::unit::of_column;
use hysid::model::Predictor;
use hysid_document::{Cell, Part, Table, count, number};

use super::{Report, seen_label};

/// Most rows of the table.
const MOST_ROWS: usize = 60;

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
    let mut table = Table::new(["parameter", "value", "unit", "meaning", "bounds"]);
    for parameter in parameters.iter().take(MOST_ROWS) {
        let (low, high) = parameter.bounds;
        table.push([
            parameter.symbol.as_str().into(),
            Cell::number(parameter.value, 5),
            parameter.unit.unit(input.as_deref(), output.as_deref(), time.as_deref()).into(),
            parameter.meaning.into(),
            format!("{} to {}", bound(low), bound(high)).into(),
        ]);
    }
    let mut parts = vec![Part::Table(table)];
    if parameters.len() > MOST_ROWS {
        let more = count(parameters.len() - MOST_ROWS, "more parameter");
        parts.push(Part::note(format!("{more} are in the model file.")));
    }
    if is_companded {
        let seen = seen_label(report);
        parts.push(Part::note(format!(
            "The input of the law is {seen}, which has no unit; its parameters refer to this input."
        )));
    }
    Some(Part::section("Parameters", parts))
}
