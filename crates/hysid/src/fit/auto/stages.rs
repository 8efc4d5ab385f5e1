//! The order of the work, such that at each stop there is the best model that the time allows. A few
//! candidates at a time are fitted to all folds and to all data, those that are usually good or fast first;
//! further starts and members come last. Candidates with errors far above the best are dropped after their
//! first folds.

use rayon::prelude::*;

use crate::fit::auto::candidates::{Candidate, Kind};
use crate::fit::auto::combination::Combination;
use crate::fit::auto::prior::Evidence;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{Bench, Trial};
use crate::model::Model;
use crate::options::auto::AutoOptions;

/// Candidates that are tried side by side. It does not depend on the number of threads, nor does the result.
const SIDE_BY_SIDE: usize = 4;

/// A candidate is dropped if its first start predicts the first folds with more than so many times the error of
/// the best candidate so far.
const HOPELESS: f64 = 3.0;

/// A law is tried on the folds if its error on what it was fitted to in haste is at most so many times the
/// error of the best candidate so far on what was held out.
const WORTH_A_TRIAL: f64 = 2.0;

/// Networks that are tried with other penalties too.
const REFINED: usize = 2;

/// Rows with an output that a law is fitted to in haste, at most.
const ROWS_IN_HASTE: usize = 600;

/// What is tried and on what.
pub(super) struct Stages<'w, 'o, 'a> {
    pub bench: Bench<'w, 'o, 'a>,
    pub options: &'w AutoOptions,
    pub evidence: Evidence,
    pub trials: Vec<Trial>,
    /// Candidates that were dropped.
    pub dropped: Vec<Candidate>,
}

impl Stages<'_, '_, '_> {
    /// Tries the candidates. `first` is a fit of the first of them to everything.
    pub fn run(&mut self, candidates: Vec<Candidate>, first: Option<Model>) {
        let (laws, others): (Vec<Candidate>, Vec<Candidate>) =
            candidates.into_iter().partition(Candidate::is_searched);
        self.expect(others.len(), laws.len());
        self.first_starts(others, first);
        let refined = self.refined();
        self.first_starts(refined, None);
        let promising = self.screened(laws);
        self.first_starts(promising, None);
        self.further_starts();
    }

    fn expect(&self, others: usize, laws: usize) {
        let folds = self.bench.folds.len();
        let further = others / 3 * self.options.starts.saturating_sub(1) * folds;
        let first = (others + laws / 4) * (folds + 1);
        self.bench.work.expect(first + laws + further + self.options.members);
    }

    /// One start of each, a few candidates at a time: on the first folds, and on the others and everything if
    /// it is not hopeless.
    fn first_starts(&mut self, candidates: Vec<Candidate>, first: Option<Model>) {
        let mut first = first;
        let mut waiting = candidates.into_iter().peekable();
        while waiting.peek().is_some() {
            let begun = self.trials.len();
            self.trials.extend(waiting.by_ref().take(SIDE_BY_SIDE).map(Trial::of));
            if let Some(model) = first.take() {
                self.trials[begun].members.insert(0, model);
            }
            let places: Vec<usize> = (begun..self.trials.len()).collect();
            let (first_folds, other_folds) = self.first_folds();
            // The very first are fitted to everything at once, should that be all there is time for.
            self.bench.try_folds(&mut self.trials, &places, 0, &first_folds, begun == 0);
            let best = self.best(&first_folds);
            let (hopeful, hopeless): (Vec<usize>, Vec<usize>) =
                places.into_iter().partition(|&place| self.is_hopeful(place, &first_folds, best));
            self.bench.try_folds(&mut self.trials, &hopeful, 0, &other_folds, true);
            self.bench.end_start(&mut self.trials, &hopeful);
            self.dropped.extend(hopeless.iter().map(|&place| self.trials[place].candidate.clone()));
            let mut place = 0;
            self.trials.retain(|_| {
                place += 1;
                !hopeless.contains(&(place - 1))
            });
        }
    }

    /// The folds on which a candidate shows whether it is hopeless, and the others. Of a single record the first
    /// is a forecast, the last a block from its middle.
    fn first_folds(&self) -> (Vec<usize>, Vec<usize>) {
        let last = self.bench.folds.len() - 1;
        (0..=last).partition(|&fold| fold == 0 || fold == last && last > 2)
    }

    fn is_hopeful(&self, place: usize, folds: &[usize], best: Option<Score>) -> bool {
        let trial = &self.trials[place];
        let Some(predicted) = trial.predicted_so_far(folds) else { return false };
        best.is_none_or(|best| is_within(self.score(trial, &predicted, folds), best, HOPELESS))
    }

    /// Of what a candidate predicts on some folds, with what is known of it beforehand.
    fn score(&self, trial: &Trial, predicted: &[Vec<f64>], folds: &[usize]) -> Score {
        let score = Score::of(predicted, self.bench.folds, |fold| folds.contains(&fold));
        score.with_prior(trial.prior(self.evidence))
    }

    /// The best networks so far with other penalties, unless the user has decided.
    fn refined(&self) -> Vec<Candidate> {
        let Self { options, .. } = self;
        if options.only.is_some() || options.ridge.is_some() || options.decay.is_some() {
            return Vec::new();
        }
        let is_network = |trial: &&Trial| trial.is_complete() && trial.candidate.kind == Kind::Networks;
        let score = |trial: &&Trial| Score::of(&trial.predicted, self.bench.folds, |_| true).sum();
        let mut networks: Vec<&Trial> = self.trials.iter().filter(is_network).collect();
        networks.sort_by(|a, b| score(a).total_cmp(&score(b)));
        networks.iter().take(REFINED).flat_map(|trial| trial.candidate.with_other_penalties()).collect()
    }

    /// The laws that, fitted in haste, come near the best candidate so far.
    fn screened(&mut self, laws: Vec<Candidate>) -> Vec<Candidate> {
        let all: Vec<usize> = (0..self.bench.folds.len()).collect();
        let Some(best) = self.best(&all) else { return laws };
        let few = self.bench.data.thinned(ROWS_IN_HASTE);
        let error = |law: &Candidate| {
            let model = self.bench.work.fit(&law.in_haste(), &few, 0).ok().flatten()?;
            model.provenance().trained_error().nrmse_std_percent
        };
        let errors: Vec<Option<f64>> = laws.par_iter().map(error).collect();
        let is_worth = |law: &Candidate, error: &Option<f64>| {
            let prior = self.evidence.prior(law.asked());
            let score = |percent: f64| (0.01 * percent).max(f64::MIN_POSITIVE).ln() + prior;
            error.is_some_and(|error| score(error) <= best.inside + WORTH_A_TRIAL.ln())
        };
        let (worth, not): (Vec<_>, Vec<_>) =
            laws.into_iter().zip(errors).partition(|(law, error)| is_worth(law, error));
        self.dropped.extend(not.into_iter().map(|(law, _)| law));
        worth.into_iter().map(|(law, _)| law).collect()
    }

    /// Further starts of the random candidates that count.
    fn further_starts(&mut self) {
        let Bench { folds, work, .. } = self.bench;
        let Some(combination) = Combination::of(&self.trials, folds, self.evidence, |_| true) else { return };
        let is_random = |place: &usize| self.trials[*place].candidate.is_random();
        let places = combination.shares().into_iter().map(|(place, _)| place);
        let places: Vec<usize> = places.filter(is_random).collect();
        let further = self.options.starts.saturating_sub(1);
        work.expect(places.len() * further * folds.len() + self.options.members);
        for start in 1..=further {
            self.bench.try_start(&mut self.trials, &places, start);
        }
    }

    /// The lowest scores of any candidate so far, on some folds.
    fn best(&self, folds: &[usize]) -> Option<Score> {
        let complete = self.trials.iter().filter(|trial| trial.is_complete());
        let scores = complete.map(|trial| self.score(trial, &trial.predicted, folds));
        scores.reduce(|a, b| Score { inside: a.inside.min(b.inside), outside: a.outside.min(b.outside) })
    }
}

/// True if a score is, in either class, at most so many times the best.
fn is_within(score: Score, best: Score, times: f64) -> bool {
    score.inside <= best.inside + times.ln() || score.outside <= best.outside + times.ln()
}
