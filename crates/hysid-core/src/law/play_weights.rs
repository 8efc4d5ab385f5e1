//! Weights of the plays of a generalized or rate-dependent Prandtl-Ishlinskii law.
//!
//! ```text
//! p(r) = ρ e^{-τ r}     or one free weight for each play                    theory.md (8.14)
//! ```
//!
//! `r` is the threshold of a play, `ρ` has the unit of a weight and `τ` the inverse unit of `r`.

use serde::{Deserialize, Serialize};

use crate::elementary::exp;
use crate::error::{Error, LARGEST_VALUE, Result};
use crate::law::{Dimension, Parameter};

/// Most plays of a law.
pub const MOST_PLAYS: usize = 1000;

/// The weights of plays with evenly spaced thresholds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum PlayWeights {
    /// `ρ e^{-τ r}`, the density of Al Janaideh, Rakheja and Su.
    Exponential {
        /// Number of plays.
        plays: usize,
        /// `ρ`, in the unit of a weight.
        rho: f64,
        /// `τ`, in the inverse unit of the thresholds.
        tau: f64,
    },
    /// A weight for each play.
    Free(Vec<f64>),
}

impl PlayWeights {
    /// Number of plays.
    pub fn plays(&self) -> usize {
        match self {
            Self::Exponential { plays, .. } => *plays,
            Self::Free(weights) => weights.len(),
        }
    }

    /// The weights of the plays at the thresholds `spacing` times `first`, `first + 1`, ...
    pub fn values(&self, spacing: f64, first: usize) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.plays());
        self.for_each(spacing, first, |_, weight| all.push(weight));
        all
    }

    /// Calls a function with the index and the weight of each play; one exponential suffices for all.
    #[inline(always)]
    pub(crate) fn for_each(&self, spacing: f64, first: usize, mut take: impl FnMut(usize, f64)) {
        match self {
            Self::Exponential { plays, rho, tau } => {
                let ratio = exp(-tau * spacing);
                let mut weight = rho * exp(-tau * spacing * first as f64);
                for index in 0..*plays {
                    take(index, weight);
                    weight *= ratio;
                }
            }
            Self::Free(weights) => {
                for (index, &weight) in weights.iter().enumerate() {
                    take(index, weight);
                }
            }
        }
    }

    /// Rejects weights that would overflow.
    pub(crate) fn check(&self, law: &str, spacing: f64, first: usize) -> Result<()> {
        if self.plays() == 0 || self.plays() > MOST_PLAYS {
            let plays = self.plays();
            return Err(Error::Parts(format!("{law}: {plays} plays, and there must be 1 to {MOST_PLAYS}")));
        }
        if self.values(spacing, first).iter().all(|weight| weight.abs() <= LARGEST_VALUE) {
            return Ok(());
        }
        Err(Error::Parts(format!("{law}: a weight is not finite or beyond {LARGEST_VALUE:e}")))
    }

    /// Its parameters; `weight` is the unit of a weight, `threshold` that of a threshold.
    pub(crate) fn parameters(
        &self,
        symbol: &str,
        first: usize,
        weight: Dimension,
        threshold: Dimension,
    ) -> Vec<Parameter> {
        let any = (-LARGEST_VALUE, LARGEST_VALUE);
        match self {
            Self::Exponential { rho, tau, .. } => {
                let inverse =
                    Dimension { input: -threshold.input, output: -threshold.output, time: -threshold.time };
                Parameter::table([
                    ("ρ", "weight of a play at threshold 0", *rho, any, weight),
                    ("τ", "decline of the weight with the threshold", *tau, any, inverse),
                ])
            }
            Self::Free(weights) => {
                Parameter::numbered(symbol, first, weights, "weight of a play", any, weight).collect()
            }
        }
    }
}
