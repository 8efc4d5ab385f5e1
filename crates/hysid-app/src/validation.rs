//! Cross-validation of a model: fits to parts of the data, and errors on the rest.

use std::ops::ControlFlow;
use std::time::Instant;

use hysid::Error;
use hysid::fit::identify;
use hysid::fit::progress::Progress;
use hysid::options::FitSpec;
use hysid::validation::{CrossValidation, CrossValidator};
use hysid_core::termination::Termination;
use hysid_document::{Result, problem};
use hysid_records::Data;
use serde::Serialize;

use crate::check_memory;
use crate::folds_text::{folds_text, percent};

/// A model to cross-validate, and the data for it.
pub struct ValidateRequest<'a> {
    pub data: &'a Data,
    pub spec: &'a FitSpec,
    /// The folds of the data.
    pub folds: CrossValidator<'a>,
    /// Threads of each fit; by default one for each processor.
    pub threads: Option<usize>,
}

/// Follows a cross-validation.
pub trait ValidateObserver: Send {
    /// True to stop: the present fold is discarded unless its fit has ended, and no new fold begins.
    fn is_to_stop(&self) -> bool;

    /// Called before the fit to a fold, counted from 0, of `count` folds.
    fn begin_fold(&mut self, place: usize, count: usize);

    /// Called with the progress of the fit to the present fold; breaks to end that fit.
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()>;

    /// Called with the result of a fold, in a line.
    fn say(&self, line: &str);

    /// Called with the reason why a fold has no result.
    fn warn(&self, line: &str);
}

/// Errors of the folds, and the cost of the fits.
#[derive(Debug, Serialize)]
pub struct ValidateOutcome {
    model: &'static str,
    /// Number of all folds; those not reached before a stop have no errors.
    folds_in_all: usize,
    /// Number of folds whose fit was ended early.
    folds_stopped: usize,
    seconds: f64,
    #[serde(flatten)]
    errors: CrossValidation,
}

/// Fits a model without each fold in turn and evaluates it on that fold, in free run.
///
/// # Errors
/// Data that the model cannot be fitted to, too little memory, or a stop before the first fold had a result.
pub fn validate(
    request: ValidateRequest<'_>,
    observer: &mut dyn ValidateObserver,
) -> Result<ValidateOutcome> {
    let ValidateRequest { data, spec, folds: mut validator, threads } = request;
    let pool = hysid::thread_pool(threads).map_err(|error| problem!("cannot start the threads: {error}"))?;
    check_memory(&data.set, spec, pool.current_num_threads()).map_err(|error| data.explain(error))?;
    let started = Instant::now();
    let (all, mut stopped) = (validator.folds(), 0);
    for place in 0..all {
        observer.begin_fold(place, all);
        let fold = validator.fold(place);
        let mut observe = |progress: &Progress<'_>| observer.observe(progress);
        let fitted = pool.install(|| identify(&fold.train, spec, &mut observe));
        let model = match fitted {
            Ok(fitted) => Some(fitted.model),
            Err(Error::Stopped) => None,
            Err(error) => return Err(data.explain(error)),
        };
        let is_whole =
            model.as_ref().is_some_and(|model| model.provenance().termination != Termination::Stopped);
        if !is_whole && observer.is_to_stop() {
            break;
        }
        let of = format!("fold {} of {all}", place + 1);
        let Some(model) = model else {
            observer.warn(&format!("{of}: stopped by the time limit before a first model"));
            continue;
        };
        stopped += usize::from(!is_whole);
        let errors = validator.judge(&fold, &model).map_err(|error| data.explain(error))?;
        observer.say(&format!("{of}: {} % of std on held-out data", percent(&errors.unseen)));
        if observer.is_to_stop() {
            break;
        }
    }
    let errors = validator.result().ok_or(Error::Stopped)?;
    let (model, seconds) = (spec.model().name(), started.elapsed().as_secs_f64());
    Ok(ValidateOutcome { model, folds_in_all: all, folds_stopped: stopped, seconds, errors })
}

impl ValidateOutcome {
    /// The folds as a table, and the cost.
    pub fn text(&self) -> String {
        format!("{}\n{}: {} in {:.1} s\n", folds_text(&self.errors), self.model, self.count(), self.seconds)
    }

    /// How many of the folds have a result, in words.
    pub fn finished(&self) -> String {
        format!("{} of {} folds are finished", self.errors.folds.len(), self.folds_in_all)
    }

    fn count(&self) -> String {
        let done = match self.errors.folds.len() {
            all if all == self.folds_in_all => format!("{all} folds"),
            some => format!("{some} of {} folds", self.folds_in_all),
        };
        match self.folds_stopped {
            0 => done,
            stopped => format!("{done}, {stopped} of them ended by the time limit,"),
        }
    }
}
