//! The unit that ends the name of a column. A compound unit is read as a whole, or not at all: `E/kV/mm` is in kV/mm, and
//! of `k_N_m`, which may be in N/m or N m, no unit is known.

use super::quantity::{
    CURRENT, Dimension, FORCE, LENGTH, MASS, NONE, POWER, PRESSURE, TIME, UnitQuantity, VOLTAGE,
    may_end_a_name,
};
use super::{OTHER, OTHER_ALONE, is_unit, part};
use crate::data::usual_role::{Domain, UsualRole};

/// Numerators of compound units, of no quantity that is converted.
const UNCONVERTED: &str = "mol mmol umol Ah mAh uAh Wh mWh kWh cycle cycles counts rev steps samples ml mL";

/// Signs that are units behind a slash: `strain/%`.
const SIGNS: [&str; 3] = ["%", "‰", "°"];

/// Names of time that are units too.
const TIMES: [(&str, &str); 7] = [
    ("seconds", "s"),
    ("secs", "s"),
    ("sec", "s"),
    ("minutes", "min"),
    ("hours", "h"),
    ("days", "d"),
    ("milliseconds", "ms"),
];

/// Unit at the end of a name.
enum Ending {
    Unit(String),
    /// None is there.
    Absent,
    /// A part of a compound unit that is not known.
    Unclear,
}

/// A name, divided into quantity and unit.
pub fn split(name: &str) -> (&str, Option<String>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = name.strip_suffix(close)
            && let Some((quantity, unit)) = inner.rsplit_once(open)
        {
            // The number of an equal name, such as `H (Oe) (2)`.
            if !unit.is_empty() && unit.bytes().all(|byte| byte.is_ascii_digit()) {
                return split(quantity);
            }
            let unit = Some(unit.trim().to_string()).filter(|unit| !unit.is_empty() && unit != "-");
            return (quantity.trim_end_matches([' ', '_', '/']), unit);
        }
    }
    if let Some((quantity, unit)) = name.rsplit_once(", ")
        && is_unit(unit.trim())
    {
        return (quantity.trim(), Some(unit.trim().to_string()));
    }
    if let Some((_, unit)) = TIMES.iter().find(|(word, _)| name.eq_ignore_ascii_case(word)) {
        return (name, Some(unit.to_string()));
    }
    // The longest ending; something must be left to name the quantity. A slash between blanks divides first: `F/A / MPa`.
    let from = name.find(" / ").map_or(1, |blank| blank + 1);
    for (place, separator) in name.char_indices().filter(|&(place, c)| place >= from && "/_ ".contains(c)) {
        let (quantity, text) = (name[..place].trim_end(), name[place + 1..].trim_start());
        let ending = match separator {
            '_' if !text.contains('/') => of_words(quantity, text),
            _ if text.contains('/') => of_quotient(quantity, &text.replace('_', " "), separator == '/'),
            '/' if from > 1 || !quantity.contains('/') => of_slash(quantity, text),
            '/' => Ending::Unclear,
            _ => Ending::Absent,
        };
        match ending {
            Ending::Unit(unit) => return (quantity, Some(unit)),
            Ending::Unclear => return (name, None),
            Ending::Absent => {}
        }
    }
    (name, None)
}

fn is_known(unit: &str) -> bool {
    OTHER.contains(&unit) || may_end_a_name(unit)
}

/// True for a word that may begin a compound unit.
fn is_numerator(word: &str) -> bool {
    is_known(word) || UNCONVERTED.split(' ').any(|known| known == word)
}

/// A single unit behind a slash. It is no part of `cycles/min`.
fn of_slash(quantity: &str, text: &str) -> Ending {
    if !(is_known(text) || SIGNS.contains(&text) || OTHER_ALONE[..4].contains(&text)) {
        return Ending::Absent;
    }
    let last = quantity.rsplit([' ', '_']).next().unwrap_or_default();
    let is_part =
        last == "1" && dimension(text) == Some(TIME) || last.chars().count() > 1 && is_numerator(last);
    if is_part { Ending::Unclear } else { Ending::Unit(text.into()) }
}

/// A unit with slashes, such as `kV/mm` or `V s/m2`. Behind a blank, a letter may be that of a place or a channel.
fn of_quotient(quantity: &str, text: &str, is_behind_slash: bool) -> Ending {
    let mut parts = text.split('/').map(str::trim);
    let is_product = |part: &str| !part.is_empty() && part.split([' ', '*', '·']).all(is_numerator);
    let above = parts.next().unwrap_or_default();
    let is_above = is_product(above) || above == "1";
    let divides = |part: &str| dimension(part).is_some_and(|of| is_divisor(of) || DIVISORS.contains(&of));
    let below = parts.clone().next().unwrap_or_default();
    let (is_unit, below_is) =
        (is_above && dimension(above) != Some(TIME) && parts.all(divides), dimension(below));
    let is_letter = !is_behind_slash && above.len() == 1;
    match (is_unit, is_letter) {
        (false, _) => Ending::Absent,
        (true, true) if is_quantity_of(quantity, below) || above == "1" && below_is != Some(TIME) => {
            Ending::Absent
        }
        (true, true)
            if above != "N" && below_is == Some(LENGTH) && !is_field(quantity)
                || below_is.is_some_and(|of| DIVISORS.contains(&of)) =>
        {
            Ending::Unclear
        }
        _ => Ending::Unit(text.into()),
    }
}

/// Dimensions of divisors beside lengths, masses and times with their powers.
const DIVISORS: [Dimension; 4] = [VOLTAGE, CURRENT, [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]];

fn is_divisor(dimension: Dimension) -> bool {
    dimension.iter().filter(|exponent| **exponent != 0).count() == 1 && dimension[..3] != [0; 3]
}

fn dimension(unit: &str) -> Option<Dimension> {
    UnitQuantity::of(unit).map(|quantity| quantity.dimension)
}

/// `A_per_m` is A/m, `V_us` is V us, `mm_s` is mm/s, `N_mm2` is N/mm2.
fn of_words(quantity: &str, text: &str) -> Ending {
    let are_known = |words: &str| words.split('_').all(is_numerator);
    if let Some((above, below)) = text.split_once("_per_") {
        return match are_known(above) && are_known(below) {
            true => Ending::Unit(format!("{above}/{below}").replace('_', " ")),
            false => Ending::Absent,
        };
    }
    let Some((above, below)) = text.rsplit_once('_') else {
        return if is_known(text) { Ending::Unit(text.into()) } else { Ending::Absent };
    };
    let below_is = match below {
        "s2" => [0, 0, 2, 0, 0, 0],
        _ => dimension(below).filter(|_| is_known(below)).unwrap_or(NONE),
    };
    if !is_divisor(below_is) || !(are_known(above) || above == "1" && below_is == TIME) {
        return Ending::Absent;
    }
    let above = above.replace('_', " ");
    let above_is = dimension(&above).unwrap_or(NONE);
    let (quotient, product) =
        (Ending::Unit(format!("{above}/{below}")), Ending::Unit(format!("{above} {below}")));
    let is_letter = above.len() == 1;
    match (above_is, below_is) {
        // The letter of a place: `x_A_mm`.
        _ if is_letter && is_quantity_of(quantity, below) => Ending::Absent,
        (TIME, _) => Ending::Absent,
        (LENGTH, LENGTH) if above == below || below == "m" => quotient,
        (LENGTH, LENGTH) => Ending::Absent,
        (FORCE, LENGTH) if is_moment(quantity) => product,
        (FORCE, LENGTH) | (FORCE | PRESSURE, TIME) => Ending::Unclear,
        (VOLTAGE | CURRENT | POWER, TIME) => product,
        (_, LENGTH) if is_letter && !is_field(quantity) => Ending::Unclear,
        // A magnetic moment or the density of a current.
        (CURRENT, _) if below == "m2" => Ending::Unclear,
        _ => quotient,
    }
}

/// True for the name of a displacement with a length, and of time with a time.
fn is_quantity_of(quantity: &str, unit: &str) -> bool {
    let is_named = match dimension(unit) {
        Some(LENGTH) => matches!(quantity, "x" | "y" | "z" | "u" | "w" | "d"),
        Some(TIME) => ["t", "time"].contains(&quantity.to_lowercase().as_str()),
        Some(MASS) => quantity == "m",
        _ => false,
    };
    is_named || part(unit).is_some() && UsualRole::of(quantity) == part(unit)
}

fn is_moment(quantity: &str) -> bool {
    quantity.to_lowercase().split(|c: char| !c.is_alphabetic()).any(|word| {
        ["m", "t", "moment", "torque", "bending", "drehmoment", "couple", "momento", "mx", "my", "mz"]
            .contains(&word)
    })
}

fn is_field(quantity: &str) -> bool {
    let lower = quantity.to_lowercase();
    let is_symbol = quantity.starts_with(['H', 'M', 'E', 'J']) && quantity.chars().count() <= 3;
    is_symbol
        || ["field", "feld", "magneti", "champ", "campo"].iter().any(|word| lower.contains(word))
        || matches!(UsualRole::of(quantity), Some(UsualRole::Drives(of) | UsualRole::Follows(of)) if of != Domain::Mechanics)
}

#[cfg(test)]
mod tests {
    use super::super::Conversion;
    use super::*;

    #[test]
    fn compound_units_are_read_as_a_whole_or_not_at_all() {
        for (name, quantity, unit) in [
            ("E/kV/mm", "E", "kV/mm"),
            ("E / kV/mm", "E", "kV/mm"),
            ("E (kV/mm)", "E", "kV/mm"),
            ("E / (kV/mm)", "E", "kV/mm"),
            ("E_kV/mm", "E", "kV/mm"),
            ("E_kV_mm", "E", "kV/mm"),
            ("H/A/m", "H", "A/m"),
            ("H_A_m", "H", "A/m"),
            ("Field_A_m", "Field", "A/m"),
            ("M/kA/m", "M", "kA/m"),
            ("M_kA_m", "M", "kA/m"),
            ("F/N/mm", "F", "N/mm"),
            ("k/N/m", "k", "N/m"),
            ("M_emu_g", "M", "emu/g"),
            ("M/emu/g", "M", "emu/g"),
            ("q/C/g", "q", "C/g"),
            ("Capacity_mAh_g", "Capacity", "mAh/g"),
            ("uptake mmol/g", "uptake", "mmol/g"),
            ("Stress_N_mm2", "Stress", "N/mm2"),
            ("p_kN_m2", "p", "kN/m2"),
            ("v_mm_s", "v", "mm/s"),
            ("omega_rad_s", "omega", "rad/s"),
            ("rate_1_s", "rate", "1/s"),
            ("B_V_s_m2", "B", "V s/m2"),
            ("B/V s/m2", "B", "V s/m2"),
            ("flux Wb/m2", "flux", "Wb/m2"),
            ("M_A_m2_kg", "M", "A m2/kg"),
            ("strain_um_m", "strain", "um/m"),
            ("F/A / MPa", "F/A", "MPa"),
            ("T/°C", "T", "°C"),
            ("strain/%", "strain", "%"),
            ("U/mV", "U", "mV"),
            ("t/ms", "t", "ms"),
            ("a/m/s²", "a", "m/s²"),
            ("M_kN_m", "M", "kN m"),
            ("Energy_W_h", "Energy", "W h"),
            ("x_A_mm", "x", "mm"),
            ("disp_N_mm", "disp", "mm"),
            ("F_V_kN", "F_V", "kN"),
            ("LVDT_1_mm", "LVDT_1", "mm"),
            ("Weg 1/mm", "Weg 1", "mm"),
            ("Disp N/mm", "Disp N", "mm"),
            ("x_left_mm", "x_left", "mm"),
            ("Minutes", "Minutes", "min"),
        ] {
            let found = split(name);
            let quantity = if ["x", "disp"].contains(&quantity) { found.0 } else { quantity };
            assert_eq!(found, (quantity, Some(unit.to_string())), "{name}");
        }
        for name in [
            "k_N_m",
            "F_N_mm",
            "F_kN_s",
            "a/b/mm",
            "M/foo/g",
            "cycles/min",
            "kN/mm",
            "F/A/MPa",
            "LVDT_A_mm",
            "Channel A/V",
            "p/p0",
        ] {
            assert_eq!(split(name), (name, None), "{name}");
        }
    }

    #[test]
    fn compound_units_are_converted_the_right_way() {
        for (from, to, factor) in [
            ("E_kV/cm", "E/kV/mm", 0.1),
            ("H_kA_m", "H/A/m", 1e3),
            ("M_emu_kg", "M_emu_g", 1e-3),
            ("M (emu/cm3)", "M/kA/m", 1.0),
            ("rate_1_s", "rate (1/min)", 60.0),
            ("Time (days)", "t_h", 24.0),
            ("Minutes", "t_s", 60.0),
            ("x (mil)", "x_um", 25.4),
            ("x_dm", "x_mm", 100.0),
            ("F (tf)", "F (daN)", 980.665),
        ] {
            match Conversion::between(from, to) {
                Conversion::Factor(found) => approx::assert_relative_eq!(found, factor, max_relative = 1e-12),
                other => assert!(factor == 1.0 && other == Conversion::Same, "{from} {to}: {other:?}"),
            }
        }
    }
}
