//! Candidates on folds: the predictions of each start of each candidate for held-out data.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::data::record::Dataset;
use crate::fit::auto::candidates::Candidate;
use crate::fit::auto::prior::LoopEvidence;
use crate::fit::auto::score::Score;
use crate::fit::auto::work::AutoWork;
use crate::fit::law::search::spread;
use crate::model::{Excursion, Model, Predictions};
use crate::optimise::parallel;
use crate::validation::Fold;

#[derive(Debug, Clone)]
pub(super) struct HeldOut {
    pub fold: Fold,
    pub rows: FoldRows,
    /// True if what is held out lies beyond the training data.
    pub is_beyond: bool,
}

impl HeldOut {
    pub fn of(fold: Fold) -> Self {
        Self { rows: FoldRows::of(&fold), is_beyond: fold.is_beyond(), fold }
    }

    /// The same, whose errors are relative to the size of their record.
    pub fn by_record(mut self) -> Self {
        let mean = self.fold.train.mean_output();
        let weights = self.fold.held_out.records().iter().flat_map(|record| {
            let share = self.rows.deviation / record.output_size(mean).max(f64::MIN_POSITIVE);
            std::iter::repeat_n(share * share, record.scored())
        });
        self.rows.weights = weights.collect();
        self
    }
}

/// The held-out rows of a fold that have an output.
#[derive(Debug, Clone)]
pub(super) struct FoldRows {
    /// Measured output of each row.
    pub measured: Vec<f64>,
    /// How far outside the fold's training range the record has been there, 0 to 1.
    pub outside: Vec<f64>,
    /// Standard deviation of the measured output, in its unit.
    pub deviation: f64,
    /// Weight of each squared error, if errors are relative to the size of their record: `(σ_f/ρ_r)²`; otherwise empty.
    pub weights: Vec<f64>,
}

impl FoldRows {
    fn of(fold: &Fold) -> Self {
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
        let (_, deviation) = spread(&measured);
        Self { measured, outside, deviation: deviation.max(f64::MIN_POSITIVE), weights: Vec::new() }
    }
}

/// True if errors on these folds are relative to the size of their record.
pub(super) fn are_by_record(folds: &[HeldOut]) -> bool {
    folds.iter().any(|fold| !fold.rows.weights.is_empty())
}

#[derive(Debug, Clone)]
pub(super) struct FoldTrial {
    pub model: Model,
    /// Prediction of each held-out row.
    pub predicted: Vec<f64>,
}

impl FoldTrial {
    /// Error on what it was fitted to, in percent of the standard deviation.
    pub fn training_error(&self) -> f64 {
        self.model.provenance().trained_error().nrmse_std_percent.unwrap_or(f64::INFINITY)
    }
}

/// A candidate, what its starts predict on the folds, and its fits to everything.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    pub candidate: Candidate,
    /// The models of each start, fold by fold.
    pub starts: Vec<Vec<FoldTrial>>,
    /// The median of what the starts predict, fold by fold.
    pub predicted: Vec<Vec<f64>>,
    /// Fits to everything, by their start.
    pub members: BTreeMap<usize, Model>,
    /// The models of the start that is under way, fold by fold.
    under_way: Vec<Option<FoldTrial>>,
}

impl Trial {
    /// A candidate that was not tried yet.
    pub fn of(candidate: Candidate) -> Self {
        Self {
            candidate,
            starts: Vec::new(),
            predicted: Vec::new(),
            members: BTreeMap::new(),
            under_way: Vec::new(),
        }
    }

    /// True if it was tried and fitted to everything at least once.
    pub fn is_complete(&self) -> bool {
        !self.starts.is_empty() && !self.members.is_empty()
    }

    /// The error of the candidate to be expected on loops that the data do not show.
    pub fn unseen_error(&self, evidence: LoopEvidence) -> f64 {
        evidence.unseen_error(self.candidate.asked())
    }

    /// Lowest error of its fits to everything, as a share of the standard deviation; 0 before there is one.
    pub fn training_error(&self) -> f64 {
        let percent = |model: &Model| model.provenance().trained_error().nrmse_std_percent;
        let errors = self.members.values().filter_map(percent);
        0.01 * errors.min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// Error on these folds that it is not believed to be better than: that of its fits to everything, which says nothing of
    /// errors relative to the size of a record.
    pub fn least_error(&self, folds: &[HeldOut]) -> f64 {
        if are_by_record(folds) { 0.0 } else { self.training_error() }
    }

    /// Its score on the folds that are `counted`, with what is known of it beside.
    pub fn score(&self, folds: &[HeldOut], evidence: LoopEvidence, counted: impl Fn(usize) -> bool) -> Score {
        let on_folds = Score::of(&self.predicted, folds, counted);
        on_folds.at_least(self.least_error(folds)).with_unseen(self.unseen_error(evidence))
    }

    /// Predictions of the start under way, fold by fold, empty where not fitted; `None` if it failed on a `wanted`
    /// fold.
    pub fn predicted_so_far(&self, wanted: &[usize]) -> Option<Vec<Vec<f64>>> {
        let is_there = |fold: &usize| self.under_way.get(*fold).is_some_and(Option::is_some);
        let predicted = |on_fold: &Option<FoldTrial>| on_fold.as_ref().map(|fold| fold.predicted.clone());
        wanted
            .iter()
            .all(is_there)
            .then(|| self.under_way.iter().map(|on_fold| predicted(on_fold).unwrap_or_default()).collect())
    }

    /// The folds that the start under way has been fitted to.
    pub fn folds_so_far(&self) -> Vec<usize> {
        (0..self.under_way.len()).filter(|&fold| self.under_way[fold].is_some()).collect()
    }

    /// A fit to everything or, if there is none, to the training part of a fold.
    pub fn any_model(&self) -> Option<&Model> {
        let on_folds = self.under_way.iter().flatten().map(|on_fold| &on_fold.model);
        self.members.values().chain(on_folds).next()
    }

    /// Ends the start that is under way: it counts if it has been fitted to every fold.
    fn end_start(&mut self, folds: usize) {
        let under_way = std::mem::take(&mut self.under_way);
        let of_folds: Option<Vec<FoldTrial>> = under_way.into_iter().collect();
        if let Some(of_folds) = of_folds.filter(|of_folds| of_folds.len() == folds) {
            self.add_start(of_folds);
        }
    }

    /// Adds a start that has been fitted to every fold.
    pub fn add_start(&mut self, of_folds: Vec<FoldTrial>) {
        let folds = of_folds.len();
        self.starts.push(of_folds);
        let median = |fold: usize| {
            let starts: Vec<&[f64]> =
                self.starts.iter().map(|folds| folds[fold].predicted.as_slice()).collect();
            medians(&starts)
        };
        self.predicted = (0..folds).map(median).collect();
    }
}

/// The median of several predictions, row by row.
fn medians(predictions: &[&[f64]]) -> Vec<f64> {
    let mut all = Predictions::default();
    let row = |row: usize| {
        all.clear();
        predictions.iter().for_each(|prediction| all.push(prediction[row], 1.0));
        all.quantile(0.5)
    };
    (0..predictions[0].len()).map(row).collect()
}

/// A start of a candidate, to be tried on a fold or, without one, fitted to everything.
#[derive(Debug, Clone, Copy)]
struct Job {
    trial: usize,
    start: usize,
    fold: Option<usize>,
}

#[allow(clippy::large_enum_variant)]
enum TrialOutcome {
    OnFold(FoldTrial),
    OnEverything(Model),
}

#[derive(Clone, Copy)]
pub(super) struct FoldBench<'w, 'o, 'a> {
    pub data: &'w Dataset,
    /// The data with all their outputs, of which a candidate with free states needs each.
    pub whole: &'w Dataset,
    pub folds: &'w [HeldOut],
    pub work: &'w AutoWork<'o, 'a>,
}

impl FoldBench<'_, '_, '_> {
    /// Tries a start of some candidates, given by their places, on all folds.
    pub fn try_start(&self, trials: &mut [Trial], places: &[usize], start: usize) {
        let all: Vec<usize> = (0..self.folds.len()).collect();
        self.try_folds(trials, places, start, &all, false);
        self.end_start(trials, places);
    }

    /// Tries a start of some candidates on some folds and, on request, on everything; failures are dropped.
    pub fn try_folds(
        &self,
        trials: &mut [Trial],
        places: &[usize],
        start: usize,
        folds: &[usize],
        on_everything: bool,
    ) {
        let of_trial = |&trial: &usize| {
            let is_missing = on_everything && !trials[trial].members.contains_key(&start);
            let everything = is_missing.then_some(Job { trial, start, fold: None });
            everything.into_iter().chain(folds.iter().map(move |&fold| Job {
                trial,
                start,
                fold: Some(fold),
            }))
        };
        let jobs: Vec<Job> = places.iter().flat_map(of_trial).collect();
        let fitted: Vec<Option<TrialOutcome>> = parallel::each(&jobs, |job| self.run(trials, job));
        for (job, fitted) in jobs.iter().zip(fitted) {
            let trial = &mut trials[job.trial];
            match (fitted, job.fold) {
                (Some(TrialOutcome::OnFold(on_fold)), Some(fold)) => {
                    trial.under_way.resize(self.folds.len(), None);
                    trial.under_way[fold] = Some(on_fold);
                }
                (Some(TrialOutcome::OnEverything(model)), _) => {
                    trial.members.insert(job.start, model);
                }
                _ => {}
            }
        }
    }

    /// Ends the starts of some candidates that are under way.
    pub fn end_start(&self, trials: &mut [Trial], places: &[usize]) {
        places.iter().for_each(|&place| trials[place].end_start(self.folds.len()));
    }

    fn run(&self, trials: &[Trial], job: &Job) -> Option<TrialOutcome> {
        let candidate = &trials[job.trial].candidate;
        // A candidate that fails on a fold is none; why, its name alone would not tell the user.
        let Some(fold) = job.fold else {
            return self.fit(candidate, job.start).map(TrialOutcome::OnEverything);
        };
        let fold = &self.folds[fold].fold;
        let train = match candidate.has_free_states() {
            true => Cow::Owned(fold.trained_of(self.whole)?),
            false => Cow::Borrowed(&fold.train),
        };
        let model = self.work.fit(&candidate.on_a_fold(), &train, job.start).ok().flatten()?.model;
        let predicted = fold.predicted_by(&model).ok()?;
        let is_sound = predicted.iter().all(|y| y.is_finite());
        is_sound.then_some(TrialOutcome::OnFold(FoldTrial { model, predicted }))
    }

    /// A fit of a candidate to everything.
    fn fit(&self, candidate: &Candidate, start: usize) -> Option<Model> {
        let data = if candidate.has_free_states() { self.whole } else { self.data };
        self.work.fit(candidate, data, start).ok().flatten().map(|fitted| fitted.model)
    }

    /// Fits candidates to everything, each given by its place and start, unless that has been done.
    pub fn fit_members(&self, trials: &mut [Trial], wanted: &[(usize, usize)]) {
        let is_missing = |(place, start): &&(usize, usize)| !trials[*place].members.contains_key(start);
        let missing: Vec<&(usize, usize)> = wanted.iter().filter(is_missing).collect();
        let fit = |&&(place, start): &&(usize, usize)| self.fit(&trials[place].candidate, start);
        let fitted: Vec<Option<Model>> = parallel::each(&missing, fit);
        for (&&(place, start), model) in missing.iter().zip(fitted) {
            if let Some(model) = model {
                trials[place].members.insert(start, model);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wild_start_does_not_move_a_candidate() {
        assert_eq!(medians(&[&[1.0, 2.0], &[1.2, 2.2], &[1e9, -1e9]]), [1.2, 2.0]);
    }
}
