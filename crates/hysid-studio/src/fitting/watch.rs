//! The observer of a fit: keeps its state, passes on the best model so far, stops it when asked to.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use hysid::fit::progress::Progress;
use hysid::fit::progress::{Standing, Tried};
use hysid::model::Model;
use hysid_document::progress::{Remaining, in_words, share_done};

use super::latest::Latest;
use super::{Candidate, FitCourse, state};

/// Least time between two reports to a page.
const BETWEEN: Duration = Duration::from_millis(250);

/// Time between two models that are drawn.
const BETWEEN_MODELS: Duration = Duration::from_secs(1);

/// The largest share of the time that may go into making models to be drawn.
const LARGEST_SHARE: f64 = 0.02;

/// The best model so far, on its way to be drawn.
pub struct SoFar {
    pub name: String,
    pub model: Model,
}

/// The observer of a fit.
pub struct Watch<'c> {
    course: &'c Arc<FitCourse>,
    words: hysid_app::ProgressText,
    began: Instant,
    limit: Option<Duration>,
    told: Instant,
    /// Errors since then, each with its second.
    errors: Vec<(f64, f64)>,
    remaining: Remaining,
    models: &'c Latest<SoFar>,
    model_due: Instant,
    /// Folds that were not held out, and error, of the candidate whose model was passed on.
    passed_on: (usize, f64),
}

impl<'c> Watch<'c> {
    /// Passes the best model so far on to `models`.
    pub fn new(
        course: &'c Arc<FitCourse>,
        models: &'c Latest<SoFar>,
        starts: usize,
        time_limit: Option<f64>,
    ) -> Self {
        let now = Instant::now();
        Self {
            course,
            words: hysid_app::ProgressText::new(starts),
            began: now,
            limit: time_limit.map(Duration::from_secs_f64),
            told: now,
            errors: Vec::new(),
            remaining: Remaining::default(),
            models,
            model_due: now,
            passed_on: (usize::MAX, f64::INFINITY),
        }
    }

    /// Takes a report of the fit's progress; breaks if the fit is to end.
    pub fn observe(&mut self, progress: &Progress) -> ControlFlow<()> {
        self.words.take(progress);
        let lowest = self.errors.last().map_or(f64::INFINITY, |(_, lowest)| *lowest);
        if let Some(error) = self.words.error(progress)
            && error < lowest
        {
            self.errors.push((self.began.elapsed().as_secs_f64(), error));
        }
        if let Some(tried) = &progress.tried {
            self.take_candidate(tried);
        } else if Instant::now() >= self.model_due {
            self.pass_on_model(progress);
        }
        let now = Instant::now();
        if now.duration_since(self.told) >= BETWEEN || progress.tried.is_some() {
            self.told = now;
            self.tell(progress);
        }
        let is_late = self.limit.is_some_and(|limit| self.began.elapsed() >= limit);
        if is_late || self.course.is_to_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Ends with the fit; returns its seconds.
    pub fn finish(mut self) -> f64 {
        let seconds = self.began.elapsed().as_secs_f64();
        self.course.change(|state| {
            state.seconds = seconds;
            self.errors.drain(..).for_each(|(second, error)| state.add_error(second, error));
        });
        seconds
    }

    fn tell(&mut self, progress: &Progress) {
        let seconds = self.began.elapsed().as_secs_f64();
        let most = self.limit.map(|limit| (limit.as_secs_f64() - seconds).max(0.0));
        let done = share_done(progress.done, seconds, self.limit.map(|limit| limit.as_secs_f64()));
        let remaining = self.remaining.after(seconds, done, most);
        let (part, errors) = (self.words.part(progress), std::mem::take(&mut self.errors));
        self.course.change(|state| {
            state.seconds = seconds;
            state.done = done.max(state.done);
            state.remaining_seconds = remaining;
            state.remaining = remaining.map(in_words);
            state.part = part;
            if progress.is_part && progress.train_nrmse_percent.is_finite() {
                state.add_running(seconds, progress.train_nrmse_percent);
            }
            errors.iter().for_each(|(second, error)| state.add_error(*second, *error));
        });
    }

    fn take_candidate(&mut self, tried: &Tried<'_>) {
        // Inside the trained range, by which the report ranks too.
        let error = tried.error_percent.map(|(inside, _)| inside);
        let candidate = Candidate {
            name: tried.name.clone(),
            error_percent: error,
            folds: tried.folds,
            of: tried.of,
            state: match tried.standing {
                Standing::Trying => state::Standing::Trying,
                Standing::Complete => state::Standing::Complete,
                Standing::Dropped => state::Standing::Dropped,
            },
        };
        // Errors on few folds say less than those on all.
        let rank = (tried.of - tried.folds, error.unwrap_or(f64::INFINITY));
        let is_best = rank.0 < self.passed_on.0 || (rank.0 == self.passed_on.0 && rank.1 < self.passed_on.1);
        let is_best = is_best && error.is_some() && tried.standing != Standing::Dropped;
        let seconds = self.began.elapsed().as_secs_f64();
        self.course.change(|state| {
            state.seconds = seconds;
            error.iter().for_each(|error| state.add_tried(seconds, *error));
            // The first error is on few folds; what counts is that of a candidate which was tried on all.
            if candidate.state == state::Standing::Complete {
                error.iter().for_each(|error| state.add_error(seconds, *error));
            }
            state.add_candidate(candidate);
        });
        if is_best && let Some(model) = tried.model {
            self.models.put(SoFar { name: tried.name.clone(), model: model.clone() });
            self.passed_on = rank;
        }
    }

    /// Passes on the model of a fit on its way, if it has one. Making it takes time of the fit.
    fn pass_on_model(&mut self, progress: &Progress) {
        let began = Instant::now();
        let model = progress.model_so_far();
        let spent = began.elapsed();
        self.model_due = Instant::now() + BETWEEN_MODELS.max(spent.div_f64(LARGEST_SHARE));
        if let Some(model) = model {
            self.models.put(SoFar { name: progress.model.name().into(), model });
        }
    }
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        self.models.close();
    }
}
