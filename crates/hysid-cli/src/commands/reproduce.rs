//! `hysid reproduce`
use crate::Outcome;
use crate::arguments::Reproduce;
use anyhow::Result;
/// Runs the command.
pub fn run(_: &Reproduce) -> Result<Outcome> {
    Ok(Outcome::Done)
}
