//! A mass on the command line.

use std::str::FromStr;

use hysid::data::unit;

use crate::quantities::number_and_unit;

/// Units of mass that name other things in the columns of a table, and their factors to kg.
const FURTHER_UNITS: [(&str, f64); 3] = [("t", 1e3), ("lb", 0.453_592_37), ("lbs", 0.453_592_37)];

/// A mass, as a number and a unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Mass {
    /// The number as it was typed.
    pub number: f64,
    /// The unit; `None` if none was typed.
    pub unit: Option<String>,
    /// The factor from this unit to kg; 1 without a unit.
    pub factor: f64,
}

impl FromStr for Mass {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (number, unit) =
            number_and_unit(text).ok_or("a number is needed, such as 2, or with a unit, such as \"2 t\"")?;
        if !(number > 0.0 && number.is_finite()) {
            return Err("a mass above 0 is needed".into());
        }
        if unit.is_empty() {
            return Ok(Self { number, unit: None, factor: 1.0 });
        }
        let further = FURTHER_UNITS.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor);
        let factor = further.or_else(|| unit::factor(unit, "kg"));
        let factor = factor.ok_or("the unit of the mass is unknown: use kg, g, t or lb")?;
        Ok(Self { number, unit: Some(unit.into()), factor })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_have_units() {
        for (text, kilograms) in [
            ("2", 2.0),
            ("2 t", 2000.0),
            ("2e3 kg", 2000.0),
            ("250g", 0.25),
            ("10 lb", 4.5359237),
            ("1.5 kN s2/m", 1500.0),
        ] {
            let mass: Mass = text.parse().unwrap();
            assert!((mass.number * mass.factor / kilograms - 1.0).abs() < 1e-12, "{text}: {mass:?}");
        }
        for (text, expected) in [
            ("", "a number is needed"),
            ("heavy", "a number is needed"),
            ("0", "above 0"),
            ("-3 kg", "above 0"),
            ("inf", "a number is needed"),
            ("1e999", "above 0"),
            ("2 mm", "the unit of the mass is unknown"),
            ("2 stone", "the unit of the mass is unknown"),
        ] {
            let error = text.parse::<Mass>().unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
