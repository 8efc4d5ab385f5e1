//! The option for the known beginning of records.

use std::str::FromStr;

use clap::Args;
use hysid::data::known_beginning::KnownSpan;
use hysid::{Model, Result};

/// Known beginning of each record.
#[derive(Debug, Clone, Args)]
pub struct KnownOptions {
    /// Measured beginning of each record, from which its state is found
    ///
    /// A number of rows, such as 100, or a time with its unit, such as 0.5s. Use it for records that are cut out of a longer
    /// past. These rows are not scored. Later rows need no output.
    #[arg(long, value_name = "ROWS|TIME", value_parser = KnownSpan::from_str, conflicts_with = "initial_state")]
    pub known: Option<KnownSpan>,
}

impl KnownOptions {
    /// The model with this known beginning.
    pub fn of(&self, model: Model) -> Result<Model> {
        let Some(known) = &self.known else { return Ok(model) };
        let beginning = known.beginning(model.names())?;
        Ok(model.with_known_beginning(beginning))
    }
}
