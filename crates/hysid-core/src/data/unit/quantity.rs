//! Units as multiples of base units, so that numbers can be converted from one to another.

use crate::data::usual_role::{Domain, UsualRole};
use crate::elementary::powi;

/// Exponents of length, mass, time, electric current, temperature difference and angle.
pub(super) type Dimension = [i8; 6];

pub(super) const NONE: Dimension = [0; 6];
pub(super) const LENGTH: Dimension = [1, 0, 0, 0, 0, 0];
const VOLUME: Dimension = [3, 0, 0, 0, 0, 0];
pub(super) const MASS: Dimension = [0, 1, 0, 0, 0, 0];
pub(super) const TIME: Dimension = [0, 0, 1, 0, 0, 0];
pub(super) const CURRENT: Dimension = [0, 0, 0, 1, 0, 0];
const TEMPERATURE: Dimension = [0, 0, 0, 0, 1, 0];
const ANGLE: Dimension = [0, 0, 0, 0, 0, 1];
const FREQUENCY: Dimension = [0, 0, -1, 0, 0, 0];
pub(super) const FORCE: Dimension = [1, 1, -2, 0, 0, 0];
pub(super) const ENERGY: Dimension = [2, 1, -2, 0, 0, 0];
const MOMENT: Dimension = ENERGY;
pub(super) const ENERGY_DENSITY: Dimension = [-1, 1, -2, 0, 0, 0];
pub(super) const PRESSURE: Dimension = ENERGY_DENSITY;
pub(super) const POWER: Dimension = [2, 1, -3, 0, 0, 0];
pub(super) const POWER_DENSITY: Dimension = [-1, 1, -3, 0, 0, 0];
pub(super) const VOLTAGE: Dimension = [2, 1, -3, -1, 0, 0];
const CHARGE: Dimension = [0, 0, 1, 1, 0, 0];
/// Charge of an area.
const POLARIZATION: Dimension = [-2, 0, 1, 1, 0, 0];
const RESISTANCE: Dimension = [2, 1, -3, -2, 0, 0];
const FLUX: Dimension = [2, 1, -2, -1, 0, 0];
pub(super) const FLUX_DENSITY: Dimension = [0, 1, -2, -1, 0, 0];
pub(super) const FIELD: Dimension = [-1, 0, 0, 1, 0, 0];
const MAGNETIC_MOMENT: Dimension = [2, 0, 0, 1, 0, 0];

const ONE: UnitQuantity = UnitQuantity { factor: 1.0, dimension: NONE };

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitQuantity {
    /// Value in SI base units; an angle in radians.
    pub factor: f64,
    /// Dimension of the quantity.
    pub dimension: Dimension,
}

impl UnitQuantity {
    /// The unit of this name, such as `kN`, `A/m`, `V us`, `N/mm2` or `m/s²`; `None` for one that is not known.
    pub fn of(unit: &str) -> Option<Self> {
        let mut parts = unit.split('/').map(product);
        let above = parts.next()?;
        let above = above.or_else(|| unit.starts_with("1/").then_some(ONE))?;
        parts.try_fold(above, |whole, below| Some(whole.times(below?, -1)))
    }

    /// The usual role of a quantity with this unit in hysteresis, if it has one.
    pub fn part(&self) -> Option<UsualRole> {
        use Domain::{Electricity, Magnetism, Mechanics};
        let part = match self.dimension {
            LENGTH | ANGLE => UsualRole::Drives(Mechanics),
            FORCE | MOMENT | PRESSURE => UsualRole::Follows(Mechanics),
            FIELD => UsualRole::Drives(Magnetism),
            FLUX | FLUX_DENSITY => UsualRole::Follows(Magnetism),
            VOLTAGE | CURRENT => UsualRole::Drives(Electricity),
            TEMPERATURE => UsualRole::Accompanies,
            CHARGE | POLARIZATION => UsualRole::Follows(Electricity),
            _ => return None,
        };
        Some(part)
    }

    /// The quantity with angles as numbers: a moment times an angle is an energy.
    pub fn without_angles(mut self) -> Self {
        self.dimension[5] = 0;
        self
    }

    /// The product with a power of another.
    pub fn times(self, other: Self, power: i8) -> Self {
        let mut dimension = self.dimension;
        dimension.iter_mut().zip(other.dimension).for_each(|(own, more)| *own += power * more);
        Self { factor: self.factor * powi(other.factor, power.into()), dimension }
    }
}

fn product(text: &str) -> Option<UnitQuantity> {
    let mut factors = text.split([' ', '*', '·']).filter(|part| !part.is_empty()).map(power).peekable();
    factors.peek()?;
    factors.try_fold(ONE, |whole, factor| Some(whole.times(factor?, 1)))
}

/// A symbol with an exponent or without.
fn power(text: &str) -> Option<UnitQuantity> {
    let exponents = [("²", 2), ("³", 3), ("2", 2), ("3", 3)];
    let split = |(ending, power): (&str, i8)| {
        let base = text.strip_suffix(ending)?;
        Some((base.strip_suffix('^').unwrap_or(base), power))
    };
    let (base, power) = exponents.into_iter().find_map(split).unwrap_or((text, 1));
    symbol(base).map(|unit| ONE.times(unit, power))
}

/// True for a single symbol that may end the name of a column without brackets, as in `force_kN`.
pub(super) fn may_end_a_name(text: &str) -> bool {
    let base = text.strip_suffix(['2', '3']).unwrap_or(text);
    symbol(base).is_some() && !NOT_IN_NAMES.contains(&base)
}

/// Symbols that are words too, and are units only in brackets.
const NOT_IN_NAMES: [&str; 11] = ["in", "ft", "%", "‰", "°", "°C", "\"", "'", "d", "second", "microstrain"];

fn symbol(text: &str) -> Option<UnitQuantity> {
    let found = |(names, factor, dimension): &(&str, f64, Dimension)| {
        let is_named = names.split(' ').any(|name| name == text);
        is_named.then_some(UnitQuantity { factor: *factor, dimension: *dimension })
    };
    SYMBOLS.iter().find_map(found)
}

/// Names, factor to base units and dimension. A name is exact: `MN` is not `mN`.
#[rustfmt::skip]
const SYMBOLS: &[(&str, f64, Dimension)] = &[
    ("s sec Sec secs second seconds с сек 秒", 1.0, TIME), ("ms msec мс 毫秒 ミリ秒", 1e-3, TIME), ("us µs μs usec", 1e-6, TIME), ("ns", 1e-9, TIME),
    ("min minutes", 60.0, TIME), ("h hours hour hr hrs", 3600.0, TIME), ("d days", 86400.0, TIME),
    ("m м 米", 1.0, LENGTH), ("mm мм 毫米", 1e-3, LENGTH), ("cm см 厘米", 1e-2, LENGTH), ("um µm μm мкм 微米", 1e-6, LENGTH), ("nm", 1e-9, LENGTH),
    ("km", 1e3, LENGTH), ("dm", 0.1, LENGTH), ("mil mils", 2.54e-5, LENGTH), ("inch in \"", 0.0254, LENGTH), ("ft '", 0.3048, LENGTH),
    ("g", 1e-3, MASS), ("kg", 1.0, MASS),
    ("N Н 牛", 1.0, FORCE), ("mN", 1e-3, FORCE), ("kN кН 千牛", 1e3, FORCE), ("MN", 1e6, FORCE),
    ("lbf", 4.448_221_615_260_5, FORCE), ("kip kips klbf", 4_448.221_615_260_5, FORCE),
    ("kgf kp", 9.806_65, FORCE), ("tf", 9_806.65, FORCE), ("daN", 10.0, FORCE), ("dyn", 1e-5, FORCE),
    ("Nm", 1.0, MOMENT), ("Nmm", 1e-3, MOMENT), ("kNm", 1e3, MOMENT), ("J", 1.0, ENERGY), ("mJ", 1e-3, ENERGY),
    ("uJ µJ", 1e-6, ENERGY), ("kJ", 1e3, ENERGY), ("MJ", 1e6, ENERGY),
    ("Pa", 1.0, PRESSURE), ("kPa", 1e3, PRESSURE), ("MPa МПа 兆帕", 1e6, PRESSURE), ("GPa", 1e9, PRESSURE),
    ("bar", 1e5, PRESSURE), ("psi", 6_894.757_293_168_361, PRESSURE),
    ("W", 1.0, POWER), ("uW µW", 1e-6, POWER), ("mW", 1e-3, POWER), ("kW", 1e3, POWER), ("MW", 1e6, POWER),
    ("V В 伏", 1.0, VOLTAGE), ("uV µV", 1e-6, VOLTAGE), ("mV", 1e-3, VOLTAGE), ("kV", 1e3, VOLTAGE),
    ("A А 安", 1.0, CURRENT), ("uA µA", 1e-6, CURRENT), ("mA", 1e-3, CURRENT), ("kA", 1e3, CURRENT),
    ("C", 1.0, CHARGE), ("nC", 1e-9, CHARGE), ("uC µC μC", 1e-6, CHARGE), ("mC", 1e-3, CHARGE),
    ("T Тл", 1.0, FLUX_DENSITY), ("uT µT", 1e-6, FLUX_DENSITY), ("mT", 1e-3, FLUX_DENSITY),
    ("G", 1e-4, FLUX_DENSITY), ("kG", 0.1, FLUX_DENSITY),
    ("Wb", 1.0, FLUX), ("mWb", 1e-3, FLUX),
    ("Oe", 1000.0 / (4.0 * std::f64::consts::PI), FIELD), ("kOe", 1e6 / (4.0 * std::f64::consts::PI), FIELD),
    ("emu", 1e-3, MAGNETIC_MOMENT), ("memu", 1e-6, MAGNETIC_MOMENT), ("uemu µemu", 1e-9, MAGNETIC_MOMENT), ("cc", 1e-6, VOLUME),
    ("Hz", 1.0, FREQUENCY), ("kHz", 1e3, FREQUENCY), ("MHz", 1e6, FREQUENCY),
    ("K", 1.0, TEMPERATURE), ("ohm", 1.0, RESISTANCE),
    ("rad", 1.0, ANGLE), ("mrad", 1e-3, ANGLE), ("deg °", std::f64::consts::PI / 180.0, ANGLE),
    ("percent pct %", 1e-2, NONE), ("‰", 1e-3, NONE), ("microstrain µε", 1e-6, NONE),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compound_units_are_multiples_of_base_units() {
        for (unit, factor, dimension) in [
            ("kN", 1e3, FORCE),
            ("A/m", 1.0, FIELD),
            ("V us", 1e-6, FLUX),
            ("N/mm2", 1e6, PRESSURE),
            ("N/mm²", 1e6, PRESSURE),
            ("mm/s^2", 1e-3, [1, 0, -2, 0, 0, 0]),
            ("uC/cm2", 1e-2, [-2, 0, 1, 1, 0, 0]),
            ("kN m", 1e3, MOMENT),
            ("kgf", 9.80665, FORCE),
            ("tf", 9806.65, FORCE),
            ("um/m", 1e-6, NONE),
        ] {
            let found = UnitQuantity::of(unit).unwrap_or_else(|| panic!("{unit}"));
            assert_eq!(found.dimension, dimension, "{unit}");
            approx::assert_relative_eq!(found.factor, factor, max_relative = 1e-12);
        }
        for unit in ["", "/", "ticks", "degC", "mm/", "2"] {
            assert_eq!(UnitQuantity::of(unit), None, "{unit}");
        }
    }
}
