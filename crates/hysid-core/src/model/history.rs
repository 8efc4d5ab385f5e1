//! Training history: the runs of a fit and their errors.

use serde::{Deserialize, Serialize};

use crate::options::network::Method;
use crate::termination::Termination;

/// A part of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Starts on the training part of a fold.
    Starts,
    /// The starts on all data; the history is that of the best one.
    AllData,
}

/// One point of a training history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HistoryPoint {
    /// Epoch: an iteration, or a generation.
    pub epoch: usize,
    /// Evaluations of the objective so far, including gradients.
    pub evaluations: usize,
    /// Error on the training rows, in percent of the output's standard deviation.
    pub train_nrmse_percent: f64,
}

/// A training run: one method from one start, or on all data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The part of the fit to which it belongs.
    pub phase: Phase,
    /// Start, counted from 0.
    pub start: usize,
    /// The method; those of a hybrid are two runs.
    pub method: Method,
    /// Error after each epoch. If there are many epochs, only those at which it decreased noticeably, and the
    /// last. Epochs and evaluations of a hybrid's second method continue those of the first.
    pub history: Vec<HistoryPoint>,
    /// Why it ended.
    pub termination: Termination,
    /// The fold of its training data, counted from 0; `None` for all data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold: Option<usize>,
    /// Error on the held-out data of the fold, in percent of their standard deviation.
    pub validation_nrmse_percent: Option<f64>,
}
