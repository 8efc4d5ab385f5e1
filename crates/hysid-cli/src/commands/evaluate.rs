//! `hysid evaluate`: errors of a free run against measured data.

use anyhow::Result;
use hysid::metrics::Errors;

use crate::Outcome;
use crate::arguments::Evaluate;
use crate::band_coverage::BandCoverage;
use crate::columns::Roles;
use crate::commands::{check_band, read_model};
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
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;
    let errors = model.evaluate(&data.set).map_err(|error| data.explain(error))?;
    model.range_warnings(&data.set).map_err(|error| data.explain(error))?.iter().for_each(warning);
    let band = arguments.band.map(|probability| BandCoverage::of(&model, &data.set, probability));
    let band = band.transpose().map_err(|error| data.explain(error))?;
    results(&match arguments.json {
        true => serde_json::to_string_pretty(&Printed { errors: &errors, band })? + "\n",
        false => {
            let table = errors_table(&[("free run", &errors)]);
            table + &band.map_or_else(String::new, |band| format!("\n{}\n", band.words()))
        }
    })?;
    Ok(Outcome::Done)
}

/// The object that `--json` prints.
#[derive(serde::Serialize)]
struct Printed<'a> {
    #[serde(flatten)]
    errors: &'a Errors,
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<BandCoverage>,
}
