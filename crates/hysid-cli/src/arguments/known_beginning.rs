//! The option for the known beginning of records.

use anyhow::{Result, bail};
use clap::Args;
use hysid::Model;
use hysid::data::record::KnownBeginning;
use hysid::data::unit::of_column;

/// Known beginning of each record.
#[derive(Debug, Clone, Args)]
pub struct KnownOptions {
    /// Measured beginning of each record, from which its state is found
    ///
    /// A number of rows, such as 100, or a time with its unit, such as 0.5s. Use it for records that are cut out of a longer
    /// past. These rows are not scored. Later rows need no output.
    #[arg(long, value_name = "ROWS|TIME", value_parser = parsed, conflicts_with = "initial_state")]
    pub known: Option<KnownText>,
}

impl KnownOptions {
    /// The model with this known beginning.
    pub fn of(&self, model: Model) -> Result<Model> {
        match &self.known {
            Some(known) => {
                let beginning = known.beginning(model.names().time.as_deref())?;
                Ok(model.with_known_beginning(beginning))
            }
            None => Ok(model),
        }
    }
}

/// A known beginning as it was typed.
#[derive(Debug, Clone, PartialEq)]
pub enum KnownText {
    Rows(usize),
    /// A time and its unit.
    Time(f64, String),
}

impl KnownText {
    /// The beginning in the unit of a column of time.
    pub fn beginning(&self, time: Option<&str>) -> Result<KnownBeginning> {
        let (duration, unit) = match self {
            Self::Rows(rows) => return Ok(KnownBeginning::Rows(*rows)),
            Self::Time(duration, unit) => (*duration, unit.as_str()),
        };
        match time.and_then(of_column) {
            Some(of_time) if of_time == unit => Ok(KnownBeginning::Time(duration)),
            Some(of_time) => bail!("--known {duration}{unit}: the unit of time is {of_time}"),
            None => bail!("--known {duration}{unit}: no unit of time is known; give a number of rows"),
        }
    }
}

pub(super) fn parsed(text: &str) -> Result<KnownText, String> {
    let advice = || "give a number of rows, such as 100, or a time with its unit, such as 0.5s".to_string();
    if let Ok(rows) = text.parse() {
        return if rows > 0 { Ok(KnownText::Rows(rows)) } else { Err(advice()) };
    }
    let end = text.find(|letter: char| letter.is_alphabetic()).ok_or_else(advice)?;
    let (number, unit) = text.split_at(end);
    match number.trim().parse() {
        Ok(duration) if duration > 0.0 && f64::is_finite(duration) => {
            Ok(KnownText::Time(duration, unit.into()))
        }
        _ => Err(advice()),
    }
}
