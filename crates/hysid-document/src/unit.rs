//! Units in column names: `force_kN`, `t [s]`, `H_A_per_m`.

/// The quantity and its unit, if the column name ends with one, as a page shows it.
pub fn split(column: &str) -> (String, Option<String>) {
    let (quantity, unit) = hysid_core::data::unit::split(column);
    (quantity.to_string(), unit.map(|unit| written(&unit)))
}

/// Units that a leading `u` makes millionths of.
const MICRO: [&str; 10] = ["s", "m", "m2", "m3", "V", "A", "C", "T", "J", "W"];

/// A unit with the signs that a column name cannot have: `uC/cm2` is µC/cm².
fn written(unit: &str) -> String {
    let symbol = |symbol: &str| match symbol {
        "percent" | "pct" => "%".into(),
        "degC" => "°C".into(),
        "deg" => "°".into(),
        "ohm" => "Ω".into(),
        _ => {
            let micro = symbol.strip_prefix('u').filter(|of| MICRO.contains(of));
            let symbol = micro.map_or(symbol.to_string(), |of| format!("µ{of}"));
            symbol.replace('2', "²").replace('3', "³")
        }
    };
    let product = |text: &str| text.split(' ').map(symbol).collect::<Vec<String>>().join(" ");
    unit.split('/').map(product).collect::<Vec<String>>().join("/")
}

/// The column as a label: `force (kN)`.
pub fn label(column: &str) -> String {
    match split(column) {
        (name, Some(unit)) => format!("{name} ({unit})"),
        (name, None) => name,
    }
}

/// The unit, or ` (unit of …)` for a column without a unit in its name.
pub fn of(column: &str) -> String {
    match split(column) {
        (_, Some(unit)) => unit,
        (name, None) => format!("unit of {name}"),
    }
}

/// A value with the unit of the column; without a unit if the name has none.
pub fn with(value: &str, column: &str) -> String {
    match split(column).1 {
        Some(unit) => format!("{value} {unit}"),
        None => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_their_units() {
        let cases = [
            ("force_kN", "force (kN)"),
            ("H_A_per_m", "H (A/m)"),
            ("t [s]", "t (s)"),
            ("disp_top_mm", "disp_top (mm)"),
            ("y (arb. units)", "y (arb. units)"),
            ("x_um", "x (µm)"),
            ("channel_7", "channel_7"),
            ("x", "x"),
            ("_m", "_m"),
        ];
        for (column, expected) in cases {
            assert_eq!(label(column), expected);
        }
        assert_eq!((of("x"), with("3", "x")), ("unit of x".to_string(), "3".to_string()));
    }
}
