//! The parameters of a classical law, in the field's symbols and the user's units.

use hysid::data::unit::of_column;
use hysid::model::Body;

use super::{Report, seen_label};
use crate::page::{count, note, number, section as section_of, table};

/// Most rows of the table.
const MOST_ROWS: usize = 60;

/// The section on the parameters; empty for a network, whose neurons are shown.
pub fn section(report: &Report) -> String {
    let Body::Law(law) = report.model.body() else { return String::new() };
    let names = report.model.names();
    let is_companded = report.model.preprocessing().companding.is_some();
    let input = of_column(&names.inputs[0]).filter(|_| !is_companded);
    let (output, time) = (of_column(&names.output), names.time.as_deref().and_then(of_column));
    let parameters = law.parameters();
    let bound = |value: f64| match value.abs() >= 1e50 {
        true if value < 0.0 => "−∞".to_string(),
        true => "∞".to_string(),
        false => number(value, 3),
    };
    let rows: Vec<Vec<String>> = parameters
        .iter()
        .take(MOST_ROWS)
        .map(|parameter| {
            let (low, high) = parameter.bounds;
            vec![
                parameter.symbol.clone(),
                number(parameter.value, 5),
                parameter.unit.unit(input.as_deref(), output.as_deref(), time.as_deref()),
                parameter.meaning.to_string(),
                format!("{} to {}", bound(low), bound(high)),
            ]
        })
        .collect();
    let headings = ["parameter", "value", "unit", "meaning", "bounds"].map(String::from);
    let mut content = table(&headings, &rows);
    if parameters.len() > rows.len() {
        let more = count(parameters.len() - rows.len(), "more parameter");
        content += &note(&format!("{more} are in the model file."));
    }
    if is_companded {
        let seen = seen_label(report);
        content += &note(&format!(
            "The law sees its input as {seen}, a number without a unit; so do its parameters."
        ));
    }
    section_of("Parameters", &content)
}
