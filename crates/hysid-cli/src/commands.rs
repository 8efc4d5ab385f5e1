//! One file for each command.

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
pub mod plan;
pub mod plot;
pub mod reproduce;
pub mod restoring_force;
pub mod simulate;
pub mod studio;
pub mod validate;

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, ensure};
use hysid::model::Model;
use hysid_document::Problem;
use hysid_tables::{Table, is_model};

use crate::arguments::ReadingOptions;
use crate::{files, help};

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

/// Kind of the files of a command that takes data or a model.
enum Given {
    /// The content of a model file.
    Model(Vec<u8>),
    Tables(Vec<Table>),
}

impl Given {
    /// Of files with these contents; `alone` is what to do with a model that comes with further files.
    fn of(files: &[PathBuf], contents: Vec<Vec<u8>>, reading: &ReadingOptions, alone: &str) -> Result<Self> {
        match contents.iter().position(|content| is_model(content)) {
            Some(_) if contents.len() == 1 => {
                Ok(Self::Model(contents.into_iter().next().unwrap_or_default()))
            }
            Some(place) => {
                let model = files[place].display();
                Err(Problem::request(format!("{model} is a model: {alone} alone, without further files"))
                    .into())
            }
            None => {
                let reading = reading.reading();
                let table = |(path, content): (&PathBuf, Vec<u8>)| Table::from_bytes(path, content, &reading);
                Ok(Self::Tables(files.iter().zip(contents).map(table).collect::<Result<_, _>>()?))
            }
        }
    }
}

fn read_model(path: &Path) -> Result<Model> {
    model_from_bytes(path, files::read(path)?)
}

/// The model that a file with this content holds.
fn model_from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Model> {
    let behind = if is_model(&bytes) { None } else { help::model_behind(path) };
    let model = match String::from_utf8(bytes) {
        Ok(text) => Model::from_json(&text).map_err(|error| anyhow!("{}: {error}", path.display())),
        Err(_) => Err(anyhow!("{}: this is not a Hysid model file: it is not text", path.display())),
    };
    model.map_err(|error| match behind {
        Some(other) => {
            let (path, other) = (path.display(), files::shown(&other));
            anyhow!("{path}: this is not a Hysid model file (swapped? {other} is one: name the model first)")
        }
        None => error,
    })
}
