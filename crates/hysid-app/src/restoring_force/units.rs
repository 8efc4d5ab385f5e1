//! Units of a motion: numbers in known units become kg, m, s and N, and the restoring force gets the unit of the applied
//! force. A number without a known unit is taken as it is.

use hysid::data::unit;
use hysid::error::MotionColumn;
use hysid_core::words::{Hint, Words};
use hysid_document::visible::clipped;
use hysid_tables::{Problem, Result};

use super::acceleration::of_acceleration;
use super::columns::{COLUMNS, MotionColumns};
use super::mass::Mass;

/// Factors to SI units, and what the result is in.
#[derive(Debug, Clone)]
pub struct MotionUnits {
    /// Factor and unit of each column; no unit if it has none that is known.
    columns: Vec<(MotionColumn, f64, Option<String>)>,
    /// Factor of the mass to kg.
    pub mass: f64,
    /// N in the unit of the restoring force.
    pub force: f64,
    /// Unit of the restoring force, if it is known.
    pub force_unit: Option<String>,
    /// Columns without a known unit, each with the SI unit that it is taken to be in.
    pub without: Vec<(String, &'static str)>,
    /// True if `--same-units` turns conversions off.
    pub is_same: bool,
}

impl MotionUnits {
    /// The units in the names of columns.
    pub fn of(file: &str, names: &MotionColumns, mass: &Mass, is_same: bool) -> Result<Self> {
        if is_same {
            let force_unit = names.applied_force.as_deref().and_then(unit::of_column);
            let columns =
                COLUMNS.map(|column| (column, 1.0, names.name_of(column).and_then(unit::of_column)));
            let columns = columns.to_vec();
            return Ok(Self { columns, mass: 1.0, force: 1.0, force_unit, without: Vec::new(), is_same });
        }
        let (mut columns, mut without) = (Vec::new(), Vec::new());
        for column in COLUMNS {
            let Some(name) = names.name_of(column) else { continue };
            let (factor, unit) = known(file, column, name)?;
            if unit.is_none() {
                without.push((name.to_string(), quantity(column).0));
            }
            columns.push((column, factor, unit));
        }
        let force = columns.iter().find(|(column, ..)| *column == MotionColumn::AppliedForce);
        let (force, force_unit) = match force {
            Some((_, factor, unit)) => (*factor, unit.clone()),
            None if !without.is_empty() => (1.0, None),
            None if mass.factor == 1e3 => (1e3, Some("kN".to_string())),
            None => (1.0, Some("N".to_string())),
        };
        Ok(Self { columns, mass: mass.factor, force, force_unit, without, is_same })
    }

    /// Factor of a column to SI units; 1 for one that is not there.
    pub fn factor(&self, column: MotionColumn) -> f64 {
        self.columns.iter().find(|(known, ..)| *known == column).map_or(1.0, |(_, factor, _)| *factor)
    }

    fn unit(&self, column: MotionColumn) -> Option<&str> {
        self.columns.iter().find(|(known, ..)| *known == column)?.2.as_deref()
    }

    /// m/s in the unit of the velocity that is written: that of the displacement over that of time.
    pub fn velocity(&self) -> f64 {
        self.factor(MotionColumn::Displacement) / self.factor(MotionColumn::Time)
    }

    /// The unit of the velocity that is written, if it is known.
    pub fn velocity_unit(&self) -> Option<String> {
        let (above, below) = (self.unit(MotionColumn::Displacement)?, self.unit(MotionColumn::Time)?);
        Some(unit::quotient(above, below))
    }

    pub fn known(&self) -> Vec<&str> {
        self.columns.iter().filter_map(|(_, _, unit)| unit.as_deref()).collect()
    }
}

/// The SI unit of a column, and what its unit must be.
fn quantity(column: MotionColumn) -> (&'static str, &'static str) {
    match column {
        MotionColumn::Time => ("s", "a time"),
        MotionColumn::Displacement => ("m", "a length"),
        MotionColumn::Velocity => ("m/s", "a velocity, such as mm/s"),
        MotionColumn::Acceleration | MotionColumn::BaseAcceleration => {
            ("m/s2", "an acceleration, such as m/s2 or g")
        }
        MotionColumn::AppliedForce => ("N", "a force"),
    }
}

/// The factor of a column to SI units and its unit, if it is known.
fn known(file: &str, column: MotionColumn, name: &str) -> Result<(f64, Option<String>)> {
    let Some(found) = unit::of_column(name) else { return Ok((1.0, None)) };
    let (si, wanted) = quantity(column);
    match if si == "m/s2" { of_acceleration(&found) } else { unit::factor(&found, si) } {
        Some(factor) => Ok((factor, Some(found))),
        None if unit::is_unit(&found) => {
            let (name, found) = (clipped(name), clipped(&found));
            let words = Words::from(format!("column \"{name}\" is in {found}, which is not {wanted}"));
            let advice = Words::from("name another column, or convert nothing with ");
            Err(Problem::in_file(file, words.advised(advice + Hint::Option("same_units"))))
        }
        None => Ok((1.0, None)),
    }
}

/// The name of a column with a unit: with an underscore where that reads back, otherwise in brackets.
pub fn named(quantity: &str, unit: Option<&str>) -> String {
    let Some(unit) = unit else { return quantity.into() };
    let plain = format!("{quantity}_{}", unit.replace(['/', ' '], "_"));
    if unit::of_column(&plain).as_deref() == Some(unit) { plain } else { format!("{quantity} [{unit}]") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_with_their_units() {
        for (unit, expected) in
            [("kN", "v_kN"), ("mm/s", "v_mm_s"), ("N", "v_N"), ("in/s", "v [in/s]"), ("кН", "v_кН")]
        {
            assert_eq!(named("v", Some(unit)), expected);
            assert_eq!(unit::of_column(expected).as_deref(), Some(unit));
        }
        assert_eq!(named("v", None), "v");
    }
}
