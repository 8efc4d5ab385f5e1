//! The stall rule: a run ends that no longer improves noticeably.

use serde::{Deserialize, Serialize};

use crate::optimise::MOST_COUNTED;

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
