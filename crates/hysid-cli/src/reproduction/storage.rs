//! Finished experiments as files `NAME.json` of a folder, so that they need not be run again.

use std::fs;

use anyhow::Result;
use hysid_paper::{Chapter, Experiment, Settings};
use serde::{Deserialize, Serialize};

use super::Outputs;
use crate::files;

/// A finished experiment and how it was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    version: String,
    seed: u64,
    quick: bool,
    /// The day it was made.
    pub date: String,
    /// How long it took, beside whatever ran at the same time.
    pub seconds: f64,
    /// What it came to.
    pub chapter: Chapter,
}

impl Finished {
    /// Made just now.
    pub fn new(settings: Settings, date: String, seconds: f64, chapter: Chapter) -> Self {
        let Settings { seed, quick } = settings;
        Self { version: env!("CARGO_PKG_VERSION").into(), seed, quick, date, seconds, chapter }
    }

    /// Stores it. It took long to make: if it cannot be written there, it is put elsewhere, and the error says where.
    pub fn keep(&self, outputs: Outputs) -> Result<()> {
        let text = serde_json::to_string(self)?;
        files::write_or_rescue(&outputs.stored(&self.chapter.name), "finished experiment", text.as_bytes())
    }
}

/// An experiment that was finished earlier by this version with the same settings; anything else there is
/// none.
pub fn find(outputs: Outputs, experiment: Experiment, settings: Settings) -> Option<Finished> {
    let text = fs::read_to_string(outputs.stored(experiment.name()).path()).ok()?;
    let found: Finished = serde_json::from_str(&text).ok()?;
    let Settings { seed, quick } = settings;
    let is_same = found.version == env!("CARGO_PKG_VERSION") && (found.seed, found.quick) == (seed, quick);
    (is_same && experiment.is_sound(&found.chapter)).then_some(found)
}
