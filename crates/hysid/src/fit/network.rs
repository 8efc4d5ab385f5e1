//! Identification: from a data set to a fitted network.
//!
//! [`fit`] is the whole of it: scale, start from one or several random networks, let each descend by the
//! chosen trainer, judge several on data that were held out, and train the best few on everything.
//! [`resume`] takes up a fit where a [`Checkpoint`] left it.

pub mod checkpoint;
pub(crate) mod curvature;
mod encoding;
mod fitting;
pub(crate) mod least_squares;
pub mod objective;
pub mod random_stops;
mod run;
mod shared_observer;
mod soundness;
pub mod start;

use std::ops::ControlFlow;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::law::search::SearchProgress;
use crate::law::facts::Origin;
use crate::model::Model;
use crate::model::history::Phase;
use crate::model::input_transform::Transformed;
use crate::options::ModelName;
use crate::options::classical::ClassicalModel;
use crate::options::network::FitOptions;
use crate::options::network::Method;
pub use checkpoint::Checkpoint;
use checkpoint::Snapshot;
use fitting::Fitting;
pub(crate) use shared_observer::SharedObserver;

/// Where a fit is, told to the observer after every epoch, and now and then in between: the same once more, without
/// a checkpoint, so that it may say stop.
#[derive(Debug, Clone)]
pub struct Progress<'a> {
    /// The model that is being fitted.
    pub model: ModelName,
    /// True for one fit of many: of a candidate of `auto`, or to a fold of a validation. Only `done` speaks of
    /// the whole work then.
    pub is_part: bool,
    /// What is being done.
    pub phase: Phase,
    /// How it is being done.
    pub method: Method,
    /// Start, counted from 0.
    pub start: usize,
    /// Epochs done by this start in this phase.
    pub epoch: usize,
    /// Evaluations of the objective by this start in this phase, gradients included.
    pub evaluations: usize,
    /// Error on the training rows, in percent of the output's standard deviation; NaN while there is none.
    pub train_nrmse_percent: f64,
    /// Share of the work done, 0 to 1, if every start takes all its epochs.
    pub done: f64,
    snapshot: Option<Snapshot<'a>>,
}

impl Progress<'_> {
    /// All that is needed to take up the fit from here; `None` for a model that has no checkpoints. It
    /// costs a copy of the state, so it is made when it is asked for.
    pub fn checkpoint(&self) -> Option<Checkpoint> {
        self.snapshot.map(|snapshot| snapshot.checkpoint())
    }

    /// The same without the state, of a fit that is only a part of the work.
    pub(crate) fn of_part(&self, done: f64) -> Progress<'static> {
        Progress { done, is_part: true, snapshot: None, ..self.clone() }
    }

    /// The same without the state.
    pub(crate) fn without_state(&self) -> Progress<'static> {
        Progress { snapshot: None, ..self.clone() }
    }

    /// Of a network's fit before its first epoch.
    pub(crate) fn of_beginning(options: &FitOptions) -> Self {
        Self {
            model: ModelName::Network(options.model),
            is_part: false,
            phase: Phase::AllData,
            method: options.training.plan(options.epochs)[0].0,
            start: 0,
            epoch: 0,
            evaluations: 0,
            train_nrmse_percent: f64::NAN,
            done: 0.0,
            snapshot: None,
        }
    }

    /// Of a model's fit that has no rounds.
    pub(crate) fn of_least_squares(model: ClassicalModel) -> Self {
        let nothing_yet =
            SearchProgress { round: 0, rounds: 1, evaluations: 0, train_nrmse_percent: f64::NAN };
        Self::of_search(model, &nothing_yet)
    }

    /// Of a classical model's search.
    pub(crate) fn of_search(model: ClassicalModel, progress: &SearchProgress) -> Self {
        Self {
            model: ModelName::Classical(model),
            is_part: false,
            phase: Phase::AllData,
            method: Method::LeastSquares,
            start: 0,
            epoch: progress.round,
            evaluations: progress.evaluations,
            train_nrmse_percent: progress.train_nrmse_percent,
            done: progress.round as f64 / progress.rounds.max(1) as f64,
            snapshot: None,
        }
    }
}

/// Who is told of the progress, and may break off.
pub type Observer<'a> = dyn FnMut(&Progress) -> ControlFlow<()> + Send + 'a;

/// A fitted model and how it came about.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// Evaluations of the objective, all starts together, gradients included.
    pub evaluations: usize,
}

/// Identifies a network.
///
/// `observer` is told of every epoch and may stop the fit by breaking: the best model so far is then
/// returned, with [`Stopped`](crate::termination::Termination::Stopped) as the reason for its end. It is also asked
/// in the midst of long epochs, so that it is obeyed soon; what such an epoch has not finished is thrown away. The
/// result depends on data, options and seed only, not on the number of threads.
///
/// # Errors
/// Data that nothing can be identified from, options outside their meaning, or a stop before there was any model.
pub fn fit(data: &Dataset, options: &FitOptions, observer: &mut Observer<'_>) -> Result<Fit> {
    let seen = Transformed::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options.clone())?.run(observer)
}

/// Goes on with a fit of the same data. What comes out is, to the last bit, what the fit would have come
/// to without the interruption.
///
/// # Errors
/// A checkpoint of other data, or one that contradicts itself.
pub fn resume(data: &Dataset, checkpoint: Checkpoint, observer: &mut Observer<'_>) -> Result<Fit> {
    let (options, state) = checkpoint.for_data(data)?;
    let seen = Transformed::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options)?.from(state)?.run(observer)
}
