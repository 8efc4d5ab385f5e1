//! Units, as column names tell them: `force_kN`, `t [s]`, `H_A_per_m`.

/// What may follow the last underscore and be a unit.
const KNOWN: &[&str] = &[
    "s", "ms", "us", "ns", "min", "h", "d", "Hz", "kHz", "m", "cm", "mm", "um", "nm", "in", "ft", "m2",
    "mm2", "N", "kN", "MN", "Nm", "kNm", "Pa", "kPa", "MPa", "GPa", "bar", "psi", "kips", "lbf", "T", "mT",
    "Oe", "G", "A", "mA", "kA", "V", "mV", "kV", "C", "uC", "K", "degC", "deg", "rad", "mrad", "g", "kg",
    "J", "W", "Ohm", "percent", "pct", "strain", "ppm",
];

/// The quantity and its unit, if the column name ends with one.
pub fn split(column: &str) -> (String, Option<String>) {
    let column = column.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = column.strip_suffix(close).and_then(|rest| rest.rsplit_once(open))
            && !unit.trim().is_empty()
        {
            return (name.trim().to_string(), Some(unit.trim().to_string()));
        }
    }
    if let Some((before, per)) = column.rsplit_once("_per_")
        && let Some((name, of)) = before.rsplit_once('_')
        && (KNOWN.contains(&of) || KNOWN.contains(&per))
    {
        return (name.to_string(), Some(format!("{of}/{per}")));
    }
    match column.rsplit_once('_') {
        Some((name, unit)) if KNOWN.contains(&unit) && !name.is_empty() => {
            (name.to_string(), Some(written(unit)))
        }
        _ => (column.to_string(), None),
    }
}

fn written(unit: &str) -> String {
    match unit {
        "percent" | "pct" => "%".into(),
        "degC" => "°C".into(),
        "deg" => "°".into(),
        "m2" | "mm2" => unit.replace('2', "²"),
        "Ohm" => "Ω".into(),
        _ => unit.strip_prefix('u').map_or(unit.to_string(), |rest| format!("µ{rest}")),
    }
}

/// The column as a label: `force (kN)`.
pub fn label(column: &str) -> String {
    match split(column) {
        (name, Some(unit)) => format!("{name} ({unit})"),
        (name, None) => name,
    }
}

/// The unit, or ` (unit of …)` for a column that does not tell it.
pub fn of(column: &str) -> String {
    match split(column) {
        (_, Some(unit)) => unit,
        (name, None) => format!("unit of {name}"),
    }
}

/// A quantity with its unit; without one if the column does not tell it.
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
