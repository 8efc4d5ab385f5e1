//! Units in column names: `force_kN`, `t [s]`, `H_A_per_m`.

/// The quantity and its unit, if the column name ends with one, as a page shows it.
pub fn split(column: &str) -> (String, Option<String>) {
    let (quantity, unit) = hysid_core::data::unit::split(column);
    (quantity.to_string(), unit.map(|unit| hysid_core::data::unit::written(&unit)))
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
