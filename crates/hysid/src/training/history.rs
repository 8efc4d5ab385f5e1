//! What became of each start of a fit.

use serde::{Deserialize, Serialize};

use crate::training::termination::Termination;

/// A part of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// The random starts, on the training part.
    Starts,
    /// The best few starts, on all data; the run kept is the winner's.
    Refit,
}

/// One point of a training history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HistoryPoint {
    /// Iteration.
    pub epoch: usize,
    /// Error on the training rows, in percent of the output's standard deviation.
    pub train_nrmse_percent: f64,
}

/// What became of one start, or of the refit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Which part of the fit it is.
    pub phase: Phase,
    /// Start, counted from 0.
    pub start: usize,
    /// Error after each iteration.
    pub history: Vec<HistoryPoint>,
    /// Why it ended.
    pub termination: Termination,
    /// Error on the data held out, in percent of their standard deviation.
    pub validation_nrmse_percent: Option<f64>,
}
