//! Why a search ended.

use serde::{Deserialize, Serialize};

/// Why a training run ended. A run that did not converge is a result, not an error.
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
    /// The observer stopped it: Ctrl-C or a time limit.
    Stopped,
}

impl std::fmt::Display for Termination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::GradientVanished => "converged (gradient vanished)",
            Self::NoFurtherImprovement => "converged (no step improves further)",
            Self::Stalled => "no noticeable improvement any more",
            Self::EpochsUsed => "all epochs used",
            Self::Stopped => "stopped",
        })
    }
}
