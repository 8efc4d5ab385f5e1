//! The observer of a fit that consists of many fits, some of them in parallel, and the completed share of the
//! work.

use std::ops::ControlFlow;
use std::sync::Mutex;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::auto::candidates::Candidate;
use crate::fit::one_model::identify;
use crate::fit::progress::{Fitted, Observer, Progress, SharedObserver, Tried};
use crate::model::Model;

pub(super) struct AutoWork<'o, 'a> {
    observer: SharedObserver<'o, 'a>,
    fits: Mutex<FitCount>,
}

#[derive(Debug, Clone, Copy)]
struct FitCount {
    done: usize,
    expected: usize,
    /// The share of the work that was reported last: it never falls.
    told: f64,
}

impl<'o, 'a> AutoWork<'o, 'a> {
    /// Work of about this number of fits.
    pub fn new(observer: &'o mut Observer<'a>, expected: usize) -> Self {
        Self {
            observer: SharedObserver::new(observer, None),
            fits: Mutex::new(FitCount { done: 0, expected: expected.max(1), told: 0.0 }),
        }
    }

    /// True once the observer has stopped the work.
    pub fn is_stopped(&self) -> bool {
        self.observer.is_over()
    }

    /// Asks the observer whether to stop, between fits.
    pub fn is_to_stop(&self) -> bool {
        self.observer.is_to_stop()
    }

    /// Fits done.
    pub fn done(&self) -> usize {
        self.fits().done
    }

    /// Corrects how many fits are still to come.
    pub fn expect(&self, to_come: usize) {
        let mut fits = self.fits();
        fits.expected = fits.done + to_come.max(1);
    }

    /// A fit that is needed in any case; stopped, it gives the best so far.
    pub fn first_fit(&self, candidate: &Candidate, data: &Dataset) -> Result<Model> {
        let fitted = identify(data, &candidate.request(0), &mut |progress| self.observe(progress))?;
        self.fits().done += 1;
        Ok(fitted.model)
    }

    /// A fit of a candidate from one of its starts; `None` if there was no time for it.
    pub fn fit(&self, candidate: &Candidate, data: &Dataset, start: usize) -> Result<Option<Fitted>> {
        if self.is_stopped() {
            return Ok(None);
        }
        let request = candidate.request(start);
        let mut observe = |progress: &Progress| self.observe(progress);
        let fitted = identify(candidate.rows_of(data).as_ref(), &request, &mut observe)?;
        self.fits().done += 1;
        // What was stopped on its way is worse than what it is compared with.
        Ok((!self.is_stopped()).then_some(fitted))
    }

    /// Tells the observer of a fit on its way.
    fn observe(&self, progress: &Progress) -> ControlFlow<()> {
        self.observer.tell(&progress.of_part(self.share()))
    }

    /// Tells the observer what has become known of a candidate. What it says is heard before the next fit.
    pub fn tell(&self, candidate: &Candidate, tried: Tried<'_>) {
        let _ = self.observer.tell(&Progress::of_candidate(candidate.asked().model(), self.share(), tried));
    }

    fn share(&self) -> f64 {
        let mut fits = self.fits();
        fits.told = fits.told.max((fits.done as f64 / fits.expected as f64).min(1.0));
        fits.told
    }

    fn fits(&self) -> std::sync::MutexGuard<'_, FitCount> {
        self.fits.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
