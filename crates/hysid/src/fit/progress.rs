//! Progress and results of a fit.

mod checkpoint;
mod held_out;
mod shared_observer;
mod tried;

use std::fmt;
use std::ops::ControlFlow;

use crate::law::Classical;
use crate::model::Model;
use crate::model::history::Phase;
use crate::options::ModelName;
use crate::options::classical::ClassicalModel;
use crate::options::network::{FitOptions, Method};

pub use checkpoint::Checkpoint;
pub use held_out::HeldOutRows;
pub(crate) use shared_observer::SharedObserver;
pub use tried::{Standing, Tried};

/// Progress of a fit, after every epoch; during long epochs the same again, without checkpoint and model.
#[derive(Debug, Clone)]
pub struct Progress<'a> {
    /// The model that is being fitted.
    pub model: ModelName,
    /// True for one fit of many (a candidate, a fold). Only `done` then refers to the whole work.
    pub is_part: bool,
    /// The present part of the fit.
    pub phase: Phase,
    /// The present method.
    pub method: Method,
    /// Start, counted from 0.
    pub start: usize,
    /// Epochs done by this start in this phase.
    pub epoch: usize,
    /// Evaluations of the objective by this start in this phase, gradients included.
    pub evaluations: usize,
    /// Error on the training rows, in percent of the output's standard deviation; NaN while there is none.
    pub train_nrmse_percent: f64,
    /// Completed share of the work, 0 to 1, if every start takes all its epochs.
    pub done: f64,
    /// News of a candidate of `auto`; `None` while a fit is on its way.
    pub tried: Option<Tried<'a>>,
    pub(crate) present: Option<CurrentFit<'a>>,
}

/// A fit on its way. What it has come to is copied only on request.
pub(crate) trait PartialFit: Sync {
    /// The state from which the fit can be resumed; `None` for a model without checkpoints.
    fn checkpoint(&self) -> Option<Checkpoint> {
        None
    }

    fn model_so_far(&self) -> Option<Model>;
}

impl<F: Fn() -> Option<Model> + Sync> PartialFit for F {
    fn model_so_far(&self) -> Option<Model> {
        self()
    }
}

#[derive(Clone, Copy)]
pub(crate) struct CurrentFit<'a>(&'a dyn PartialFit);

impl fmt::Debug for CurrentFit<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a fit on its way")
    }
}

impl<'a> Progress<'a> {
    /// The state from which the fit can be resumed, copied on request; `None` for a model without checkpoints.
    pub fn checkpoint(&self) -> Option<Checkpoint> {
        self.present?.0.checkpoint()
    }

    /// The best model so far, which the fit would return if it stopped now: the network with the lowest objective, or the
    /// law that the search ranks first. Each call simulates the training data once.
    ///
    /// `None` before there is any model, for a law that is fitted without a search, and for a fit that is part of a larger
    /// one; for candidates of `auto` see [`tried`](Self::tried).
    pub fn model_so_far(&self) -> Option<Model> {
        self.present?.0.model_so_far()
    }

    /// Copy for a fit that is part of a larger one: without its state, `done` is the share of the whole work.
    pub(crate) fn of_part(&self, done: f64) -> Self {
        Self { done, is_part: true, present: None, ..self.clone() }
    }

    /// Copy without borrowed data.
    pub(crate) fn without_state(&self) -> Progress<'static> {
        Progress { tried: None, present: None, ..self.clone() }
    }

    pub(crate) fn with_state(self, unfinished: &'a dyn PartialFit) -> Self {
        Self { present: Some(CurrentFit(unfinished)), ..self }
    }

    pub(crate) fn of_beginning(options: &FitOptions) -> Self {
        Self::beginning(ModelName::Network(options.model), options.training.plan(options.epochs)[0].0)
    }

    pub(crate) fn of_least_squares(model: ClassicalModel) -> Self {
        Self::beginning(ModelName::Classical(model), Method::LeastSquares)
    }

    /// Report on a candidate of `auto`: its result so far, and its training error.
    pub(crate) fn of_candidate(model: ModelName, done: f64, tried: Tried<'a>) -> Self {
        let trained = tried.model.and_then(|model| model.provenance().trained_error().nrmse_std_percent);
        let train_nrmse_percent = trained.unwrap_or(f64::NAN);
        let beginning = Self::beginning(model, Method::LeastSquares);
        Self { is_part: true, train_nrmse_percent, done, tried: Some(tried), ..beginning }
    }

    fn beginning(model: ModelName, method: Method) -> Self {
        Self {
            model,
            is_part: false,
            phase: Phase::AllData,
            method,
            start: 0,
            epoch: 0,
            evaluations: 0,
            train_nrmse_percent: f64::NAN,
            done: 0.0,
            tried: None,
            present: None,
        }
    }

    pub(crate) fn of_search(model: ClassicalModel, progress: &SearchProgress) -> Self {
        Self {
            epoch: progress.round,
            evaluations: progress.evaluations,
            train_nrmse_percent: progress.train_nrmse_percent,
            done: progress.round as f64 / progress.rounds.max(1) as f64,
            ..Self::of_least_squares(model)
        }
    }
}

/// A function that gets the progress of a fit and can stop it.
pub type Observer<'a> = dyn FnMut(&Progress) -> ControlFlow<()> + Send + 'a;

/// A fitted model with the number of evaluations.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The fitted model, ready to simulate.
    pub model: Model,
    /// Evaluations of the objective, all starts together, gradients included.
    pub evaluations: usize,
    /// Parameters found by the search of a law, from which a similar fit can begin
    /// ([`near`](crate::options::classical::ClassicalOptions::near)); empty for other models.
    pub searched: Vec<f64>,
    /// The rows that were held out in turn, with their predictions; `None` if none were held out.
    pub held_out: Option<HeldOutRows>,
}

impl Fitted {
    /// A model that no similar fit can begin from.
    pub(crate) fn of(model: Model, evaluations: usize) -> Self {
        Self { model, evaluations, searched: Vec::new(), held_out: None }
    }

    pub(crate) fn with_held_out(self, held_out: Option<HeldOutRows>) -> Self {
        Self { held_out, ..self }
    }
}

/// Progress of a search, after every round.
#[derive(Debug, Clone, Copy)]
pub struct SearchProgress<'a> {
    /// Iterations of every remaining start.
    pub round: usize,
    /// Largest number of rounds.
    pub rounds: usize,
    /// Free runs of the law so far, all starts together.
    pub evaluations: usize,
    /// Error of the best start in free run, in percent of the standard deviation; NaN before there is one.
    pub train_nrmse_percent: f64,
    pub(crate) law: PartialLaw<'a>,
}

impl SearchProgress<'_> {
    /// The law of the best start so far, which is made only on request; `None` before there is one.
    pub fn law_so_far(&self) -> Option<Classical> {
        self.law.0.and_then(|law| law())
    }
}

/// How to make the law that a search has come to.
#[derive(Clone, Copy)]
pub(crate) struct PartialLaw<'a>(pub Option<&'a (dyn Fn() -> Option<Classical> + Sync)>);

impl fmt::Debug for PartialLaw<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(if self.0.is_some() { "a law" } else { "no law" })
    }
}

/// A function that gets the progress of a search and can stop it.
pub type SearchObserver<'a> = dyn FnMut(SearchProgress) -> ControlFlow<()> + 'a;
