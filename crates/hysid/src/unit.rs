//! Units in the names of columns: `force [kN]`, `Time (s)`, `x / mm`, `H_A_per_m`.

const TIME: [&str; 8] = ["s", "ms", "us", "µs", "μs", "ns", "min", "h"];
const LENGTH: [&str; 7] = ["m", "mm", "cm", "um", "µm", "nm", "km"];
const OTHER: [&str; 63] = [
    "N", "mN", "kN", "MN", "Nm", "Nmm", "kNm", "Pa", "kPa", "MPa", "GPa", "bar", "psi", "lbf", "kip", "inch",
    "V", "uV", "mV", "kV", "A", "uA", "mA", "kA", "C", "nC", "uC", "µC", "mC", "T", "uT", "mT", "Wb", "mWb",
    "Oe", "kOe", "G", "kG", "W", "kW", "J", "mJ", "Hz", "kHz", "MHz", "K", "degC", "deg", "rad", "mrad", "g",
    "kg", "m2", "mm2", "cm2", "um2", "m3", "cm3", "mm3", "s2", "percent", "pct", "ohm",
];

/// The unit that a column's name tells, if any.
pub fn of_column(name: &str) -> Option<String> {
    split(name).1
}

/// True for `t`, `time`, and either with a unit of time.
pub fn is_time(name: &str) -> bool {
    let (quantity, unit) = split(name);
    let of_time = unit.is_none_or(|unit| TIME.contains(&unit.as_str()));
    of_time && ["t", "time"].contains(&quantity.to_lowercase().as_str())
}

/// A number's unit as it is printed after it.
pub fn suffix(unit: Option<&str>) -> String {
    unit.map_or_else(String::new, |unit| format!(" {unit}"))
}

/// A name as quantity and unit.
pub fn split(name: &str) -> (&str, Option<String>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = name.strip_suffix(close)
            && let Some((quantity, unit)) = inner.rsplit_once(open)
        {
            let unit = Some(unit.trim().to_string()).filter(|unit| !unit.is_empty() && unit != "-");
            return (quantity.trim_end_matches([' ', '_']), unit);
        }
    }
    if let Some((quantity, unit)) = name.rsplit_once('/')
        && is_known(unit.trim())
    {
        return (quantity.trim(), Some(unit.trim().to_string()));
    }
    // The longest known ending; something must be left to name the quantity.
    for (place, _) in name.char_indices().filter(|&(_, c)| c == '_') {
        if place > 0
            && let Some(unit) = from_words(&name[place + 1..])
        {
            return (&name[..place], Some(unit));
        }
    }
    (name, None)
}

/// `A_per_m` is A/m, `V_us` is V us, `mm_s` is mm/s.
fn from_words(text: &str) -> Option<String> {
    if let Some((above, below)) = text.split_once("_per_") {
        return (is_known(above) && is_known(below)).then(|| format!("{above}/{below}"));
    }
    match text.split_once('_') {
        None => is_known(text).then(|| text.to_string()),
        Some((length, time)) if LENGTH.contains(&length) && TIME.contains(&time) => {
            Some(format!("{length}/{time}"))
        }
        Some((force, arm)) if ["N", "kN"].contains(&force) && LENGTH.contains(&arm) => {
            Some(format!("{force} {arm}"))
        }
        Some((unit, time)) if is_known(unit) && TIME.contains(&time) => Some(format!("{unit} {time}")),
        Some(_) => None,
    }
}

fn is_known(unit: &str) -> bool {
    TIME.contains(&unit) || LENGTH.contains(&unit) || OTHER.contains(&unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_in_names() {
        for (name, unit) in [
            ("force [kN]", "kN"),
            ("Time (s)", "s"),
            ("x / mm", "mm"),
            ("force_kN", "kN"),
            ("H_A_per_m", "A/m"),
            ("P_uC_per_cm2", "uC/cm2"),
            ("B_V_us", "V us"),
            ("H_fit_V", "V"),
            ("V_V", "V"),
            ("stress_true_MPa", "MPa"),
            ("v_mm_s", "mm/s"),
            ("M_kN_m", "kN m"),
            ("t_µs", "µs"),
        ] {
            assert_eq!(of_column(name).as_deref(), Some(unit), "{name}");
        }
        for name in ["V", "x", "force", "V_in", "x_1", "ratio [-]", "_s"] {
            assert_eq!(of_column(name), None, "{name}");
        }
    }

    #[test]
    fn time_is_recognised() {
        for name in ["t", "T", "time", "Time (s)", "time [ms]", "t_us", "TIME_s", "t/s"] {
            assert!(is_time(name), "{name}");
        }
        for name in ["t_mm", "temperature", "time_index", "x_s", "t1"] {
            assert!(!is_time(name), "{name}");
        }
    }
}
