//! Identification of networks.
//!
//! [`fit`] does all of it: it scales the data, trains several random networks by the chosen trainer,
//! cross-validates some of them, and trains the best few on all data. [`resume`] continues a fit from a
//! [`Checkpoint`].
//!
//! ```text
//! F(θ) = min_c [ ½ ‖Φ(θ) c - y‖²/N + ½ λ ‖c‖² ] + ½ κ ‖θ‖²_w               theory.md (3.1)
//! ```
//!
//! All trainers minimize `F`. `θ` are the parameters found by search, `c` the output weights (by least
//! squares, for each `θ`), `Φ` the terms of the output, one row for each of the `N` scored samples, `y` the
//! scaled measured output, `λ` and `κ` the penalties
//! ([`Regularisation`](crate::options::network::Regularisation)).

pub mod checkpoint;
pub(crate) mod curvature;
mod encoding;
pub(crate) mod fitting;
pub(crate) mod least_squares;
pub mod objective;
pub mod random_stops;
mod run;
mod shared_observer;
mod soundness;
pub mod start;

use std::fmt;
use std::ops::ControlFlow;

use crate::data::record::Dataset;
use crate::error::Result;
use crate::fit::HeldOutRows;
use crate::fit::auto::Tried;
use crate::fit::initial_state::Wanted;
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
use fitting::Fitting;
pub(crate) use shared_observer::SharedObserver;

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
    /// What has just become known of a candidate of `auto`; `None` if this tells of a fit on its way.
    pub tried: Option<Tried<'a>>,
    present: Option<Present<'a>>,
}

/// A fit on its way. What it has come to is copied only on request.
#[derive(Clone, Copy)]
pub(crate) enum Present<'a> {
    Network(&'a Fitting<'a>),
    Law(&'a (dyn Fn() -> Option<Model> + Sync)),
}

impl fmt::Debug for Present<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Present::Network(_) => "Network",
            Present::Law(_) => "Law",
        })
    }
}

impl<'a> Progress<'a> {
    /// The state from which the fit can be resumed, copied on request; `None` for a model without checkpoints.
    pub fn checkpoint(&self) -> Option<Checkpoint> {
        match self.present? {
            Present::Network(fitting) => Some(fitting.checkpoint()),
            Present::Law(_) => None,
        }
    }

    /// The best model of the fit so far, complete, as if the fit had been stopped: the network with the lowest
    /// objective, or the law that the search ranks first. It is made only on request, which takes a free run over the
    /// training data.
    ///
    /// `None` before there is any model, for a law that is found without a search, and for a fit that is only a part
    /// of the work; candidates of `auto` have models of their own in [`tried`](Self::tried).
    pub fn model_so_far(&self) -> Option<Model> {
        match self.present? {
            Present::Network(fitting) => fitting.model_so_far(),
            Present::Law(model) => model(),
        }
    }

    /// The same of a fit that is only a part of the work, and so without its state.
    pub(crate) fn of_part(&self, done: f64) -> Self {
        Self { done, is_part: true, present: None, ..self.clone() }
    }

    /// The same without what it refers to.
    pub(crate) fn without_state(&self) -> Progress<'static> {
        Progress { tried: None, present: None, ..self.clone() }
    }

    pub(crate) fn with_state(self, present: Present<'a>) -> Self {
        Self { present: Some(present), ..self }
    }

    pub(crate) fn of_beginning(options: &FitOptions) -> Self {
        Self::beginning(ModelName::Network(options.model), options.training.plan(options.epochs)[0].0)
    }

    pub(crate) fn of_least_squares(model: ClassicalModel) -> Self {
        Self::beginning(ModelName::Classical(model), Method::LeastSquares)
    }

    /// Of a candidate of `auto`: what has become known of it, and its error on the rows that it was fitted to.
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
    /// The model.
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

/// Identifies a network.
///
/// `observer` is called after every epoch. If it returns `Break`, the fit ends with the best model so far,
/// and with [`Stopped`](crate::termination::Termination::Stopped) as the reason. It is also called during
/// long epochs, so that a fit stops soon; the results of an incomplete epoch are discarded. The result
/// depends on data, options and seed only, not on the number of threads.
///
/// # Errors
/// Data from which no model can be identified, invalid options, or a stop before there was a model.
pub fn fit(data: &Dataset, options: &FitOptions, observer: &mut Observer<'_>) -> Result<Fitted> {
    let begun = wanted_of(options).of(data, observer)?;
    let data = begun.as_ref();
    let seen = Transformed::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options.clone())?.run(observer)
}

fn wanted_of(options: &FitOptions) -> Wanted {
    let FitOptions { shaping, rate, seed, .. } = *options;
    Wanted { state: shaping.initial_state, origin: Origin::OfData, rate, seed }
}

/// Resumes a fit of the same data. The result is the same to the last bit as without the interruption.
///
/// # Errors
/// A checkpoint of other data, or one that is inconsistent.
pub fn resume(data: &Dataset, checkpoint: Checkpoint, observer: &mut Observer<'_>) -> Result<Fitted> {
    let begun = wanted_of(checkpoint.options()).of(data, observer)?;
    let data = begun.as_ref();
    let (options, state) = checkpoint.for_data(data)?;
    let seen = Transformed::of(data, &options.shaping, options.rate, Origin::OfData)?;
    Fitting::new(data, &seen, options)?.from(state)?.run(observer)
}
