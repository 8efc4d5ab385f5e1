//! The columns of a table for a model that was trained on other units: factors, or why there are none.

use hysid_core::data::record::ColumnNames;
use hysid_core::data::unit::{self, Conversion};
use hysid_core::model::Model;
use hysid_core::significant::Significant;
use hysid_core::words::{Hint, Words};
use hysid_tables::{Problem, Result};

use crate::columns::Roles;
use hysid_document::visible::clipped;

/// Factors that convert each column to the model's units; `None` leaves it as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitFactors {
    pub time: Option<f64>,
    pub inputs: Vec<Option<f64>>,
    pub rate: Option<f64>,
    pub output: Option<f64>,
    /// Columns that were taken by their units, and conversions, in words.
    pub conversions: Vec<String>,
}

impl UnitFactors {
    /// From the units in the names of the table's columns to those of the columns that the model was trained
    /// on. `is_scored` if the output is read.
    ///
    /// # Errors
    /// Units that differ without a factor between them, unless the user declares them the same.
    pub fn of(model: &Model, roles: &Roles, file: &str, is_scored: bool, are_the_same: bool) -> Result<Self> {
        let mut factors =
            Self::between(roles, (model.names(), "the model's"), file, is_scored, are_the_same)?;
        factors.conversions.splice(..0, roles.taken.iter().cloned());
        Ok(factors)
    }

    /// The same for the columns of other data, which the words `whose` name.
    pub fn between(
        roles: &Roles,
        (trained, whose): (&ColumnNames, &str),
        file: &str,
        is_scored: bool,
        are_the_same: bool,
    ) -> Result<Self> {
        if are_the_same {
            let inputs = vec![None; roles.inputs.len()];
            return Ok(Self { time: None, inputs, rate: None, output: None, conversions: Vec::new() });
        }
        let mut conversions = Vec::new();
        let mut column = |found: &str, trained: &str| -> Result<Option<f64>> {
            let Some(factor) = factor(file, found, trained, whose)? else {
                conversions.extend(no_conversion(found, trained, whose));
                return Ok(None);
            };
            conversions.push(conversion(found, trained, whose, factor));
            Ok(Some(factor))
        };
        let mut both = |found: &Option<String>, trained: &Option<String>| match (found, trained) {
            (Some(found), Some(trained)) => column(found, trained),
            _ => Ok(None),
        };
        // The inverse has all inputs but the first.
        let inputs = {
            let missing = trained.inputs.len() - roles.inputs.len();
            roles.inputs.iter().zip(&trained.inputs[missing..])
        };
        let time = both(&roles.time, &trained.time)?;
        let rate = both(&roles.rate, &trained.rate)?;
        let inputs = inputs.map(|(found, trained)| column(found, trained)).collect::<Result<_>>()?;
        let output = if is_scored { column(&roles.output, &trained.output)? } else { None };
        Ok(Self { time, inputs, rate, output, conversions })
    }

    /// The names of the columns after the conversion: those of the model where a column is converted.
    pub fn names(&self, model: &Model, roles: &Roles) -> ColumnNames {
        let trained = model.names();
        let name = |factor: Option<f64>, trained: &String, found: &String| {
            if factor.is_some() { trained.clone() } else { found.clone() }
        };
        let either = |factor: Option<f64>, trained: &Option<String>, found: &Option<String>| {
            found.as_ref().map(|found| name(factor, trained.as_ref().unwrap_or(found), found))
        };
        let inputs = self.inputs.iter().zip(&trained.inputs).zip(&roles.inputs);
        ColumnNames {
            time: either(self.time, &trained.time, &roles.time),
            inputs: inputs.map(|((factor, trained), found)| name(*factor, trained, found)).collect(),
            rate: either(self.rate, &trained.rate, &roles.rate),
            output: name(self.output, &trained.output, &roles.output),
        }
    }
}

/// Conversion factor; `None` for equal units.
fn factor(file: &str, found: &str, trained: &str, whose: &str) -> Result<Option<f64>> {
    match Conversion::between(found, trained) {
        Conversion::Same => Ok(None),
        Conversion::Factor(factor) => Ok(Some(factor)),
        Conversion::Impossible => {
            let (here, there) = (unit_of(found), unit_of(trained));
            let (found, trained) = (clipped(found), clipped(trained));
            let words = Words::from(format!(
                "column \"{found}\" is in {}, {whose} \"{trained}\" in {}: no conversion between them is known",
                clipped(&here),
                clipped(&there),
            ));
            let advice = "name another column, convert the numbers, or use them unchanged with ";
            Err(Problem::in_file(file, words.advised(Words::from(advice) + Hint::Option("same_units"))))
        }
    }
}

fn conversion(found: &str, trained: &str, whose: &str, factor: f64) -> String {
    let (here, there) = (unit_of(found), unit_of(trained));
    format!(
        "converted: {} from {} to {}, the unit of {whose} {} (factor {:.6})",
        clipped(found),
        clipped(&here),
        clipped(&there),
        clipped(trained),
        Significant(factor),
    )
}

/// Message on a column without a known unit, if that of the model has one.
fn no_conversion(found: &str, trained: &str, whose: &str) -> Option<String> {
    let unit = unit::of_column(trained).filter(|_| unit::of_column(found).is_none())?;
    Some(format!(
        "not converted: {}, whose name tells no known unit, is taken to be in {}, the unit of {whose} {}",
        clipped(found),
        clipped(&unit),
        clipped(trained)
    ))
}

fn unit_of(name: &str) -> String {
    unit::of_column(name).unwrap_or_default()
}
