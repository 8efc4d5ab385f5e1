//! Candidates that make the ensemble worse than one of them, and are left out of it.
//!
//! An ensemble is given only if its held-out error is at most 1/[`CLEARLY_BETTER`] times that of the best candidate, and its
//! training error at most [`FITS`] times that of the candidate that fits best, unless the ensemble predicts held-out
//! rows better than that candidate. Otherwise the candidates that are worse are dropped, in two steps.
//!
//! Where even the best candidate misses held-out rows by half of their standard deviation, the folds show nothing: each
//! needs more than the others show. Candidates that do not fit the data are then left out before all else.

use super::{EnsembleSelection, Trial, ValidatedEnsemble, errors_held_out};
use crate::fit::auto::combination::Combination;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::are_by_record;
use hysid_core::elementary::ln;

/// Training error of an ensemble, relative to that of the candidate that fits best. Designed.
const FITS: f64 = 1.3;

/// Slack for data of one loop, in percent of the standard deviation: behaviour inside the loop matters more. Designed.
const SLACK_OF_ONE_LOOP: f64 = 0.5;

/// Held-out error, relative to the ensemble's, at which a candidate is preferred: the lowest of many is low by chance.
/// Designed.
const CLEARLY_BETTER: f64 = 0.9;

/// Lowest score, in percent of the standard deviation, at which the folds show nothing. Designed.
const TELLS_NOTHING: f64 = 50.0;

#[derive(Debug, Clone, Copy)]
pub(super) struct MisfitStep {
    /// Held-out errors of candidates that stay beside the preferred one, relative to its own. Designed.
    about_as_good: f64,
    /// True if a candidate that does not fit well stays where it predicts better than the one that fits best.
    keeps_better_predictors: bool,
}

pub(super) const STEPS: [MisfitStep; 2] = [
    MisfitStep { about_as_good: 1.2, keeps_better_predictors: true },
    MisfitStep { about_as_good: 1.0, keeps_better_predictors: false },
];

#[derive(Debug, Clone, Copy)]
struct Fitness {
    training: f64,
    held_out: f64,
    /// The error by which candidates are weighted.
    score: f64,
}

impl EnsembleSelection<'_, '_, '_> {
    /// Drops candidates that make the ensemble worse than one of them; false if there are none, or the user decided.
    pub(super) fn drops_misfits(&mut self, ensemble: &ValidatedEnsemble, step: MisfitStep) -> bool {
        let all: Vec<Option<Fitness>> = self.trials.iter().map(|trial| self.fitness(trial)).collect();
        let least = |figure: fn(&Fitness) -> f64| {
            all.iter().flatten().copied().min_by(|a, b| figure(a).total_cmp(&figure(b)))
        };
        let best = least(|one| one.training).zip(least(|one| one.held_out));
        let Some(((fits, predicts), ensemble)) = best.zip(self.fitness_of_ensemble(ensemble)) else {
            return false;
        };
        let is_one_loop = self.evidence.is_one_loop();
        let most = FITS * fits.training + if is_one_loop { SLACK_OF_ONE_LOOP } else { 0.0 };
        let is_misfit = ensemble.training > most && ensemble.score >= fits.score;
        // For one loop, held-out rows are not what candidates are chosen by.
        let is_beaten = !is_one_loop
            && predicts.held_out < CLEARLY_BETTER * ensemble.held_out
            && predicts.score < ensemble.score;
        let is_kept = |one: &Fitness| {
            let fits_well = one.training <= most || step.keeps_better_predictors && one.score < fits.score;
            let predicts_well = one.held_out <= step.about_as_good * predicts.held_out;
            (!is_misfit || fits_well) && (!is_beaten || predicts_well)
        };
        let keeps: Vec<bool> = all.iter().map(|one| one.as_ref().is_some_and(is_kept)).collect();
        if self.options.only.is_some() || !is_misfit && !is_beaten || !keeps.contains(&true) {
            return false;
        }
        self.keep(keeps);
        true
    }

    /// Leaves out candidates that do not fit the data, where the folds show nothing.
    pub(super) fn drops_what_does_not_fit(&mut self) {
        if self.options.only.is_some() {
            return;
        }
        let all: Vec<Option<Fitness>> = self.trials.iter().map(|trial| self.fitness(trial)).collect();
        let lowest =
            |figure: fn(&Fitness) -> f64| all.iter().flatten().map(figure).fold(f64::INFINITY, f64::min);
        let most = FITS * lowest(|one| one.training);
        if most.is_finite() && lowest(|one| one.score) >= TELLS_NOTHING {
            self.keep(all.iter().map(|one| one.is_some_and(|one| one.training <= most)).collect());
        }
    }

    /// Keeps the starts of a candidate with free states alone, unless they predict held-out rows clearly worse than together
    /// with all others.
    pub(super) fn prefers_starts_with_free_states(&mut self) {
        let folds = self.bench.folds;
        let error = |trials: &[Trial]| -> Option<f64> {
            let all = Combination::of(trials, folds, self.evidence, |_| true)?;
            Some(all.first(self.options.members)?.score(trials, folds).sum())
        };
        let is_alone = |trial: &Trial| {
            trial.candidate.has_free_states() && trial.starts.len() >= self.options.members.max(2)
        };
        let alone: Vec<Trial> = self.trials.iter().filter(|trial| is_alone(trial)).cloned().collect();
        let worse = error(&alone).zip(error(&self.trials)).map(|(alone, all)| alone - all);
        if self.options.only.is_none() && worse.is_some_and(|worse| worse <= -2.0 * ln(CLEARLY_BETTER)) {
            self.keep(self.trials.iter().map(is_alone).collect());
        }
    }

    fn keep(&mut self, keeps: Vec<bool>) {
        let (kept, left): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.trials).into_iter().zip(keeps).partition(|(_, keep)| *keep);
        self.trials = kept.into_iter().map(|(trial, _)| trial).collect();
        self.left_out.extend(left.into_iter().map(|(trial, _)| trial));
    }

    fn fitness(&self, trial: &Trial) -> Option<Fitness> {
        let folds = self.bench.folds;
        let errors = trial.is_complete().then(|| errors_held_out(&trial.predicted, folds, ""))??;
        let least = trial.least_error(folds);
        let score = Score::of(&trial.predicted, folds, |_| true).at_least(least).mean_percent();
        let held_out = if are_by_record(folds) { score } else { errors.nrmse_std_percent? };
        Some(Fitness { training: 100.0 * least, held_out, score })
    }

    fn fitness_of_ensemble(&self, ensemble: &ValidatedEnsemble) -> Option<Fitness> {
        let provenance = ensemble.model.provenance();
        let score = ensemble.combination.score(&self.trials, self.bench.folds).mean_percent();
        if are_by_record(self.bench.folds) {
            return Some(Fitness { training: 0.0, held_out: score, score });
        }
        Some(Fitness {
            training: provenance.trained_error().nrmse_std_percent?,
            held_out: provenance.validation.as_ref()?.nrmse_std_percent?,
            score,
        })
    }
}
