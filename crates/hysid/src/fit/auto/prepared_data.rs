//! How the records begin: in the virgin state, after a warm-up, after one period of themselves, or in states that are
//! found for them.
//!
//! Each way is compared by the validation error of candidates that take a moment to fit. The virgin state is kept
//! unless a warm-up is better by 10 %, or other states by 20 %: these have more ways to fit by chance. Records whose
//! beginning and end meet are tried as periods, before states are looked for.

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::record::{Dataset, Record};
use crate::error::Result;
use crate::fit::auto::candidates::Candidate;
use crate::fit::auto::score::Score;
use crate::fit::auto::trial::{FoldBench, HeldOut, Trial};
use crate::fit::auto::warm_up::better;
use crate::fit::auto::work::AutoWork;
use crate::fit::initial_state::{self, QUICK_INTERVALS, found_on, known};
use crate::fit::law::hysteretic_dynamics::first_second_difference;
use crate::law::facts::Origin;
use crate::model::selection::{FoundStates, WarmUp};
use crate::optimise::parallel;
use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::options::fit_spec::AutoOptions;
use crate::stop_check::StopCheck;
use crate::validation::Fold;

/// The validation error that other states must come to, as a share of that of the virgin state. Designed.
const WORTH: f64 = 0.8;

/// Largest gap between the ends of a record that meet, as a share of the range and in largest steps. Designed.
const CLOSED: f64 = 0.1;
const CLOSED_STEPS: f64 = 2.0;

/// Share of a record that begins with a jump of the input whose rows are not scored. Designed.
const AFTER_A_JUMP: f64 = 0.1;

/// A second difference of the input in the first rows above this share of its range is a jump. Designed.
const JUMP: f64 = 0.01;

pub(super) struct PreparedData {
    pub data: Dataset,
    pub folds: Vec<Fold>,
    pub warm_up: WarmUp,
    /// The records have other lead-ins than before.
    pub is_changed: bool,
    /// Why states were found, if cross-validation decided it.
    pub found: Option<FoundStates>,
}

/// The data in the initial state that the user chose, if it is a known one.
pub(super) fn as_chosen<'d>(data: &'d Dataset, options: &AutoOptions) -> Result<Cow<'d, Dataset>> {
    match options.initial_state {
        None | Some(InitialState::Unknown | InitialState::Free) => Ok(Cow::Borrowed(data)),
        Some(state) => known(data, state, Origin::OfData).map(Cow::Owned),
    }
}

impl PreparedData {
    /// How the records of these data begin.
    pub fn of(
        quick: &Candidate,
        data: &Dataset,
        folds: Vec<Fold>,
        options: &AutoOptions,
        work: &AutoWork,
    ) -> Self {
        let has_lead_in = |record: &Record| record.lead_in().is_some();
        let is_open = options.initial_state.is_none() && !data.records().iter().any(has_lead_in);
        let warm_up = match options.warm_up {
            Some(rows) => WarmUp::decided(rows),
            None => better(quick.clone(), data, &folds, work),
        };
        let ways = Ways { quick, data, folds: &folds, options, work };
        let other = match (options.initial_state, options.warm_up) {
            (Some(InitialState::Unknown), _) => ways.found(),
            (None, None) if is_open => {
                let is_worth = |states: &AlternativeStates| states.is_worth(warm_up);
                ways.periods().filter(is_worth).or_else(|| ways.found().filter(is_worth))
            }
            _ => None,
        };
        let Some(other) = other else {
            return Self { data: data.clone(), folds, warm_up, is_changed: false, found: None };
        };
        Self {
            data: other.data,
            folds: other.folds,
            warm_up: if is_open { WarmUp::decided(0) } else { warm_up },
            is_changed: true,
            found: other.errors.filter(|_| is_open),
        }
    }

    /// Records whose states are found together with the parameters.
    pub fn with_free_states(data: &Dataset, folds: Vec<Fold>) -> Self {
        let warm_up = WarmUp::decided(0);
        Self { data: data.clone(), folds, warm_up, is_changed: false, found: None }
    }

    /// Records of systems with inertia: from rest, or after a warm-up that the user decided. If the input of a held-out
    /// record begins with a jump, the first tenth of the record is not scored, because the input between its first rows is
    /// not known.
    pub fn with_inertia(data: &Dataset, folds: Vec<Fold>, options: &AutoOptions) -> Self {
        let warm_up = WarmUp::decided(options.warm_up.unwrap_or(0));
        let (low, high) = data.input_range(0);
        let without_jump = |record: &Record| {
            let rows =
                if jumps(record, high - low) { (AFTER_A_JUMP * record.len() as f64) as usize } else { 0 };
            record.clone().scored_where(|row| row >= rows)
        };
        let judged = |fold: Fold| {
            let held_out = fold.held_out.records().iter().map(without_jump).collect();
            match Dataset::new(fold.held_out.names().clone(), held_out) {
                Ok(held_out) if held_out.scored() > 0 => Fold { held_out, ..fold },
                _ => fold,
            }
        };
        let folds = folds.into_iter().map(judged).collect();
        Self { data: data.clone(), folds, warm_up, is_changed: false, found: None }
    }

    /// The data with the lead-ins of these records, which are some of their rows.
    pub fn of_all<'d>(&self, all: &'d Dataset) -> Result<Cow<'d, Dataset>> {
        if !self.is_changed {
            return Ok(Cow::Borrowed(all));
        }
        let records = self.data.records();
        let of_record = |index: usize, _: &Record| records[index].lead_in().unwrap_or_default().to_vec();
        all.clone().with_lead_ins(of_record).map(Cow::Owned)
    }
}

/// True if the first rows of a record are not those of an input that begins smoothly.
fn jumps(record: &Record, range: f64) -> bool {
    first_second_difference(&record.inputs()[0]) > JUMP * range
}

struct AlternativeStates {
    data: Dataset,
    folds: Vec<Fold>,
    /// Errors on the folds; `None` where they are those of the virgin state, and without folds.
    errors: Option<FoundStates>,
}

impl AlternativeStates {
    /// True if it is enough better than the virgin state, and no worse than a warm-up that is better too.
    fn is_worth(&self, warm_up: WarmUp) -> bool {
        let Some(FoundStates { found_percent, virgin_percent }) = self.errors else { return false };
        let ratio = found_percent / virgin_percent;
        let of_warm_up = warm_up.without_percent.zip(warm_up.with_percent);
        ratio < WORTH && of_warm_up.is_none_or(|(without, with)| ratio <= without / with)
    }
}

struct Ways<'a, 'o, 'w> {
    quick: &'a Candidate,
    data: &'a Dataset,
    folds: &'a [Fold],
    options: &'a AutoOptions,
    work: &'a AutoWork<'o, 'w>,
}

impl Ways<'_, '_, '_> {
    /// States found for all records and for the training part of each fold; `None` once stopped, or if no candidate
    /// fits.
    fn found(&self) -> Option<AlternativeStates> {
        let is_to_stop = || self.work.is_to_stop();
        let stop = StopCheck::new(&is_to_stop);
        let (rate, seed) = (self.options.rate, self.options.seed);
        let folds = parallel::each(self.folds, |fold| found_on(fold, rate, seed, stop).ok()?);
        let folds = folds.into_iter().collect::<Option<_>>()?;
        Some(self.judged(initial_state::found(self.data, rate, seed, stop).ok()??, folds))
    }

    /// All records after one period of themselves; `None` if the ends of a record do not meet.
    fn periods(&self) -> Option<AlternativeStates> {
        if !self.data.records().iter().all(is_closed) {
            return None;
        }
        let begun = |data: &Dataset| data.clone().with_periodic_lead_ins().ok();
        let of_fold = |fold: &Fold| {
            Some(Fold {
                name: fold.name.clone(),
                train: begun(&fold.train)?,
                held_out: begun(&fold.held_out)?,
            })
        };
        Some(self.judged(begun(self.data)?, self.folds.iter().map(of_fold).collect::<Option<_>>()?))
    }

    /// Other states, with their errors on the folds beside those of the virgin state.
    fn judged(&self, data: Dataset, folds: Vec<Fold>) -> AlternativeStates {
        let has_past = |record: &Record| !record.lead_in_rows().is_empty();
        let is_changed = folds.iter().any(|fold| fold.train.records().iter().any(has_past));
        let errors = || {
            let (found_percent, virgin_percent) =
                (self.percent(&data, &folds)?, self.percent(&data, self.folds)?);
            Some(FoundStates { found_percent, virgin_percent })
        };
        // Folds with the same lead-ins as before have the same errors.
        let errors = is_changed.then(errors).flatten();
        AlternativeStates { data, folds, errors }
    }

    /// The validation error of the better of two quick candidates.
    fn percent(&self, data: &Dataset, folds: &[Fold]) -> Option<f64> {
        let held_out: Vec<HeldOut> = folds.iter().cloned().map(HeldOut::of).collect();
        // A magnet is not seen by stops alone, nor deterioration by relays.
        let judges = std::iter::once(self.quick.clone()).chain(self.relays());
        let mut trials: Vec<Trial> = judges.map(Trial::of).collect();
        let places: Vec<usize> = (0..trials.len()).collect();
        FoldBench { data, whole: data, folds: &held_out, work: self.work }.try_start(&mut trials, &places, 0);
        let tried = trials.iter().filter(|trial| !trial.starts.is_empty());
        let errors = tried.map(|trial| Score::of(&trial.predicted, &held_out, |_| true).mean_percent());
        errors.min_by(f64::total_cmp)
    }

    /// A Preisach plane that takes a moment to fit, for data of one input.
    fn relays(&self) -> Option<Candidate> {
        let preisach = ClassicalOptions {
            operators: Some(QUICK_INTERVALS),
            seed: self.options.seed,
            ..ClassicalOptions::of(ClassicalModel::Preisach)
        };
        (self.data.names().inputs.len() == 1).then(|| Candidate::alone(&FitSpec::Classical(preisach)))
    }
}

/// True if the end of a record and its beginning are one point of its loop.
fn is_closed(record: &Record) -> bool {
    let meet = |values: &[f64]| {
        let known = || values.iter().filter(|value| !value.is_nan());
        let (Some(first), Some(last)) = (known().next(), known().next_back()) else { return false };
        let (low, high) = known().fold((*first, *first), |(low, high), &v| (low.min(v), high.max(v)));
        let step = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        (last - first).abs() <= (CLOSED_STEPS * step).min(CLOSED * (high - low))
    };
    meet(&record.inputs()[0]) && meet(record.output())
}
