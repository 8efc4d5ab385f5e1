//! Units in the names of columns: `force [kN]`, `Time (s)`, `x / mm`, `H_A_per_m`.

mod derived;
mod in_name;
mod quantity;
mod written;

use crate::data::usual_role::{Domain, UsualRole};
use crate::elementary::{log10, powi};
pub use derived::{energy, power, pure_quotient, quotient};
pub use in_name::split;
use quantity::UnitQuantity;
pub use written::written;

/// Known units that are no multiples of others: a temperature in degrees Celsius has another zero.
const OTHER: [&str; 1] = ["degC"];

/// Further units that do not end a name without brackets.
const OTHER_ALONE: [&str; 5] = ["°C", "℃", "°F", "Celsius", "n.u."];

/// Names that only time has.
const TIME_NAMES: &str = "t time";

/// Further names of time, lower case, without blanks and underscores. The values must confirm them.
const FURTHER_TIME_NAMES: &str = "timestamp elapsed elapsedtime timeelapsed testtime runtime clock date \
                                  datetime sec secs second seconds minutes hours days zeit zeitstempel messzeit temps tiempo \
                                  tempo xvalue relativetime tijd czas tid время 时间 时刻 時間 時刻";

/// Words of longer names of time, such as `Running Time`.
const TIME_WORDS: [&str; 6] = ["time", "zeit", "temps", "tiempo", "tempo", "время"];

/// The usual role of a quantity with this unit in hysteresis, if it has one.
pub(crate) fn part(unit: &str) -> Option<UsualRole> {
    if OTHER.contains(&unit) || OTHER_ALONE.contains(&unit) && unit != "n.u." {
        return Some(UsualRole::Accompanies);
    }
    // That of a volume has the dimension of a field.
    if unit.contains("emu") {
        return Some(UsualRole::Follows(Domain::Magnetism));
    }
    UnitQuantity::of(unit)?.part()
}

/// Conversion of a column from one unit to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conversion {
    /// No conversion: the units are equal, or one of them is unknown.
    Same,
    /// Numbers are multiplied by this factor.
    Factor(f64),
    /// The units differ and have no common factor.
    Impossible,
}

impl Conversion {
    /// The conversion from the unit in the name of one column to that in the name of another.
    pub fn between(from: &str, to: &str) -> Self {
        let (Some(from), Some(to)) = (of_column(from), of_column(to)) else { return Self::Same };
        if from == to {
            return Self::Same;
        }
        match (UnitQuantity::of(&from), UnitQuantity::of(&to)) {
            (Some(from), Some(to)) if from.dimension == to.dimension => match from.factor / to.factor {
                // Such as `us` and `µs`.
                1.0 => Self::Same,
                // A quotient of factors is off by a rounding where 1000 is meant.
                factor => Self::Factor(rounded(factor)),
            },
            _ => Self::Impossible,
        }
    }
}

/// The factor from one unit to another; `None` if a unit is unknown or of another quantity.
pub fn factor(from: &str, to: &str) -> Option<f64> {
    let (from, to) = (UnitQuantity::of(from)?, UnitQuantity::of(to)?);
    (from.dimension == to.dimension).then(|| rounded(from.factor / to.factor))
}

/// The power of ten that a number is, but for roundings; otherwise the number.
fn rounded(factor: f64) -> f64 {
    let power = powi(10.0, log10(factor).round() as i32);
    if (factor / power - 1.0).abs() < 1e-12 { power } else { factor }
}

/// The unit in the name of a column, if there is one.
pub fn of_column(name: &str) -> Option<String> {
    split(name).1
}

/// True for a text that is a known unit and nothing else, such as `kN`, `A/m` or `°C`.
pub fn is_unit(text: &str) -> bool {
    OTHER.contains(&text) || OTHER_ALONE.contains(&text) || UnitQuantity::of(text).is_some()
}

/// True for `t`, `time`, and either with a unit of time.
pub fn is_time(name: &str) -> bool {
    is_named_time(name, TIME_NAMES)
}

/// True for names that may mean time, in several languages, or have a unit of time.
pub fn may_be_time(name: &str) -> bool {
    let (quantity, unit) = split(name);
    let has_word = || {
        quantity.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| TIME_WORDS.contains(&word))
    };
    let is_in_time = is_in_unit_of_time(unit.as_deref());
    is_time(name) || is_named_time(name, FURTHER_TIME_NAMES) || is_in_time || unit.is_none() && has_word()
}

fn is_named_time(name: &str, names: &str) -> bool {
    let (quantity, unit) = split(name);
    let plain: String = quantity.to_lowercase().chars().filter(|c| !" _-.".contains(*c)).collect();
    (unit.is_none() || is_in_unit_of_time(unit.as_deref())) && names.split(' ').any(|known| known == plain)
}

fn is_in_unit_of_time(unit: Option<&str>) -> bool {
    let quantity = unit.and_then(UnitQuantity::of);
    quantity.is_some_and(|quantity| quantity.dimension == quantity::TIME)
}

/// A unit as it is printed after a number.
pub fn suffix(unit: Option<&str>) -> String {
    unit.map_or_else(String::new, |unit| format!(" {}", written(unit)))
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
            ("acc_m_s2", "m/s2"),
            ("M_kN_m", "kN m"),
            ("t_µs", "µs"),
            ("Force, kN", "kN"),
            ("Сила, кН", "кН"),
            ("H (Oe) (2)", "Oe"),
        ] {
            assert_eq!(of_column(name).as_deref(), Some(unit), "{name}");
        }
        for name in ["V", "x", "force", "V_in", "x_1", "ratio [-]", "_s", "x (2)"] {
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
        for name in ["time [sec]", "t (seconds)"] {
            assert!(is_time(name), "{name}");
        }
        for name in ["timestamp", "Zeit", "Elapsed Time", "elapsed_ms", "Time_Stamp (s)", "x_s"] {
            assert!(may_be_time(name), "{name}");
        }
        for name in ["temperature", "x_mm", "v_mm_s", "index", "Zeit [mm]"] {
            assert!(!may_be_time(name), "{name}");
        }
    }

    #[test]
    fn units_of_one_quantity_have_a_factor() {
        assert_eq!(factor("kN s2/m", "kg"), Some(1e3));
        assert_eq!(factor("mm/s^2", "m/s2"), Some(1e-3));
        assert_eq!(factor("mm", "N"), None);
        assert_eq!(factor("ticks", "mm"), None);
    }

    #[test]
    fn numbers_are_converted_where_units_are_known() {
        let between = Conversion::between;
        assert_eq!(between("displacement_m", "disp_mm"), Conversion::Factor(1000.0));
        assert_eq!(between("force_N", "F [kN]"), Conversion::Factor(1e-3));
        assert_eq!(between("t_ms", "t_s"), Conversion::Factor(1e-3));
        assert_eq!(between("t_min", "t_s"), Conversion::Factor(60.0));
        assert_eq!(between("sigma [N/mm²]", "stress_MPa"), Conversion::Same);
        assert_eq!(between("t_us", "t_µs"), Conversion::Same);
        assert_eq!(between("x", "x_mm"), Conversion::Same);
        assert_eq!(between("x [ticks]", "y [ticks]"), Conversion::Same);
        assert_eq!(between("x [ticks]", "x_mm"), Conversion::Impossible);
        assert_eq!(between("force_N", "x_mm"), Conversion::Impossible);
        assert_eq!(between("T_K", "T_degC"), Conversion::Impossible);
    }
}
