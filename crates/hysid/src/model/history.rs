//! What became of each training run.

use serde::{Deserialize, Serialize};

use crate::options::network::Method;
use crate::termination::Termination;

/// A part of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Starts on the training part of a fold.
    Starts,
    /// The starts on all data; the run kept is the winner's.
    #[serde(alias = "refit")]
    AllData,
}

/// One point of a training history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HistoryPoint {
    /// Epoch: an iteration, or a generation.
    pub epoch: usize,
    /// Evaluations of the objective so far, gradients included; 0 in old files, which did not count.
    #[serde(default)]
    pub evaluations: usize,
    /// Error on the training rows, in percent of the output's standard deviation.
    pub train_nrmse_percent: f64,
}

/// What one method made of one start, or of all data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Which part of the fit it is.
    pub phase: Phase,
    /// Start, counted from 0.
    pub start: usize,
    /// The method; those of a hybrid are two runs.
    #[serde(default)]
    pub method: Method,
    /// Error after each epoch; where epochs are many, those at which it fell noticeably, and the last.
    /// Epochs and evaluations of a hybrid's second method go on from the first.
    pub history: Vec<HistoryPoint>,
    /// Why it ended.
    pub termination: Termination,
    /// The fold that it was trained on, counted from 0; `None` for all data, and in files of before version 4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold: Option<usize>,
    /// Error on what was held out of the fold, in percent of the standard deviation there.
    pub validation_nrmse_percent: Option<f64>,
}
