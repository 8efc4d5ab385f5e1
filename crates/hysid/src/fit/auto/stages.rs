//! The order of the work, such that at each stop there is the best model that the time allows. A few
//! candidates at a time are fitted to all folds and to all data, those that are usually good or fast first;
//! further starts and members come last. Candidates with errors far above the best are dropped after their
//! first folds.

use hysid_core::elementary::{exp, ln};

use crate::fit::auto::candidates::{Candidate, CandidateKind};
use crate::fit::auto::combination::Combination;
use crate::fit::auto::prior::LoopEvidence;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{FoldBench, Trial};
use crate::fit::progress::{Standing, Tried};
use crate::model::Model;
use crate::optimise::parallel;
use crate::options::fit_spec::AutoOptions;

/// Candidates that are tried side by side. It does not depend on the number of threads, nor does the result.
const SIDE_BY_SIDE: usize = 4;

/// Largest error on the first folds, relative to the best, and places within a kind, of a candidate that is kept.
const HOPELESS: f64 = 3.0;
const HOPEFUL_OF_KIND: usize = 6;

/// Largest error, relative to the best, of a model with inertia that has fewer parts and is enough.
const ABOUT_AS_GOOD: f64 = 1.2;

/// Ratio of the errors of single starts with free states up to which they do not tell candidates apart. Designed.
const ALIKE: f64 = 1.15;

/// Number of folds up to which all are first folds.
const FEW_FOLDS: usize = 3;

/// A law passes screening if its training error is at most this many times the best held-out error.
const WORTH_A_TRIAL: f64 = 2.0;

/// For noise-free data, a law passes screening up to this error, as a share of the standard deviation.
const NEARLY_EXACT: f64 = 0.03;

/// The held-out error with the rate that makes up for not knowing it at other speeds, relative to that without. Designed.
const EARNED: f64 = 0.8;

const REFINED: usize = 2;

/// Error of the best network, as a share of the standard deviation, below which there is hardly any noise.
const WITHOUT_NOISE: f64 = 0.01;

pub(super) struct Stages<'w, 'o, 'a> {
    pub bench: FoldBench<'w, 'o, 'a>,
    pub options: &'w AutoOptions,
    pub evidence: LoopEvidence,
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
        let mut others: Vec<Trial> = others.into_iter().map(Trial::of).collect();
        if let Some((model, trial)) = first.zip(others.first_mut()) {
            trial.members.insert(0, model);
        }
        self.first_starts(others);
        let refined = [self.refined(), self.with_found_pasts()].concat();
        self.expect(refined.len(), laws.len());
        self.first_starts(refined.into_iter().map(Trial::of).collect());
        self.expect(0, laws.len());
        let promising = self.screened(laws);
        self.expect(promising.len(), 0);
        self.first_starts(promising);
        self.further_starts();
    }

    /// Announces the fits still to come; about a third of the `others` and a quarter of the `laws` go on.
    fn expect(&self, others: usize, laws: usize) {
        let (first_folds, other_folds) = self.first_folds();
        let of_all = other_folds.len() + 1;
        let tried = |count: usize, share: usize| count * first_folds.len() + count.div_ceil(share) * of_all;
        let to_come = tried(others, 3) + laws + tried(laws.div_ceil(4), 1) + self.fits_of_further_starts(2);
        self.bench.work.expect(to_come);
    }

    /// Fits of the further starts of some candidates, and to everything.
    fn fits_of_further_starts(&self, candidates: usize) -> usize {
        let further = self.options.starts.saturating_sub(1);
        candidates * further * (self.bench.folds.len() + 1)
    }

    /// One start of each on the first folds, of the best of each kind on all. The very first few are tried on all at
    /// once.
    fn first_starts(&mut self, trials: Vec<Trial>) {
        let begun = self.trials.len();
        self.trials.extend(trials);
        let fitted: Vec<usize> =
            (begun..self.trials.len()).filter(|&place| !self.trials[place].members.is_empty()).collect();
        self.tell(&fitted, Standing::Trying);
        let (first_folds, other_folds) = self.first_folds();
        let all: Vec<usize> = (begun..self.trials.len()).collect();
        let urgent = if begun == 0 { self.urgent().min(all.len()) } else { 0 };
        let (urgent, others) = all.split_at(urgent);
        self.bench.try_folds(&mut self.trials, urgent, 0, &first_folds, true);
        self.tell(urgent, Standing::Trying);
        self.bench.try_folds(&mut self.trials, urgent, 0, &other_folds, false);
        self.tell(urgent, Standing::Trying);
        for few in others.chunks(SIDE_BY_SIDE) {
            self.bench.try_folds(&mut self.trials, few, 0, &first_folds, false);
            self.tell(few, Standing::Trying);
        }
        let hopeful = self.hopeful(&all, &first_folds);
        let (tried, hopeful): (Vec<usize>, Vec<usize>) =
            hopeful.into_iter().partition(|place| urgent.contains(place));
        self.end_start(&tried);
        for few in hopeful.chunks(SIDE_BY_SIDE) {
            self.bench.try_folds(&mut self.trials, few, 0, &other_folds, true);
            self.end_start(few);
        }
        let is_dropped = |place: &usize| !tried.contains(place) && !hopeful.contains(place);
        let dropped: Vec<usize> = all.into_iter().filter(is_dropped).collect();
        self.tell(&dropped, Standing::Dropped);
        self.dropped.extend(dropped.iter().map(|&place| self.trials[place].candidate.clone()));
        let mut place = 0;
        self.trials.retain(|_| {
            place += 1;
            !dropped.contains(&(place - 1))
        });
    }

    /// Number of candidates tried on everything at once; of slow models with inertia only the first.
    fn urgent(&self) -> usize {
        let has_inertia = self.trials.first().is_some_and(|trial| trial.candidate.is_dynamic());
        if has_inertia { 1 } else { SIDE_BY_SIDE }
    }

    /// Ends the starts of some candidates that are under way, and reports their results.
    fn end_start(&mut self, places: &[usize]) {
        self.bench.end_start(&mut self.trials, places);
        for &place in places {
            let is_complete = self.trials[place].is_complete();
            self.tell(&[place], if is_complete { Standing::Complete } else { Standing::Dropped });
        }
    }

    fn tell(&self, places: &[usize], standing: Standing) {
        let FoldBench { folds, work, .. } = self.bench;
        for trial in places.iter().map(|&place| &self.trials[place]) {
            let (predicted, judged) = match standing {
                Standing::Complete => (trial.predicted.clone(), (0..folds.len()).collect()),
                _ => (trial.predicted_so_far(&[]).unwrap_or_default(), trial.folds_so_far()),
            };
            let error = || Score::of(&predicted, folds, |fold| judged.contains(&fold)).percent();
            let tried = Tried {
                name: trial.candidate.name(),
                error_percent: (!judged.is_empty()).then(error),
                folds: judged.len(),
                of: folds.len(),
                standing,
                model: trial.any_model(),
            };
            work.tell(&trial.candidate, tried);
        }
    }

    /// The best candidates of each kind on these folds, best first, without those far above the best.
    fn hopeful(&self, places: &[usize], folds: &[usize]) -> Vec<usize> {
        let score = |&place: &usize| {
            let trial = &self.trials[place];
            let predicted = trial.predicted_so_far(folds)?;
            let score = Score::of(&predicted, self.bench.folds, |fold| folds.contains(&fold));
            Some((place, score.with_unseen(trial.unseen_error(self.evidence))))
        };
        let mut scored: Vec<(usize, Score)> = places.iter().filter_map(score).collect();
        let Some(best) = lowest(scored.iter().map(|(_, score)| *score)) else { return Vec::new() };
        let best = lowest([best].into_iter().chain(self.best(folds))).unwrap_or(best);
        let above = |score: &Score| (score.inside - best.inside).min(score.outside - best.outside);
        scored.retain(|(_, score)| above(score) <= ln(HOPELESS));
        scored.sort_by(|(_, a), (_, b)| above(a).total_cmp(&above(b)));
        let mut of_kinds = [0; CandidateKind::ALL.len()];
        scored.retain(|(place, _)| {
            let of_kind = &mut of_kinds[self.trials[*place].candidate.kind as usize];
            *of_kind += 1;
            *of_kind <= HOPEFUL_OF_KIND
        });
        let enough = 0.5 * best.sum() + ln(ABOUT_AS_GOOD);
        let scored = scored.into_iter().map(|(place, score)| (place, 0.5 * score.sum() <= enough));
        self.without_needless_parts(scored.collect())
    }

    /// Of candidates, each with whether its error is at most [`ABOUT_AS_GOOD`] times the lowest: those for which no
    /// simpler one is about as good. Unnecessary hysteresis or modes increase the error beyond the training range.
    fn without_needless_parts(&self, candidates: Vec<(usize, bool)>) -> Vec<usize> {
        let candidate = |place: usize| &self.trials[place].candidate;
        let enough: Vec<&Candidate> = candidates
            .iter()
            .filter(|(_, is_enough)| *is_enough)
            .map(|(place, _)| candidate(*place))
            .collect();
        let is_needed =
            |place: &usize| !enough.iter().any(|other| candidate(*place).has_more_parts_than(other));
        candidates.into_iter().map(|(place, _)| place).filter(is_needed).collect()
    }

    /// The folds on which a candidate shows whether it is hopeless, and the others. Of a single record the first
    /// is a forecast, the last a block from its middle. Few folds are all needed.
    fn first_folds(&self) -> (Vec<usize>, Vec<usize>) {
        let last = self.bench.folds.len() - 1;
        (0..=last).partition(|&fold| fold == 0 || fold == last || last < FEW_FOLDS)
    }

    /// The best networks so far with other penalties, unless the user decided or one loop cannot distinguish them.
    fn refined(&self) -> Vec<Candidate> {
        let Self { options, .. } = self;
        if self.evidence.is_one_loop()
            || options.only.is_some()
            || options.ridge.is_some()
            || options.decay.is_some()
        {
            return Vec::new();
        }
        let is_network =
            |trial: &&Trial| trial.is_complete() && trial.candidate.kind == CandidateKind::Networks;
        let score = |trial: &&Trial| Score::of(&trial.predicted, self.bench.folds, |_| true).sum();
        let mut networks: Vec<&Trial> = self.trials.iter().filter(is_network).collect();
        networks.sort_by(|a, b| score(a).total_cmp(&score(b)));
        let is_without_noise = networks.first().is_some_and(|best| score(best) < 2.0 * ln(WITHOUT_NOISE));
        let refined = |trial: &&Trial| trial.candidate.with_other_penalties(is_without_noise);
        networks.iter().take(REFINED).flat_map(refined).collect()
    }

    /// The best candidate of each kind so far with pasts that are found together with its parameters, for records with a known
    /// beginning.
    fn with_found_pasts(&self) -> Vec<Candidate> {
        if self.options.known.is_none() || self.options.initial_state.is_some() || self.options.only.is_some()
        {
            return Vec::new();
        }
        let score = |trial: &&Trial| Score::of(&trial.predicted, self.bench.folds, |_| true).sum();
        let best_of = |kind: CandidateKind| {
            let of_kind = |trial: &&Trial| trial.is_complete() && trial.candidate.kind == kind;
            let best = self.trials.iter().filter(of_kind).min_by(|a, b| score(a).total_cmp(&score(b)));
            best?.candidate.with_found_pasts()
        };
        CandidateKind::ALL.into_iter().filter_map(best_of).collect()
    }

    /// The laws whose search on all data comes near the best candidate so far, with the fits found.
    fn screened(&mut self, laws: Vec<Candidate>) -> Vec<Trial> {
        let all: Vec<usize> = (0..self.bench.folds.len()).collect();
        let Some(best) = self.best(&all) else { return laws.into_iter().map(Trial::of).collect() };
        let (FoldBench { data, work, .. }, evidence) = (self.bench, self.evidence);
        let least = if best.inside < ln(WITHOUT_NOISE) { NEARLY_EXACT } else { 0.0 };
        let most_percent = |law: &Candidate| {
            let (most, unseen) = (WORTH_A_TRIAL * exp(best.inside), evidence.unseen_error(law.asked()));
            let worth = (most * most - unseen * unseen).max(0.0).sqrt();
            100.0 * worth.max(least)
        };
        let fit = |law: Candidate| {
            let fitted = work.fit(&law, data, 0).ok().flatten();
            let (model, searched) =
                fitted.map_or((None, Vec::new()), |fitted| (Some(fitted.model), fitted.searched));
            (law.near(searched), model)
        };
        let mut worth = Vec::new();
        for (law, model) in parallel::each_taken(laws, fit) {
            let error = model.as_ref().and_then(|m| m.provenance().trained_error().nrmse_std_percent);
            match model {
                Some(model) if error.is_some_and(|error| error <= most_percent(&law)) => {
                    let mut trial = Trial::of(law);
                    trial.members.insert(0, model);
                    worth.push(trial);
                }
                model => self.drop_unjudged(law, model.as_ref()),
            }
        }
        worth
    }

    /// Drops a law that was validated on no fold.
    fn drop_unjudged(&mut self, law: Candidate, model: Option<&Model>) {
        let tried = Tried {
            name: law.name(),
            error_percent: None,
            folds: 0,
            of: self.bench.folds.len(),
            standing: Standing::Dropped,
            model,
        };
        self.bench.work.tell(&law, tried);
        self.dropped.push(law);
    }

    fn further_starts(&mut self) {
        let FoldBench { folds, work, .. } = self.bench;
        let Some(combination) = Combination::of(&self.trials, folds, self.evidence, |_| true) else { return };
        let is_random = |place: &usize| self.trials[*place].candidate.is_random();
        let places = combination.shares().into_iter().map(|(place, _)| place);
        let (places, starts) = match self.best_with_free_states() {
            Some(best) => (vec![best], self.options.starts.max(self.options.members)),
            None => (places.filter(is_random).collect::<Vec<usize>>(), self.options.starts),
        };
        let further = starts.saturating_sub(1);
        work.expect(places.len() * further * (folds.len() + 1));
        for start in 1..=further {
            self.bench.try_start(&mut self.trials, &places, start);
            self.tell(&places, Standing::Complete);
        }
    }

    /// The best candidate with states of its own, of alike ones the one with the fewest numbers, if it is about the best of all
    /// and the user did not choose it. Such models differ more from start to start than from candidate to candidate.
    fn best_with_free_states(&self) -> Option<usize> {
        let score = |place: usize| Score::of(&self.trials[place].predicted, self.bench.folds, |_| true).sum();
        let complete = || (0..self.trials.len()).filter(|&place| self.trials[place].is_complete());
        let free = || complete().filter(|&place| self.trials[place].candidate.has_free_states());
        let lowest = free().map(score).fold(f64::INFINITY, f64::min);
        let numbers = |place: usize| self.trials[place].members.values().map(Model::parameters).max();
        let alike = free().filter(|&place| score(place) <= lowest + 2.0 * ln(ALIKE));
        let best = alike.min_by_key(|&place| numbers(place).unwrap_or(usize::MAX))?;
        let is_about_best = complete().all(|other| score(best) <= score(other) + 2.0 * ln(ABOUT_AS_GOOD));
        (self.options.only.is_none() && is_about_best).then_some(best)
    }

    /// Drops the candidates with the rate unless they are clearly better than those without, for data in which a
    /// dependence on the rate and one on the amplitude look alike: at other speeds a needless rate is harmful.
    pub fn drop_unearned_rates(&mut self) {
        let has_rate = |trial: &Trial| trial.candidate.asked().rate().is_some();
        let best = |with: bool| {
            let trials = self.trials.iter().filter(|trial| trial.is_complete() && has_rate(trial) == with);
            let errors =
                trials.map(|trial| Score::of(&trial.predicted, self.bench.folds, |_| true).mean_percent());
            errors.min_by(f64::total_cmp)
        };
        if let Some((with, without)) = best(true).zip(best(false))
            && with > EARNED * without
        {
            let (dropped, kept) = std::mem::take(&mut self.trials).into_iter().partition(has_rate);
            self.trials = kept;
            self.dropped.extend(dropped.into_iter().map(|trial: Trial| trial.candidate));
        }
    }

    /// The lowest scores of any candidate so far, on some folds.
    fn best(&self, folds: &[usize]) -> Option<Score> {
        let complete = self.trials.iter().filter(|trial| trial.is_complete());
        lowest(
            complete.map(|trial| trial.score(self.bench.folds, self.evidence, |fold| folds.contains(&fold))),
        )
    }
}

fn lowest(scores: impl Iterator<Item = Score>) -> Option<Score> {
    scores.reduce(|a, b| Score { inside: a.inside.min(b.inside), outside: a.outside.min(b.outside) })
}
