//! `hysid evaluate`: errors of a free run against measured data, row by row.

use std::ops::ControlFlow;

use anyhow::{Context, Result};
use hysid::data::metrics::ErrorSums;
use hysid::error::{Channel, DataError, DataProblem};
use hysid_app::BandCoverage;
use hysid_document::object;
use hysid_records::{Roles, explained};
use hysid_tables::Rows;

use crate::Outcome;
use crate::arguments::Evaluate;
use crate::commands::{check_band, read_model};
use crate::data::factors;
use crate::errors_table::{AFTER_WARM_UP, errors_table};
use crate::gathered::Gatherer;
use crate::messages::{json_results, results, summarised, warning};
use crate::residual_tests;
use crate::table_run::{self, KeptColumns, Simulated};

pub fn run(arguments: &Evaluate) -> Result<Outcome> {
    let model = arguments.beginning.of(read_model(&arguments.model)?)?;
    let mut rows = Rows::open(&arguments.data, &arguments.columns.reading.reading())?;
    let roles = Roles::of_model(&model, &rows.head, &arguments.columns.choice(), true)?;
    let factors = factors(&model, &roles, &rows.head.file, true, arguments.units.same_units)?;
    arguments.band.map_or(Ok(()), |_| check_band(&model, &arguments.model))?;

    let warm_up = model.warm_up();
    let (mut sums, mut sums_behind, mut covered) = (ErrorSums::default(), ErrorSums::default(), (0, 0));
    let mut gatherer = arguments.residuals.then(Gatherer::default);
    let mut take = |simulated: &Simulated<'_>| {
        let (prediction, measured) = (simulated.prediction, simulated.measured);
        sums.add_rows(measured, &prediction.output);
        let skipped = warm_up.saturating_sub(simulated.before).min(measured.len());
        sums_behind.add_rows(&measured[skipped..], &prediction.output[skipped..]);
        let (inside, scored) = prediction.covered(measured);
        covered = (covered.0 + inside, covered.1 + scored);
        if let Some(gatherer) = &mut gatherer {
            gatherer.take(simulated);
        }
        if simulated.ends_record {
            sums.end_record();
            sums_behind.end_record();
        }
        Ok(ControlFlow::Continue(()))
    };
    let wanted = KeptColumns {
        measured: true,
        drive: arguments.residuals,
        cells: false,
        band: arguments.data_sets.level(arguments.band),
        zero: arguments.columns.reading.zero,
    };
    let warnings = table_run::run(&model, &mut rows, &roles, &factors, wanted, &mut take)?;
    // Errors of converted outputs are in the model's unit, which its name tells.
    let output = if factors.output.is_some() { &model.names().output } else { &roles.output };
    let Some(errors) = sums.errors(output) else {
        let (channel, problem) = (Some(Channel::Output), DataProblem::NothingToScore);
        let defect = DataError { record: String::new(), row: None, channel, problem };
        return Err(explained(&rows.head.file, None, defect.into(), &roles).into());
    };
    let warnings = warnings.context("the run was ended early")?;
    summarised(&warnings).iter().for_each(warning);
    let residuals =
        gatherer.map(|gatherer| residual_tests::tests(gatherer, &model, output, &warnings)).transpose();
    let residuals = residuals.map_err(|error| explained(&rows.head.file, None, error, &roles))?;
    let level = arguments.data_sets.level(arguments.band);
    let band = level.map(|level| BandCoverage::of(covered, level));
    let after_warm_up = (warm_up > 0).then(|| sums_behind.errors(output)).flatten();
    match arguments.json {
        true => json_results(&object! {
            #[serde(flatten)]
            errors: errors,
            /// Errors without the rows of a warm-up, for a model that has one.
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            after_warm_up: after_warm_up,
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            band: band,
            /// Tests of the residual, if requested.
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            residuals: residuals,
        })?,
        false => {
            let mut sets = vec![("free run", &errors)];
            sets.extend(after_warm_up.as_ref().map(|errors| (AFTER_WARM_UP, errors)));
            let mut text = errors_table(&sets);
            if after_warm_up.is_some() {
                text += &format!("({AFTER_WARM_UP}: without the first {warm_up} rows of each record)\n");
            }
            text += &band.map_or_else(String::new, |band| format!("\n{}\n", band.words()));
            text +=
                &residuals.map_or_else(String::new, |found| format!("\n{}", residual_tests::text(&found)));
            results(&text)?;
        }
    }
    Ok(Outcome::Done)
}
