//! The initial state of the records that a model is fitted to: known, or found for each record.
//!
//! An unknown state is found with a model that takes a moment to fit: each record gets the lead-in with which the
//! model has the lowest error on all records together.

mod search;

use std::borrow::Cow;

use crate::data::initial_state::InitialState;
use crate::data::rate::RateMethod;
use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::progress::{Observer, Progress, SharedObserver};
use crate::law::facts::Origin;
use crate::model::input_transform::origin;
use crate::options::classical::{ClassicalModel, ClassicalOptions};
use crate::stop_check::StopCheck;
use crate::validation::Fold;

/// Rows with an output that states are found from, at most.
const MOST_ROWS: usize = 6000;

/// A network that takes a moment to fit.
pub(crate) fn quick() -> ClassicalOptions {
    let (operators, hidden, deterioration) = (Some(60), Some(0), Some(true));
    ClassicalOptions { operators, hidden, deterioration, ..ClassicalOptions::of(ClassicalModel::RandomStops) }
}

pub(crate) const QUICK_INTERVALS: usize = search::INTERVALS;

/// The requested initial state, and what is needed to find it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StateRequest {
    pub state: Option<InitialState>,
    /// Where the model measures its input from.
    pub origin: Origin,
    /// Rate and seed of the model that an unknown state is found with.
    pub rate: Option<RateMethod>,
    pub seed: u64,
}

impl StateRequest {
    /// Each record after its lead-in. Once the observer stops, an unknown state is the one found so far.
    pub fn of<'d>(&self, data: &'d Dataset, observer: &mut Observer<'_>) -> Result<Cow<'d, Dataset>> {
        match self.state {
            None | Some(InitialState::Free) => Ok(Cow::Borrowed(data)),
            Some(InitialState::Unknown) => {
                let beginning = Progress::of_least_squares(ClassicalModel::RandomStops);
                let observer = SharedObserver::new(observer, Some(beginning.of_part(0.0)));
                let is_to_stop = || observer.is_to_stop();
                let found = found(data, self.rate, self.seed, StopCheck::new(&is_to_stop))?;
                Ok(found.map_or(Cow::Borrowed(data), Cow::Owned))
            }
            Some(state) => known(data, state, self.origin).map(Cow::Owned),
        }
    }

    /// Folds with the states found on each, if the state is unknown; none once stopped.
    pub fn on_folds(&self, folds: Vec<Fold>, stop: StopCheck<'_>) -> Result<Vec<Fold>> {
        if self.state != Some(InitialState::Unknown) {
            return Ok(folds);
        }
        let on_folds = folds.iter().map(|fold| found_on(fold, self.rate, self.seed, stop));
        Ok(on_folds.collect::<Result<Option<_>>>()?.unwrap_or_default())
    }
}

pub(crate) fn known(data: &Dataset, state: InitialState, measured_from: Origin) -> Result<Dataset> {
    if state == InitialState::Periodic {
        return data.clone().with_periodic_lead_ins();
    }
    let origin = match measured_from {
        Origin::Zero(_) => 0.0,
        Origin::OfData => origin(data, 0),
    };
    let lead_in = state.lead_in(data.input_range(0), origin).unwrap_or_default();
    data.clone().with_lead_ins(|_, _| lead_in.clone())
}

/// The data with the lead-ins that are found for the records; `None` once stopped.
pub(crate) fn found(
    data: &Dataset,
    rate: Option<RateMethod>,
    seed: u64,
    stop: StopCheck<'_>,
) -> Result<Option<Dataset>> {
    let Some(lead_ins) = search::lead_ins(&data.thinned(MOST_ROWS), rate, seed, stop)? else {
        return Ok(None);
    };
    data.clone().with_lead_ins(|index, _| lead_ins[index].clone()).map(Some)
}

/// A fold with lead-ins found for its training data; held-out data have the most frequent of them. `None` once stopped.
pub(crate) fn found_on(
    fold: &Fold,
    rate: Option<RateMethod>,
    seed: u64,
    stop: StopCheck<'_>,
) -> Result<Option<Fold>> {
    let Some(train) = found(&fold.train, rate, seed, stop)? else { return Ok(None) };
    let lead_in = train.most_frequent_lead_in().to_vec();
    let held_out = fold.held_out.clone().with_lead_ins(|_, _| lead_in.clone())?;
    Ok(Some(Fold { name: fold.name.clone(), train, held_out }))
}
