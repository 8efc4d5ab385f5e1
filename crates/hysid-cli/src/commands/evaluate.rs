//! `hysid evaluate`: errors of a free run against measured data, row by row.

use std::path::Path;

use anyhow::Result;
use hysid::Model;
use hysid_app::evaluation::{EvaluateRequest, Evaluation, evaluate};
use hysid_records::Roles;
use hysid_tables::Rows;

use crate::Outcome;
use crate::arguments::Evaluate;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::files::shown;
use crate::messages::{raw_results, results, warning};

pub fn run(arguments: &Evaluate) -> Result<Outcome> {
    let model = arguments.known.of(arguments.beginning.of(read_model(&arguments.model)?)?)?;
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;
    let all = arguments.data.iter().map(|file| of_file(arguments, &model, file));
    let all: Vec<Evaluation> = all.collect::<Result<_>>()?;
    if arguments.json {
        let objects: Vec<String> = all.iter().map(Evaluation::json).collect::<hysid_document::Result<_>>()?;
        raw_results(&match objects.as_slice() {
            [one] => one.clone(),
            several => format!("[{}]", several.join(",")),
        })?;
        return Ok(Outcome::Done);
    }
    let named = |(file, evaluation): (&std::path::PathBuf, &Evaluation)| match all.len() {
        1 => evaluation.text(),
        _ => format!("{}\n{}", shown(file), evaluation.text()),
    };
    results(&arguments.data.iter().zip(&all).map(named).collect::<Vec<_>>().join("\n"))?;
    Ok(Outcome::Done)
}

fn of_file(arguments: &Evaluate, model: &Model, file: &Path) -> Result<Evaluation> {
    let mut rows = Rows::open(file, &arguments.columns.reading.reading())?;
    let roles = Roles::of_model(model, &rows.head, &arguments.columns.choice(), true)?;
    let factors = factors(model, &roles, &rows.head.file, true, arguments.units.same_units)?;
    let request = EvaluateRequest {
        model,
        roles: &roles,
        factors: &factors,
        band: arguments.data_sets.level(arguments.band),
        zero: arguments.columns.reading.zero,
        residuals: arguments.residuals,
    };
    let evaluation = evaluate(&request, &mut rows)?;
    evaluation.warnings.iter().for_each(warning);
    Ok(evaluation)
}
