//! `hysid models`: all models that a fit can use, or what a model file holds.

use anyhow::Result;
use hysid_app::models;

use crate::Outcome;
use crate::arguments::Models;
use crate::commands::model_from_bytes;
use crate::files;
use crate::inspection::Inspected;
use crate::messages::told;

pub fn run(arguments: &Models) -> Result<Outcome> {
    match &arguments.model {
        None => {
            let all = models::all();
            told(arguments.json, || Ok(&all), || models::text(&all))?;
        }
        Some(path) => {
            let content = files::read(path)?;
            let model = model_from_bytes(path, content.clone())?;
            let inspected = Inspected::of(path, &content, &model)?;
            told(arguments.json, || Ok(inspected.printed()), || inspected.text())?;
        }
    }
    Ok(Outcome::Done)
}
