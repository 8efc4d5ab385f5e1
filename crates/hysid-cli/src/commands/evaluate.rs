//! `hysid evaluate`: errors of a free run against measured data.

use anyhow::Result;

use crate::Outcome;
use crate::arguments::Evaluate;
use crate::columns::Roles;
use crate::commands::read_model;
use crate::data::Data;
use crate::errors_table::errors_table;
use crate::messages::{results, warning};
use crate::table::Table;

/// Runs the command.
pub fn run(arguments: &Evaluate) -> Result<Outcome> {
    let model = read_model(&arguments.model)?;
    let table = Table::read(&arguments.data)?;
    let roles = Roles::of_model(&model, &table, &arguments.columns, true)?;
    let data = Data::new(vec![table], roles, true)?;
    let errors = model.evaluate(&data.set).map_err(|error| data.explain(error))?;
    model.range_warnings(&data.set).map_err(|error| data.explain(error))?.iter().for_each(warning);
    results(&match arguments.json {
        true => serde_json::to_string_pretty(&errors)? + "\n",
        false => errors_table(&[("free run", &errors)]),
    })?;
    Ok(Outcome::Done)
}
