//! Validity of the state of a fit that was read from a file: every number finite and within its bounds, every
//! length that of the network. A checksum detects damage, but not edited files.

use crate::error::{Error, Result};
use crate::network::{Architecture, ParameterLayout};
use crate::options::network::FitOptions;

pub(super) struct NetworkFrame<'a> {
    pub options: &'a FitOptions,
    pub architecture: &'a Architecture,
    pub layout: ParameterLayout,
}

impl<'a> NetworkFrame<'a> {
    pub fn new(options: &'a FitOptions, architecture: &'a Architecture) -> Self {
        Self { options, architecture, layout: ParameterLayout::new(*architecture) }
    }

    /// Parameters within their bounds.
    pub fn are_parameters(&self, values: &[f64]) -> bool {
        self.layout.check(values).is_ok()
    }
}

pub(super) fn are_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

/// Refuses what is not sound, naming it.
pub(super) fn require(is_sound: bool, what: &str) -> Result<()> {
    if is_sound {
        return Ok(());
    }
    Err(Error::Checkpoint(format!("the checkpoint is inconsistent ({what}): start a new fit")))
}
