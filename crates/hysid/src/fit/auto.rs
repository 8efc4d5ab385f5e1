//! The model `auto`: candidates are cross-validated, and the best are combined.
//!
//! 1. *Folds* of the training data, [`crate::validation::folds`]; of a single record only three of them.
//! 2. *Candidates*: for data that look like a resonance models with inertia, a network and a recurrent network, which
//!    are scored on the beginnings of the records and fitted to all of them (theory.md, section 15); otherwise networks,
//!    recurrent networks, random stops and all classical laws, with and without rate, deterioration, relaxation and
//!    compression. Laws with searched parameters are first fitted to few rows, and dropped if their errors are far above
//!    the best. The other candidates and the remaining laws are fitted to the first folds, the best of each kind also to
//!    the other folds, and those with a weight once more from a second start. The prediction of a candidate is the
//!    median of its starts.
//! 3. *Weights*: the best eight candidates are weighted by their scores and combined by their weighted median.
//!    Rows inside and outside the trained range have separate scores.
//! 4. *Members*: the fewest starts, at least five, whose error on the folds is at most 1 % above that of all
//!    starts. They are fitted to all data and form an [`Ensemble`], or one small model is distilled from it.
//! 5. *Prediction band*, calibrated on the folds.
//!
//! ```text
//! S = mean over the folds f of ln(rmse_f / σ_f)                                             theory.md (11.5)
//! w = (e^S / e^{S_best})^{-p},    p = 3, and 8 for data of one loop                         theory.md (11.6)
//! ```
//!
//! `S` is the score of a candidate, `rmse_f` its error on fold `f`, `σ_f` the standard deviation of the
//! output there, and `w` its weight.
//!
//! docs/accuracy.md of the repository reports the settings that were compared, on which cases, and the
//! errors.

mod candidates;
mod combination;
mod law;
mod misfits;
mod prepared_data;
mod prior;
mod score;
mod selection;
mod single;
mod stages;
mod trial;
mod warm_up;
mod work;

use serde_json::json;

use crate::data::FEWEST_ROWS;
use crate::data::initial_state::InitialState;
use crate::data::known_beginning::KnownBeginning;
use crate::data::metrics::Errors;
use crate::data::record::{Dataset, Record, SpeedEvidence};
use crate::error::{Error, Result};
use crate::fit::progress::{Fitted, HeldOutRows, Observer};
use crate::model::input_transform::InputTransform;
use crate::model::selection::{Beyond, FoundStates, Selection, WarmUp};
use crate::model::{
    Band, Ensemble, Group, HeldOutRow, Model, Node, NodeKind, Predictor, Provenance, ProvenanceDraft, Weights,
};
use crate::options::FitSpec;
use crate::options::classical::ClassicalOptions;
use crate::options::fit_spec::AutoOptions;
use crate::options::table::check;
use crate::termination::Termination;
use crate::validation::{PooledErrors, folds_of_loop, folds_to_choose_by};
use candidates::{Candidate, candidates, quick, suited};
use combination::{Combination, Leaf};
use prepared_data::{PreparedData, as_chosen};
use prior::LoopEvidence;
use selection::selection;
use stages::Stages;
use trial::{FoldBench, HeldOut, Trial};
use work::AutoWork;

const MOST_FOLDS: usize = 5;

/// Rows with an output that candidates are fitted to and validated on, at most; the memory runs through all.
const MOST_ROWS: usize = 4000;

/// Rows that candidates with inertia are validated on, at most: the beginnings of the records.
const ROWS_WITH_INERTIA: usize = 6000;

/// Fits expected before anything is known.
const FITS_EXPECTED: usize = 200;

/// True for the initial state that is found together with the parameters.
fn is_free(state: &InitialState) -> bool {
    *state == InitialState::Free
}

/// Specifications of all candidates, each for its first start.
pub(crate) fn requests(data: &Dataset, options: &AutoOptions) -> Vec<FitSpec> {
    wanted(data, options).iter().map(|candidate| candidate.request(0)).collect()
}

/// The candidates: all that suit the data, or the one requested model.
fn wanted(data: &Dataset, options: &AutoOptions) -> Vec<Candidate> {
    match &options.only {
        // The records have their initial state before any candidate is fitted to them, unless it is found with the model.
        Some(request) => {
            vec![Candidate::alone(&request.with_initial_state(options.initial_state.filter(is_free)))]
        }
        None => candidates(data, options),
    }
}

pub(crate) fn fit(data: &Dataset, options: &AutoOptions, observer: &mut Observer<'_>) -> Result<Fitted> {
    data.check_identifiable(FEWEST_ROWS)?;
    check([("members", json!(options.members))])?;
    let candidates = suited(wanted(data, options), data, options);
    let Some(first) = candidates.first() else {
        return Err(Error::NoCandidate);
    };
    let data = &*as_chosen(data, options)?;
    let has_inertia = candidates.iter().any(Candidate::is_dynamic);
    let is_free = options.initial_state.as_ref().is_some_and(is_free);
    let few = match (is_free, has_inertia) {
        // A state is found from all rows of a beginning.
        (true, _) => data.clone(),
        (_, true) => data.beginnings(ROWS_WITH_INERTIA)?,
        _ => data.thinned(MOST_ROWS),
    };
    let evidence = LoopEvidence::of(data);
    let folds =
        if evidence.is_one_loop() { folds_of_loop(&few) } else { folds_to_choose_by(&few, MOST_FOLDS) };
    let beginning = KnownBeginning::judged(options.known.as_ref(), options.initial_state, data.names())?;
    let folds = folds.into_iter().map(|fold| fold.with_known_beginning(beginning, data)).collect();
    let work = AutoWork::new(observer, FITS_EXPECTED);

    // Should the observer stop everything soon, this is what there is.
    let alone = work.first_fit(first, if has_inertia { data } else { &few })?;
    let beginning = match (is_free, has_inertia) {
        (true, _) => PreparedData::with_free_states(&few, folds),
        (_, true) => PreparedData::with_inertia(&few, folds, options),
        _ => PreparedData::of(&quick(options), &few, folds, options, &work),
    };
    let data = &*beginning.of_all(data)?;
    let PreparedData { data: few, folds, warm_up, is_changed, found } = beginning;
    let candidates: Vec<Candidate> = candidates.iter().map(|one| one.warmed_up(warm_up.rows)).collect();
    let is_by_record =
        (is_free || options.known.is_some()) && data.size_ratio() > ClassicalOptions::RATIO_OF_SIZES;
    let held_out = |fold| if is_by_record { HeldOut::of(fold).by_record() } else { HeldOut::of(fold) };
    let held_out: Vec<HeldOut> = folds.into_iter().map(held_out).collect();
    let is_first = warm_up.rows == 0 && !is_changed && !work.is_stopped();
    let first_member = is_first.then(|| alone.clone());
    let fitted_to = if has_inertia { data } else { &few };
    if held_out.is_empty() {
        return without_folds(data, fitted_to, options, &candidates[0], alone, &work);
    }
    let work = &work;
    let bench = FoldBench { data: fitted_to, whole: data, folds: &held_out, work };
    let mut stages = Stages { bench, options, evidence, trials: Vec::new(), dropped: Vec::new() };
    stages.run(candidates, first_member);
    if !options.always_rate && options.only.is_none() && data.speeds() == SpeedEvidence::OfAmplitude {
        stages.drop_unearned_rates();
    }
    let Stages { trials, dropped, .. } = stages;
    EnsembleSelection {
        data,
        options,
        bench,
        evidence,
        trials,
        dropped,
        left_out: Vec::new(),
        warm_up,
        found,
    }
    .fit(alone)
}

/// Data too few to hold any out: the first candidate, unjudged.
fn without_folds(
    data: &Dataset,
    few: &Dataset,
    options: &AutoOptions,
    candidate: &Candidate,
    alone: Model,
    work: &AutoWork,
) -> Result<Fitted> {
    let mut trials = [Trial::of(candidate.clone())];
    let starts = if candidate.is_random() { options.starts.min(options.members) } else { 1 };
    let wanted: Vec<(usize, usize)> = (0..starts).map(|start| (0, start)).collect();
    FoldBench { data: few, whole: data, folds: &[], work }.fit_members(&mut trials, &wanted);
    let [trial] = trials;
    let members: Vec<Model> = trial.members.into_values().collect();
    if members.is_empty() || options.members == 1 {
        let model = members.into_iter().next().unwrap_or(alone);
        let provenance = provenance_of(&model, None, None, work);
        return Ok(Fitted::of(model.with_provenance(provenance), work.done()));
    }
    let node = |member| Node { weights: Weights::equal(), kind: NodeKind::Member(member) };
    let group = Group { name: trial.candidate.name(), nodes: (0..members.len()).map(node).collect() };
    let body = Predictor::Ensemble(Ensemble::new(members, group, data.input_range(0))?);
    let model = ensemble(body, data, options, None, None, work)?;
    Ok(Fitted::of(model, work.done()))
}

struct EnsembleSelection<'w, 'o, 'a> {
    data: &'w Dataset,
    options: &'w AutoOptions,
    bench: FoldBench<'w, 'o, 'a>,
    evidence: LoopEvidence,
    trials: Vec<Trial>,
    dropped: Vec<Candidate>,
    /// Candidates that were tried and made the ensemble worse.
    left_out: Vec<Trial>,
    warm_up: WarmUp,
    found: Option<FoundStates>,
}

/// An ensemble, and what is known of it from the folds.
struct ValidatedEnsemble {
    combination: Combination,
    rows: Vec<Vec<HeldOutRow>>,
    predicted: Vec<Vec<f64>>,
    selection: Selection,
    model: Model,
}

impl EnsembleSelection<'_, '_, '_> {
    /// The ensemble, or the single model that was requested; `alone` where nothing was tried in time.
    fn fit(mut self, alone: Model) -> Result<Fitted> {
        let FoldBench { work, .. } = self.bench;
        let fit = |model| Ok(Fitted::of(model, work.done()));
        self.drops_what_does_not_fit();
        self.prefers_starts_with_free_states();
        if let Some(place) = self.place_of_law()
            && let Some(fitted) = self.of_law(place)?
        {
            return Ok(fitted);
        }
        let mut assembled = self.assembled()?;
        for step in misfits::STEPS {
            match &assembled {
                Some(ensemble) if self.drops_misfits(ensemble, step) => assembled = self.assembled()?,
                _ => break,
            }
        }
        let Some(ValidatedEnsemble { combination, rows, predicted, selection, model }) = assembled else {
            let model = self.without_validation(alone);
            if self.combination(|_| true).is_some() {
                return fit(model);
            }
            let provenance = provenance_of(&model, None, None, work);
            return fit(model.with_provenance(provenance));
        };
        if self.options.members == 1
            && let Some(fitted) = self.single(&combination, &model, selection)?
        {
            return Ok(fitted);
        }
        // A law alone is a law, not an ensemble.
        if let [leaf] = combination.leaves()
            && !self.trials[leaf.place].candidate.is_random()
            && let Some(fitted) = self.of_law(leaf.place)?
        {
            return Ok(fitted);
        }
        let band = self.band(&rows, combination.unseen_error(&self.trials, self.evidence));
        let held_out = self.held_out(&predicted)?;
        Ok(fit(model.with_band_over(band, self.data)?)?.with_held_out(held_out))
    }

    /// The ensemble of all candidates that are left, its members fitted; `None` if none could be fitted in time.
    fn assembled(&mut self) -> Result<Option<ValidatedEnsemble>> {
        let FoldBench { work, .. } = self.bench;
        let Some(all) = self.combination(|_| true) else { return Ok(None) };
        let wanted: Vec<(usize, usize)> = all.leaves().iter().map(|leaf| (leaf.place, leaf.start)).collect();
        self.bench.fit_members(&mut self.trials, &wanted);
        // Those that there was no time for are left out.
        let is_fitted = |leaf: Leaf| self.trials[leaf.place].members.contains_key(&leaf.start);
        let Some(combination) = all.only(is_fitted).or_else(|| self.of_fitted()) else { return Ok(None) };
        let rows = self.rows_held_out(&combination);
        let predicted = self.predicted(&rows);
        let validation = self.errors_held_out(&predicted);
        let selection = self.judged_by(self.selection(&combination), validation.as_ref(), &predicted);
        let members = |place: usize, start: usize| self.trials[place].members.get(&start).cloned();
        let body = Predictor::Ensemble(combination.ensemble(members, self.data.input_range(0))?);
        let model = ensemble(body, self.data, self.options, validation, Some(selection.clone()), work)?;
        Ok(Some(ValidatedEnsemble { combination, rows, predicted, selection, model }))
    }

    fn predicted(&self, rows: &[Vec<HeldOutRow>]) -> Vec<Vec<f64>> {
        let of_fold = |(fold, rows): (&HeldOut, &Vec<HeldOutRow>)| {
            let measured =
                fold.fold.held_out.records().iter().flat_map(Record::output).filter(|y| !y.is_nan());
            measured.zip(rows).map(|(measured, row)| measured - row.error).collect()
        };
        self.bench.folds.iter().zip(rows).map(of_fold).collect()
    }

    fn held_out(&self, predicted: &[Vec<f64>]) -> Result<Option<HeldOutRows>> {
        let folds = self.bench.folds.iter().map(|fold| &fold.fold);
        HeldOutRows::of(self.data.names(), folds.zip(predicted.iter().map(Vec::as_slice)))
    }

    fn errors_held_out(&self, predicted: &[Vec<f64>]) -> Option<Errors> {
        errors_held_out(predicted, self.bench.folds, &self.data.names().output)
    }

    /// The candidates' starts with their weights by the folds that are `counted`, no more than are needed.
    fn combination(&self, counted: impl Fn(usize) -> bool + Copy) -> Option<Combination> {
        let (folds, evidence) = (self.bench.folds, self.evidence);
        let all = Combination::of(&self.trials, folds, evidence, counted)?;
        // A single model is distilled from more than one.
        let default = AutoOptions::default().members;
        let most = if self.options.members == 1 { default } else { self.options.members };
        if self.options.only.is_some() {
            return all.first(most);
        }
        all.smallest(&self.trials, folds, evidence, counted, most)
    }

    fn of_fitted(&self) -> Option<Combination> {
        let all = Combination::of(&self.trials, self.bench.folds, self.evidence, |_| true)?;
        all.only(|leaf| self.trials[leaf.place].members.contains_key(&leaf.start))
    }

    /// The model with the lowest training error of those fitted to everything so far.
    fn without_validation(&self, alone: Model) -> Model {
        let error = |model: &&Model| model.provenance().trained_error().rmse;
        let members = self.trials.iter().flat_map(|trial| trial.members.values());
        let lowest = members.chain([&alone]).min_by(|a, b| error(a).total_cmp(&error(b)));
        lowest.cloned().unwrap_or(alone)
    }

    fn selection(&self, combination: &Combination) -> Selection {
        let output = &self.data.names().output;
        let mut selection = selection(&self.trials, &self.left_out, self.bench.folds, combination, output);
        selection.warm_up = (self.warm_up.rows > 0).then_some(self.warm_up);
        selection.found_states = self.found;
        selection.one_loop = self.evidence.is_one_loop();
        selection.dropped = self.dropped.iter().map(Candidate::name).collect();
        selection
    }

    /// The same with the errors of what is predicted on the folds.
    fn judged_by(
        &self,
        selection: Selection,
        validation: Option<&Errors>,
        predicted: &[Vec<f64>],
    ) -> Selection {
        let folds = self.bench.folds;
        let percent = |errors: &Errors| errors.nrmse_std_percent;
        let beyond = errors_beyond(predicted, folds, "").as_ref().and_then(percent);
        let names = || folds.iter().filter(|fold| fold.is_beyond).map(|fold| fold.fold.name.clone());
        Selection {
            held_out_percent: validation.and_then(percent),
            beyond: beyond.map(|percent| Beyond { folds: names().collect(), percent }),
            ..selection
        }
    }

    /// The band from the errors on held-out rows; of one loop, at least that of the errors `unseen` that smaller loops are
    /// expected to have.
    fn band(&self, folds: &[Vec<HeldOutRow>], unseen: f64) -> Option<Band> {
        let band = Band::calibrate(folds)?;
        Some(match self.evidence {
            LoopEvidence::SeveralLoops => band,
            LoopEvidence::OneLoop(_) => {
                band.wider(prior::WIDER_BAND).for_unseen(unseen * single::deviation(self.data))
            }
        })
    }

    /// Held-out rows of each fold, predicted with weights from the other folds, because their own would flatter them.
    fn rows_held_out(&self, combination: &Combination) -> Vec<Vec<HeldOutRow>> {
        let folds = self.bench.folds;
        let of_fold = |fold: usize| {
            let of_others = (folds.len() > 1).then(|| self.combination(|other| other != fold)).flatten();
            of_others.as_ref().unwrap_or(combination).rows(&self.trials, folds, fold)
        };
        (0..folds.len()).map(of_fold).collect()
    }

    /// One small model, with what is known of it.
    fn single(
        &mut self,
        combination: &Combination,
        ensemble: &Model,
        mut selection: Selection,
    ) -> Result<Option<Fitted>> {
        let Self { options, bench, evidence, .. } = *self;
        let makers =
            single::SingleSources { trials: &mut self.trials, bench, combination, evidence, options };
        let Some(found) = makers.single(ensemble)? else { return Ok(None) };
        selection.single = Some(found.how);
        let validation = self.errors_held_out(&found.predicted);
        let unseen = combination.unseen_error(&self.trials, self.evidence);
        Ok(Some(self.validated(found.model, selection, validation, (&found.predicted, unseen))?))
    }

    /// A single model with what is known of it from what models made in the same way `predicted` on the folds, and the error
    /// to be expected where the data show nothing.
    fn validated(
        &self,
        model: Model,
        selection: Selection,
        validation: Option<Errors>,
        (predicted, unseen): (&[Vec<f64>], f64),
    ) -> Result<Fitted> {
        let FoldBench { folds, work, .. } = self.bench;
        let mut selection = self.judged_by(selection, validation.as_ref(), predicted);
        selection.candidates.iter_mut().for_each(|candidate| candidate.members = 0);
        let provenance = provenance_of(&model, Some(selection), validation, work);
        let band = self.band(&single::rows_held_out(predicted, folds), unseen);
        // A distilled model was taught more than the data.
        let model =
            model.with_provenance(provenance).trained_on(self.data)?.with_band_over(band, self.data)?;
        Ok(Fitted::of(model, work.done()).with_held_out(self.held_out(predicted)?))
    }
}

/// Errors over the rows held out: of folds between the others, if there are any, else of all.
fn errors_held_out(predicted: &[Vec<f64>], folds: &[HeldOut], output: &str) -> Option<Errors> {
    let some_between = folds.iter().any(|fold| !fold.is_beyond);
    errors_where(predicted, folds, output, |fold| !(some_between && fold.is_beyond))
}

/// Errors over the rows of folds beyond the others; `None` without such a fold.
fn errors_beyond(predicted: &[Vec<f64>], folds: &[HeldOut], output: &str) -> Option<Errors> {
    errors_where(predicted, folds, output, |fold| fold.is_beyond)
}

fn errors_where(
    predicted: &[Vec<f64>],
    folds: &[HeldOut],
    output: &str,
    counts: impl Fn(&HeldOut) -> bool,
) -> Option<Errors> {
    let mut pooled = PooledErrors::default();
    for (fold, predicted) in folds.iter().zip(predicted).filter(|(fold, _)| counts(fold)) {
        pooled.add(&fold.fold.held_out, predicted);
    }
    pooled.errors(output)
}

fn ensemble(
    body: Predictor,
    data: &Dataset,
    options: &AutoOptions,
    validation: Option<Errors>,
    selection: Option<Selection>,
    work: &AutoWork,
) -> Result<Model> {
    let found = ProvenanceDraft {
        options: FitSpec::Auto(options.clone()),
        chosen_start: 0,
        termination: if work.is_stopped() { Termination::Stopped } else { Termination::Converged },
        validation,
        penalties: None,
        runs: Vec::new(),
        selection,
    };
    Model::new(body, InputTransform::default(), options.rate, data, found)
}

fn provenance_of(
    model: &Model,
    selection: Option<Selection>,
    validation: Option<Errors>,
    work: &AutoWork,
) -> Provenance {
    let provenance = model.provenance().clone();
    let termination = if work.is_stopped() { Termination::Stopped } else { provenance.termination };
    Provenance { termination, validation, selection, ..provenance }
}
