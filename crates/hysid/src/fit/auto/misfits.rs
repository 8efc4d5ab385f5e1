//! Candidates that make the ensemble worse than one of them, and are left out of it.
//!
//! An ensemble is given only if its held-out error is at most 1/[`CLEARLY_BETTER`] times that of the best candidate, and its
//! training error at most [`FITS`] times that of the candidate that fits best, unless the ensemble predicts held-out
//! rows better than that candidate. Otherwise the candidates that are worse are dropped, in two steps.

use super::{Chosen, Trial, errors_held_out};
use crate::error::Result;
use crate::fit::auto::combination::Leaf;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::fit_members;
use crate::model::Predictor;

/// Training error of an ensemble, relative to that of the candidate that fits best. Designed.
const FITS: f64 = 1.3;

/// What may be added to it for data of one loop, in percent of the standard deviation: how a candidate behaves inside the
/// loop matters more than small errors on it. Designed.
const SLACK_OF_ONE_LOOP: f64 = 0.5;

/// Held-out error of a candidate, relative to that of the ensemble, at which the candidate is preferred: the lowest of
/// many errors is low by chance. Designed.
const CLEARLY_BETTER: f64 = 0.9;

/// Held-out errors of candidates that stay beside the preferred one, relative to its own, in the first and second step.
const ABOUT_AS_GOOD: [f64; 2] = [1.2, 1.0];

/// Errors of a candidate or an ensemble, in percent of the standard deviation.
#[derive(Debug, Clone, Copy)]
struct Fitness {
    training: f64,
    held_out: f64,
    /// The error by which candidates are weighted.
    score: f64,
}

impl Chosen<'_, '_, '_> {
    /// Drops candidates until the ensemble of the others is no misfit.
    ///
    /// # Errors
    /// As a free run over the data.
    pub(super) fn drop_misfits(&mut self) -> Result<()> {
        if self.options.only.is_some() {
            return Ok(());
        }
        for (step, about_as_good) in ABOUT_AS_GOOD.into_iter().enumerate() {
            let Some(ensemble) = self.fitness_of_ensemble()? else { return Ok(()) };
            let all: Vec<Option<Fitness>> = self.trials.iter().map(|trial| self.fitness(trial)).collect();
            let least = |figure: fn(&Fitness) -> f64| {
                all.iter().flatten().copied().min_by(|a, b| figure(a).total_cmp(&figure(b)))
            };
            let Some((fits, predicts)) = least(|one| one.training).zip(least(|one| one.held_out)) else {
                return Ok(());
            };
            let most =
                FITS * fits.training + if self.evidence.is_one_loop() { SLACK_OF_ONE_LOOP } else { 0.0 };
            let is_misfit = ensemble.training > most && ensemble.score >= fits.score;
            // For one loop, held-out rows are not what candidates are chosen by.
            let is_beaten = !self.evidence.is_one_loop()
                && predicts.held_out < CLEARLY_BETTER * ensemble.held_out
                && predicts.score < ensemble.score;
            let is_kept = |one: &Fitness| {
                let fits_well = one.training <= most || step == 0 && one.score < fits.score;
                let predicts_well = one.held_out <= about_as_good * predicts.held_out;
                (!is_misfit || fits_well) && (!is_beaten || predicts_well)
            };
            let keeps: Vec<bool> = all.iter().map(|one| one.as_ref().is_some_and(is_kept)).collect();
            if !is_misfit && !is_beaten || !keeps.contains(&true) {
                return Ok(());
            }
            let (kept, left): (Vec<_>, Vec<_>) =
                std::mem::take(&mut self.trials).into_iter().zip(keeps).partition(|(_, keep)| *keep);
            self.trials = kept.into_iter().map(|(trial, _)| trial).collect();
            self.left_out.extend(left.into_iter().map(|(trial, _)| trial));
        }
        Ok(())
    }

    fn fitness(&self, trial: &Trial) -> Option<Fitness> {
        let folds = self.bench.folds;
        let errors = trial.is_complete().then(|| errors_held_out(&trial.predicted, folds, ""))??;
        let of_members =
            trial.members.values().filter_map(|m| m.provenance().trained_error().nrmse_std_percent);
        Some(Fitness {
            training: of_members.min_by(f64::total_cmp)?,
            held_out: errors.nrmse_std_percent?,
            score: Score::of(&trial.predicted, folds, |_| true).mean_percent(),
        })
    }

    /// Fits the members of the ensemble of all candidates, and judges it; `None` if there is none.
    fn fitness_of_ensemble(&mut self) -> Result<Option<Fitness>> {
        let Some(all) = self.combination(|_| true) else { return Ok(None) };
        let wanted: Vec<(usize, usize)> = all.leaves().iter().map(|leaf| (leaf.place, leaf.start)).collect();
        fit_members(&mut self.trials, &wanted, self.bench.data, self.bench.work);
        let is_fitted = |leaf: Leaf| self.trials[leaf.place].members.contains_key(&leaf.start);
        let Some(combination) = all.only(is_fitted) else { return Ok(None) };
        let members = |place: usize, start: usize| self.trials[place].members.get(&start).cloned();
        let body = Predictor::Ensemble(combination.ensemble(members, self.data.input_range(0))?);
        let model = super::ensemble(body, self.bench.data, self.options, None, None, self.bench.work)?;
        let predicted = self.predicted(&self.rows_held_out(&combination));
        let held_out = self.errors_held_out(&predicted).and_then(|errors| errors.nrmse_std_percent);
        let training = model.provenance().trained_error().nrmse_std_percent;
        let score = combination.score(&self.trials, self.bench.folds).mean_percent();
        Ok(held_out.zip(training).map(|(held_out, training)| Fitness { training, held_out, score }))
    }
}
