//! News of a candidate for the observer.

use crate::model::Model;

/// Errors and standing of a candidate of `auto` so far.
///
/// The observer gets it when a candidate has been fitted to further folds, when it is complete and when it is dropped.
/// The model with the lowest error of those tried is a good one to look at until the fit ends.
#[derive(Debug, Clone)]
pub struct Tried<'a> {
    /// Name of the candidate, as in [`CandidateResult`](crate::model::selection::CandidateResult).
    pub name: String,
    /// Error on the rows held out of the folds so far, in percent of the standard deviation, inside and outside the
    /// trained range, as in [`CandidateResult`](crate::model::selection::CandidateResult); `None` before any fold. For a
    /// law that was dropped before, [`train_nrmse_percent`](crate::fit::progress::Progress::train_nrmse_percent) is the error on the
    /// few rows that it was fitted to.
    pub error_percent: Option<(f64, f64)>,
    /// Folds that count in the error.
    pub folds: usize,
    /// Folds in all.
    pub of: usize,
    /// How the candidate stands.
    pub standing: Standing,
    /// The candidate, fitted to all folds together or to one of them; `None` if no fit succeeded.
    pub model: Option<&'a Model>,
}

/// How a candidate stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It has not been fitted to all folds.
    Trying,
    /// Fitted to all folds, so that it can be part of the model; reported again after each further start.
    Complete,
    /// It was given up: its error is far above the best, many of its kind are better, or a fit failed.
    Dropped,
}
