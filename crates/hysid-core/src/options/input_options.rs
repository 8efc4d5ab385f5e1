//! What a model sees of its input, as it is asked for.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::error::Result;
use crate::options::table::check;

/// What is asked for, in shares of what the data show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InputOptions {
    /// `s` of theory.md (11.1) as a share of the largest magnitude of the first input; `None` for an input
    /// as it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub companding: Option<f64>,
    /// `s'` as a share of the rate that 99.5 % of all rows stay below.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_companding: Option<f64>,
    /// The largest magnitude and the path of the first input so far are inputs too, theory.md (11.2).
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub history: bool,
    /// Rows at the beginning of each record that drive the memory and are not trained on: a record that
    /// does not begin in the virgin state comes to its own memory there.
    #[serde(skip_serializing_if = "is_zero")]
    pub warm_up: usize,
}

fn is_zero(rows: &usize) -> bool {
    *rows == 0
}

/// Shares that spread something, and not everything.
pub const SHARES: RangeInclusive<f64> = 1e-6..=1e3;

/// Inputs that a summary of the past adds.
pub const HISTORY_INPUTS: usize = 2;

impl InputOptions {
    /// True if nothing is asked for.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Refuses shares that spread nothing, or everything.
    pub(crate) fn check(&self) -> Result<()> {
        let shares = [("companding", self.companding), ("rate_companding", self.rate_companding)];
        check(shares.into_iter().filter_map(|(name, share)| Some((name, json!(share?)))))
    }
}
