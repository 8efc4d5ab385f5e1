//! A mass on the command line.

use std::str::FromStr;

use hysid::data::unit;

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
        let text = text.trim();
        let is_of_number = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
        // The number is the longest beginning that is one: `2e3 kg`, and not the `e` of a unit.
        let places = (1..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
        let number =
            |end: usize| text[..end].chars().all(is_of_number).then(|| text[..end].parse::<f64>().ok())?;
        let found = places.into_iter().find_map(|end| Some((number(end)?, text[end..].trim())));
        let (number, unit) = found.ok_or("a number is needed, such as 2, or with a unit, such as \"2 t\"")?;
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
