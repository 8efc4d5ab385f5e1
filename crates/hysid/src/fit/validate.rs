//! Cross-validation of a model that is identified on every fold.

use crate::data::record::Dataset;
use crate::error::{Error, Result};
use crate::fit::identify;
use crate::fit::progress::{Observer, Progress};
use crate::options::FitSpec;
use crate::validation::{CrossValidation, CrossValidator};

/// Cross-validates a model: identifies it on each fold and evaluates it on the held-out data. The observer is
/// as in [`identify`]; `done` is the share of all folds. If it stops, the present fold is evaluated with its
/// best model so far, and no further fold begins.
///
/// # Errors
/// Too few data for two folds, and as [`identify`].
pub fn cross_validate(
    data: &Dataset,
    request: &FitSpec,
    most_folds: usize,
    observer: &mut Observer<'_>,
) -> Result<CrossValidation> {
    let mut validator =
        CrossValidator::new(data, most_folds)?.with_known_beginning(request.judged_beginning(data.names())?);
    let count = validator.folds();
    for place in 0..count {
        let fold = validator.fold(place);
        let mut stopped = false;
        let mut of_fold = |progress: &Progress| {
            let share = (place as f64 + progress.done) / count as f64;
            let flow = observer(&progress.of_part(share));
            stopped = flow.is_break();
            flow
        };
        match identify(&fold.train, request, &mut of_fold) {
            Err(Error::Stopped) if place > 0 => break,
            fitted => validator.judge(&fold, &fitted?.model)?,
        };
        if stopped {
            break;
        }
    }
    Ok(validator.result().expect("every fold has rows to judge on"))
}
