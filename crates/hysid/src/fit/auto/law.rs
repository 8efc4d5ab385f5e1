//! A law that is the model by itself: one of few numbers whose errors are about the lowest of all candidates, on the
//! data and on the folds. Whatever the data do not show, it predicts better than a combination of networks: its numbers
//! cannot follow the data by chance.

use super::Chosen;
use crate::error::Result;
use crate::fit::auto::candidates::Kind;
use crate::fit::auto::trial::Trial;
use crate::fit::network::Fitted;
use crate::model::selection::SingleModel;

/// Most numbers of such a law. Designed.
const FEW_NUMBERS: usize = 40;

/// Largest product of its two errors, on the data and on the folds, each relative to the lowest of all candidates.
/// Designed.
const ABOUT_THE_LOWEST: f64 = 1.4;

impl Chosen<'_, '_, '_> {
    /// The place of the best such law; `None` if there is none, if the user decided, or for one loop, on which laws that
    /// differ elsewhere are alike.
    pub(super) fn place_of_law(&self) -> Option<usize> {
        if self.options.only.is_some() || self.evidence.is_one_loop() {
            return None;
        }
        let complete = |(_, trial): &(usize, &Trial)| trial.is_complete();
        let score = |trial: &Trial| trial.score(self.bench.folds, self.evidence, |_| true).mean_percent();
        let judged: Vec<(usize, &Trial, f64)> = (self.trials.iter().enumerate().filter(complete))
            .map(|(place, trial)| (place, trial, score(trial)))
            .collect();
        let lowest = |error: &dyn Fn(&(usize, &Trial, f64)) -> f64| {
            judged.iter().map(error).fold(f64::INFINITY, f64::min)
        };
        let training = lowest(&|(_, trial, _)| trial.training_error());
        let held_out = lowest(&|(_, _, score)| *score);
        let is_such_a_law = |(_, trial, score): &&(usize, &Trial, f64)| {
            let numbers = trial.members.values().map(|model| model.parameters()).max();
            trial.candidate.kind == Kind::Classical
                && numbers.is_some_and(|numbers| numbers <= FEW_NUMBERS)
                && trial.training_error() * score <= ABOUT_THE_LOWEST * training * held_out
        };
        let best = judged.iter().filter(is_such_a_law).min_by(|a, b| a.2.total_cmp(&b.2));
        best.map(|(place, ..)| *place)
    }

    /// The law at a place as the model; `None` if there was no time to validate it.
    pub(super) fn of_law(&mut self, place: usize) -> Result<Option<Fitted>> {
        let law = self.trials.remove(place);
        self.left_out.append(&mut self.trials);
        self.trials.push(law);
        let Some(combination) = self.combination(|_| true) else { return Ok(None) };
        let Some(law) = self.trials.first() else { return Ok(None) };
        let (name, predicted) = (law.candidate.name(), law.predicted.clone());
        let Some(model) = law.members.values().next().cloned() else { return Ok(None) };
        let mut selection = self.selection(&combination, &predicted);
        selection.single = Some(SingleModel {
            name,
            distilled: false,
            distilled_percent: None,
            plain_percent: selection.held_out_percent,
            is_law: true,
        });
        Ok(Some(self.validated(model, selection, &predicted)?))
    }
}
