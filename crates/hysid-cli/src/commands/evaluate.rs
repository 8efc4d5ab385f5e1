//! `hysid evaluate`: errors of a free run against measured data, row by row.

use anyhow::Result;
use hysid_app::evaluation::{EvaluateRequest, evaluate};
use hysid_records::Roles;
use hysid_tables::Rows;

use crate::Outcome;
use crate::arguments::Evaluate;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::messages::{raw_results, results, warning};

pub fn run(arguments: &Evaluate) -> Result<Outcome> {
    let model = arguments.known.of(arguments.beginning.of(read_model(&arguments.model)?)?)?;
    let mut rows = Rows::open(&arguments.data, &arguments.columns.reading.reading())?;
    let roles = Roles::of_model(&model, &rows.head, &arguments.columns.choice(), true)?;
    let factors = factors(&model, &roles, &rows.head.file, true, arguments.units.same_units)?;
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;
    let request = EvaluateRequest {
        model: &model,
        roles: &roles,
        factors: &factors,
        band: arguments.data_sets.level(arguments.band),
        zero: arguments.columns.reading.zero,
        residuals: arguments.residuals,
    };
    let evaluation = evaluate(&request, &mut rows)?;
    evaluation.warnings.iter().for_each(warning);
    match arguments.json {
        true => raw_results(&evaluation.json()?)?,
        false => results(&evaluation.text())?,
    }
    Ok(Outcome::Done)
}
