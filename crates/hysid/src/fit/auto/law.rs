//! A law that is the model by itself: one of few numbers, or one of many that stands alone. The product of its errors, on
//! the data and on the folds, is about the lowest of all candidates. Whatever the data do not show, it predicts better than a
//! combination of networks: few numbers cannot follow the data by chance, and equations as those of a Preisach plane hold
//! everywhere.

use super::EnsembleSelection;
use crate::error::Result;
use crate::fit::auto::candidates::CandidateKind;
use crate::fit::auto::trial::Trial;
use crate::fit::progress::Fitted;
use crate::model::selection::SingleModel;
use crate::options::FitSpec;

/// Most numbers of such a law. Designed.
const FEW_NUMBERS: usize = 40;

/// Largest product of its two errors, on the data and on the folds, each relative to the lowest of all candidates: of a
/// law of few numbers, and where there is none, of one of many numbers. Designed.
const ABOUT_THE_LOWEST: f64 = 1.4;
const ABOUT_THE_LOWEST_OF_MANY: f64 = 2.0;

/// Largest training error of a law of many numbers, relative to the standard deviation; above it, the law does not
/// represent the data. Designed.
const LEFT_BY_MANY: f64 = 0.05;

/// Least ratio of the error on the folds to the training error at which a law of many numbers is taken: the folds then
/// extrapolate, and cross-validation cannot rank the candidates. Designed.
const ASKS_FOR_MORE: f64 = 5.0;

/// Ratio of scores to the lowest up to which laws count as equal: the law with the fewest numbers is taken. Designed.
const ALIKE: f64 = 1.05;

/// A candidate with its errors on the data and on the folds.
struct ScoredCandidate {
    place: usize,
    is_law: bool,
    stands_alone: bool,
    numbers: usize,
    training: f64,
    score: f64,
}

impl EnsembleSelection<'_, '_, '_> {
    /// The place of the best such law; `None` if there is none, if the user decided, or for one loop, on which laws that
    /// differ elsewhere are alike.
    pub(super) fn place_of_law(&self) -> Option<usize> {
        if self.options.only.is_some() || self.evidence.is_one_loop() {
            return None;
        }
        let judged: Vec<ScoredCandidate> = (self.trials.iter().enumerate())
            .filter(|(_, trial)| trial.is_complete())
            .map(|(place, trial)| self.judged(place, trial))
            .collect();
        let lowest =
            |error: fn(&ScoredCandidate) -> f64| judged.iter().map(error).fold(f64::INFINITY, f64::min);
        let least = lowest(|one| one.training) * lowest(|one| one.score);
        let is_about = |most: f64| move |one: &&ScoredCandidate| one.training * one.score <= most * least;
        let few = judged.iter().filter(|one| one.is_law && one.numbers <= FEW_NUMBERS);
        let mut laws: Vec<&ScoredCandidate> = few.filter(is_about(ABOUT_THE_LOWEST)).collect();
        if laws.is_empty() {
            let asks_for_more = |one: &&ScoredCandidate| 0.01 * one.score >= ASKS_FOR_MORE * one.training;
            let many = judged.iter().filter(|one| one.stands_alone && one.training <= LEFT_BY_MANY);
            laws = many.filter(asks_for_more).filter(is_about(ABOUT_THE_LOWEST_OF_MANY)).collect();
        }
        let best = laws.iter().map(|law| law.score).fold(f64::INFINITY, f64::min);
        let alike = laws.into_iter().filter(|law| law.score <= ALIKE * best);
        alike.min_by(|a, b| a.numbers.cmp(&b.numbers).then(a.score.total_cmp(&b.score))).map(|law| law.place)
    }

    fn judged(&self, place: usize, trial: &Trial) -> ScoredCandidate {
        ScoredCandidate {
            place,
            is_law: trial.candidate.kind == CandidateKind::Classical,
            stands_alone: matches!(trial.candidate.asked(), FitSpec::Classical(options) if options.model.facts().stands_alone),
            numbers: trial.members.values().map(|model| model.parameters()).max().unwrap_or(usize::MAX),
            training: trial.training_error(),
            score: trial.score(self.bench.folds, self.evidence, |_| true).mean_percent(),
        }
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
        let validation = self.errors_held_out(&predicted);
        let mut selection = self.selection(&combination);
        selection.single = Some(SingleModel {
            name,
            distilled: false,
            distilled_percent: None,
            plain_percent: validation.as_ref().and_then(|errors| errors.nrmse_std_percent),
            is_law: true,
        });
        let unseen = combination.unseen_error(&self.trials, self.evidence);
        Ok(Some(self.validated(model, selection, validation, (&predicted, unseen))?))
    }
}
