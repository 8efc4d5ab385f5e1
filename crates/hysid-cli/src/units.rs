//! The columns of a table for a model that was trained on other units: factors, or why there are none.

use anyhow::{Result, bail};
use hysid::data::record::ColumnNames;
use hysid::data::unit::{self, Conversion};
use hysid::model::Model;
use hysid::significant::Significant;

use crate::columns::Roles;
use crate::messages::note;
use crate::terminal::clipped;

/// What the numbers of each column are multiplied by to be in the model's units; `None` for as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// Of time stamps.
    pub time: Option<f64>,
    /// Of each input.
    pub inputs: Vec<Option<f64>>,
    /// Of the given rate.
    pub rate: Option<f64>,
    /// Of the output.
    pub output: Option<f64>,
}

impl Factors {
    /// From the units that the names of the table's columns tell to those of the columns that the model was trained
    /// on. `is_scored` if the output is read. Says what is converted.
    ///
    /// # Errors
    /// Units that differ without a factor between them, unless the user says that they are the same.
    pub fn of(model: &Model, roles: &Roles, file: &str, is_scored: bool, are_the_same: bool) -> Result<Self> {
        let trained = model.names();
        if are_the_same {
            return Ok(Self { time: None, inputs: vec![None; roles.inputs.len()], rate: None, output: None });
        }
        let column = |found: &str, trained: &str| factor(file, found, trained);
        let both = |found: &Option<String>, trained: &Option<String>| match (found, trained) {
            (Some(found), Some(trained)) => column(found, trained),
            _ => Ok(None),
        };
        // The inverse has all inputs but the first.
        let inputs = {
            let missing = trained.inputs.len() - roles.inputs.len();
            roles.inputs.iter().zip(&trained.inputs[missing..])
        };
        Ok(Self {
            time: both(&roles.time, &trained.time)?,
            inputs: inputs.map(|(found, trained)| column(found, trained)).collect::<Result<_>>()?,
            rate: both(&roles.rate, &trained.rate)?,
            output: if is_scored { column(&roles.output, &trained.output)? } else { None },
        })
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

fn factor(file: &str, found: &str, trained: &str) -> Result<Option<f64>> {
    let unit = |name: &str| unit::of_column(name).unwrap_or_default();
    let (here, there) = (unit(found), unit(trained));
    let conversion = Conversion::between(found, trained);
    let (found, trained) = (clipped(found), clipped(trained));
    match conversion {
        Conversion::Same => Ok(None),
        Conversion::Factor(factor) => {
            let factor_shown = Significant(factor);
            note(format_args!(
                "converted: {found} from {} to {}, the unit of the model's {trained} (factor \
                 {factor_shown:.6})",
                clipped(&here),
                clipped(&there),
            ));
            Ok(Some(factor))
        }
        Conversion::Impossible => bail!(
            "{file}: column \"{found}\" is in {}, the model's \"{trained}\" in {}: no conversion between \
             them is known (name another column, convert the numbers, or use them unchanged with \
             --same-units)",
            clipped(&here),
            clipped(&there),
        ),
    }
}
