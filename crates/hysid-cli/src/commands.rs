//! One file for each command.

pub mod bench;
pub mod compare;
pub mod completions;
pub mod cycles;
pub mod demo;
pub mod diagnose;
pub mod evaluate;
pub mod export;
pub mod fit;
pub mod generate;
pub mod invert;
pub mod look;
pub mod man;
pub mod models;
pub mod reproduce;
pub mod simulate;
pub mod validate;

use std::path::Path;

use anyhow::{Result, anyhow, ensure};
use hysid::model::Model;

use crate::files;

/// Refuses a model without a band.
fn check_band(model: &Model, path: &Path) -> Result<()> {
    ensure!(
        model.band().is_some(),
        "{}: this model has no prediction band: `hysid fit` calibrates one with --model auto or --members, \
         if there are enough data to hold some out",
        path.display()
    );
    Ok(())
}

/// Reads a model file.
fn read_model(path: &Path) -> Result<Model> {
    model_from_bytes(path, files::read(path)?)
}

/// The model that a file with this content holds.
fn model_from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Model> {
    let text = String::from_utf8(bytes)
        .map_err(|_| anyhow!("{}: this is not a Hysid model file: it is not text", path.display()))?;
    Model::from_json(&text).map_err(|error| anyhow!("{}: {error}", path.display()))
}
