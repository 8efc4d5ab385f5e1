//! `hysid completions`: a script by which a shell completes commands and options.

use anyhow::Result;

use crate::Outcome;
use crate::arguments::{Arguments, Completions};
use crate::messages::raw_results;

pub fn run(arguments: &Completions) -> Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::whole(), "hysid", &mut script);
    raw_results(&String::from_utf8(script)?)?;
    Ok(Outcome::Done)
}
