//! Errors as a small table, in the user's units.

use hysid::data::metrics::Errors;
use hysid_core::significant::Significant;
use hysid_document::plain::aligned;

use hysid::data::unit;

use hysid_document::visible::clipped;

/// Heading of errors without the rows of a warm-up.
pub const AFTER_WARM_UP: &str = "after warm-up";

/// Letters of a column, at least.
const COLUMN: usize = 13;

/// Text of one measure, a row of the table.
type Measure = fn(&Errors) -> String;

/// One column for each named set of errors, one row for each measure.
pub fn errors_table(sets: &[(&str, &Errors)]) -> String {
    let column = sets.first().map_or("", |(_, errors)| errors.output.as_str());
    let unit = unit::of_column(column)
        .map_or_else(String::new, |unit| format!(", {}", clipped(&unit::written(&unit))));
    let output = clipped(column);
    let rows: [(String, Measure); 5] = [
        (format!("RMSE of {output}{unit}"), |errors| number(errors.rmse)),
        ("NRMSE, % of std".into(), |errors| percent(errors.nrmse_std_percent)),
        ("NRMSE, % of range".into(), |errors| percent(errors.nrmse_range_percent)),
        (format!("largest error{unit}"), |errors| number(errors.max_abs_error)),
        ("rows scored".into(), |errors| errors.samples.to_string()),
    ];
    let heading = |&(name, _): &(&str, &Errors)| format!("{name:>COLUMN$}");
    let mut table = vec![std::iter::once(String::new()).chain(sets.iter().map(heading)).collect()];
    table.extend(rows.map(|(label, measure)| {
        std::iter::once(label).chain(sets.iter().map(|(_, errors)| measure(errors))).collect()
    }));
    aligned(&table).join("\n") + "\n"
}

fn number(value: f64) -> String {
    format!("{:.4}", Significant(value))
}

/// `None` is for an output that does not vary.
fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), number)
}
