//! Candidates tried on folds: what each start of each candidate foretold of what it had not seen.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::automatic::candidates::Candidate;
use crate::error::Result;
use crate::identification::identify;
use crate::model::{Excursion, Model};
use crate::record::Dataset;
use crate::training::{Observer, Progress};
use crate::validation::Fold;

/// A fold with what its rows are judged by.
pub(super) struct Judge<'f> {
    pub fold: &'f Fold,
    /// Measured output of each judged row.
    pub measured: Vec<f64>,
    /// How far outside the fold's training range the record has been there, 0 to 1.
    pub outside: Vec<f64>,
    /// Standard deviation of the measured output, in its unit.
    pub deviation: f64,
}

impl<'f> Judge<'f> {
    pub fn of(fold: &'f Fold) -> Self {
        let range = fold.train.input_range(0);
        let (mut measured, mut outside) = (Vec::new(), Vec::new());
        for record in fold.held_out.records() {
            let mut excursion = Excursion::beyond(range);
            for (&x, &y) in record.inputs()[0].iter().zip(record.output()) {
                let degree = excursion.take(x);
                if !y.is_nan() {
                    measured.push(y);
                    outside.push(degree);
                }
            }
        }
        let count = measured.len() as f64;
        let mean = measured.iter().sum::<f64>() / count;
        let variance = measured.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / count;
        Self { fold, measured, outside, deviation: variance.sqrt().max(f64::MIN_POSITIVE) }
    }

    /// What a model foretells of the judged rows.
    fn hear(&self, model: &Model) -> Result<Vec<f64>> {
        let mut foretold = Vec::with_capacity(self.measured.len());
        for record in self.fold.held_out.records() {
            let output = model.simulate(record)?;
            let rows = output.into_iter().zip(record.output());
            foretold.extend(rows.filter(|(_, y)| !y.is_nan()).map(|(simulated, _)| simulated));
        }
        Ok(foretold)
    }
}

/// What the starts of a candidate foretold, fold by fold.
pub(super) struct Trial {
    pub folds: Vec<Vec<Vec<f64>>>,
}

/// The observer, shared by fits that run side by side, and the share of the whole work that is done.
pub(super) struct Watch<'o, 'a> {
    observer: Mutex<&'o mut Observer<'a>>,
    stopped: AtomicBool,
    /// Work done and work in all, in units of one fit.
    work: Mutex<(f64, f64)>,
}

impl<'o, 'a> Watch<'o, 'a> {
    pub fn new(observer: &'o mut Observer<'a>, work: usize) -> Self {
        Self {
            observer: Mutex::new(observer),
            stopped: AtomicBool::new(false),
            work: Mutex::new((0.0, work.max(1) as f64)),
        }
    }

    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Hears of a fit on its way.
    fn hear(&self, progress: &Progress) -> ControlFlow<()> {
        let (done, all) = *self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.tell(&progress.of_part((done / all).min(1.0)))
    }

    fn tell(&self, progress: &Progress) -> ControlFlow<()> {
        let mut observer = self.observer.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        // Asked once more by a fit that has not heard yet, the observer must not change its mind.
        if self.is_stopped() || observer(progress).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// A fit is done.
    fn advance(&self) {
        self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).0 += 1.0;
    }

    /// A fit that is needed whatever happens: stopped, it gives the best so far.
    pub fn first_fit(&self, candidate: &Candidate, data: &Dataset) -> Result<Model> {
        let fitted = identify(data, &candidate.request(0), &mut |progress| self.hear(progress))?;
        self.advance();
        Ok(fitted.model)
    }

    /// Fits done.
    pub fn fits(&self) -> usize {
        self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).0 as usize
    }

    /// A fit of its own; `None` if there was no time for it.
    pub fn fit(&self, candidate: &Candidate, data: &Dataset, start: usize) -> Result<Option<Model>> {
        if self.is_stopped() {
            return Ok(None);
        }
        let fitted = identify(data, &candidate.request(start), &mut |progress| self.hear(progress))?;
        self.advance();
        Ok(Some(fitted.model))
    }
}

/// Tries candidates on all folds with so many starts each (one, where a candidate has no chance in it). A
/// candidate that cannot be fitted, or was not finished in time, has no trial.
pub(super) fn try_all(
    candidates: &[Candidate],
    judges: &[Judge],
    starts: usize,
    watch: &Watch,
) -> Vec<Option<Trial>> {
    let jobs: Vec<(usize, usize, usize)> = candidates
        .iter()
        .enumerate()
        .flat_map(|(index, candidate)| {
            let starts = if candidate.is_random() { starts } else { 1 };
            (0..judges.len()).flat_map(move |fold| (0..starts).map(move |start| (index, fold, start)))
        })
        .collect();
    let run = |&(candidate, fold, start): &(usize, usize, usize)| -> Option<Vec<f64>> {
        let judge: &Judge = &judges[fold];
        // A candidate that fails on a fold is no candidate; why, its name alone would tell the user.
        let model = watch.fit(&candidates[candidate], &judge.fold.train, start).ok().flatten()?;
        let foretold = judge.hear(&model).ok()?;
        (!watch.is_stopped() && foretold.iter().all(|y| y.is_finite())).then_some(foretold)
    };
    let foretold: Vec<Option<Vec<f64>>> = jobs.par_iter().map(run).collect();
    let mut trials: Vec<Option<Trial>> =
        candidates.iter().map(|_| Some(Trial { folds: vec![Vec::new(); judges.len()] })).collect();
    for (&(candidate, fold, _), foretold) in jobs.iter().zip(foretold) {
        match (foretold, &mut trials[candidate]) {
            (Some(foretold), Some(trial)) => trial.folds[fold].push(foretold),
            (None, trial) => *trial = None,
            (Some(_), None) => {}
        }
    }
    trials
}
