//! The option for the known beginning of records.

use clap::Args;
use hysid::data::known_beginning::{KnownBeginning, KnownSpan};
use hysid::data::record::ColumnNames;
use hysid::{Model, Result};

/// Known beginning of each record.
#[derive(Debug, Clone, Args)]
pub struct KnownOptions {
    /// Measured beginning of each record, from which its state is found
    ///
    /// A number of rows, such as 100, or a time with its unit, such as 0.5s. Use it for records that are cut out of a longer
    /// past. These rows are not scored. Later rows need no output.
    #[arg(long, value_name = "ROWS|TIME", value_parser = known_span, conflicts_with = "initial_state")]
    pub known: Option<KnownSpan>,
}

impl KnownOptions {
    /// The beginning of records with these columns.
    pub fn beginning(&self, names: &ColumnNames) -> Result<KnownBeginning> {
        self.known.as_ref().map_or_else(|| Ok(KnownBeginning::default()), |known| known.beginning(names))
    }

    /// The model with this known beginning.
    pub fn of(&self, model: Model) -> Result<Model> {
        let beginning = self.beginning(model.names())?;
        Ok(model.with_known_beginning(beginning))
    }
}

/// A known beginning on a command line.
pub fn known_span(text: &str) -> Result<KnownSpan> {
    text.parse()
}
