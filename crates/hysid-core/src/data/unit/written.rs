//! Units as text shows them.

use super::quantity::UnitQuantity;

/// A unit with the signs that a column name may lack: µC/cm² of `uC/cm2`, °C of `degC`.
pub fn written(unit: &str) -> String {
    let part = |part: &str| {
        let symbol = part.trim_end_matches(SEPARATORS);
        with_signs(symbol) + &part[symbol.len()..]
    };
    unit.split_inclusive(SEPARATORS).map(part).collect()
}

const SEPARATORS: [char; 4] = [' ', '/', '(', ')'];

fn with_signs(symbol: &str) -> String {
    match symbol {
        "percent" | "pct" => return "%".into(),
        "degC" | "℃" | "Celsius" => return "°C".into(),
        "deg" => return "°".into(),
        "ohm" => return "Ω".into(),
        _ => {}
    }
    let powers = [('2', "²"), ('3', "³")];
    let raised = powers.into_iter().find_map(|(digit, sign)| {
        let base = symbol.strip_suffix(digit)?.trim_end_matches('^');
        // What is raised may stand in brackets before it.
        (base.is_empty() || base.ends_with(char::is_alphabetic)).then_some((base, sign))
    });
    let (base, power) = raised.unwrap_or((symbol, ""));
    // The Greek letter looks like the sign for a millionth.
    let micro = base
        .strip_prefix('μ')
        .or_else(|| base.strip_prefix('u').filter(|_| UnitQuantity::of(base).is_some()));
    match micro {
        Some(of) => format!("µ{of}{power}"),
        None => format!("{base}{power}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_written_with_their_signs() {
        for (unit, expected) in [
            ("um", "µm"),
            ("μm", "µm"),
            ("uC/cm2", "µC/cm²"),
            ("um/(kV/mm)", "µm/(kV/mm)"),
            ("kN/(um V)", "kN/(µm V)"),
            ("mm/s^2", "mm/s²"),
            ("T/(A/m)2", "T/(A/m)²"),
            ("degC", "°C"),
            ("percent", "%"),
            ("mmH2O", "mmH2O"),
            ("unit", "unit"),
            ("J/m3", "J/m³"),
        ] {
            assert_eq!(written(unit), expected);
        }
    }
}
