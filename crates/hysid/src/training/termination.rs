//! Why a training run ended.

use serde::{Deserialize, Serialize};

use crate::training::soundness::MOST_COUNTED;

/// Why a training run ended. Not converging is an answer, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// The objective no longer falls noticeably.
    Converged,
    /// The gradient vanishes.
    GradientVanished,
    /// No step, however short, improves the objective at this precision.
    NoFurtherImprovement,
    /// The best value fell by less than one part in 10 000 over as many epochs as the stall rule allows.
    Stalled,
    /// All iterations were used.
    EpochsUsed,
    /// The observer said stop: Ctrl-C or a time limit.
    Stopped,
}

impl Termination {
    /// True if more iterations would not have helped.
    pub fn is_converged(self) -> bool {
        matches!(self, Self::Converged | Self::GradientVanished | Self::NoFurtherImprovement)
    }
}

impl std::fmt::Display for Termination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::GradientVanished => "converged (gradient vanished)",
            Self::NoFurtherImprovement => "converged (no step improves further)",
            Self::Stalled => "no longer improving noticeably",
            Self::EpochsUsed => "all epochs used",
            Self::Stopped => "stopped",
        })
    }
}

/// Relative fall of the best value that counts as an improvement.
const NOTICEABLE: f64 = 1e-4;

/// The stall rule: no noticeable improvement in so many epochs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stall {
    patience: usize,
    reference: f64,
    epochs: usize,
}

impl Stall {
    /// From a value on; without the rule if `patience` is 0.
    pub fn new(value: f64, patience: usize) -> Self {
        Self { patience, reference: value, epochs: 0 }
    }

    /// True if it is one that counts epochs of values.
    pub fn is_sound(&self) -> bool {
        !self.reference.is_nan() && self.epochs <= MOST_COUNTED
    }

    /// Takes the best value after one more epoch.
    pub fn is_reached(&mut self, best: f64) -> bool {
        if best < self.reference - NOTICEABLE * self.reference.abs() {
            self.reference = best;
            self.epochs = 0;
            return false;
        }
        self.epochs += 1;
        self.patience > 0 && self.epochs >= self.patience
    }
}
