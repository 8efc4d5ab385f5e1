//! Units of quantities that are made of others: energies, powers and quotients.

use super::quantity::{
    Dimension, ENERGY, ENERGY_DENSITY, FIELD, FLUX_DENSITY, POWER, POWER_DENSITY, UnitQuantity,
};

/// Prefixes and their factors.
const PREFIXES: [(&str, f64); 5] = [("u", 1e-6), ("m", 1e-3), ("", 1.0), ("k", 1e3), ("M", 1e6)];

/// Units with names of their own. A prefix stands before them.
const NAMED: [(&str, Dimension); 4] =
    [("J", ENERGY), ("J/m3", ENERGY_DENSITY), ("W", POWER), ("W/m3", POWER_DENSITY)];

/// The unit of the energy of a loop and the factor from its area, which is in the product of the units of output and input.
/// The factor is 1 for `J` of kN and mm, `J/m3` of T and A/m, and `lbf inch`, where the product is no decimal multiple of a
/// unit of energy. Of a flux density and a field in other units, such as kG and Oe, the energy is in `J/m3`.
pub fn energy(output: &str, input: &str) -> (String, f64) {
    let both = UnitQuantity::of(output).zip(UnitQuantity::of(input));
    let is_magnetic = |(a, b): &(UnitQuantity, UnitQuantity)| {
        [[FLUX_DENSITY, FIELD], [FIELD, FLUX_DENSITY]].contains(&[a.dimension, b.dimension])
    };
    match both.and_then(|(a, b)| name(a.times(b, 1))) {
        Some(unit) => (unit, 1.0),
        None => match both.filter(is_magnetic) {
            Some((a, b)) => ("J/m3".into(), a.factor * b.factor),
            None => (format!("{output} {input}"), 1.0),
        },
    }
}

/// The unit of an energy over time: `W` of J and s, `W/m3` of J/m3 and s.
pub fn power(energy: &str, time: &str) -> String {
    let over = UnitQuantity::of(energy).zip(UnitQuantity::of(time)).map(|(a, b)| a.times(b, -1));
    over.and_then(name).unwrap_or_else(|| quotient(energy, time))
}

/// The unit of a quotient: `kN/mm`, `T/(A/m)`.
pub fn quotient(above: &str, below: &str) -> String {
    if below.contains(['/', ' ']) { format!("{above}/({below})") } else { format!("{above}/{below}") }
}

/// Permeability of vacuum, in V s/(A m).
const VACUUM_PERMEABILITY: f64 = 1.256_637_062e-6;

/// The factor to a pure number of an input over an output, such as a field over a flux density, if it is one.
pub fn pure_quotient(input: &str, output: &str) -> Option<f64> {
    let (above, below) = (UnitQuantity::of(input)?, UnitQuantity::of(output)?);
    let factor = above.factor / below.factor;
    match (above.dimension, below.dimension) {
        (FIELD, FLUX_DENSITY) => Some(factor * VACUUM_PERMEABILITY),
        (a, b) => (a == b).then_some(factor),
    }
}

/// The name of a unit that is a decimal multiple of an energy or a power. Angles count as numbers.
fn name(quantity: UnitQuantity) -> Option<String> {
    let quantity = quantity.without_angles();
    let (unit, _) = NAMED.into_iter().find(|(_, dimension)| *dimension == quantity.dimension)?;
    let is_near = |factor: f64| (quantity.factor / factor - 1.0).abs() < 1e-9;
    let (prefix, _) = PREFIXES.into_iter().find(|(_, factor)| is_near(*factor))?;
    Some(format!("{prefix}{unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_have_the_name_of_their_unit_where_the_number_stays() {
        for (output, input, expected) in [
            ("kN", "mm", "J"),
            ("N", "mm", "mJ"),
            ("kN", "m", "kJ"),
            ("T", "A/m", "J/m3"),
            ("T", "kA/m", "kJ/m3"),
            ("uC/cm2", "kV/cm", "kJ/m3"),
            ("kN m", "rad", "kJ"),
            ("kN m", "mrad", "J"),
            ("mWb", "A", "mJ"),
            ("um", "V", "um V"),
            ("lbf", "inch", "lbf inch"),
            ("MPa", "percent", "MPa percent"),
            ("ticks", "mm", "ticks mm"),
        ] {
            assert_eq!(energy(output, input), (expected.to_string(), 1.0), "{output} {input}");
        }
        // ∮ H dB/(4π) in erg/cm³, a tenth of it in J/m³.
        let per_gauss_oersted = 0.1 / (4.0 * std::f64::consts::PI);
        for (output, input, factor) in
            [("G", "Oe", 1.0), ("kG", "Oe", 1e3), ("Oe", "kG", 1e3), ("G", "kOe", 1e3), ("T", "Oe", 1e4)]
        {
            let (unit, found) = energy(output, input);
            assert_eq!(unit, "J/m3", "{output} {input}");
            approx::assert_relative_eq!(found, factor * per_gauss_oersted, max_relative = 1e-12);
        }
    }

    #[test]
    fn quotients_of_fields_are_pure_numbers() {
        // α = 1.6e-3 of JAmodel's set, M_s = 1.6e6 A/m or 2.0106 T.
        for (input, output, alpha) in [
            ("A/m", "A/m", 1.6e-3),
            ("kA/m", "A/m", 1.6e-6),
            ("A/m", "T", 1.6e-3 / 1.256_637_062e-6),
            ("Oe", "kG", 1.6e-3 / 1e-3),
        ] {
            approx::assert_relative_eq!(
                alpha * pure_quotient(input, output).unwrap(),
                1.6e-3,
                max_relative = 1e-6
            );
        }
        assert_eq!(pure_quotient("mm", "kN"), None);
        assert_eq!(pure_quotient("A", "T"), None);
    }

    #[test]
    fn powers_are_energies_over_time() {
        assert_eq!(power("J", "s"), "W");
        assert_eq!(power("J/m3", "s"), "W/m3");
        assert_eq!(power("J/m3", "ms"), "kW/m3");
        assert_eq!(power("J", "min"), "J/min");
        assert_eq!(power("um V", "s"), "um V/s");
        assert_eq!(quotient("T", "A/m"), "T/(A/m)");
    }
}
