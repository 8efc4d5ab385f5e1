//! Options of the input transform.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::data::initial_state::InitialState;

/// Options of the [input transform](crate::model::input_transform), relative to the data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InputOptions {
    /// Compression `asinh(x / s)` of the first input: `s` as a share of its largest magnitude (theory.md (11.1)).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compression: Option<f64>,
    /// Compression `asinh(x' / s')` of the rate: `s'` as a share of the rate that 99.5 % of all rows stay below.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_compression: Option<f64>,
    /// True if running peak and travelled path of the first input, `max |x| so far` and `ln(1 + 10 path so
    /// far / P)`, are inputs too (theory.md (11.2)).
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub history: bool,
    /// Warm-up: rows at the beginning of each record that advance the memory and are not scored in training.
    #[serde(skip_serializing_if = "is_zero")]
    pub warm_up: usize,
    /// Initial state of every record; `None` for the lead-ins that the records have, virgin without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<InitialState>,
}

fn is_zero(rows: &usize) -> bool {
    *rows == 0
}

/// Valid shares.
pub const SHARES: RangeInclusive<f64> = 1e-6..=1e3;

/// Number of inputs that the history adds.
pub const HISTORY_INPUTS: usize = 2;

impl InputOptions {
    /// True if the input is not transformed and there is no warm-up.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
