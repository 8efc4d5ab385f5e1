//! Errors of a free run against measured data, row by row.

use std::ops::ControlFlow;

use hysid::data::metrics::{ErrorSums, Errors};
use hysid::diagnosis::residuals::Residuals;
use hysid::error::{Channel, DataError, DataProblem};
use hysid::model::{BandLevel, Model};
use hysid_core::significant::Significant;
use hysid_document::{Result, object};
use hysid_records::{Roles, UnitFactors, explained, summarised};
use hysid_tables::Rows;

use crate::errors_table::{AFTER_WARM_UP, errors_table};
use crate::fading_errors::{FadingErrors, first_of};
use crate::gathered::Gatherer;
use crate::table_run::{self, KeptColumns, Simulated};
use crate::{BandCoverage, residual_tests, residual_words};

pub struct EvaluateRequest<'a> {
    pub model: &'a Model,
    pub roles: &'a Roles,
    pub factors: &'a UnitFactors,
    pub band: Option<BandLevel>,
    /// Over how many rows at the beginning of each record input and output are to be zero in the mean.
    pub zero: Option<usize>,
    /// True to test the residual; its rows are kept in memory.
    pub residuals: bool,
}

pub struct Evaluation {
    errors: Errors,
    /// Rows of the warm-up, and errors without them, for a model that has one.
    warm_up: usize,
    after_warm_up: Option<Errors>,
    band: Option<BandCoverage>,
    residuals: Option<Residuals>,
    pub warnings: Vec<String>,
}

/// Runs a model over a table and compares its outputs with the measured ones.
///
/// # Errors
/// Cells that are no numbers where the model needs them; a table without a measured output.
pub fn evaluate(request: &EvaluateRequest<'_>, rows: &mut Rows) -> Result<Evaluation> {
    let EvaluateRequest { model, roles, factors, band, zero, residuals } = *request;
    let warm_up = model.warm_up();
    let (mut sums, mut sums_behind, mut covered) = (ErrorSums::default(), ErrorSums::default(), (0, 0));
    let mut gatherer = residuals.then(Gatherer::default);
    let (mut fading, mut faded) = (FadingErrors::default(), Vec::new());
    let mut take = |simulated: &Simulated<'_>| -> Result<_> {
        let (prediction, measured) = (simulated.prediction, simulated.measured);
        sums.add_rows(measured, &prediction.output);
        let skipped = warm_up.saturating_sub(simulated.before).min(measured.len());
        sums_behind.add_rows(&measured[skipped..], &prediction.output[skipped..]);
        let (inside, scored) = prediction.covered(measured);
        covered = (covered.0 + inside, covered.1 + scored);
        if let Some(gatherer) = &mut gatherer {
            gatherer.take(simulated);
        }
        fading.add(measured, &prediction.output);
        if simulated.ends_record {
            let fade = std::mem::take(&mut fading).fade(model);
            faded.extend(fade.map(|fade| fade.words(simulated.record, &model.names().output)));
            sums.end_record();
            sums_behind.end_record();
        }
        Ok(ControlFlow::Continue(()))
    };
    let wanted = KeptColumns { measured: true, drive: residuals, cells: false, band, zero };
    let end = table_run::run(model, rows, roles, factors, wanted, &mut take)?;
    // Errors of converted outputs are in the model's unit, which its name tells.
    let output = if factors.output.is_some() { &model.names().output } else { &roles.output };
    let Some(errors) = sums.errors(output) else {
        let problem = match model.known_beginning().is_none() {
            true => DataProblem::NothingToScore,
            false => DataProblem::NothingAfterBeginning,
        };
        let defect = DataError { record: String::new(), row: None, channel: Some(Channel::Output), problem };
        return Err(explained(&rows.head.file, None, defect.into(), roles));
    };
    let unlike = model.provenance().validation.as_ref().and_then(|expected| unlike(&errors, expected));
    let residuals =
        gatherer.map(|gatherer| residual_tests::tests(gatherer, model, output, &end.warnings)).transpose();
    Ok(Evaluation {
        errors,
        warm_up,
        after_warm_up: (warm_up > 0).then(|| sums_behind.errors(output)).flatten(),
        band: band.map(|level| BandCoverage::of(covered, level)),
        residuals: residuals.map_err(|error| explained(&rows.head.file, None, error, roles))?,
        warnings: end
            .note
            .into_iter()
            .chain(summarised(&end.warnings))
            .chain(unlike)
            .chain(first_of(faded.into_iter()))
            .collect(),
    })
}

/// How much larger the error may be than that of the validation before it is told. Designed.
const UNLIKE: f64 = 3.0;

/// Errors far above those of the validation, in words.
fn unlike(errors: &Errors, expected: &Errors) -> Option<String> {
    let percent =
        |errors: &Errors| errors.nrmse_std_percent.map(|percent| format!("{:.3} %", Significant(percent)));
    let (found, expected_percent) = (percent(errors)?, percent(expected)?);
    (errors.rmse > UNLIKE * expected.rmse).then(|| {
        format!(
            "the error, {found} of the standard deviation, is far above that of the validation ({expected_percent}): these data are \
             not like the training data, or are of another specimen"
        )
    })
}

impl Evaluation {
    pub fn json(&self) -> Result<String> {
        Ok(hysid_document::json(&object! {
            #[serde(flatten)]
            errors: &self.errors,
            /// Errors without the rows of a warm-up, for a model that has one.
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            after_warm_up: &self.after_warm_up,
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            band: &self.band,
            /// Tests of the residual, if requested.
            #[serde(skip_serializing_if = "hysid_document::is_nothing")]
            residuals: &self.residuals,
        })?)
    }

    pub fn text(&self) -> String {
        let mut sets = vec![("free run", &self.errors)];
        sets.extend(self.after_warm_up.as_ref().map(|errors| (AFTER_WARM_UP, errors)));
        let mut text = errors_table(&sets);
        if self.after_warm_up.is_some() {
            text += &format!("({AFTER_WARM_UP}: without the first {} rows of each record)\n", self.warm_up);
        }
        text += &self.band.as_ref().map_or_else(String::new, |band| format!("\n{}\n", band.words()));
        let residuals = self.residuals.as_ref().map(|found| format!("\n{}", residual_words::text(found)));
        text + &residuals.unwrap_or_default()
    }
}
