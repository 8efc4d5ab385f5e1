//! The initial state of the records that a model is fitted to: known, or found for each record.
//!
//! An unknown state is found by alternation. A model that takes a moment to fit, of random stops, is fitted to
//! the records with their present lead-ins; then each record gets the lead-in with which the model has the
//! lowest squared error there. It ends when no record changes, or after four rounds.

use std::borrow::Cow;

use rayon::prelude::*;

use crate::data::initial_state::{InitialState, lead_ins_tried};
use crate::data::rate::RateMethod;
use crate::data::record::{Dataset, Record};
use crate::error::{Error, Result};
use crate::fit::identify;
use crate::fit::network::{Observer, SharedObserver};
use crate::law::facts::Origin;
use crate::model::Model;
use crate::model::input_transform::origin;
use crate::options::FitSpec;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::validation::Fold;

/// Rounds of the alternation, at most.
const ROUNDS: usize = 4;

/// Share of its squared error that a record must be left with by another lead-in. Designed.
const WORTH: f64 = 0.99;

/// Rows with an output that the quick model is fitted to and compared with, at most.
const MOST_ROWS: usize = 6000;

/// Stops of the quick model.
const QUICK_STOPS: usize = 60;

/// A model that takes a moment to fit: few random stops.
pub(crate) fn quick(rate: Option<RateMethod>, deterioration: bool, seed: u64) -> ClassicalOptions {
    ClassicalOptions {
        rate,
        deterioration: Some(deterioration),
        operators: Some(QUICK_STOPS),
        hidden: Some(0),
        seed,
        ..ClassicalOptions::of(ClassicalModel::RandomStops)
    }
}

/// A fit of the quick model; `None` if there was no time for it.
pub(crate) type QuickFit<'f> = dyn Fn(&Dataset) -> Result<Option<Model>> + Sync + 'f;

/// The initial state that is asked for, and what is needed to find it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted {
    pub state: Option<InitialState>,
    /// Where the model measures its input from.
    pub origin: Origin,
    /// Rate and seed of the quick model.
    pub rate: Option<RateMethod>,
    pub seed: u64,
}

impl Wanted {
    /// The data as they are to be fitted to: each record after its lead-in. The observer is asked whether to
    /// stop; an unknown state is then that which was found so far.
    ///
    /// # Errors
    /// Data to which the quick model cannot be fitted.
    pub fn of<'d>(&self, data: &'d Dataset, observer: &mut Observer<'_>) -> Result<Cow<'d, Dataset>> {
        match self.state {
            None => Ok(Cow::Borrowed(data)),
            Some(InitialState::Unknown) => {
                let observer = SharedObserver::new(observer, None);
                let fit = |data: &Dataset| self.quick_fit(data, &observer);
                Ok(Cow::Owned(found(data, &fit)?))
            }
            Some(state) => known(data, state, self.origin).map(Cow::Owned),
        }
    }

    /// Folds of data whose initial state is unknown, as [`on_fold`] has them; others as they are.
    ///
    /// # Errors
    /// Data to which the quick model cannot be fitted.
    pub fn on_folds(&self, folds: Vec<Fold>, observer: &SharedObserver<'_, '_>) -> Result<Vec<Fold>> {
        if self.state != Some(InitialState::Unknown) {
            return Ok(folds);
        }
        let fit = |data: &Dataset| self.quick_fit(data, observer);
        folds.into_iter().map(|fold| on_fold(&fold, found(&fold.train, &fit)?)).collect()
    }

    fn quick_fit(&self, data: &Dataset, observer: &SharedObserver<'_, '_>) -> Result<Option<Model>> {
        let request = FitSpec::Classical(quick(self.rate, true, self.seed));
        match identify(data, &request, &mut |progress| observer.tell(&progress.of_part(0.0))) {
            Err(Error::Stopped) => Ok(None),
            fitted => Ok(Some(fitted?.model).filter(|_| !observer.is_over())),
        }
    }
}

/// The data in a known initial state.
///
/// # Errors
/// None for data with an input.
pub(crate) fn known(data: &Dataset, state: InitialState, measured_from: Origin) -> Result<Dataset> {
    let origin = match measured_from {
        Origin::Zero => 0.0,
        Origin::OfData => origin(data, 0),
    };
    let lead_in = state.lead_in(data.input_range(0), origin).unwrap_or_default();
    data.clone().with_lead_ins(|_, _| lead_in.clone())
}

/// The data with the lead-ins that were found; those of the last finished round if there was no time for more.
fn found(data: &Dataset, fit: &QuickFit<'_>) -> Result<Dataset> {
    let few = data.thinned(MOST_ROWS);
    let few = Alternation::of(&few, fit)?.data;
    data.clone().with_lead_ins(|index, _| few.records()[index].lead_in().unwrap_or_default().to_vec())
}

/// A fold whose training data have the lead-ins that were found for them alone: held-out data begin with the
/// most frequent of them.
///
/// # Errors
/// None for lead-ins that records have.
pub(crate) fn on_fold(fold: &Fold, train: Dataset) -> Result<Fold> {
    let lead_in = train.most_frequent_lead_in().to_vec();
    let held_out = fold.held_out.clone().with_lead_ins(|_, _| lead_in.clone())?;
    Ok(Fold { name: fold.name.clone(), train, held_out })
}

/// What the alternation found.
pub(crate) struct Alternation {
    /// The data with their lead-ins.
    pub data: Dataset,
    /// The quick models of the virgin state and of the lead-ins that were found; `None` if there was no time.
    pub models: Option<(Model, Model)>,
}

impl Alternation {
    /// Finds the lead-in of each record with an output; the others are virgin.
    ///
    /// # Errors
    /// As the fit, and a free run of its model.
    pub fn of(data: &Dataset, fit: &QuickFit<'_>) -> Result<Self> {
        let tried = lead_ins_tried(data.input_range(0));
        let mut chosen = vec![0; data.records().len()];
        let begun = |chosen: &[usize]| data.clone().with_lead_ins(|index, _| tried[chosen[index]].clone());
        let mut present = begun(&chosen)?;
        let Some(virgin) = fit(&present)? else { return Ok(Self { data: present, models: None }) };
        let mut fitted = virgin.clone();
        for _ in 0..ROUNDS {
            let records = data.records().par_iter().zip(&chosen);
            let next: Vec<usize> =
                records.map(|(record, &before)| best(record, before, &tried, &fitted)).collect::<Result<_>>()?;
            if next == chosen {
                break;
            }
            let with_next = begun(&next)?;
            let Some(model) = fit(&with_next)? else { return Ok(Self { data: present, models: None }) };
            (present, fitted, chosen) = (with_next, model, next);
        }
        Ok(Self { data: present, models: Some((virgin, fitted)) })
    }
}

/// The lead-in with the lowest squared error in a record, by its place among those tried; that of before unless
/// another is worth a change.
fn best(record: &Record, before: usize, tried: &[Vec<f64>], model: &Model) -> Result<usize> {
    let square_error = |lead_in: &Vec<f64>| -> Result<f64> {
        let simulated = model.response(&record.excitation().with_lead_in(lead_in)?)?;
        let rows = simulated.iter().zip(record.output()).filter(|(_, y)| !y.is_nan());
        Ok(rows.map(|(simulated, y)| (simulated - y) * (simulated - y)).sum())
    };
    let errors: Vec<f64> = tried.iter().map(square_error).collect::<Result<_>>()?;
    let lowest = (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(before);
    Ok(if errors[lowest] < WORTH * errors[before] { lowest } else { before })
}
